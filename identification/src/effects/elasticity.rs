//! Torsional elasticity between motor and measured position.

use ferntast_model::friction::{Contrast, Proposal, TORQUE, Unit};

use super::{Effect, Facts, Memory, Point, free, logarithmic, row};
use crate::numerics::filter::{Kernel, least_width};
use crate::signals::{Channels, InvalidSamples};

row!(
    Elasticity,
    id: "elasticity",
    equation: "q_m = q + δ with K δ + K3 δ³ = τ, K = 1/inverse_K, K3 = K/(inverse_K τ_s)²: τ_F and J feel q_m",
    source: "stiffness of the flex spline, ROKVISS, lessons learned, Fig. 15",
    coefficients: &[free("inverse_K", Unit::new("rad/Nm", "m/N"))],
    shape: &[free("tau_s", TORQUE)],
    shows_as: "over τ and τ̇",
    excited_by: "load that changes fast while the joint hardly moves",
    shown_by: Proposal::Accelerations,
    contrasts: &[Contrast::SlowReversals, Contrast::Accelerations],
    confusable_with: &["presliding_hysteresis", "channel_delay"],
    needs_prediction: true,
    acts_on_channels: true,
);

/// Most steps of Newton's method: up to seven for u to 10; beyond, each takes a third off, and
/// u = 1e12 takes 49.
const STEPS: usize = 64;

/// f of f + f³ = u, u the `load`: deflection of a stiffening joint, scaled by that at
/// which the cubic term equals the linear one.
fn wound_up(load: f64) -> f64 {
    let most = load.abs();
    // Above where it turns back nowhere; (u + 2)/3 is the tangent of ∛u at 1.
    let mut twist = most.min((most + 2.0) / 3.0);
    for _ in 0..STEPS {
        let square = twist * twist;
        let next = twist - (twist * (1.0 + square) - most) / (1.0 + 3.0 * square);
        // It comes down to the root; where it no longer does, only rounding is left.
        if next.is_nan() || next >= twist {
            break;
        }
        twist = next;
    }
    twist.copysign(load)
}

impl Effect for Elasticity {
    row!(methods);

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        // To first order: ∂τ_F/∂q̇ times the speed of winding up, J times its
        // acceleration.
        if let ([c], [stiff, ..]) = (columns, shape) {
            let twist = wound_up(point.load / stiff);
            let slope = 1.0 / (1.0 + 3.0 * twist * twist);
            let curve = -6.0 * twist * slope.powi(3) / stiff;
            *c = point.friction_slope * slope * point.load_rate
                + point.inertia * (slope * point.load_jerk + curve * point.load_rate.powi(2));
        }
    }

    // From twice as stiff under a third of the greatest load to hardly stiffer.
    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        logarithmic(low, high, 6)
            .into_iter()
            .map(|torque| vec![torque])
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![[0.1 * facts.motor_torque, 10.0 * facts.motor_torque]]
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        facts.no_torque_sensor()
    }

    fn compensate(
        &self,
        shape: &[f64],
        coefficients: &[f64],
        channels: &mut Channels,
        points: &[Point],
    ) -> InvalidSamples {
        let first = points.first();
        if let ([stiff, ..], [inverse, ..], Some(first)) = (shape, coefficients, first) {
            let period = first.period;
            let recorded = std::slice::from_ref(&channels.joint_torque);
            let width = least_width(recorded, 2, period);
            let smooth = Kernel::sharp(width, 0, period);
            for (at, position) in channels.position.iter_mut().enumerate() {
                let torque = smooth.at(&channels.joint_torque, at);
                *position += inverse * stiff * wound_up(torque / stiff);
            }
        }
        InvalidSamples::default()
    }

    // The motor is ahead of the measured position in the direction of the torque.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.first().is_some_and(|c| *c > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// τ = 300 δ + 6e4 δ³.
    #[test]
    fn a_stiffening_joint_winds_up_by_its_law() {
        let stiff = 300.0 * f64::sqrt(300.0 / 6e4);
        for angle in [-0.5, -0.01, 0.0, 1e-4, 0.03, 0.5, 100.0] {
            let torque = 300.0 * angle + 6e4 * f64::powi(angle, 3);
            let found = stiff / 300.0 * wound_up(torque / stiff);
            let most = 1e-12 * f64::max(1.0, angle.abs());
            assert!((found - angle).abs() < most, "{found} for {angle}");
        }
    }

    /// Its column is the derivative of what it does to τ_F + J q̈_m.
    #[test]
    fn its_column_is_what_winding_up_does() {
        let (load, rate, jerk, by) = (12.0, 90.0, -400.0, 1e-4);
        let twist = |time: f64| {
            let load = load + rate * time + 0.5 * jerk * time * time;
            20.0 * wound_up(load / 20.0)
        };
        let speed = (twist(by) - twist(-by)) / (2.0 * by);
        let acceleration = (twist(by) + twist(-by) - 2.0 * twist(0.0)) / (by * by);
        let point = Point {
            load,
            load_rate: rate,
            load_jerk: jerk,
            friction_slope: 70.0,
            inertia: 1.2,
            ..Point::default()
        };
        let mut column = [0.0];
        Elasticity::default().evaluate(&[20.0], &point, &mut [0.0; 4], &mut column);
        let expected = 70.0 * speed + 1.2 * acceleration;
        assert!((column[0] - expected).abs() < 1e-4 * expected.abs());
    }
}

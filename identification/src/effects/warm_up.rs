//! Friction that falls while a joint warms up and nobody measures its temperature.
//!
//! A joint is one heat capacity that is heated and cools towards its surroundings, and its lubricant gets
//! thinner: tw dθ/dt = P/P0 − θ, with θ how warm it is, 1 of a joint that has been heated with P0 for
//! long. P is the power of friction, (τ_m − τ) q̇ (what inertia, weight and springs take they give back
//! in much less than tw), or the joint is heated evenly, as by its drive, P/P0 = 1. Every recording
//! begins cold. Simoni, Beschi, Legnani and Visioli 2015, "Friction modeling with temperature effects for
//! industrial robot manipulators", IROS (abstract), for the power of friction.

use ferntast_model::friction::{EffectParameter, Facts, Unit, Unmeasured, logarithmic};

use super::{Effect, Memory, Point, combinations, free};

/// Their shape: tw, and P0 or [`EVENLY`].
pub(super) const SHAPE: &[EffectParameter] = &[
    free("tw", Unit::new("s", "s")),
    free("P0", Unit::new("W", "W")),
];

/// In place of P0.
const EVENLY: f64 = 0.0;
/// Fastest that a joint warms up, the film of its lubricant \[s\].
const FASTEST: f64 = 15.0;
/// Time constants that are told by a recording, in its lengths: beyond, it shows a straight line.
const SLOWEST_OF_LENGTH: f64 = 2.0;

/// θ \[-\] at a sample; the memory is θ before it.
pub(super) fn warmth(shape: &[f64], point: &Point, memory: &mut Memory) -> f64 {
    let [warmth, ..] = memory;
    if let [time_constant, power] = *shape {
        *warmth += (heating(power, point) - *warmth) * point.period / time_constant;
    }
    *warmth
}

/// P/P0.
fn heating(power: f64, point: &Point) -> f64 {
    match power == EVENLY {
        true => 1.0,
        false => (point.motor_torque - point.load) * point.velocity / power,
    }
}

/// The column of `effect` over a piece that begins within its recording, as warm as a joint that did
/// the same before; `None` of one that begins with it, cold.
pub(super) fn within_a_recording(
    effect: &dyn Effect,
    shape: &[f64],
    points: &[Point],
) -> Option<Vec<Vec<f64>>> {
    let ([time_constant, power], [first, ..]) = (shape, points) else {
        return None;
    };
    if first.time <= first.period {
        return None;
    }
    let heating = points.iter().map(|point| heating(*power, point));
    let mean = heating.sum::<f64>() / points.len() as f64;
    let warm = mean * (1.0 - (-first.time / time_constant).exp());
    let mut memory = [warm, 0.0, 0.0, 0.0];
    let each = points.iter().map(|point| {
        let mut column = [0.0];
        effect.evaluate(shape, point, &mut memory, &mut column);
        column[0]
    });
    Some(vec![each.collect()])
}

// P0 is not refined: it is a scale.
pub(super) fn bounds(facts: &Facts) -> Vec<[f64; 2]> {
    let slowest = SLOWEST_OF_LENGTH * facts.recording_length;
    vec![[FASTEST, slowest.max(FASTEST)], [0.0, 0.0]]
}

pub(super) fn shapes(facts: &Facts) -> Vec<Vec<f64>> {
    let [low, high] = bounds(facts)[0];
    let powers = [EVENLY, facts.friction_power].into_iter();
    let powers = powers.filter(|own| *own >= EVENLY).collect();
    combinations(&[logarithmic(low, high, 8), powers])
}

/// Why nothing can be said of warming up, if nothing can.
pub(super) fn unavailable(facts: &Facts) -> Option<String> {
    let measured = Unmeasured::Temperature.measured(facts);
    measured.or(facts.no_warm_up())
}

/// Friction falls as a joint warms up.
pub(super) fn plausible(coefficients: &[f64]) -> bool {
    coefficients.iter().all(|own| *own > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{column_of, find};

    const PERIOD: f64 = 0.1;

    /// 100 s at 0.5 rad/s against 8 Nm, from `start` \[s\] on.
    fn points(start: f64) -> Vec<Point> {
        (0..1000)
            .map(|at| Point {
                period: PERIOD,
                time: start + f64::from(at) * PERIOD,
                velocity: 0.5,
                motor_torque: 11.0,
                load: 3.0,
                ..Point::default()
            })
            .collect()
    }

    /// θ = 1 − e^(−t/tw) of even heat, and P/P0 times that of a power that stays: 4 W of 2 W.
    #[test]
    fn it_warms_up_as_one_heat_capacity_does() {
        let coulomb = find("warm_up_coulomb").unwrap();
        for (power, most) in [(EVENLY, 1.0), (2.0, 2.0)] {
            let column = column_of(coulomb.as_ref(), &[40.0, power], &points(0.0));
            let expected = most * (1.0 - (-100.0_f64 / 40.0).exp());
            assert!((column[999] + expected).abs() < 2e-3, "{}", column[999]);
            assert!(coulomb.whole(&[40.0, power], &points(0.0)).is_none());
            // A piece that begins 100 s later goes on from there.
            let later = coulomb.whole(&[40.0, power], &points(100.0)).unwrap();
            assert!((later[0][0] / column[999] - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn viscous_friction_falls_with_speed() {
        let shape = [40.0, EVENLY];
        let [coulomb, viscous] = ["warm_up_coulomb", "warm_up_viscous"]
            .map(|id| column_of(find(id).unwrap().as_ref(), &shape, &points(0.0)));
        assert!((viscous[500] / coulomb[500] - 0.5).abs() < 1e-12);
    }
}

//! A soft gear before a load that nobody measures.
//!
//! Motor and load are two inertias with a spring and a damper between them. The motor is measured;
//! a share s of the inertia J and of the friction is behind the spring. With the winding
//! x = θ − q_L and the load's own frequency ω = √(K / s J), at which it swings while the motor is
//! held, the load goes by J q̈_L = J (ω² x + 2 ζ ω ẋ) − r τ_R(q̇_L) per share, and the motor feels
//! s J (ω² x + 2 ζ ω ẋ) where a model without it has s (J θ̈ + r τ_R(θ̇)). Spong 1987, "Modeling
//! and control of elastic joint robots", ASME J. Dyn. Syst. Meas. Control 109, with friction of the
//! load and damping. Weight winds the spring up by a little that hardly changes: it is left out.

use ferntast_model::friction::{ONE, Proposal, Unit};

use super::{Effect, Facts, Memory, Point, free, logarithmic, row, sign};

row!(
    LoadElasticity,
    id: "load_elasticity",
    equation: "in place of s (J q̈ + r τ_R) of the load the motor feels s J (ω² x + 2 ζ ω ẋ), ω = 2π frequency, x = q − q_L",
    source: "Spong 1987, elastic joint; with friction of the load and damping",
    coefficients: &[free("inertia_share", ONE)],
    shape: &[
        free("frequency", Unit::new("Hz", "Hz")),
        free("damping_ratio", ONE),
        free("friction_ratio", ONE),
    ],
    shows_as: "swings that die away after a start, a stop or a reversal",
    excited_by: "starts, stops and reversals that take no longer than one swing",
    shown_by: Proposal::Accelerations,
    confusable_with: &["load_backlash", "presliding_hysteresis", "channel_delay"],
    needs_prediction: true,
    of_unmeasured_load: true,
);

/// Indices of the memory: position \[rad\] and speed \[rad/s\] of the load, the latter half a
/// sample before; whether begun.
const POSITION: usize = 0;
const SPEED: usize = 1;
const BEGUN: usize = 2;

/// Slowest load \[Hz\]: what swings more slowly is another mechanism than a gear.
const SLOWEST: f64 = 2.0;
/// Fastest load \[Hz\], and in periods of the samples, seven of which have one swing.
const FASTEST: f64 = 60.0;
const FASTEST_OF_SAMPLES: f64 = 0.15;
/// Greatest damping ratio of a gear, and that up to which it is searched: what fits best where
/// nothing swings is a lag, which has other causes.
const MOST_DAMPED: f64 = 0.2;
const MOST_DAMPED_SEARCHED: f64 = 0.7;

/// What the motor feels of the load beyond what it would feel of a stiff one, per share of the
/// inertia \[Nm\].
fn beyond_stiff(shape: &[f64], point: &Point, memory: &mut Memory) -> f64 {
    let ([frequency, damping, friction_ratio], true) = (shape, point.inertia > 0.0) else {
        return 0.0;
    };
    let inertial = point.inertia * point.acceleration;
    // The modelled load is inertia, weight and springs.
    let friction = friction_ratio * (point.friction_predicted - (point.load - inertial));
    let stiff = (inertial + friction) / point.inertia;
    let omega = std::f64::consts::TAU * frequency;
    // Steps of this length swing faster by (ω T)²/24.
    let omega = omega * (1.0 - (omega * point.period).powi(2) / 24.0);
    let [spring, damper] = [omega * omega, 2.0 * damping * omega];
    if memory[BEGUN] == 0.0 {
        *memory = [
            point.position - stiff / spring,
            point.velocity - 0.5 * point.period * point.acceleration,
            1.0,
            0.0,
        ];
    }
    let felt = |speed: f64| {
        spring * (point.position - memory[POSITION]) + damper * (point.velocity - speed)
    };
    let before = memory[SPEED];
    let driven = before + felt(before) * point.period;
    // Friction stops it, and does not turn it round.
    let slowed = (driven.abs() - friction.abs() / point.inertia * point.period).max(0.0);
    let speed = slowed * sign(driven);
    let felt = felt(0.5 * (before + speed));
    memory[POSITION] += speed * point.period;
    memory[SPEED] = speed;
    point.inertia * (felt - stiff)
}

impl Effect for LoadElasticity {
    row!(methods);

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        if let [column] = columns {
            *column = beyond_stiff(shape, point, memory);
        }
    }

    // So close that a load that swings by itself for long is not missed between two of them.
    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        let mut shapes = Vec::new();
        for frequency in logarithmic(low, high, 14) {
            for damping_ratio in [0.04, 0.2] {
                for friction_ratio in [0.0, 0.7, 1.4] {
                    shapes.push(vec![frequency, damping_ratio, friction_ratio]);
                }
            }
        }
        shapes
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let fastest = FASTEST.min(FASTEST_OF_SAMPLES / facts.period);
        vec![
            [SLOWEST.min(fastest), fastest],
            [0.0, MOST_DAMPED_SEARCHED],
            [0.0, 4.0],
        ]
    }

    fn is_itself(&self, shape: &[f64]) -> bool {
        shape.get(1).is_some_and(|damping| *damping <= MOST_DAMPED)
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        // Of the inertia that a model without it has, which may be smaller.
        coefficients.iter().all(|share| (0.05..2.0).contains(share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const PERIOD: f64 = 1e-3;
    const INERTIA: f64 = 0.9;

    /// A motor that swings by 0.1 rad at `frequency` \[Hz\] for 4 s, and `friction` \[Nm\].
    fn points(frequency: f64, friction: f64) -> Vec<Point> {
        let rate = TAU * frequency;
        (0..4000)
            .map(|at| {
                let time = f64::from(at) * PERIOD;
                let (sine, cosine) = (rate * time).sin_cos();
                let acceleration = -0.1 * rate * rate * sine;
                let velocity = 0.1 * rate * cosine;
                Point {
                    period: PERIOD,
                    time,
                    position: 0.1 * sine,
                    velocity,
                    acceleration,
                    load: INERTIA * acceleration,
                    friction_predicted: friction * velocity.signum(),
                    inertia: INERTIA,
                    ..Point::default()
                }
            })
            .collect()
    }

    fn column(shape: &[f64], points: &[Point]) -> Vec<f64> {
        let mut memory = Memory::default();
        let each = points.iter();
        each.map(|point| beyond_stiff(shape, point, &mut memory))
            .collect()
    }

    /// Without friction it is linear: J θ̈ (1/(1 − ρ²) − 1) with ρ the ratio of the frequencies,
    /// once the swings of the beginning have died away, and little damping.
    #[test]
    fn an_inert_load_swings_farther_than_the_motor() {
        for (motor, own, gain) in [
            (5.0, 10.0, 1.0 / 3.0),
            (5.0, 20.0, 1.0 / 15.0),
            (20.0, 10.0, -4.0 / 3.0),
        ] {
            let points = points(motor, 0.0);
            let column = column(&[own, 0.02, 0.0], &points);
            let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
            let felt = most(&mut column[3800..].iter().copied());
            let rigid = most(&mut points[3800..].iter().map(|own| own.load));
            assert!(
                (felt / rigid - f64::abs(gain)).abs() < 0.02,
                "{own} Hz: {}",
                felt / rigid
            );
            // In phase below its own frequency, in antiphase above.
            let together: f64 = (3800..4000).map(|at| column[at] * points[at].load).sum();
            assert_eq!(together > 0.0, gain > 0.0, "{own} Hz");
        }
    }

    /// The spring winds up to J ω² x = r τ_R before the load moves: 2 Nm at 5 Hz take 2.25 mrad.
    #[test]
    fn friction_holds_the_load_until_the_spring_is_wound_up() {
        let start = |at: usize| Point {
            period: PERIOD,
            position: 1e-5 * at as f64,
            velocity: 0.01,
            friction_predicted: 2.0,
            inertia: INERTIA,
            ..Point::default()
        };
        let mut memory = [0.0, 0.0, 1.0, 0.0];
        let moves = (0..1000).find(|&at| {
            beyond_stiff(&[5.0, 0.0, 1.0], &start(at), &mut memory);
            memory[SPEED] > 0.0
        });
        let expected = 2.0 / (INERTIA * (TAU * 5.0).powi(2));
        let travel = 1e-5 * moves.unwrap() as f64;
        assert!((travel - expected).abs() < 3e-5, "{travel} rad");
    }

    #[test]
    fn a_stiff_load_is_felt_as_one() {
        let points = points(0.5, 1.5);
        let column = column(&[60.0, 0.3, 1.0], &points);
        let rms = |own: &mut dyn Iterator<Item = f64>| {
            (own.map(|value| value * value).sum::<f64>() / 4000.0).sqrt()
        };
        let beyond = rms(&mut column.iter().copied());
        // What is left are the short swings where friction turns round.
        assert!(beyond < 0.2 * 1.5, "{beyond} Nm");
    }
}

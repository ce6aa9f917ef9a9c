//! A soft gear before a load that nobody measures.
//!
//! Motor and load are two inertias with a spring and a damper between them. The motor is measured;
//! behind the spring is a share s of the inertia J and of the friction, or the links of an arm
//! (s = 1). What a stiff load would take, L = s (J θ̈ + G + r τ_R) with weight and springs G, or the
//! torque of the links, winds the spring up: with y the winding times the load's inertia,
//! ÿ + 2 ζ ω ẏ + ω² y = L, and the motor feels 2 ζ ω ẏ + ω² y in place of L. ω is the load's own
//! frequency, at which it swings while the motor is held. Spong 1987, "Modeling and control of
//! elastic joint robots", ASME J. Dyn. Syst. Meas. Control 109, with friction of the load, which goes
//! by its own speed, and damping. Of an arm's links friction is the motor's, ω is that of their mean
//! inertia, and with ρ the inertia in the posture over its mean (ρ ẏ)˙ + 2 ζ ω ẏ + ω² y = L: how the
//! inertia changes acts on the speed of the links, not of the motor.

use ferntast_model::friction::{ONE, Proposal, Unit, Unmeasured};

use super::{Effect, Facts, Memory, Point, are_shares, combinations, free, logarithmic, row, sign};

/// Its coefficient.
pub const LOAD_SHARE: &str = "load_share";

row!(
    LoadElasticity,
    id: "load_elasticity",
    equation: "in place of L = s (J q̈ + G + r τ_R), of an arm's links of their torque, the motor feels 2ζω ẏ + ω² y; ÿ + 2ζω ẏ + ω² y = L, ω = 2π frequency",
    source: "Spong 1987, elastic joint; with friction of the load and damping",
    coefficients: &[free(LOAD_SHARE, ONE)],
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
    of_unmeasured: Some(Unmeasured::Load),
);

/// Indices of the memory: y at the next sample \[Nm s²\]; ρ ẏ half a sample before that \[Nm s\];
/// whether begun; y at this sample.
const WOUND: usize = 0;
const MOMENTUM: usize = 1;
const BEGUN: usize = 2;
const WOUND_NOW: usize = 3;

/// Slowest load \[Hz\]: what swings more slowly is another mechanism than a gear.
const SLOWEST: f64 = 2.0;
/// Fastest load \[Hz\], and in periods of the samples, seven of which have one swing.
const FASTEST: f64 = 60.0;
const FASTEST_OF_SAMPLES: f64 = 0.15;
/// Greatest damping ratio of a gear, and that up to which it is searched: what fits best where
/// nothing swings is a lag, which has other causes.
const MOST_DAMPED: f64 = 0.2;
const MOST_DAMPED_SEARCHED: f64 = 0.7;

/// What the motor feels of the load beyond what it would feel of a stiff one, per share \[Nm\].
fn beyond_stiff(shape: &[f64], point: &Point, memory: &mut Memory) -> f64 {
    let [frequency, damping, friction_ratio] = *shape else {
        return 0.0;
    };
    let omega = std::f64::consts::TAU * frequency;
    // Steps of this length swing faster by (ω T)²/24.
    let omega = omega * (1.0 - (omega * point.period).powi(2) / 24.0);
    let [spring, damper] = [omega * omega, 2.0 * damping * omega];
    let friction = friction_ratio * point.friction_beside_load();
    let stiff = point.load + friction;
    if memory[BEGUN] == 0.0 {
        *memory = [stiff / spring, 0.0, 1.0, 0.0];
    }
    let [wound, before, ..] = *memory;
    let mobility = mobility(spring, point);
    // Half of what the damper takes of ρ ẏ in a sample: by the mean of before and after.
    let half_damped = 0.5 * damper * mobility * point.period;
    let driven = before * (1.0 - half_damped) + (point.load - spring * wound) * point.period;
    let momentum = slowed_by(friction, driven / (1.0 + half_damped), point);
    memory[WOUND] = wound + mobility * momentum * point.period;
    memory[MOMENTUM] = momentum;
    memory[WOUND_NOW] = wound;
    spring * wound + damper * mobility * 0.5 * (before + momentum) - stiff
}

/// 1/ρ, no greater than steps of this length integrate: ω² T²/ρ is below 4.
fn mobility(spring: f64, point: &Point) -> f64 {
    if point.relative_links_inertia == 1.0 {
        return 1.0;
    }
    let most = 3.5 / (spring * point.period * point.period);
    point.relative_links_inertia.recip().min(most)
}

/// ρ ẏ \[Nm s\] after a sample, where it would be `driven` without friction of the load, per share
/// \[Nm\]: this stops the load, and does not turn it round.
fn slowed_by(friction: f64, driven: f64, point: &Point) -> f64 {
    if friction == 0.0 || point.inertia <= 0.0 {
        return driven;
    }
    let momentum = point.inertia * point.velocity - driven;
    let slowed = (momentum.abs() - friction.abs() * point.period).max(0.0);
    point.inertia * point.velocity - slowed * sign(momentum)
}

/// Fastest load \[Hz\] that samples show.
fn fastest(facts: &Facts) -> f64 {
    FASTEST.min(FASTEST_OF_SAMPLES / facts.period)
}

/// Of the shape.
fn bounds(facts: &Facts) -> [[f64; 2]; 3] {
    let most_friction = match facts.torque_is_of_links {
        true => 0.0,
        false => 4.0,
    };
    [
        [SLOWEST, fastest(facts).max(SLOWEST)],
        [0.0, MOST_DAMPED_SEARCHED],
        [0.0, most_friction],
    ]
}

impl Effect for LoadElasticity {
    row!(methods);

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        if let [column] = columns {
            *column = beyond_stiff(shape, point, memory);
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        if facts.joint_torque && !facts.torque_is_of_links {
            return Some(
                "the torque of the load is given: what is soft before it is \"elasticity\"".into(),
            );
        }
        let least = 2.0 * SLOWEST;
        (fastest(facts) < least).then(|| {
            format!(
                "loads that swing at {least} Hz are not seen: record or filter at a higher rate"
            )
        })
    }

    // So close that a load that swings by itself for long is not missed between two of them.
    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [[low, high], _, [_, most]] = bounds(facts);
        let friction_ratios = match most > 0.0 {
            true => vec![0.0, 0.7, 1.4],
            false => vec![0.0],
        };
        combinations(&[logarithmic(low, high, 14), vec![0.04, 0.2], friction_ratios])
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        bounds(facts).into()
    }

    fn is_itself(&self, shape: &[f64]) -> bool {
        shape.get(1).is_some_and(|damping| *damping <= MOST_DAMPED)
    }

    fn winding(&self, shape: &[f64], points: &[Point]) -> Option<Vec<f64>> {
        let mut memory = Memory::default();
        let each = points.iter().map(|point| {
            beyond_stiff(shape, point, &mut memory);
            memory[WOUND_NOW]
        });
        Some(each.collect())
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        are_shares(coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::column_of;
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
                    relative_links_inertia: 1.0,
                    ..Point::default()
                }
            })
            .collect()
    }

    fn column(shape: &[f64], points: &[Point]) -> Vec<f64> {
        column_of(&LoadElasticity::default(), shape, points)
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
        let start = Point {
            period: PERIOD,
            velocity: 0.01,
            friction_predicted: 2.0,
            inertia: INERTIA,
            relative_links_inertia: 1.0,
            ..Point::default()
        };
        // The load is at rest: the spring winds up as fast as the motor goes.
        let mut memory = [0.0, INERTIA * 0.01, 1.0, 0.0];
        let moves = (0..1000).find(|_| {
            beyond_stiff(&[5.0, 0.0, 1.0], &start, &mut memory);
            memory[MOMENTUM] < 0.999 * INERTIA * 0.01
        });
        let expected = 2.0 / (INERTIA * (TAU * 5.0).powi(2));
        let travel = 0.01 * PERIOD * moves.unwrap() as f64;
        assert!((travel - expected).abs() < 3e-5, "{travel} rad");
    }

    /// In postures in which they nearly have no inertia, too, and at the highest frequency that samples
    /// show: nothing grows without end.
    #[test]
    fn links_without_inertia_are_felt_as_stiff_ones() {
        let mut points = points(5.0, 0.0);
        for (at, own) in points.iter_mut().enumerate() {
            own.relative_links_inertia = if at % 1000 < 500 { 0.0 } else { 2.0 };
        }
        let all = column(&[FASTEST_OF_SAMPLES / PERIOD, 0.2, 0.0], &points);
        let most = |own: &mut dyn Iterator<Item = f64>| {
            own.fold(0.0, |most, own| f64::max(most, own.abs()))
        };
        let beyond = most(&mut all.iter().copied());
        let stiff = most(&mut points.iter().map(|own| own.load));
        assert!(
            all.iter().all(|own| own.is_finite()) && beyond < 0.1 * stiff,
            "{beyond} of {stiff} Nm"
        );
        let shape = [FASTEST_OF_SAMPLES / PERIOD, 0.2, 0.0];
        let wound = LoadElasticity::default().winding(&shape, &points).unwrap();
        assert!(wound.iter().all(|own| own.is_finite()));
    }

    /// Of an arm's links, whose torque is given: nothing is asked of the joint's own inertia.
    #[test]
    fn of_links_all_torque_winds_the_gear_up() {
        let mut points = points(5.0, 0.0);
        for own in &mut points {
            own.load += 20.0;
            own.inertia = 0.0;
        }
        let column = column(&[10.0, 0.02, 0.0], &points);
        let most = column[3800..].iter().copied().fold(0.0, f64::max);
        // The weight is borne as by a stiff gear.
        let expected = INERTIA * 0.1 * (TAU * 5.0).powi(2) / 3.0;
        assert!((most / expected - 1.0).abs() < 0.05, "{most} Nm");
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

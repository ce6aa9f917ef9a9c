//! The contact-force estimator behind torque sensors that are off: what zeroing on
//! line makes of it, and whether the standard errors that it states are true.

use crate::common::{TICK, rokviss};
use crate::driver::Driver;
use ferntast_control::estimator::{
    ContactEstimate, ContactEstimator, JointMeasurement, Uncertainty,
};
use ferntast_model::Vector2;
use ferntast_sim::arm::{ArmConfig, TorqueSensorErrors, Truth};
use std::f64::consts::TAU;

/// The edges: the way to it, and its true coefficient on the day of the shipped arm.
fn edges() -> [([f64; 2], f64); 2] {
    let lubricated = 0.45 - 0.35 * (-57.0_f64 / 300.0).exp();
    [([1.0, 0.0], 0.45), ([0.0, -1.0], lubricated)]
}

/// Torque sensors with these zeros \[Nm\] and gains \[-\], and a contour turned by `turn`
/// \[rad\] about the nominal tip.
fn spoilt(zeros: [f64; 2], gains: [f64; 2], turn: f64) -> ArmConfig {
    let mut config = rokviss();
    for joint in 0..2 {
        config.truth.joint[joint].sensor.torque_errors = Some(TorqueSensorErrors {
            zero: zeros[joint],
            gain: gains[joint],
            ..Default::default()
        });
    }
    let middle = Vector2::from(config.contour.nominal_tip);
    let (sine, cosine) = turn.sin_cos();
    let turned = |place: [f64; 2]| -> [f64; 2] {
        let from = Vector2::from(place) - middle;
        let (x, y) = (
            cosine * from.x - sine * from.y,
            sine * from.x + cosine * from.y,
        );
        (middle + Vector2::new(x, y)).into()
    };
    let mut contour = config.contour.clone();
    for edge in &mut contour.edge {
        edge.from = turned(edge.from);
        edge.to = turned(edge.to);
    }
    contour.spring.clear();
    config.truth.contour = Some(contour);
    config
}

/// From when until when the tip waits just off the edge \[s\].
const HOVER_FROM: f64 = 2.0;
const HOVER_UNTIL: f64 = 3.0;

/// Rests for a second in the middle, goes near the edge, waits there for another one,
/// presses, and slides to and fro for four periods.
fn run(config: &ArmConfig, toward: [f64; 2], seed: u64) -> Vec<(Truth, ContactEstimate)> {
    let mut driver = Driver::new(config, seed);
    let mut estimator = ContactEstimator::new(&config.model(), &config.estimator).expect("valid");
    let path = |time: f64| {
        let press =
            0.027 * (time - 1.0).clamp(0.0, 1.0) + 0.009 * (time - HOVER_UNTIL).clamp(0.0, 0.5);
        let swing = 0.02 * (TAU * (time - 4.0).max(0.0) / 2.0).sin();
        [
            toward[0] * press + toward[1].abs() * swing,
            toward[1] * press + toward[0].abs() * swing,
        ]
    };
    (0..(12.0 / TICK) as usize)
        .map(|tick| {
            let measured = driver.step(path(tick as f64 * TICK));
            let measurement = JointMeasurement {
                motor_position: measured.motor_position.into(),
                joint_torque: measured.joint_torque.into(),
            };
            (driver.arm.truth(), estimator.step(TICK, &measurement))
        })
        .collect()
}

struct Score {
    /// RMS error of F_T over its peak \[-\].
    tangential: f64,
    /// b_0T in standard errors from the truth, and its standard error.
    off: f64,
    error: f64,
    /// Share of the free way that is told as contact \[-\].
    false_contact: f64,
}

/// F_T is judged from `from` \[s\] on.
fn score(ticks: &[(Truth, ContactEstimate)], coefficient: f64, from: f64) -> Score {
    let sliding: Vec<_> = ticks[(from / TICK) as usize..]
        .iter()
        .filter(|(truth, seen)| {
            truth.normal_force > 0.0
                && seen.state.valid
                && seen.state.in_contact
                && !seen.state.near_rest
        })
        .map(|(truth, seen)| {
            let against = -truth.tangential_force * truth.sliding_velocity.signum();
            (against, seen.state.tangential_force)
        })
        .collect();
    assert!(sliding.len() > 2000, "{}", sliding.len());
    let peak = sliding.iter().map(|pair| pair.0.abs()).fold(0.0, f64::max);
    let square: f64 = sliding
        .iter()
        .map(|(truth, seen)| (seen - truth).powi(2))
        .sum();
    // Within `contact_distance` of the surface, where a force alone makes a contact.
    let hover = &ticks[(HOVER_FROM / TICK) as usize..(HOVER_UNTIL / TICK) as usize];
    let told = hover
        .iter()
        .filter(|(truth, seen)| truth.surface.is_none() && seen.state.in_contact);
    let false_contact = told.count() as f64 / hover.len() as f64;
    let found = ticks.last().expect("ticks").1.state.friction;
    Score {
        tangential: (square / sliding.len() as f64).sqrt() / peak,
        off: (found.value - coefficient) / found.error,
        error: found.error,
        false_contact,
    }
}

/// How well the torque sensors and the contour are known that the draws are from.
const UNCERTAINTY: Uncertainty = Uncertainty {
    torque_zero: 0.3,
    torque_gain: 0.03,
    torque_hysteresis: 0.0,
    spring_stiffness: 0.0,
    contour_turn: 0.035,
};

/// The same arm with and without zeroing.
fn before_and_after(
    config: &ArmConfig,
    toward: [f64; 2],
    coefficient: f64,
    seed: u64,
) -> [Score; 2] {
    [(0.0, Uncertainty::default()), (2.0, UNCERTAINTY)].map(|(zeroing_time, uncertainty)| {
        let mut config = config.clone();
        config.estimator.zeroing_time = zeroing_time;
        config.estimator.uncertainty = uncertainty;
        score(&run(&config, toward, seed), coefficient, 0.0)
    })
}

/// Gains of 3 % more and less, a contour turned by 2 degrees, and both: what is left of them once
/// the tip has slid to and fro. A gain of both sensors alike is none of it: it is in all forces.
#[test]
fn sliding_takes_the_ratio_of_gains_and_the_turn_out() {
    let two_degrees = 2.0_f64.to_radians();
    let mut worst = [0.0_f64; 2];
    for (gains, turn) in [
        ([1.03, 0.97], 0.0),
        ([0.97, 1.03], 0.0),
        ([1.0, 1.0], two_degrees),
        ([1.0, 1.0], -two_degrees),
        ([0.97, 1.03], two_degrees),
        ([1.03, 1.03], 0.0),
    ] {
        let config = spoilt([0.1, -0.1], gains, turn);
        for (at, (toward, coefficient)) in edges().into_iter().enumerate() {
            let [before, after] = [0.0, 60.0].map(|calibration_time| {
                let mut config = config.clone();
                config.estimator.zeroing_time = 2.0;
                config.estimator.calibration_time = calibration_time;
                config.estimator.uncertainty = UNCERTAINTY;
                score(&run(&config, toward, 11), coefficient, 7.0)
            });
            println!(
                "gains {gains:?}, turn {:.0} deg, {toward:?}: F_T off by {:.3} -> {:.3} of its peak, \
                 b_0T off by {:.2} of {:.4} -> {:.2} of {:.4}",
                turn.to_degrees(),
                before.tangential,
                after.tangential,
                before.off,
                before.error,
                after.off,
                after.error
            );
            worst[at] = worst[at].max(before.tangential);
            assert!(after.tangential < 0.06, "{}", after.tangential);
            // What is left has a floor: hysteresis goes with the direction of sliding, too.
            assert!(after.off.abs() < 3.0 && after.error < 0.6 * before.error);
        }
    }
    // That there was something to take out.
    assert!(worst[0] > 0.04 && worst[1] > 0.2, "{worst:?}");
}

/// A zero of 0.75 % of the range, and what is left of it once the sensors are zeroed.
#[test]
fn zeroing_takes_a_zero_of_the_sensors_out() {
    let (mut worst_force, mut worst_contact, mut worst_off) = (0.0_f64, 0.0_f64, 0.0_f64);
    for zeros in [[0.3, -0.3], [-0.3, 0.3], [0.3, 0.3], [-0.3, -0.3]] {
        let config = spoilt(zeros, [1.0; 2], 0.0);
        for (toward, coefficient) in edges() {
            let [before, after] = before_and_after(&config, toward, coefficient, 7);
            println!(
                "zeros {zeros:?} Nm, {toward:?}: F_T off by {:.3} -> {:.3} of its peak, false contact {:.2} -> {:.2}, \
                 b_0T off by {:.1} -> {:.2} standard errors of {:.4}",
                before.tangential,
                after.tangential,
                before.false_contact,
                after.false_contact,
                before.off,
                after.off,
                after.error,
            );
            worst_force = worst_force.max(before.tangential);
            worst_contact = worst_contact.max(before.false_contact);
            worst_off = worst_off.max(before.off.abs());
            assert!(after.tangential > 0.0 && after.tangential < 0.05);
            assert_eq!(after.false_contact, 0.0);
            assert!(after.off.abs() < 3.0);
        }
    }
    // That there was something to take out.
    assert!(worst_force > 0.4 && worst_contact > 0.5 && worst_off > 20.0);
}

/// Zeros, gains and turn drawn from what is stated of them: the truth is within three
/// standard errors, and these are not so large that it is always well within one.
#[test]
fn the_stated_error_of_the_coefficient_covers_the_truth() {
    let mut offs = Vec::new();
    for seed in 0..24 {
        let mut draw = Draw(1_000 + seed);
        let zeros = [0; 2].map(|_| UNCERTAINTY.torque_zero * draw.normal());
        let gains = [0; 2].map(|_| 1.0 + UNCERTAINTY.torque_gain * draw.normal());
        let turn = UNCERTAINTY.contour_turn * draw.normal();
        let config = spoilt(zeros, gains, turn);
        for (toward, coefficient) in edges() {
            let [before, after] = before_and_after(&config, toward, coefficient, seed);
            println!(
                "{toward:?}: {:.1} -> {:.2} of {:.4}",
                before.off, after.off, after.error
            );
            assert!(after.error > 1e-3 && after.error < 0.05);
            offs.push(after.off);
        }
    }
    let within = |errors: f64| {
        offs.iter().filter(|off| off.abs() < errors).count() as f64 / offs.len() as f64
    };
    let rms = (offs.iter().map(|off| off * off).sum::<f64>() / offs.len() as f64).sqrt();
    println!(
        "within 1: {:.2}, within 3: {:.2}; RMS {rms:.2}",
        within(1.0),
        within(3.0)
    );
    assert!(within(3.0) >= 0.95);
    // One, were the errors stated as large as they are; a third is a factor of three.
    assert!(rms > 0.33 && rms < 1.5);
}

/// Whatever the tip runs into, wherever: it is not learned as a zero.
#[test]
fn a_contact_that_nobody_knows_of_is_not_learned() {
    for force in [1.0, 3.0, 20.0] {
        let mut config = rokviss();
        config.estimator.zeroing_time = 2.0;
        let model = config.model();
        let mut estimator = ContactEstimator::new(&model, &config.estimator).expect("valid");
        let kinematics = model.arm.kinematics();
        let q = Vector2::from(config.truth.start_position);
        let mut told = [0.0; 2];
        // Three seconds free, then for ten seconds `force` in the middle of nowhere.
        for tick in 0..13_000 {
            let pushed = ((f64::from(tick) - 3000.0) / 100.0).clamp(0.0, 1.0) * force;
            let tip_force = Vector2::new(-0.6, 0.8) * pushed;
            let torque = -kinematics.jacobian(&q).transpose() * tip_force;
            let estimate = estimator.step(
                TICK,
                &JointMeasurement {
                    motor_position: [0, 1]
                        .map(|joint: usize| {
                            model.joint[joint].motor_position(q[joint], torque[joint])
                        })
                        .into(),
                    joint_torque: (torque + Vector2::new(0.3, -0.3)).into(),
                },
            );
            told = estimate.force;
        }
        let lost = force - told[0].hypot(told[1]);
        // It is at contact_off within 100 ms: a twentieth of that, at most.
        let bound = 0.1 / 2.0 * config.estimator.contact_off;
        println!("{force} N: {lost:.4} N learned away, at most {bound:.4}");
        assert!(lost > -1e-3 && lost < bound);
    }
}

/// Normally distributed numbers, enough for a draw: the sum of twelve uniform ones
/// of a linear congruential generator (Knuth's MMIX).
struct Draw(u64);

impl Draw {
    fn normal(&mut self) -> f64 {
        let uniform = (0..12).map(|_| {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        });
        uniform.sum::<f64>() - 6.0
    }
}

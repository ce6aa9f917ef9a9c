//! The servo of arms with one, three and seven joints: no Cartesian model, each
//! joint a unit inertia of its own.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../../tests/shared/allocations.rs"]
mod allocations;

use allocations::allocations;
use ferntast_control::operating::{OperatingState, StateCommand};
use ferntast_control::servo::{
    Command, CommandRefusal, Measurement, Servo, ServoConfig, ServoInput, ServoOutput, Target,
};
use ferntast_model::friction::FrictionParameters;
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, Joints, MAX_JOINTS};
use nalgebra::Complex;
use std::f64::consts::TAU;

const TICK: f64 = 1e-3;
const TICK_NS: i64 = 1_000_000;
const START: i64 = 1_700_000_000_000_000_000;
/// ω of the tracker, and what the setpoint closes in with \[1/s\].
const TRACKER: f64 = 80.0;
const CLOSING: f64 = 1.25 * TRACKER;

/// Every joint has numbers of its own \[rad\].
fn amplitude(joint: usize) -> f64 {
    0.3 - 0.02 * joint as f64
}

/// \[rad/s\]
fn frequency(joint: usize) -> f64 {
    TAU * (0.4 + 0.1 * joint as f64)
}

/// \[Nm/rad\]
fn stiffness(joint: usize) -> f64 {
    4000.0 + 500.0 * joint as f64
}

/// \[Nm·s/rad\]
fn damping(joint: usize) -> f64 {
    80.0 + 5.0 * joint as f64
}

/// A unit inertia without friction.
fn joint() -> JointParameters {
    JointParameters {
        motor_inertia: 1.0,
        gear_ratio: 100.0,
        stiffness: 5000.0,
        damping: 5.0,
        motor_constant: 10.0,
        motor_torque_limit: 150.0,
        torque_sensor_range: 120.0,
        position_lower: -1.5,
        position_upper: 1.5,
        velocity_limit: 2.0,
        friction: FrictionParameters {
            speed_range: [0.0, 1.0],
            effects: [].into(),
        },
    }
}

fn config(joints: usize) -> ServoConfig {
    let list = |value: fn(usize) -> f64| (0..joints).map(value).collect();
    ServoConfig {
        tracker_frequency: TRACKER,
        stiffness: list(stiffness),
        damping: list(damping),
        acceleration_limit: vec![40.0; joints],
        pressing_limit: vec![20.0; joints],
        hold_stiffness: vec![1000.0; joints],
        hold_damping: vec![40.0; joints],
        ..ServoConfig::default()
    }
}

/// The servo and what it moves.
struct Bench {
    servo: Servo,
    position: Joints<f64>,
    velocity: Joints<f64>,
    now: i64,
    allocations: u64,
}

impl Bench {
    fn new(joints: usize) -> Bench {
        let rest = Joints::filled(JointCount::new(joints).unwrap(), 0.0);
        Bench {
            servo: Servo::new(&vec![joint(); joints], &config(joints)).unwrap(),
            position: rest,
            velocity: rest,
            now: START,
            allocations: 0,
        }
    }

    /// A tick, and the motion of the joints in it.
    fn step(&mut self, target: Option<Target>, state: Option<StateCommand>) -> ServoOutput {
        self.now += TICK_NS;
        let stamp_ns = self.now;
        let input = ServoInput {
            measurement: Some(Measurement {
                stamp_ns,
                position: self.position,
                velocity: self.velocity,
                torque: Joints::filled(self.position.count(), 0.0),
            }),
            command: target.map(|target| Command { stamp_ns, target }),
            state_command: state,
        };
        let (output, allocated) = allocations(|| self.servo.step(self.now, &input));
        self.allocations += allocated;
        for (joint, acceleration) in output.torque.iter().enumerate() {
            let velocity = self.velocity[joint];
            self.position[joint] += TICK * (velocity + 0.5 * TICK * acceleration);
            self.velocity[joint] += TICK * acceleration;
        }
        output
    }
}

/// Position of joint number `joint` over its command, at its frequency: the
/// difference equations of tracker, generator and law, and a unit inertia
/// under a torque that is held for a tick.
fn transfer(joint: usize) -> Complex<f64> {
    let one = Complex::new(1.0, 0.0);
    let back = Complex::from_polar(1.0, -frequency(joint) * TICK);
    let ahead = one / back - one;
    let slope = (one - back) / TICK;
    // Tracker: its error e drives velocity by ω² e and position by 2 ω e besides.
    let track = |error: Complex<f64>| {
        let velocity = error * TRACKER * TRACKER / slope;
        (velocity, (velocity + error * 2.0 * TRACKER) / slope)
    };
    let error = one / (one + back * track(one).1);
    let (velocity, position) = track(error);
    let setpoint = (velocity + position * CLOSING) / (slope + back * CLOSING);
    let (k_p, k_d) = (stiffness(joint), damping(joint));
    let plant_velocity = one * TICK / ahead;
    let plant_position = (plant_velocity + 0.5 * TICK) * TICK / ahead;
    let law = slope * slope + slope * k_d + k_p;
    setpoint * law * plant_position / (one + plant_position * k_p + plant_velocity * k_d)
}

#[test]
fn every_joint_follows_its_sine_as_far_as_theory_says() {
    for joints in [1, 3, 7] {
        let mut bench = Bench::new(joints);
        bench.step(None, Some(StateCommand::Enable));
        let count = bench.servo.joints();
        let mut worst = Joints::filled(count, 0.0_f64);
        for k in 0..6000 {
            let time = f64::from(k) * TICK;
            let sine = |joint: usize| amplitude(joint) * (frequency(joint) * time).sin();
            let target = Joints::from_fn(count, sine);
            let measured = bench.position;
            let output = bench.step(Some(Target::Joints(target)), None);
            assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
            assert_eq!((output.refused, output.effort_limited), (None, false));
            // From the third second on nothing is left of how it began.
            if k < 3000 {
                continue;
            }
            for joint in 0..joints {
                let phase = Complex::from_polar(amplitude(joint), frequency(joint) * time);
                let theory = (transfer(joint) * phase).im;
                let off = (measured[joint] - theory).abs();
                assert!(
                    off < 1e-9,
                    "joint {joint} of {joints}: {off} rad from theory"
                );
                worst[joint] = worst[joint].max((measured[joint] - target[joint]).abs());
            }
        }
        for (joint, worst) in worst.iter().enumerate() {
            let theory = amplitude(joint) * (transfer(joint) - 1.0).norm();
            let ratio = worst / theory;
            assert!((0.999..1.001).contains(&ratio), "joint {joint}: {ratio}");
            assert!((5e-4..1e-2).contains(worst), "joint {joint}: {worst} rad");
        }
        assert_eq!(bench.allocations, 0, "{joints} joints");
    }
}

#[test]
fn whatever_happens_a_step_allocates_nothing() {
    let mut bench = Bench::new(MAX_JOINTS);
    let count = bench.servo.joints();
    let target = Target::Joints(Joints::filled(count, 0.2));
    let fewer = Target::Joints([0.1; 2].into());
    let far = Target::Joints(Joints::filled(count, 9.0));
    let tip = Target::Tip([0.3, 0.0, 0.0]);
    bench.step(None, Some(StateCommand::Resume));
    bench.step(None, Some(StateCommand::Enable));
    for target in [target, fewer, far, tip, target] {
        bench.step(Some(target), None);
    }
    for _ in 0..50 {
        bench.step(None, None);
    }
    assert_eq!(bench.servo.state(), OperatingState::Paused);
    bench.position[MAX_JOINTS - 1] = 5.0;
    bench.step(None, None);
    assert_eq!(bench.servo.state(), OperatingState::Fault);
    assert_eq!(bench.allocations, 0);
    // The counter counts.
    let ((), counted) = allocations(|| drop(std::hint::black_box(vec![1])));
    assert!(counted >= 1);
}

#[test]
fn faults_and_refusals_are_those_of_the_joint_that_has_them() {
    let mut bench = Bench::new(7);
    bench.step(None, Some(StateCommand::Enable));
    let count = bench.servo.joints();
    let far = Joints::from_fn(count, |joint| if joint == 4 { 1.6 } else { 0.0 });
    let refused = bench.step(Some(Target::Joints(far)), None).refused;
    let words = refused.unwrap().to_string();
    assert!(words.contains("limits of joint 5"), "{words}");
    let tip = bench.step(Some(Target::Tip([0.3, 0.0, 0.0])), None);
    assert_eq!(tip.refused, Some(CommandRefusal::NoTipModel));
    assert_eq!(tip.refusals.total(), 2);
    bench.velocity[5] = 3.1;
    let fault = bench.step(None, None);
    assert_eq!(fault.state, OperatingState::Fault);
    let words = fault.reason.to_string();
    assert!(words.contains("joint 6 is too fast"), "{words}");
    assert_eq!(fault.torque, [0.0; 7]);
}

#[test]
fn lists_of_another_length_are_refused_by_key_and_counts() {
    type List = fn(&mut ServoConfig) -> &mut Vec<f64>;
    let lists: [(&str, List); 6] = [
        ("acceleration_limit", |own| &mut own.acceleration_limit),
        ("stiffness", |own| &mut own.stiffness),
        ("pressing_limit", |own| &mut own.pressing_limit),
        ("damping", |own| &mut own.damping),
        ("hold_stiffness", |own| &mut own.hold_stiffness),
        ("hold_damping", |own| &mut own.hold_damping),
    ];
    for (key, list) in lists {
        for found in [0, 2, 4] {
            let mut config = config(3);
            list(&mut config).resize(found, 50.0);
            let error = Servo::new(&vec![joint(); 3], &config).unwrap_err();
            let expected = format!(
                "{key} has {found} entries where 3 are needed: one for each joint of the arm"
            );
            assert_eq!(error.to_string(), expected);
        }
    }
    for joints in [0, MAX_JOINTS + 1] {
        let joints = vec![joint(); joints];
        let error = Servo::new(&joints, &config(joints.len())).unwrap_err();
        assert_eq!(error.key(), "number of joints");
    }
}

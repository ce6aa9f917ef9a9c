//! The servo on the simulated arm that is shipped: it tracks, presses and
//! lets go, with a tick of delay from sensor to servo and another one back.

use crate::common::{TICK, TICK_NS, rokviss};
use ferntast_control::operating::{OperatingState, StateCommand};
use ferntast_control::servo::{
    Command, ContactStopConfig, Measurement, Servo, ServoConfig, ServoInput, ServoOutput, Target,
};
use ferntast_model::Joints;
use ferntast_sim::arm::SimulatedArm;

struct Bench {
    arm: SimulatedArm,
    servo: Servo,
    nominal: [f64; 2],
    measured: Measurement,
    torque: Joints<f64>,
    now: i64,
}

impl Bench {
    fn new() -> Bench {
        Bench::tuned(&ServoConfig::default())
    }

    fn tuned(servo: &ServoConfig) -> Bench {
        let config = rokviss();
        let start = config.truth.start_position;
        let mut bench = Bench {
            arm: SimulatedArm::new(&config, 5).expect("valid"),
            servo: Servo::planar(&config.joint, &config.arm, servo).expect("valid"),
            nominal: config.contour.nominal_tip,
            measured: Measurement {
                stamp_ns: 1_700_000_000_000_000_000,
                position: start.into(),
                velocity: [0.0; 2].into(),
                torque: [0.0; 2].into(),
            },
            torque: [0.0; 2].into(),
            now: 1_700_000_000_000_000_000,
        };
        let output = bench.step(None, Some(StateCommand::Enable));
        assert_eq!(output.state, OperatingState::Enabled);
        bench
    }

    fn step(&mut self, command: Option<Command>, state: Option<StateCommand>) -> ServoOutput {
        self.now += TICK_NS;
        let output = self.servo.step(
            self.now,
            &ServoInput {
                measurement: Some(self.measured),
                command,
                state_command: state,
            },
        );
        self.arm.advance([self.torque[0], self.torque[1]], TICK);
        self.torque = output.torque;
        let measured = self.arm.measure();
        self.measured = Measurement {
            stamp_ns: self.now,
            position: measured.motor_position.into(),
            velocity: measured.motor_velocity.into(),
            torque: measured.joint_torque.into(),
        };
        output
    }

    /// One tick towards `offset` [m] from the nominal tip.
    fn follow(&mut self, offset: [f64; 2]) -> ServoOutput {
        let [x, y] = [0, 1].map(|axis: usize| self.nominal[axis] + offset[axis]);
        let command = Command {
            stamp_ns: self.now + TICK_NS,
            target: Target::Tip([x, y, 0.0]),
        };
        let output = self.step(Some(command), None);
        assert_eq!(output.refused, None);
        assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
        output
    }

    fn error(&self, offset: [f64; 2]) -> f64 {
        let tip = self.arm.truth().tip;
        (tip[0] - self.nominal[0] - offset[0]).hypot(tip[1] - self.nominal[1] - offset[1])
    }
}

#[test]
fn it_tracks_within_3_mm_at_20_cm_per_second_in_free_space() {
    let mut bench = Bench::new();
    let mut run = |path: &dyn Fn(f64) -> [f64; 2]| {
        let mut worst = 0.0_f64;
        for k in 0..2000 {
            bench.follow(path(0.0));
            assert!(k < 1000 || bench.error(path(0.0)) < 2e-3);
        }
        for k in 0..5000 {
            let offset = path(f64::from(k) * TICK);
            bench.follow(offset);
            worst = worst.max(bench.error(offset));
        }
        worst
    };
    // Across, ± 20 mm at up to 0.20 m/s: joint 1 at 0.57 rad/s.
    let across = run(&|t| [0.0, -0.002 + 0.020 * (10.0 * t.min(5.0)).sin() * t.min(1.0)]);
    // Towards the base, at up to 0.08 m/s.
    let along = run(&|t| [0.020 * (4.0 * t).sin() * t.min(1.0), 0.0]);
    println!("across {across} m, along {along} m");
    assert!((1e-4..3e-3).contains(&across), "{across} m");
    assert!((1e-4..3e-3).contains(&along), "{along} m");
}

#[test]
fn it_presses_no_harder_than_it_may_and_lets_go() {
    let mut bench = Bench::new();
    for _ in 0..1000 {
        bench.follow([0.0, 0.0]);
    }
    let mut forces = Vec::new();
    for k in 0..4000 {
        // 10 mm behind the lubricated edge at −30 mm, within a second.
        let way = -0.040 * (f64::from(k) * TICK).min(1.0);
        bench.follow([0.0, way]);
        forces.push(bench.arm.truth().normal_force);
    }
    let end = &forces[3000..];
    let low = end.iter().copied().fold(f64::INFINITY, f64::min);
    let high = end.iter().copied().fold(0.0, f64::max);
    println!("{low} … {high} N");
    assert!(high - low < 1.0, "it chatters: {low} … {high} N");
    // 20 Nm at 0.35 m from joint 1 and friction that holds on to the rest.
    assert!(low > 20.0 && high < 120.0, "{low} … {high} N");
    for k in 0..2000 {
        bench.follow([0.0, -0.040 * (1.0 - f64::from(k) * TICK).max(0.0)]);
    }
    assert_eq!(bench.arm.truth().normal_force, 0.0);
    assert!(bench.error([0.0, 0.0]) < 2e-3);
}

/// Largest force \[N\] where the tip runs into the bare edge, of 40 kN/m, with `speed` \[m/s\] and
/// is told to go on for 10 ms more, as a law does that has not heard of it; it stops where the
/// contact's torque is more than `torque` \[Nm\].
fn impact(speed: f64, torque: f64) -> f64 {
    let mut bench = Bench::tuned(&ServoConfig {
        contact_stop: ContactStopConfig {
            torque,
            ..ContactStopConfig::default()
        },
        ..ServoConfig::default()
    });
    for _ in 0..2000 {
        bench.follow([0.0, 0.0]);
    }
    let (edge, mut peak) = (0.030, 0.0_f64);
    let mut way = 0.0;
    let end = ((edge / speed + 0.010) / TICK) as u32;
    for k in 0..end + 200 {
        way += if k < end { speed * TICK } else { -0.1 * TICK };
        bench.follow([way.max(0.0), 0.0]);
        peak = peak.max(bench.arm.truth().normal_force);
    }
    peak
}

/// Of what it hits without: the rest is what the links bring along by themselves, √(k m) v with
/// some 1.3 kg, 14 N at 60 mm/s.
#[test]
fn it_hits_what_it_runs_into_with_half_the_force() {
    for speed in [0.03, 0.06, 0.1] {
        let [with, without] = [0.55, 0.0].map(|torque| impact(speed, torque));
        println!("{speed} m/s: {with} N, {without} N without stopping");
        assert!(
            (0.3..0.6).contains(&(with / without)),
            "{with} of {without} N"
        );
        assert!((100.0..1000.0).contains(&(with / speed)), "{with} N");
    }
}

#[test]
fn a_silent_command_relieves_the_contact() {
    let mut bench = Bench::new();
    for k in 0..3000 {
        bench.follow([0.0, -0.036 * (f64::from(k) * TICK).min(1.0)]);
    }
    let pressed = bench.arm.truth().normal_force;
    let mut paused = None;
    for k in 0..3000 {
        let output = bench.step(None, None);
        if output.state == OperatingState::Paused && paused.is_none() {
            paused = Some(k);
        }
    }
    assert!((24..=27).contains(&paused.expect("valid")), "{paused:?} ms");
    let held = bench.arm.truth().normal_force;
    println!("{pressed} N, then {held} N");
    assert!(held <= pressed + 1.0, "{pressed} N, then {held} N");
}

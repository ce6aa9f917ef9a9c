//! The servo on a plant of its own: motor, elasticity and link of each joint.

mod beginning;

use super::*;
use ferntast_model::Vector2;
use ferntast_model::arm::{ArmParameters, LinkParameters};
use ferntast_model::friction::FrictionParameters;
use ferntast_model::kinematics::Kinematics;
use proptest::prelude::*;
use std::collections::VecDeque;

const MS: i64 = 1_000_000;
const START: i64 = 1_700_000_000_000_000_000;

pub(super) fn arm() -> ArmParameters {
    let link = LinkParameters {
        length: 0.25,
        mass: 1.5,
        center_of_mass: 0.12,
        inertia: 0.01,
    };
    ArmParameters {
        gravity: [0.0; 2],
        link: [link; 2],
    }
}

/// "on_ground" of Table 1.
pub(super) fn joint() -> JointParameters {
    let effects = [
        ("coulomb", "b_0", 7.573),
        ("viscous", "b_1", 168.388),
        ("quadratic_viscous", "b_2", -544.193),
        ("cubic_viscous", "b_3", 516.421),
    ];
    let effects = effects
        .into_iter()
        .map(|(effect, name, value)| (effect.to_owned(), [(name.to_owned(), value)].into()))
        .collect();
    JointParameters {
        motor_inertia: 1.0,
        gear_ratio: 160.0,
        stiffness: 4400.0,
        damping: 5.0,
        motor_constant: 10.0,
        motor_torque_limit: 150.0,
        torque_sensor_range: 120.0,
        position_lower: -1.6,
        position_upper: 2.6,
        velocity_limit: 2.0,
        friction: FrictionParameters {
            speed_range: [0.0, 0.7],
            effects,
        },
    }
}

/// One joint after equation (2) with an elastic gear and a link of its own.
#[derive(Clone, Copy, Default)]
struct Joint {
    motor: [f64; 2],
    link: [f64; 2],
    torque: f64,
    /// A stiff wall: 4e4 N/m at 0.35 m from the axis.
    wall: Option<f64>,
}

impl Joint {
    const LINK_INERTIA: f64 = 0.2;

    fn step(&mut self, motor_torque: f64, external: f64) {
        const PARTS: usize = 20;
        let dt = 1e-3 / PARTS as f64;
        for _ in 0..PARTS {
            let v = self.motor[1];
            // Table 1, written here a second time on purpose: the plant does
            // not ask the model. tanh keeps the integration smooth.
            let friction =
                7.573 * (v / 1e-3).tanh() + v * (168.388 - 544.193 * v.abs() + 516.421 * v * v);
            self.torque = 4400.0 * (self.motor[0] - self.link[0]) + 5.0 * (v - self.link[1]);
            self.motor[1] += (motor_torque - friction - self.torque) * dt;
            self.motor[0] += self.motor[1] * dt;
            let depth = self.wall.map_or(0.0, |wall| (self.link[0] - wall).max(0.0));
            let wall = if depth > 0.0 {
                (-4900.0 * depth - 12.0 * self.link[1]).min(0.0)
            } else {
                0.0
            };
            self.link[1] += (self.torque + external + wall) / Self::LINK_INERTIA * dt;
            self.link[0] += self.link[1] * dt;
        }
    }

    fn energy(&self) -> f64 {
        0.5 * (self.motor[1].powi(2) + Self::LINK_INERTIA * self.link[1].powi(2))
            + 0.5 * 4400.0 * (self.motor[0] - self.link[0]).powi(2)
    }
}

/// Servo and two joints, 1 ms from measurement to servo and 1 ms back.
struct Bench {
    servo: Servo,
    joints: [Joint; 2],
    torques: VecDeque<Joints<f64>>,
    measured: VecDeque<Measurement>,
    now: i64,
    external: [f64; 2],
}

impl Bench {
    fn new(position: [f64; 2]) -> Bench {
        let joints = [joint(), joint()];
        // It keeps what it presses with: giving way is tested for itself (`release.rs`).
        let release = ReleaseConfig {
            distance: 0.0,
            ..ReleaseConfig::default()
        };
        let config = ServoConfig {
            release,
            ..ServoConfig::default()
        };
        let mut bench = Bench {
            servo: Servo::planar(&joints, &arm(), &config).unwrap(),
            joints: position.map(|q| Joint {
                motor: [q, 0.0],
                link: [q, 0.0],
                ..Joint::default()
            }),
            torques: [[0.0; 2].into()].into(),
            measured: VecDeque::new(),
            now: START,
            external: [0.0; 2],
        };
        bench.measured.push_back(bench.measure());
        bench
    }

    fn measure(&self) -> Measurement {
        Measurement {
            stamp_ns: self.now,
            position: self.joints.map(|joint| joint.motor[0]).into(),
            velocity: self.joints.map(|joint| joint.motor[1]).into(),
            torque: self.joints.map(|joint| joint.torque).into(),
        }
    }

    fn step(
        &mut self,
        command: Option<Command>,
        state_command: Option<StateCommand>,
    ) -> ServoOutput {
        let measurement = self.measured.pop_front();
        self.step_with(measurement, command, state_command)
    }

    fn step_with(
        &mut self,
        measurement: Option<Measurement>,
        command: Option<Command>,
        state_command: Option<StateCommand>,
    ) -> ServoOutput {
        self.now += MS;
        let input = ServoInput {
            measurement,
            command,
            state_command,
        };
        let output = self.servo.step(self.now, &input);
        self.torques.push_back(output.torque);
        let applied = self.torques.pop_front().unwrap();
        for (index, joint) in self.joints.iter_mut().enumerate() {
            joint.step(applied[index], self.external[index]);
        }
        self.measured.clear();
        self.measured.push_back(self.measure());
        output
    }

    fn tip_command(&self, x: f64, y: f64) -> Command {
        Command {
            stamp_ns: self.now + MS,
            target: Target::Tip([x, y, 0.0]),
        }
    }

    fn tip(&self) -> Vector2<f64> {
        let q = Vector2::new(self.joints[0].link[0], self.joints[1].link[0]);
        Kinematics::new([0.25, 0.25]).forward(&q)
    }

    /// Enables and waits until the arm is at (x, y).
    fn approach(&mut self, x: f64, y: f64) {
        self.step(None, Some(StateCommand::Enable));
        for _ in 0..20_000 {
            let command = self.tip_command(x, y);
            let output = self.step(Some(command), None);
            assert_eq!(output.refused, None);
            assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
        }
        assert!(
            (self.tip() - Vector2::new(x, y)).norm() < 1e-3,
            "{}",
            self.tip()
        );
    }
}

/// Worst and root-mean-square distance of the tip from `path(t)` \[m\].
fn tracking_error(path: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let mut bench = Bench::new([-0.6, 1.2]);
    let [x, y] = path(0.0);
    bench.approach(x, y);
    let (mut worst, mut sum, count) = (0.0_f64, 0.0, 6000);
    for k in 0..count {
        let [x, y] = path(k as f64 * 1e-3);
        let command = bench.tip_command(x, y);
        // 500 Hz, as the link has it.
        let output = bench.step((k % 2 == 0).then_some(command), None);
        assert_eq!(output.refused, None);
        assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
        let error = (bench.tip() - Vector2::new(x, y)).norm();
        worst = worst.max(error);
        sum += error * error;
    }
    [worst, (sum / f64::from(count)).sqrt()]
}

/// Across: 0.3 m/s at the tip is 0.67 rad/s, the end of what Table 1 covers.
#[test]
fn the_tip_follows_a_hand_at_30_cm_per_second_within_3_mm() {
    let [worst, rms] = tracking_error(|t| {
        let angle = 0.2 * (1.0 - (3.35 * t).cos());
        [0.45 * angle.cos(), 0.45 * angle.sin()]
    });
    println!("across: worst {worst} m, rms {rms} m");
    assert!(
        (1e-4..3e-3).contains(&worst),
        "worst {worst} m, rms {rms} m"
    );
    assert!((1e-5..2e-3).contains(&rms), "worst {worst} m, rms {rms} m");
}

/// In a circle, where moving towards the base turns the elbow faster.
#[test]
fn the_tip_follows_a_circle_at_10_cm_per_second_within_3_mm() {
    let [worst, rms] = tracking_error(|t| {
        let (radius, angle) = (0.02 * t.min(1.0), 5.0 * t);
        [0.38 + radius * angle.cos(), 0.05 + radius * angle.sin()]
    });
    println!("circle: worst {worst} m, rms {rms} m");
    assert!(
        (1e-4..3e-3).contains(&worst),
        "worst {worst} m, rms {rms} m"
    );
    assert!((1e-5..2e-3).contains(&rms), "worst {worst} m, rms {rms} m");
}

#[test]
fn silence_pauses_within_30_ms_and_latches() {
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.approach(0.38, 0.05);
    let last = bench.now;
    let paused_at = loop {
        let output = bench.step(None, None);
        if output.state == OperatingState::Paused {
            break bench.now;
        }
        assert!(bench.now - last <= 30 * MS);
    };
    let silence = paused_at - last;
    assert!((24 * MS..=26 * MS).contains(&silence), "{silence} ns");
    // Commands that come back do not move it.
    let hold = bench.tip();
    for _ in 0..500 {
        let command = bench.tip_command(0.30, 0.0);
        let output = bench.step(Some(command), None);
        assert_eq!(output.state, OperatingState::Paused);
    }
    assert!((bench.tip() - hold).norm() < 1e-3);
    // Re-armed, it goes there on a ramp.
    let output = bench.step(None, Some(StateCommand::Resume));
    assert_eq!(output.state, OperatingState::Enabled);
    let mut fastest = 0.0_f64;
    for k in 0..12_000 {
        let command = bench.tip_command(0.30, 0.0);
        let output = bench.step(Some(command), None);
        assert!(output.approaching || k > 500);
        // No joint goes ahead of the others; after two seconds all go faster.
        for setpoint in output.setpoint.iter().filter(|_| k < 2000) {
            fastest = fastest.max(setpoint.velocity.abs());
        }
    }
    assert!((bench.tip() - Vector2::new(0.30, 0.0)).norm() < 1e-3);
    assert!((0.05..=0.060_01).contains(&fastest), "{fastest} rad/s");
}

/// The hand slides along what it presses on: the arm must not press deeper on its way there
/// than the line between the two.
#[test]
fn the_way_to_the_first_command_is_straight() {
    let (from, to) = ([-0.6, 1.2], [-0.55, 1.5]);
    let mut bench = Bench::new(from);
    let tip = Kinematics::new([0.25, 0.25]).forward(&Vector2::from(to));
    bench.step(None, Some(StateCommand::Enable));
    let (mut worst, mut approaching) = (0.0_f64, 0);
    for _ in 0..8000 {
        let command = bench.tip_command(tip.x, tip.y);
        let output = bench.step(Some(command), None);
        let [done, other] =
            [0, 1].map(|j| (output.setpoint[j].position - from[j]) / (to[j] - from[j]));
        worst = worst.max((done - other).abs() * (to[0] - from[0]));
        approaching += i32::from(output.approaching);
    }
    // The shorter way's distance from the line: 40 mrad if each joint goes as fast as it may.
    assert!(worst < 2.5e-3, "{worst} rad");
    // 0.3 rad at 0.06 rad/s, and faster after two seconds.
    assert!((2500..3600).contains(&approaching), "{approaching} ms");
}

#[test]
fn what_is_silent_only_while_the_servo_was_held_up_is_not_silent() {
    // All processes held up for 40 ms, then the commands come again …
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.approach(0.38, 0.05);
    let held_up = 40 * MS;
    bench.now += held_up;
    for step in 0..200 {
        // … the first of them only after a link of 20 ms.
        let command = (step >= 20).then(|| bench.tip_command(0.38, 0.05));
        let output = bench.step(command, None);
        assert_eq!(output.state, OperatingState::Enabled, "step {step}");
    }
    // Without commands afterwards it is the commands that are silent.
    bench.now += held_up;
    let again = bench.now;
    loop {
        let output = bench.step(None, None);
        if output.state != OperatingState::Enabled {
            break;
        }
        assert!(output.setpoint.iter().all(|own| own.velocity == 0.0));
        assert!(bench.now - again <= 28 * MS);
    }
    assert!(bench.now - again >= 23 * MS);
}

/// Who measures was held up for longer than the servo, and the commands go on meanwhile.
/// They are not followed until it is measured again, and are no silence either.
#[test]
fn what_is_said_while_it_is_not_measured_is_no_silence() {
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.approach(0.38, 0.05);
    let stands = bench.measure();
    for _ in 0..10 {
        bench.step_with(Some(stands), None, None);
    }
    // The last that is said for now, in the step before it is measured again …
    let command = bench.tip_command(0.38, 0.05);
    let said = bench.now;
    let output = bench.step_with(Some(stands), Some(command), None);
    assert!(bench.now - stands.stamp_ns > 10 * MS);
    assert_eq!(output.setpoint[1].velocity, 0.0);
    // Nothing that could not be followed counts.
    let bad = bench.tip_command(f64::NAN, 0.05);
    bench.step_with(Some(stands), Some(bad), None);
    // … counts as what was heard last.
    loop {
        let output = bench.step(Some(command), None);
        if output.state != OperatingState::Enabled {
            break;
        }
        assert!(bench.now - said <= 26 * MS);
    }
    assert!(bench.now - said >= 24 * MS, "{} ns", bench.now - said);
}

/// Held up while the arm was moved by 0.03 rad: it begins there, forgets what it was told
/// meanwhile, and goes back as slowly as to a first command.
#[test]
fn after_it_was_held_up_it_begins_where_the_arm_is() {
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.approach(0.38, 0.05);
    let meanwhile = bench.tip_command(0.38, 0.05);
    bench.now += 40 * MS;
    let moved = &mut bench.joints[1];
    moved.motor[0] += 0.03;
    moved.link[0] += 0.03;
    // The first step has the measurement of before.
    let output = bench.step(Some(meanwhile), None);
    assert_eq!(output.setpoint[1].velocity, 0.0);
    let mut fastest = 0.0_f64;
    for step in 0..1000 {
        let measured = bench.joints[1].motor[0];
        let command = bench.tip_command(0.38, 0.05);
        let output = bench.step(Some(command), None);
        assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
        if step == 0 {
            assert_eq!(output.setpoint[1].position, measured);
        }
        fastest = fastest.max(output.setpoint[1].velocity.abs());
    }
    assert!((0.05..=0.060_01).contains(&fastest), "{fastest} rad/s");
    assert!((bench.tip() - Vector2::new(0.38, 0.05)).norm() < 1e-3);
}

#[test]
fn enabled_without_a_command_holds_and_is_not_silent() {
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.step(None, Some(StateCommand::Enable));
    let before = bench.tip();
    for _ in 0..1000 {
        let output = bench.step(None, None);
        assert_eq!(output.state, OperatingState::Enabled);
        assert!(output.command_age.is_nan());
    }
    assert!((bench.tip() - before).norm() < 1e-6);
}

#[test]
fn bad_commands_leave_the_arm_unmoved_and_do_not_feed_the_watchdog() {
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.approach(0.38, 0.05);
    let before = bench.tip();
    let bad: [(i64, [f64; 3]); 5] = [
        (0, [0.38, 0.05, 0.0]),
        (1, [0.38, 0.05, 0.0]),
        (2, [f64::NAN, 0.05, 0.0]),
        (2, [0.7, 0.05, 0.0]),
        (2, [0.30, 0.15, 0.0]),
    ];
    let (mut refused, mut state) = (0, OperatingState::Enabled);
    for k in 0..200 {
        let (kind, tip) = bad[k % bad.len()];
        let stamp_ns = match kind {
            0 => 0,
            1 => bench.now - 100 * MS - k as i64,
            _ => bench.now + MS,
        };
        let target = Target::Tip(tip);
        let output = bench.step(Some(Command { stamp_ns, target }), None);
        refused += u64::from(output.refused.is_some());
        state = output.state;
    }
    assert_eq!(state, OperatingState::Paused);
    assert!((20..=30).contains(&refused), "{refused} until it paused");
    assert!((bench.tip() - before).norm() < 1e-3);
}

#[test]
fn broken_measurements_are_faults() {
    for break_it in [
        |_: Measurement| None,
        |own: Measurement| {
            Some(Measurement {
                position: [f64::NAN, 0.0].into(),
                ..own
            })
        },
        |own: Measurement| {
            Some(Measurement {
                stamp_ns: own.stamp_ns - 20 * MS,
                ..own
            })
        },
        |own: Measurement| {
            Some(Measurement {
                velocity: [0.0, 9.0].into(),
                ..own
            })
        },
        |own: Measurement| {
            Some(Measurement {
                position: [-2.0, 1.2].into(),
                ..own
            })
        },
        |own: Measurement| {
            Some(Measurement {
                torque: [0.0; 3].into(),
                ..own
            })
        },
    ] {
        let mut bench = Bench::new([-0.6, 1.2]);
        let output = bench.step(None, Some(StateCommand::Enable));
        assert_eq!(output.state, OperatingState::Enabled);
        let measured = break_it(bench.measure());
        let output = bench.step_with(measured, None, None);
        assert_eq!(output.state, OperatingState::Fault, "{}", output.reason);
        assert_eq!(output.torque, [0.0; 2]);
        let output = bench.step(None, Some(StateCommand::Enable));
        assert!(output.state_refused.is_some());
    }
}

#[test]
fn it_cannot_be_enabled_without_a_measurement() {
    let mut bench = Bench::new([-0.6, 1.2]);
    let output = bench.step_with(None, None, Some(StateCommand::Enable));
    assert_eq!(output.state, OperatingState::Disabled);
    assert!(matches!(
        output.state_refused,
        Some(StateRefusal::NotReady { .. })
    ));
}

#[test]
fn an_arm_outside_its_limits_can_be_brought_back() {
    let mut bench = Bench::new([-1.7, 1.2]);
    bench.approach(0.30, -0.2);
}

#[test]
fn pressing_against_a_stiff_wall_settles() {
    let mut bench = Bench::new([-0.6, 1.2]);
    let (x, y) = (0.38, 0.05);
    bench.approach(x, y);
    bench.joints[0].wall = Some(bench.joints[0].link[0] + 0.002);
    let mut torques = Vec::new();
    for k in 0..4000 {
        // 20 mm across, into the wall, within a second.
        let command = bench.tip_command(x, y + 0.02 * (k as f64 * 1e-3).min(1.0));
        let output = bench.step(Some(command), None);
        assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
        torques.push(bench.joints[0].torque);
    }
    // The plant's Coulomb friction creeps a little: look at 0.2 s.
    let end = &torques[3800..];
    let (low, high) = (
        end.iter().copied().fold(f64::INFINITY, f64::min),
        end.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    );
    assert!(high - low < 0.3, "still moving: {low} … {high} Nm");
    // The pressing limit of 20 Nm, give or take Coulomb friction.
    assert!(low > 12.0 && high < 28.0, "{low} … {high} Nm");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Pushed about while paused, the arm gives back no more energy than was
    /// put in.
    #[test]
    fn the_hold_injects_no_energy(
        push in -20.0..20.0f64,
        frequency in 0.2..20.0f64,
        kick in -0.5..0.5f64,
    ) {
        let mut bench = Bench::new([-0.6, 1.2]);
        bench.step(None, Some(StateCommand::Enable));
        bench.step(None, Some(StateCommand::Pause));
        bench.joints[0].link[1] = kick;
        let mut put_in = bench.joints[0].energy();
        for k in 0..2000 {
            bench.external[0] = push * (frequency * std::f64::consts::TAU * k as f64 * 1e-3).sin();
            let before = bench.joints[0].link[0];
            let output = bench.step(None, None);
            prop_assert_eq!(output.state, OperatingState::Paused);
            put_in += bench.external[0] * (bench.joints[0].link[0] - before);
            prop_assert!(bench.joints[0].energy() <= put_in + 1e-3);
        }
    }
}

//! Servo and estimator of a serial arm on the simulated one, which shares geometry with what
//! they believe and neither friction nor contact.

use std::collections::BTreeMap;

use ferntast_control::{
    estimator::{
        EstimatorParameters, Form, JointMeasurement, MotorCurrentParameters, SpatialEstimator,
        Uncertainty,
    },
    operating::{OperatingState, StateCommand},
    servo::{Command, Measurement, Servo, ServoConfig, ServoInput, Target},
};
use ferntast_model::{
    Joints,
    friction::FrictionParameters,
    joint::JointParameters,
    rigid_body::Vector3,
    serial_arm::{Plane, SerialArm as Believed},
};
use ferntast_sim::serial_arm::{SerialArm, SerialArmParameters};

use crate::common::TICK_NS;
use crate::serial_arm::arms;

const START: i64 = 1_700_000_000_000_000_000;
const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
/// How far below the tip the table is \[m\].
const APART: f64 = 0.02;
/// How late forces are: 2/ω of filters of 40 Hz \[ticks\].
const LATE: usize = 8;

/// Gears are rigid from that stiffness on \[Nm/rad\]; damping of softer ones \[Nm·s/rad\].
const RIGID: f64 = 1e6;
const SOFT_DAMPING: f64 = 20.0;

fn believed(stiffness: f64) -> Believed {
    let chain = arms::seven_joints();
    let joint = |torque: f64| JointParameters {
        motor_inertia: 0.1,
        gear_ratio: 100.0,
        stiffness,
        damping: if stiffness < RIGID { SOFT_DAMPING } else { 0.0 },
        motor_constant: 10.0,
        motor_torque_limit: torque,
        torque_sensor_range: 1.5 * torque,
        position_lower: -2.8,
        position_upper: 2.8,
        velocity_limit: 2.0,
        friction: FrictionParameters {
            speed_range: [0.01, 2.0],
            effects: BTreeMap::new(),
        },
    };
    let joints = [87.0, 87.0, 87.0, 87.0, 20.0, 20.0, 20.0].map(joint);
    let new = |planes: Vec<Plane>| {
        let gravity = [0.0, 0.0, -9.80665];
        Believed::new(chain.clone(), joints.to_vec(), gravity, &HOME, planes).expect("valid")
    };
    let tip = new(Vec::new()).home_tip().translation;
    new(vec![Plane {
        name: "table".into(),
        point: (tip - Vector3::z() * APART).into(),
        normal: [0.0, 0.0, 1.0],
        stiffness: 2e4,
        damping: 100.0,
        friction: 0.3,
    }])
}

fn servo_config(arm: &Believed) -> ServoConfig {
    let mass = arm.mass_with_motors(arm.home());
    let each = |factor: f64| (0..7).map(|joint| factor * mass[(joint, joint)]).collect();
    ServoConfig {
        workspace_lower: [-2.0; 2],
        workspace_upper: [2.0; 2],
        acceleration_limit: vec![20.0; 7],
        stiffness: each(3600.0),
        damping: each(120.0),
        pressing_limit: vec![25.0, 25.0, 25.0, 25.0, 6.0, 6.0, 6.0],
        hold_stiffness: each(900.0),
        hold_damping: each(60.0),
        ..ServoConfig::default()
    }
}

fn parameters(form: Form) -> EstimatorParameters {
    EstimatorParameters {
        form,
        cut_off: 40.0,
        contact_on: 2.0,
        contact_off: 1.0,
        contact_distance: 0.004,
        rest_speed: 0.001,
        rest_travel: 0.0005,
        singularity: 0.05,
        friction_memory: 10.0,
        longest_gap: 0.05,
        zeroing_time: 0.0,
        calibration_time: 0.0,
        uncertainty: Uncertainty::default(),
        motor_current: MotorCurrentParameters::default(),
    }
}

/// A simulated arm, its servo and an estimator, at home over the table.
struct Bench {
    believed: Believed,
    arm: SerialArm,
    servo: Servo,
    estimator: SpatialEstimator,
    now: i64,
    torque: Joints<f64>,
    /// Estimated and true forces \[N\], tick by tick.
    forces: Vec<[Vector3<f64>; 2]>,
    /// Of the last tick.
    tip: Vector3<f64>,
    friction: f64,
}

impl Bench {
    fn new(form: Form, stiffness: f64, sensors: &str) -> Bench {
        let believed = believed(stiffness);
        let [x, y, z] = believed.surfaces()[0].point;
        let gear = match stiffness < RIGID {
            true => format!("stiffness = {stiffness:?}\ndamping = {SOFT_DAMPING:?}"),
            false => String::new(),
        };
        let truth: SerialArmParameters = toml::from_str(&format!(
            "start_position = {HOME:?}
             [[joint]]
             motor_inertia = 0.1
             {gear}
             {sensors}
             [[object]]
             name = \"table\"
             shape = {{ kind = \"plane\", point = [{x}, {y}, {z}], normal = [0.0, 0.0, 1.0] }}
             surface = {{ stiffness = 2e4, damping = 100.0, friction = 0.3, tangential_stiffness = 2e4, \
             tangential_damping = 100.0 }}"
        ))
        .expect("valid");
        let limits = Joints::from_fn(believed.count(), |joint| {
            believed.joints()[joint].motor_torque_limit
        });
        Bench {
            arm: SerialArm::new(believed.chain(), &limits, &truth, 1).expect("valid"),
            servo: Servo::serial(&believed, &servo_config(&believed)).expect("valid"),
            estimator: SpatialEstimator::new(&believed, &parameters(form)).expect("valid"),
            now: START,
            torque: Joints::filled(believed.count(), 0.0),
            forces: Vec::new(),
            tip: Vector3::zeros(),
            friction: 0.0,
            believed,
        }
    }

    /// One millisecond, with a state command and a place for the tip relative to home \[m\].
    fn tick(&mut self, state_command: Option<StateCommand>, tip: Option<Vector3<f64>>) {
        self.now += TICK_NS;
        self.arm.advance(&self.torque, 1e-3);
        let measured = self.arm.measure();
        let truth = self.arm.truth();
        let estimate = self.estimator.step(
            1e-3,
            &JointMeasurement {
                motor_position: measured.motor_position,
                joint_torque: measured.joint_torque,
            },
        );
        self.tip = truth.tip.translation;
        self.friction = estimate.state.friction.value;
        self.forces.push([estimate.force.into(), truth.force]);
        let home = self.believed.home_tip().translation;
        let output = self.servo.step(
            self.now,
            &ServoInput {
                measurement: Some(Measurement {
                    stamp_ns: self.now,
                    position: measured.motor_position,
                    velocity: measured.motor_velocity,
                    torque: measured.joint_torque,
                }),
                command: tip.map(|own| Command {
                    stamp_ns: self.now,
                    target: Target::Tip((home + own).into()),
                }),
                state_command,
            },
        );
        self.torque = output.torque;
    }

    /// Enabled, it goes from one place to the other within `ticks`, evenly.
    fn go(&mut self, from: Vector3<f64>, to: Vector3<f64>, ticks: u32) {
        for tick in 1..=ticks {
            let share = f64::from(tick) / f64::from(ticks);
            self.tick(None, Some(from + (to - from) * share));
        }
        assert_eq!(self.servo.state(), OperatingState::Enabled);
    }

    /// The greatest difference of estimate and truth, and the greatest truth \[N\], from `first`
    /// tick on.
    fn error(&self, first: usize) -> [f64; 2] {
        let later = self.forces.iter().skip(first + LATE);
        let pairs = later.zip(self.forces.iter().skip(first));
        let apart = pairs.map(|(estimated, truth)| (estimated[0] - truth[1]).norm());
        let peak = self.forces.iter().map(|own| own[1].norm());
        [apart.fold(0.0, f64::max), peak.fold(0.0, f64::max)]
    }
}

const NOISY: &str = "sensor = { encoder_counts = 16384.0, velocity_time_constant = 0.002, \
    torque_noise = 0.05, torque_step = 0.0, current_noise = 0.0, current_step = 0.0 }";

/// Down onto the table, pressing by 3 mm, and along it.
fn press_and_slide(bench: &mut Bench) -> usize {
    let (none, along) = (Vector3::zeros(), Vector3::new(0.0, 0.03, 0.0));
    let [above, deep] = [APART - 0.003, APART + 0.003].map(|down| Vector3::z() * -down);
    for _ in 0..50 {
        bench.tick(None, None);
    }
    bench.tick(Some(StateCommand::Enable), None);
    bench.go(none, none, 200);
    bench.go(none, above, 1000);
    let first = bench.forces.len();
    bench.go(above, deep, 800);
    bench.go(deep, deep + along, 2000);
    first
}

#[test]
fn the_contact_force_is_the_true_one() {
    // An arm with flexible gears rings at the touch, which the filters see less of.
    for (form, stiffness, sensors, share) in [
        (Form::Direct, 1e6, "", 0.03),
        (Form::MomentumObserver, 1e6, "", 0.04),
        (Form::Direct, 1e6, NOISY, 0.03),
        (Form::Direct, 1.5e4, NOISY, 0.08),
    ] {
        let mut bench = Bench::new(form, stiffness, sensors);
        let first = press_and_slide(&mut bench);
        let [apart, peak] = bench.error(first);
        println!("{form:?}, {stiffness} Nm/rad: {apart:.2} N of {peak:.1} N");
        assert!(peak > 10.0, "{form:?}: {peak} N");
        assert!(
            apart < share * peak,
            "{form:?}, {stiffness}: {apart} N of {peak} N"
        );
        assert!((bench.friction - 0.3).abs() < 0.03, "{}", bench.friction);
    }
}

/// The gear gives way under the weight: the tip is where it was to be all the same.
#[test]
fn the_tip_is_where_it_was_to_be_with_rigid_and_with_flexible_gears() {
    for stiffness in [1e6, 1.5e4] {
        let mut bench = Bench::new(Form::Direct, stiffness, "");
        bench.tick(Some(StateCommand::Enable), None);
        let way = Vector3::new(0.03, -0.04, 0.05);
        bench.go(Vector3::zeros(), Vector3::zeros(), 500);
        bench.go(Vector3::zeros(), way, 1000);
        bench.go(way, way, 500);
        let apart = bench.tip - bench.believed.home_tip().translation - way;
        println!("{stiffness} Nm/rad: {:.3} mm", apart.norm() * 1e3);
        assert!(apart.norm() < 3e-4, "{stiffness} Nm/rad: {apart}");
    }
}

/// Disabled it is carried, so that it stays about where it was.
#[test]
fn a_disabled_arm_does_not_fall() {
    let mut bench = Bench::new(Form::Direct, 1e6, NOISY);
    for _ in 0..2000 {
        bench.tick(None, None);
    }
    assert_eq!(bench.servo.state(), OperatingState::Disabled);
    let fallen = (bench.tip - bench.believed.home_tip().translation).norm();
    assert!(fallen < 5e-3, "{fallen} m");
}

/// Largest force \[N\] where the arm runs into the table with 0.1 m/s and is told to go on for 10 ms
/// more, with a servo that stops where the contact's torque is more than `torque` \[Nm\].
fn impact(stiffness: f64, sensors: &str, torque: f64) -> f64 {
    let mut bench = Bench::new(Form::Direct, stiffness, sensors);
    let mut config = servo_config(&bench.believed);
    config.contact_stop.torque = torque;
    bench.servo = Servo::serial(&bench.believed, &config).expect("valid");
    for _ in 0..50 {
        bench.tick(None, None);
    }
    bench.tick(Some(StateCommand::Enable), None);
    let (none, deep) = (Vector3::zeros(), Vector3::z() * -(APART + 0.001));
    bench.go(none, none, 1000);
    bench.go(none, deep, 210);
    bench.go(deep, none, 210);
    bench.error(0)[1]
}

#[test]
fn it_hits_what_it_runs_into_less_hard_where_it_stops() {
    for (stiffness, sensors) in [(1e6, ""), (1e6, NOISY), (1.5e4, NOISY)] {
        let [with, without] = [2.0, 0.0].map(|torque| impact(stiffness, sensors, torque));
        println!("{stiffness} Nm/rad: {with:.1} N, {without:.1} N without stopping");
        assert!(
            (0.5..0.85).contains(&(with / without)),
            "{with} of {without} N"
        );
        assert!((20.0..40.0).contains(&without), "{without} N");
    }
}

//! The simulated arm: its configuration, its energy, its rest, its sensors.

use crate::common::{TICK, rokviss};
use crate::driver::Driver;
use ferntast_model::Vector2;
use ferntast_model::friction::Preset;
use ferntast_model::kinematics::Elbow;
use ferntast_sim::arm::{ArmConfig, DriveFlags, SimulatedArm, SimulatedArmError};
use proptest::prelude::*;

const SHIPPED: &str = include_str!("../../../config/arms/rokviss.toml");

/// The shipped arm without anything that takes energy.
fn lossless() -> ArmConfig {
    let mut config = rokviss();
    for joint in &mut config.truth.joint {
        joint.damping = 0.0;
        joint.friction.b_0 = 0.0;
        joint.friction.b_0t = 0.0;
        joint.friction.b_1 = 0.0;
        joint.friction.b_2 = 0.0;
        joint.friction.b_3 = 0.0;
    }
    config.contour.edge.clear();
    config.contour.spring.clear();
    config
}

#[test]
fn the_shipped_arm_is_the_published_one() {
    let config = rokviss();
    config.validate().unwrap();
    let [one, two] = config.arm.link;
    assert!((one.length + two.length - 0.5).abs() < 1e-12);
    assert!((one.mass + two.mass - 7.0).abs() < 1e-12);
    assert_eq!(config.joint[1].stiffness, 4900.0);
    let believed = &config.joint[1].friction;
    let table = Preset::named("spring_2005_03_24").unwrap();
    assert_eq!(believed.effects, table.parameters().effects);
    let truth = config.truth.joint[1].friction;
    assert_eq!(
        [truth.b_0, truth.b_0t, truth.b_1, truth.b_2, truth.b_3],
        [12.372, 0.146, 163.301, -578.954, 547.449]
    );
}

#[test]
fn the_hand_has_its_workspace_and_every_surface_is_in_it() {
    let config = rokviss();
    let kinematics = config.arm.kinematics();
    let nominal = Vector2::from(config.contour.nominal_tip);
    let start = kinematics.forward(&Vector2::from(config.truth.start_position));
    assert!((start - nominal).norm() < 1e-4);
    assert_eq!(config.contour.nominal_elbow, Elbow::Positive);
    for x in -6..=6 {
        for y in -6..=6 {
            let tip = nominal + Vector2::new(f64::from(x), f64::from(y)) * 0.01;
            let q = kinematics.inverse(&tip, Elbow::Positive).unwrap();
            for (joint, parameters) in config.joint.iter().enumerate() {
                assert!(q[joint] > parameters.position_lower + 0.05);
                assert!(q[joint] < parameters.position_upper - 0.05);
            }
            assert!(kinematics.manipulability(&q) > 0.5);
        }
    }
    for feature in config.contour.features() {
        let distance = feature.distance(&nominal);
        assert!(feature.faces(&nominal) && distance > 0.02 && distance < 0.05);
    }
}

#[test]
fn wrong_configurations_are_refused_by_name() {
    let unknown = SHIPPED.replace("gear_ratio", "gear_ration");
    let error = toml::from_str::<ArmConfig>(&unknown).unwrap_err();
    assert!(error.to_string().contains("gear_ration"), "{error}");

    let mut config = rokviss();
    config.truth.joint[1].stiffness = -1.0;
    let error = SimulatedArm::new(&config, 1).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("truth.joint[1].stiffness = -1 Nm/rad"),
        "{error}"
    );

    // An arm that is planar and of two links has two joints.
    let mut config = rokviss();
    config.joint.push(config.joint[0].clone());
    let error = SimulatedArm::new(&config, 1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "arm configuration: joint has 3 entries where 2 are needed: one for each link in the \
         section [arm]"
    );

    let mut config = rokviss();
    config.truth.substep = 5e-4;
    config.truth.surface.lubricated.stiffness = 1e6;
    let error = config.validate().unwrap_err();
    assert_eq!(error.key(), "truth.substep");

    let mut config = rokviss();
    config.truth.start_position = [-0.62, 1.3];
    let error = SimulatedArm::new(&config, 1).unwrap_err();
    assert!(
        matches!(error, SimulatedArmError::StartsInContact { .. }),
        "{error}"
    );
}

/// Kicks the arm for 50 ms, then lets it go for 10 s; energy of every tick after the kick.
fn energies(config: &ArmConfig, kick: [f64; 2]) -> Vec<f64> {
    let mut arm = SimulatedArm::new(config, 1).expect("valid");
    for _ in 0..50 {
        arm.advance(kick, TICK);
    }
    (0..10_000)
        .map(|_| {
            arm.advance([0.0, 0.0], TICK);
            arm.truth().energy
        })
        .collect()
}

#[test]
fn energy_is_kept_without_friction() {
    for gravity in [[0.0, 0.0], [0.0, -9.80665]] {
        let mut config = lossless();
        config.arm.gravity = gravity;
        let kick = [10.0, -6.0];
        let energies = energies(&config, kick);
        let rest = SimulatedArm::new(&config, 1).unwrap().truth().energy;
        // What the kick put in; with gravity the arm swings through far more.
        let scale = (energies[0] - rest).abs();
        let worst = energies
            .iter()
            .map(|energy| (energy - energies[0]).abs() / scale)
            .fold(0.0, f64::max);
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let drift = (mean(&energies[9000..]) - mean(&energies[..1000])) / scale;
        println!("gravity {gravity:?}: {scale:.3} J, worst {worst:.2e}, drift in 10 s {drift:.2e}");
        assert!(worst < 1e-4 && worst > 0.0);
        assert!(drift.abs() < 1e-5);
    }
}

#[test]
fn energy_never_grows_with_friction() {
    let mut config = rokviss();
    config.truth.joint[0].friction.b_0 = 1.0;
    config.truth.joint[1].friction.b_0 = 1.0;
    for kick in [[60.0, 0.0], [0.0, 40.0], [-50.0, 50.0]] {
        let energies = energies(&config, kick);
        let first = energies[0];
        assert!(first > 0.01);
        for pair in energies.windows(2) {
            assert!(pair[1] <= pair[0] + 1e-4 * first, "{pair:?} of {first}");
        }
        assert!(energies.last().unwrap() < &(0.5 * first));
    }
}

#[test]
fn below_stiction_the_motor_stands_exactly_still() {
    let mut config = rokviss();
    config.truth.environment.temperature = Some([10.0, 10.0]);
    let mut arm = SimulatedArm::new(&config, 1).unwrap();
    let start = arm.truth();
    for _ in 0..1000 {
        arm.advance([12.3, -12.3], TICK);
        assert_eq!(arm.truth().motor_velocity, [0.0, 0.0]);
    }
    assert_eq!(arm.truth().motor_position, start.motor_position);
    for _ in 0..100 {
        arm.advance([12.5, -12.5], TICK);
    }
    let moved = arm.truth();
    assert!(moved.motor_velocity[0] > 1e-4 && moved.motor_velocity[1] < -1e-4);
}

#[test]
fn a_pressed_tip_rests_on_the_edge_and_stays() {
    let mut driver = Driver::new(&rokviss(), 5);
    // Into the edge, then along it, but less than it takes to slide.
    for tick in 0..1000 {
        driver.step([0.031 * f64::from(tick) / 1000.0, 0.0]);
    }
    for tick in 0..200 {
        driver.step([0.031, 0.0003 * f64::from(tick) / 200.0]);
    }
    // The links ring, as nothing but the gears' small damping stops them.
    for _ in 0..2500 {
        driver.arm.advance([0.0, 0.0], TICK);
    }
    let before = driver.arm.truth();
    for _ in 0..5000 {
        driver.arm.advance([0.0, 0.0], TICK);
    }
    let after = driver.arm.truth();
    assert!(before.normal_force > 5.0 && before.tangential_force.abs() > 0.5);
    assert!((after.normal_force - before.normal_force).abs() < 1e-6);
    assert!((after.tangential_force - before.tangential_force).abs() < 1e-6);
    assert!(after.tip_velocity[0].hypot(after.tip_velocity[1]) < 1e-9);
    assert_eq!(after.motor_velocity, [0.0, 0.0]);
}

/// Turns joint 2 freely at a constant speed; mean of τ_m − τ, as the sensors give it.
fn measured_friction(config: &ArmConfig, degrees_per_second: f64) -> f64 {
    let mut arm = SimulatedArm::new(config, 9).expect("valid");
    let speed = degrees_per_second.to_radians();
    let start = arm.measure().motor_position;
    let ticks = (0.6 / speed / TICK) as u32;
    let (mut sum, mut count) = (0.0, 0.0);
    let mut torque = [0.0; 2];
    for tick in 1..=ticks {
        arm.advance(torque, TICK);
        let m = arm.measure();
        let goal = start[1] + speed * f64::from(tick) * TICK;
        torque = [
            4000.0 * (start[0] - m.motor_position[0]) - 100.0 * m.motor_velocity[0],
            1500.0 * (goal - m.motor_position[1]) + 80.0 * (speed - m.motor_velocity[1]),
        ];
        if tick > ticks / 2 {
            sum += m.motor_torque_from_current[1] - m.joint_torque[1];
            count += 1.0;
        }
    }
    sum / count
}

fn lossy_and_free() -> ArmConfig {
    let mut config = rokviss();
    config.contour.edge.clear();
    config.contour.spring.clear();
    config.truth.environment.temperature = Some([10.0, 10.0]);
    config
}

/// Equation (2) and Table 1 (spring 2005-03-24), as an experimenter would see them.
#[test]
fn currents_and_torques_show_the_friction_of_table_1() {
    let config = lossy_and_free();
    for (speed, expected) in [(1.0, 15.05), (5.0, 22.58), (10.0, 26.15)] {
        let found = measured_friction(&config, speed);
        println!("{speed} deg/s: {found:.2} Nm of {expected} Nm");
        assert!(
            (found - expected).abs() < 0.03 * expected,
            "{speed}: {found}"
        );
    }
}

/// Figs. 12 to 14, as an experimenter would see them.
#[test]
fn damping_depends_on_temperature_as_published() {
    let at = |temperature, speed| {
        let mut config = lossy_and_free();
        config.truth.environment.temperature = Some([temperature; 2]);
        measured_friction(&config, speed)
    };
    for (speed, warm, ratio) in [(1.0, 20.0, 0.6), (5.0, 20.0, 1.0), (30.0, 25.0, 1.4)] {
        let found = at(warm, speed) / at(-5.0, speed);
        println!("{speed} deg/s: {warm} against -5 degC {found:.3}");
        assert!((found - ratio).abs() < 0.05, "{speed}: {found}");
    }
}

#[test]
fn torques_that_are_no_numbers_are_taken_as_zero_and_told() {
    let mut broken = SimulatedArm::new(&rokviss(), 1).unwrap();
    let mut still = SimulatedArm::new(&rokviss(), 1).unwrap();
    let flags = broken.advance([f64::NAN, 30.0], 0.05);
    assert_eq!(flags.not_finite, [true, false]);
    assert_eq!(still.advance([0.0, 30.0], 0.05), DriveFlags::default());
    assert_eq!(broken.truth(), still.truth());
    let flags = broken.advance([f64::NEG_INFINITY, 1e9], 0.01);
    assert_eq!(
        (flags.not_finite, flags.limited),
        ([true, false], [false, true])
    );
    still.advance([0.0, 80.0], 0.01);
    assert_eq!(broken.truth(), still.truth());
    for duration in [0.0, -1.0, f64::NAN] {
        broken.advance([0.0, 0.0], duration);
    }
    assert_eq!(broken.truth().position, still.truth().position);
}

#[test]
fn moving_warms_the_joints() {
    let mut config = rokviss();
    config.truth.environment.temperature = Some([10.0, -5.0]);
    let mut driver = Driver::new(&config, 2);
    let before = driver.arm.truth().temperature;
    for tick in 0..4000 {
        let swing = 0.02 * (f64::from(tick) * TICK * 3.0).sin();
        driver.step([swing, swing]);
    }
    let after = driver.arm.truth().temperature;
    assert_eq!(before, [10.0, -5.0]);
    assert!(after[1] > before[1] && after[1] < before[1] + 1.0);
}

#[test]
fn on_the_ground_it_is_the_reference_of_table_1() {
    let ground = rokviss().on_ground().unwrap();
    ground.validate().unwrap();
    assert_eq!(ground.arm.gravity, [0.0, -9.80665]);
    let truth = &ground.truth.joint[1];
    assert_eq!(
        (truth.stiffness, ground.joint[1].stiffness),
        (4400.0, 4400.0)
    );
    let friction = truth.friction;
    assert_eq!(
        [
            friction.b_0,
            friction.b_0t,
            friction.b_1,
            friction.b_2,
            friction.b_3
        ],
        [7.573, 0.127, 168.388, -544.193, 516.421]
    );
    let table = Preset::named("on_ground").unwrap().parameters();
    assert_eq!(ground.joint[1].friction.effects, table.effects);
    let arm = SimulatedArm::new(&ground, 1).unwrap();
    assert_eq!(arm.truth().temperature, [20.0, 20.0]);
    let mut without = rokviss();
    without.ground = None;
    assert_eq!(without.on_ground().unwrap_err().key(), "ground");
}

#[test]
fn the_day_decides_on_temperature_and_wear() {
    let mut config = rokviss();
    let today = SimulatedArm::new(&config, 1).unwrap().truth().temperature;
    // Table 1's set of that day is to be found where nothing else is asked for.
    assert!(
        (today[0] - 10.0).abs() < 2.0 && (today[1] - 10.0).abs() < 2.0,
        "{today:?}"
    );
    config.truth.environment.day = 72.0;
    let cold = SimulatedArm::new(&config, 1).unwrap().truth().temperature;
    assert!(cold[0] < today[0] - 5.0, "{cold:?}");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 16,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_same_seed_gives_the_same_bytes(seed: u64, torques in prop::collection::vec(-60.0..60.0f64, 100)) {
        let run = |seed: u64| {
            let mut arm = SimulatedArm::new(&rokviss(), seed).unwrap();
            let mut bits = Vec::new();
            for pair in torques.chunks_exact(2) {
                arm.advance([pair[0], pair[1]], 0.01);
                let m = arm.measure();
                let numbers = [m.motor_position, m.motor_velocity, m.joint_torque, m.motor_current, m.temperature];
                bits.extend(numbers.iter().flatten().map(|x| x.to_bits()));
            }
            bits
        };
        prop_assert_eq!(run(seed), run(seed));
        prop_assert_ne!(run(seed), run(seed ^ 1));
    }

    /// Without friction, damping, contact and input energy is kept to 1e-4 of
    /// what moves in the arm, whatever the motion, gravity and cubic stiffness.
    #[test]
    fn energy_is_kept_in_any_motion(
        kick in (-15.0..15.0f64, -15.0..15.0f64), x in -10.0..10.0f64, y in -10.0..10.0f64,
        cubic in 0.0..2e7f64, q2 in 0.3..2.5f64,
    ) {
        let mut config = lossless();
        config.arm.gravity = [x, y];
        config.truth.start_position[1] = q2;
        for joint in &mut config.truth.joint {
            joint.cubic_stiffness = cubic;
        }
        let mut arm = SimulatedArm::new(&config, 1).unwrap();
        let rest = arm.truth().energy;
        for _ in 0..50 {
            arm.advance([kick.0, kick.1], TICK);
        }
        let first = arm.truth().energy;
        // With gravity the arm may go on to swing through more than the kick gave.
        let weight = 9.0 * x.hypot(y) * 0.25;
        let scale = (first - rest).abs() + 0.1 * weight + 0.01;
        for _ in 0..2000 {
            arm.advance([0.0, 0.0], TICK);
            let error = (arm.truth().energy - first).abs() / scale;
            prop_assert!(error < 1e-4, "{} of {} J", error, scale);
        }
    }

    /// Whatever the drives do, nothing blows up, and the surfaces never pull.
    #[test]
    fn no_torque_breaks_the_arm(torques in prop::collection::vec(-80.0..80.0f64, 40)) {
        let mut arm = SimulatedArm::new(&rokviss(), 3).unwrap();
        for pair in torques.chunks_exact(2) {
            for _ in 0..100 {
                arm.advance([pair[0], pair[1]], TICK);
                let truth = arm.truth();
                prop_assert!(truth.normal_force >= 0.0);
                prop_assert!(truth.energy.is_finite() && truth.energy < 1e3);
                prop_assert!(truth.velocity[0].abs() < 50.0 && truth.velocity[1].abs() < 50.0);
            }
        }
    }
}

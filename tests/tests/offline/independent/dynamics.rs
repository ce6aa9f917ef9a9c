//! The arm's dynamics against an independent library: MuJoCo.

use ferntast_model::{Vector2, arm::Arm};
use ferntast_sim::arm::{ArmConfig, SimulatedArm};
use serde_json::{Value, json};

use super::numbers::Numbers;

const ARM: &str = include_str!("../../../../config/arms/rokviss.toml");

/// The shipped arm with nothing to touch and no friction.
fn free(gravity: [f64; 2]) -> ArmConfig {
    let mut config: ArmConfig = toml::from_str(ARM).expect("config/arms");
    config.arm.gravity = gravity;
    // Two integrators are compared, so that each has to be near the true motion.
    config.truth.substep = 1e-5;
    config.contour.edge.clear();
    config.contour.spring.clear();
    for joint in &mut config.truth.joint {
        let friction = &mut joint.friction;
        (friction.b_0, friction.b_0t) = (0.0, 0.0);
        (friction.b_1, friction.b_2, friction.b_3) = (0.0, 0.0, 0.0);
    }
    config
}

fn mujoco(input: &Value) -> Value {
    ferntast_tests::ask_python(&ferntast_tests::peer("mujoco_arm.py"), input)
}

fn pair(value: &Value) -> Vector2<f64> {
    let number = |index: usize| value[index].as_f64().expect("a number");
    Vector2::new(number(0), number(1))
}

fn arm_of(config: &ArmConfig) -> Value {
    json!({
        "gravity": config.arm.gravity,
        "links": config.arm.link.iter().map(|link| json!({
            "length": link.length, "mass": link.mass,
            "center_of_mass": link.center_of_mass, "inertia": link.inertia,
        })).collect::<Vec<_>>(),
        "motors": config.truth.joint.iter().map(|joint| json!({
            "inertia": joint.motor_inertia, "stiffness": joint.stiffness, "damping": joint.damping,
        })).collect::<Vec<_>>(),
        "start": config.truth.start_position,
    })
}

#[test]
fn the_arms_dynamics_are_those_of_an_independent_library() {
    let mut numbers = Numbers::new(0x2005_0126);
    for gravity in [[0.0, 0.0], [0.0, -9.80665], [3.0, -2.0]] {
        let config = free(gravity);
        let states: Vec<_> = (0..200)
            .map(|_| {
                (
                    numbers.pair(3.1),
                    numbers.pair(3.0),
                    numbers.pair(20.0),
                    numbers.pair(50.0),
                )
            })
            .collect();
        let hold = 0.01;
        let torques: Vec<_> = (0..50).map(|_| numbers.pair(15.0)).collect();
        let mut input = arm_of(&config);
        input["states"] = states
            .iter()
            .map(|(q, qd, qdd, force)| json!({"q": q, "qd": qd, "qdd": qdd, "force": force}))
            .collect();
        input["hold"] = json!(hold);
        input["torques"] = json!(torques);
        let told = mujoco(&input);

        // Equation (5), left side less right side, state by state.
        let arm = Arm::new(&config.arm);
        let (zero, mut worst) = (Vector2::zeros(), 0.0_f64);
        let rest = arm.potential_energy(&zero);
        let rest_told = told["states"].as_array().expect("states").len();
        assert_eq!(rest_told, states.len());
        // Potential energy counts from another zero there.
        let mut zero_of_energy = None;
        for ((q, qd, qdd, force), theirs) in states.iter().zip(told["states"].as_array().unwrap()) {
            let (q, qd) = (Vector2::from(*q), Vector2::from(*qd));
            let (tip, jacobian) = arm.kinematics().forward_and_jacobian(&q);
            let torque = arm.inverse_dynamics(&q, &qd, &Vector2::from(*qdd))
                - jacobian.tr_mul(&Vector2::from(*force));
            let inertia = arm.inertia(&q);
            let energy = arm.kinetic_energy(&q, &qd) + arm.potential_energy(&q) - rest;
            let offset = theirs["energy"].as_f64().unwrap() - energy;
            let zero_there = *zero_of_energy.get_or_insert(offset);
            worst = [
                (torque - pair(&theirs["torque"])).norm() / (1.0 + torque.norm()),
                (tip - pair(&theirs["tip"])).norm(),
                (inertia * Vector2::new(1.0, 0.0) - pair(&theirs["inertia"][0])).norm(),
                (inertia * Vector2::new(0.0, 1.0) - pair(&theirs["inertia"][1])).norm(),
                (offset - zero_there).abs() / (1.0 + energy.abs()),
            ]
            .into_iter()
            .fold(worst, f64::max);
        }
        println!("gravity {gravity:?}: states differ by {worst:.1e}");
        assert!(worst < 1e-11, "{worst}");

        // Half a second of the whole plant with its flexible joints.
        let mut simulated = SimulatedArm::new(&config, 1).expect("valid");
        let (mut position, mut joint_torque, mut way) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (torque, theirs) in torques.iter().zip(told["motion"].as_array().unwrap()) {
            simulated.advance(*torque, hold);
            let truth = simulated.truth();
            position = position
                .max((Vector2::from(truth.position) - pair(&theirs["link"])).norm())
                .max((Vector2::from(truth.motor_position) - pair(&theirs["motor"])).norm());
            joint_torque = joint_torque
                .max((Vector2::from(truth.joint_torque) - pair(&theirs["torque"])).norm());
            way = way.max(
                (Vector2::from(truth.position) - Vector2::from(config.truth.start_position)).norm(),
            );
        }
        println!("  motion of {way:.2} rad: {position:.1e} rad, {joint_torque:.1e} Nm apart");
        assert!(way > 0.05);
        assert!(position < 2e-6, "{position}");
        assert!(joint_torque < 0.01, "{joint_torque}");
    }
}

//! Energy, rest, rigidity, chance.

use ferntast_model::Joints;

use super::{TICK, arm, arms, no_torque};

const SPREAD: &str = "start_position = [0.3, -0.6, 0.4, -1.9, 0.5, 1.6, 0.2]\n";
const FLEXIBLE: &str = "[[joint]]\nmotor_inertia = 0.3\nstiffness = 8000.0\n";
const FRICTION: &str = "friction = { b_0 = 2.0, b_0T = 0.05, b_1 = 3.0, b_2 = 0.0, b_3 = 0.0, \
                        linear_from = 1.0 }\n";

/// Greatest change of energy in two seconds of falling, in parts of the energy that moves.
fn change(drive: &str, substep: f64) -> f64 {
    let chain = arms::seven_joints();
    let mut arm = arm(&chain, &format!("substep = {substep}\n{SPREAD}{drive}"));
    let (begin, torque) = (arm.truth().energy, no_torque(&chain));
    let (mut worst, mut moving) = (0.0_f64, 0.0_f64);
    for _ in 0..2000 {
        arm.advance(&torque, TICK);
        let truth = arm.truth();
        worst = worst.max((truth.energy - begin).abs());
        let kinetic: f64 = chain.kinetic_energy(&truth.position, &truth.velocity);
        moving = moving.max(kinetic);
    }
    println!("{substep} s: {worst:.2e} J of {moving:.1} J");
    worst / moving
}

#[test]
fn a_falling_arm_keeps_its_energy_to_second_order() {
    for drive in ["", FLEXIBLE] {
        let (coarse, fine) = (change(drive, 5e-4), change(drive, 2.5e-4));
        assert!(coarse < 2e-3, "{coarse}");
        let order = (coarse / fine).log2();
        assert!((1.6..2.5).contains(&order), "order {order}");
    }
}

/// What the motors put in is in the arm or has become heat.
#[test]
fn work_is_energy_and_heat() {
    for gear in ["[[joint]]\n", FLEXIBLE] {
        let chain = arms::seven_joints();
        let mut arm = arm(&chain, &format!("substep = 1e-4\n{SPREAD}{gear}{FRICTION}"));
        let begin = arm.truth().energy;
        let mut worst = 0.0_f64;
        for tick in 0..2000 {
            let time = f64::from(tick) * TICK;
            let torque = Joints::from_fn(chain.count(), |joint| {
                (20.0 - 2.0 * joint as f64) * (4.0 * time + joint as f64).sin()
            });
            arm.advance(&torque, TICK);
            let truth = arm.truth();
            let missing = truth.motor_work - truth.friction_heat - (truth.energy - begin);
            worst = worst.max(missing.abs());
        }
        let truth = arm.truth();
        println!(
            "{worst:.1e} J are missing of {:.1} J of heat",
            truth.friction_heat
        );
        assert!(truth.friction_heat > 10.0);
        assert!(worst < 1e-3 * truth.friction_heat, "{worst}");
    }
}

#[test]
fn friction_holds_motors_exactly_still_and_lets_go_beyond_it() {
    for gear in ["[[joint]]\n", FLEXIBLE] {
        let chain = arms::seven_joints();
        let text = format!("gravity = [0.0, 0.0, 0.0]\n{SPREAD}{gear}{FRICTION}");
        let mut arm = arm(&chain, &text);
        let begin = arm.truth();
        let mut torque = Joints::filled(chain.count(), 1.9);
        for _ in 0..300 {
            arm.advance(&torque, TICK);
        }
        let held = arm.truth();
        assert_eq!(held.motor_position, begin.motor_position);
        assert!(held.motor_velocity.iter().all(|rate| *rate == 0.0));
        torque[3] = 2.3;
        for _ in 0..100 {
            arm.advance(&torque, TICK);
        }
        let moved = arm.truth().motor_position[3] - begin.motor_position[3];
        assert!(moved > 1e-5, "{moved}");
    }
}

/// A gear that is ever stiffer comes to move as a rigid one, which has no equation of its own
/// for the motor.
#[test]
fn a_rigid_gear_is_the_limit_of_a_stiff_one() {
    let chain = arms::seven_joints();
    let end = |gear: &str| {
        let mut arm = arm(
            &chain,
            &format!("substep = 1e-4\n{SPREAD}[[joint]]\n{gear}"),
        );
        let torque = Joints::filled(chain.count(), 2.0);
        for _ in 0..300 {
            arm.advance(&torque, TICK);
        }
        arm.truth().position
    };
    let rigid = end("");
    let apart = |stiffness: f64| {
        let flexible = end(&format!(
            "stiffness = {stiffness}\ndamping = {}",
            stiffness * 1e-3
        ));
        let pairs = rigid.iter().zip(flexible.iter());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let (soft, hard) = (apart(1e4), apart(1e6));
    println!("{soft:.1e} and {hard:.1e} rad apart");
    assert!(hard < 2e-4 && hard < 0.03 * soft && hard > 0.0);
}

#[test]
fn a_rigid_joint_at_rest_feels_the_weight() {
    let chain = arms::seven_joints();
    let mut arm = arm(&chain, SPREAD);
    let begin = arm.truth();
    let weight = begin.joint_torque;
    for _ in 0..100 {
        arm.advance(&weight, TICK);
    }
    let end = arm.truth();
    for joint in 0..7 {
        assert!((end.position[joint] - begin.position[joint]).abs() < 1e-9);
        assert!((end.joint_torque[joint] - weight[joint]).abs() < 1e-6);
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_one_does_not() {
    let chain = arms::seven_joints();
    let text = format!(
        "{SPREAD}{FLEXIBLE}{FRICTION}sensor = {{ encoder_counts = 4096, velocity_time_constant = 0.002, \
         torque_noise = 0.05, torque_step = 0.01, current_noise = 0.02, current_step = 0.005 }}\n"
    );
    let parameters = super::parameters(&text);
    let run = |seed| {
        let limits = arms::any_torque(&chain);
        let mut arm =
            ferntast_sim::serial_arm::SerialArm::new(&chain, &limits, &parameters, seed).unwrap();
        let mut told = String::new();
        for _ in 0..200 {
            arm.advance(&Joints::filled(chain.count(), 3.0), TICK);
            told += &format!("{:?}", arm.measure());
        }
        told
    };
    assert!(run(7) == run(7));
    assert!(run(7) != run(8));
}

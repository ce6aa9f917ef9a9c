//! What the tip feels: weights, springs, Coulomb's law, work.

use ferntast_model::{Joints, rigid_body::Vector3};

use super::{TICK, arm, arms, no_torque};

const G: f64 = 9.80665;
const TABLE: &str = "start_position = [0.0, 0.01]\n[[object]]\nname = \"table\"\n\
    shape = { kind = \"plane\", point = [0, 0, 0], normal = [0, 0, 1] }\n\
    surface = { stiffness = 2e4, damping = 300, friction = 0.4, tangential_stiffness = 2e4, \
    tangential_damping = 100 }\n";

#[test]
fn what_rests_on_a_table_weighs_on_it() {
    let chain = arms::slides();
    let mut arm = arm(&chain, TABLE);
    for _ in 0..2000 {
        arm.advance(&no_torque(&chain), TICK);
    }
    let truth = arm.truth();
    assert!(
        (truth.normal_force - 2.0 * G).abs() < 1e-9,
        "{}",
        truth.normal_force
    );
    assert!((truth.force - Vector3::new(0.0, 0.0, 2.0 * G)).norm() < 1e-9);
    // m g / k deep.
    assert!((truth.tip.translation.z + 2.0 * G / 2e4).abs() < 1e-12);
    assert_eq!(truth.object, Some(0));
}

#[test]
fn coulomb_friction_holds_up_to_its_limit_and_no_more() {
    let chain = arms::slides();
    let mut arm = arm(&chain, TABLE);
    for _ in 0..1000 {
        arm.advance(&no_torque(&chain), TICK);
    }
    let limit = 0.4 * 2.0 * G;
    let push = |arm: &mut ferntast_sim::serial_arm::SerialArm, force: f64| {
        for _ in 0..1000 {
            arm.advance(&Joints::from([force, 0.0]), TICK);
        }
        arm.truth()
    };
    let held = push(&mut arm, 0.9 * limit);
    assert!(held.tip_velocity.norm() < 1e-9);
    assert!((held.force.x + 0.9 * limit).abs() < 1e-6, "{}", held.force);
    let slides = push(&mut arm, 1.5 * limit);
    assert!((slides.force.x + limit).abs() < 1e-6);
    // Half of the limit is left to accelerate 3 kg for a second.
    let speed = 0.5 * limit / 3.0;
    assert!(
        (slides.tip_velocity.x / speed - 1.0).abs() < 0.01,
        "{}",
        slides.tip_velocity
    );
}

/// On springs without damping the energy that the tip had comes back.
#[test]
fn a_lossless_bounce_gives_back_all_energy_and_a_damped_one_takes_some() {
    let chain = arms::seven_joints();
    let run = |damping: f64, friction: f64, kind: &str| {
        let text = format!(
            "substep = 1e-4\nstart_position = [0.0, 0.3, 0.0, -1.6, 0.0, 1.9, 0.0]\ntip_radius = 0.02\n\
             [[joint]]\nmotor_inertia = 0.2\nstiffness = 2e4\n\
             [[object]]\nname = \"floor\"\nshape = {kind}\n\
             surface = {{ stiffness = 2e4, damping = {damping}, friction = {friction}, \
             tangential_stiffness = 2e4, tangential_damping = {damping} }}\n"
        );
        let mut arm = arm(&chain, &text);
        let begin = arm.truth();
        let (mut peak, mut worst) = (0.0_f64, 0.0_f64);
        for _ in 0..2000 {
            arm.advance(&no_torque(&chain), TICK);
            let truth = arm.truth();
            peak = peak.max(truth.normal_force);
            // A surface that is left faster than it comes back pushes no more, and is still
            // bent.
            if truth.tip.translation.z > 0.425 {
                // All that the contact gave or took went through the tip.
                let missing = truth.energy - begin.energy - truth.contact_work;
                worst = worst.max(missing.abs());
            }
        }
        (arm.truth(), begin, peak, worst)
    };
    let table = "{ kind = \"plane\", point = [0, 0, 0.4], normal = [0, 0, 1] }";
    let cube = "{ kind = \"box\", center = [0.5, 0, 0.3], size = [0.6, 0.6, 0.2] }";
    for kind in [table, cube] {
        let (end, begin, peak, worst) = run(0.0, 0.0, kind);
        println!("{peak:.0} N, {worst:.1e} J");
        assert!(peak > 100.0 && worst < 0.05, "{peak} N, {worst} J");
        assert!((end.energy - begin.energy).abs() < 0.05);
        let (end, begin, _, worst) = run(100.0, 0.3, kind);
        assert!(worst < 0.05, "{worst}");
        assert!(end.energy < begin.energy - 1.0);
    }
}

/// A wall that comes and goes works on an arm that is held: by the force that it takes.
#[test]
fn a_moving_wall_presses_as_deep_as_it_comes() {
    let chain = arms::slides();
    let text = "gravity = [0, 0, 0]\nstart_position = [-0.001, 0]\n\
        [[joint]]\nstiffness = 1e9\nmotor_inertia = 1000\n\
        [[object]]\nname = \"ram\"\nshape = { kind = \"box\", center = [0.1, 0, 0], size = [0.2, 0.2, 0.2] }\n\
        motion = { amplitude = [0.005, 0, 0], frequency = 1.0, phase = 0.0 }\n\
        surface = { stiffness = 1000, damping = 0, friction = 0, tangential_stiffness = 1000, \
        tangential_damping = 0 }\n";
    let mut arm = arm(&chain, text);
    let mut worst = 0.0_f64;
    for tick in 1..2000 {
        arm.advance(&no_torque(&chain), TICK);
        let truth = arm.truth();
        // The force is that of half a substep ago.
        let time = f64::from(tick) * TICK - 0.5 * arm.substep();
        let wall = 0.005 * (std::f64::consts::TAU * time).sin();
        let deep = (truth.tip.translation.x - wall).max(0.0);
        worst = worst.max((truth.normal_force - 1000.0 * deep).abs());
        assert!(truth.force.x <= 0.0);
    }
    println!("{worst:.1e} N");
    assert!(worst < 0.02, "{worst}");
}

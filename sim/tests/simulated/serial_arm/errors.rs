//! What is refused, and in which words.

use ferntast_model::Joints;
use ferntast_sim::serial_arm::{SerialArm, SerialArmParameters};

use super::{TICK, arm, arms, parameters};

fn told(text: &str) -> String {
    let chain = arms::seven_joints();
    let parameters = parameters(text);
    let arm = SerialArm::new(&chain, &arms::any_torque(&chain), &parameters, 1);
    arm.expect_err("refused").to_string()
}

const FLOOR: &str = "[[object]]\nname = \"floor\"\nshape = { kind = \"plane\", point = [0, 0, 0.4], \
    normal = [0, 0, 1] }\nsurface = { stiffness = 1e6, damping = 0, friction = 0, \
    tangential_stiffness = 1, tangential_damping = 0 }\n";

#[test]
fn lists_of_another_length_are_refused() {
    assert!(told("start_position = [0.0, 1.0]").contains("start_position has 2 entries where 7"));
    let two = "[[joint]]\nstiffness = 1e4\n[[joint]]\n";
    assert!(told(two).contains("joint has 2 entries where 7 are needed"));
}

#[test]
fn a_value_out_of_bounds_is_named_by_its_key() {
    assert!(told("[[joint]]\nstiffness = -1.0").contains("joint[0].stiffness = -1 Nm/rad"));
    let ball = FLOOR.replace(
        "kind = \"plane\", point = [0, 0, 0.4], normal = [0, 0, 1]",
        "kind = \"sphere\", center = [0, 0, 0], radius = -2",
    );
    assert!(
        told(&ball).contains("object[0].shape.radius = -2 m"),
        "{}",
        told(&ball)
    );
    assert!(toml::from_str::<SerialArmParameters>("[[joint]]\nstifness = 1.0").is_err());
    assert!(toml::from_str::<SerialArmParameters>(&FLOOR.replace("plane", "plain")).is_err());
}

#[test]
fn a_start_within_a_thing_names_it() {
    let told = told(&FLOOR.replace("0.4]", "3.0]"));
    assert!(told.contains("on or within \"floor\""), "{told}");
}

#[test]
fn a_substep_that_does_not_resolve_a_contact_is_refused_and_chosen_where_left_out() {
    let refused = told(&format!("substep = 1e-3\n{FLOOR}"));
    assert!(
        refused.contains("set it to") && refused.contains("leave it out"),
        "{refused}"
    );
    let chain = arms::seven_joints();
    // Links that are not one with their motors vibrate faster.
    let flexible = format!("[[joint]]\nstiffness = 1e4\n{FLOOR}");
    let chosen = arm(&chain, &flexible).substep();
    assert!(chosen < 5e-4 && chosen > 1e-5, "{chosen}");
    assert_eq!(arm(&chain, "").substep(), 5e-4);
}

#[test]
fn a_command_that_is_no_number_lets_the_drive_go() {
    let chain = arms::seven_joints();
    let limits = Joints::filled(chain.count(), 10.0);
    let mut arm = SerialArm::new(&chain, &limits, &parameters("gravity = [0, 0, 0]"), 1).unwrap();
    let begin = arm.truth();
    let mut torque = Joints::filled(chain.count(), 0.0);
    torque[2] = f64::NAN;
    let flags = arm.advance(&torque, TICK);
    assert!(flags.not_finite[2] && !flags.not_finite[1]);
    assert_eq!(arm.truth().position, begin.position);
    torque[2] = 11.0;
    assert!(arm.advance(&torque, TICK).limited[2]);
    assert!((arm.measure().motor_torque_from_current[2] - 10.0).abs() < 1e-12);
    for time in [0.0, -1.0, f64::NAN] {
        let before = arm.truth();
        arm.advance(&torque, time);
        assert_eq!(arm.truth(), before);
    }
}

//! The stiffness in a summary, beside the recording and the arm's file.

use ferntast_msgs::{Time, topics};
use ferntast_tests::{Session, messages, number, run};

/// The hand of `rokviss` rests from 3.0 to 3.2 s, pressed into the lubricated edge, which is at
/// y = −30 mm; force and way between hand and tip have the scales 0.05 and 1.
#[test]
fn it_is_what_the_hand_felt_at_rest() {
    let session = Session::new();
    let arguments = ["lockstep", "--duration", "5", "--record", "run", "--json"];
    let told = run(&session, &arguments).success().json();
    let folder = session.folder().join("run");
    let places = messages(&folder, topics::LEADER_SETPOINT_CP);
    let forces = messages(&folder, topics::LEADER_SERVO_CF);
    let start = places.first().expect("poses").received;
    let rests = |received: Time| (3.05..3.2).contains(&received.seconds_since(start));
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let place = places.iter().filter(|own| rests(own.received));
    let place = mean(place.map(|own| own.message.position[1]).collect());
    let force = forces.iter().filter(|own| rests(own.received));
    let force = mean(force.map(|own| own.message.force[1]).collect());
    let felt = force / 0.05 / (-0.03 - place);
    assert!((10e3..16e3).contains(&felt), "{felt} N/m");
    let ratio = number(&told, "felt_stiffness_N_per_m") / felt;
    assert!((0.97..1.03).contains(&ratio), "{ratio} of {felt} N/m");
}

/// The hand rests for 0.4 s, and what it feels is 0.6 s late.
#[test]
fn where_nothing_can_be_told_nothing_is() {
    let session = Session::new();
    let arguments = ["lockstep", "relay", "--duration", "20", "--json"];
    let told = run(&session, &arguments).success().json();
    assert!(number(&told, "contact.time_s") > 2.0, "{told:#}");
    assert!(told["felt_stiffness_N_per_m"].is_null(), "{told:#}");
}

/// The second edge stands across the first one. The hand is pressed 3 mm into it from 11.6 to
/// 13.6 s, and feels some 40 N at the scale of the force; so hard presses the arm then.
#[test]
fn a_second_surface_is_felt_as_well() {
    for law in ["model_mediated", "two_layer", "auto"] {
        let session = Session::new();
        let arguments = [
            "lockstep",
            "--law",
            law,
            "--duration",
            "13.5",
            "--record",
            "run",
            "--json",
        ];
        let told = run(&session, &arguments).success().json();
        let peak = number(&told, "contact.peak_force_N");
        assert!((10.0..60.0).contains(&peak), "{law}: {told:#}");
        let forces = messages(&session.folder().join("run"), topics::LEADER_SERVO_CF);
        let start = forces.first().expect("forces").received;
        let late = forces
            .iter()
            .filter(|own| own.received.seconds_since(start) > 12.0);
        let least = late
            .map(|own| -own.message.force[0])
            .fold(f64::INFINITY, f64::min);
        assert!((1.0..3.0).contains(&least), "{law}: {least} N");
    }
}

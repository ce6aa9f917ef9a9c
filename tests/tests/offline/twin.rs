//! A twin of a joint: the same live as played back, and refusals in words.

use std::fs;

use ferntast_msgs::topics;
use ferntast_tests::{JOINT_2, Session, experiment_on_joint_2, messages, number, refused, run};

#[test]
fn played_back_it_is_what_it_was_live_byte_for_byte() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let arguments = [
        "lockstep",
        "--twin",
        "joint.toml",
        "--duration",
        "150",
        "--seed",
        "5",
        "--record",
        "second",
        "--json",
    ];
    let live = run(&session, &arguments).success().json();
    let replay = ["replay", "second", "--twin", "joint.toml", "--json"];
    let replay = run(&session, &replay).success().json();
    assert_eq!(replay["equal"], true, "{replay:#}");
    let twin = &live["twins"][0];
    assert_eq!(twin, &replay["twins"][0]);
    assert_eq!(twin["joint"], "joint_2", "{twin:#}");
    assert_ne!(twin["verdict"], "pending", "{twin:#}");
    // Those of equation (4), and the fastest speed at which they were found.
    let parameters = twin["parameters"].as_array().expect("parameters");
    assert_eq!(parameters.len(), 6, "{twin:#}");

    // What is compared is there: predictions, residuals and parameters.
    let second = session.folder().join("second");
    let predicted = messages(&second, topics::TWIN_MOTOR_JS);
    let residual = messages(&second, topics::TWIN_RESIDUAL_JS);
    let parameters = messages(&second, topics::TWIN_PARAMETERS);
    assert!(predicted.len() > 10_000 && parameters.len() > 800);
    assert!(residual.len() > 4000 && residual.len() < predicted.len());
    // The same arm, the same model: what is left is a small part of the torque.
    let rms = |all: &[ferntast_bus::Received<ferntast_msgs::sample::JointSample>]| {
        let squares = all.iter().map(|own| own.message.effort[1].powi(2));
        (squares.sum::<f64>() / all.len() as f64).sqrt()
    };
    let (left, whole) = (rms(&residual), rms(&predicted));
    assert!(
        left < 0.3 * whole && left > 1e-3 * whole,
        "{left} of {whole} Nm"
    );
}

/// Take-over, the way back and the refusals are in the recording, and come out
/// the same when it is fed again, with a twin of its own and without one.
#[test]
fn a_take_over_is_recorded_and_replayed_byte_for_byte() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let arguments = [
        "lockstep",
        "--twin",
        "joint.toml",
        "--duration",
        "70",
        "--take-over",
        "50",
        "--give-back",
        "60",
        "--record",
        "taken",
        "--json",
    ];
    let told = run(&session, &arguments).success().json();
    let second = &told["friction"][1];
    assert_eq!(second["joint"], "joint_2", "{told:#}");
    assert_eq!(second["source"], "configured", "{second:#}");
    assert_eq!(second["refused"], serde_json::Value::Null, "{second:#}");

    let taken = session.folder().join("taken");
    let commands = messages(&taken, topics::FOLLOWER_FRICTION_COMMAND);
    assert_eq!(commands.len(), 2);
    let friction = topics::FOLLOWER_JOINT_FRICTION
        .of("joint_2")
        .expect("a name");
    let friction = messages(&taken, friction);
    let by_the_twin = |own: &&ferntast_bus::Received<_>| {
        let own: &ferntast_msgs::sample::FrictionStatusSample = &own.message;
        own.source == ferntast_msgs::sample::FrictionSource::TWIN
    };
    let last = friction.iter().rfind(by_the_twin);
    let last = last.expect("taken over").message;
    // Close to what was configured, since it is the same arm; but not it.
    for i in 0..last.len() {
        if last.names[i].as_str() == "v_seen" {
            // The fastest speed that the twin has seen: nothing that is configured.
            assert!((0.1..0.5).contains(&last.values[i]), "{last:?}");
            continue;
        }
        let share = last.values[i] / last.configured[i];
        assert!((0.9..1.1).contains(&share), "{last:?}");
    }
    assert_ne!(last.values[0], last.configured[0]);
    assert_eq!(last.values, last.targets);

    for arguments in [
        &["replay", "taken", "--json"][..],
        &["replay", "taken", "--twin", "joint.toml", "--json"],
    ] {
        let replay = run(&session, arguments).success().json();
        assert_eq!(replay["equal"], true, "{replay:#}");
    }
}

#[test]
fn the_lab_goes_on_with_what_the_twin_found() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let arguments = ["lockstep", "--twin", "joint.toml", "--duration", "60"];
    let arguments = [&arguments[..], &["--seed", "9", "--record", "second"]].concat();
    run(&session, &arguments).success();
    let arguments = [
        "twin",
        "experiment",
        "second",
        "--model",
        "joint.toml",
        "-o",
        "found.toml",
        "--json",
    ];
    let told = run(&session, &arguments).success().json();
    let found = number(&told, "parameters.b0.value");
    assert!((found - 12.372).abs() < 0.5, "{told:#}");
    assert!(number(&told, "held_out_before") > 0.0 && number(&told, "held_out_after") > 0.0);

    let compared = run(&session, &["lab", "compare", "found.toml", "--json"]);
    let compared = compared.success().json();
    let fitted = number(&compared, "parameters.b0.value");
    assert!((fitted - found).abs() < 0.3, "{compared:#}");
    let history = run(&session, &["lab", "history", "found.toml", "--json"]);
    let history = history.success().json();
    let steps = history.as_array().expect("steps");
    assert_eq!(steps.len(), 2, "{history:#}");
    assert_eq!(steps[1]["other_data"], true);
    assert_eq!(number(&steps[1], "parameters.b0.value"), found);

    // Not over a file; not with another model; not without a twin.
    refused(&session, &arguments, &["found.toml", "exists already"]);
    let other = JOINT_2.replace("[1]", "[0]").replace("joint_2", "joint_1");
    fs::write(session.folder().join("other.toml"), other).expect("scratch folder");
    for (recording, model, words) in [
        ("second", "other.toml", "joint_2"),
        ("first", "joint.toml", "nothing of a twin"),
    ] {
        let arguments = [
            "twin",
            "experiment",
            recording,
            "--model",
            model,
            "-o",
            "new.toml",
        ];
        refused(&session, &arguments, &[words]);
    }
}

#[test]
fn take_over_asks_for_a_session() {
    let session = Session::new();
    let arguments = ["twin", "take-over", "--session", session.name()];
    let ended = run(&session, &arguments);
    assert_eq!(ended.status.code(), Some(1), "{ended:#?}");
    assert!(ended.stderr.contains("does not answer"), "{ended:#?}");
    let arguments = ["lockstep", "--take-over", "3"];
    refused(&session, &arguments, &["--twin"]);
}

#[test]
fn an_experiment_that_is_not_of_a_session_is_refused() {
    let session = Session::new();
    fs::write(session.folder().join("drive.csv"), "t_s,q_rad,applied_V\n").expect("scratch folder");
    let column = String::from(
        "recording = \"drive.csv\"\n[signals]\nposition = \"q_rad\"\nmotor_torque = \"applied_V\"\n\
         [model]\ninertia = { fit = true }\neffects = [\"coulomb\"]\n",
    );
    let mixed = JOINT_2.replace("motor_js.effort[1]", "motor_js.effort[0]");
    for (text, words) in [
        (
            &column,
            ["signals.position", "/follower/measured_js.position[0]"],
        ),
        (
            &mixed,
            ["signals.motor_torque", "/follower/motor_js.effort[1]"],
        ),
    ] {
        fs::write(session.folder().join("other.toml"), text).expect("scratch folder");
        for command in ["session", "lockstep"] {
            refused(&session, &[command, "--twin", "other.toml"], &words);
        }
    }
    refused(
        &session,
        &["lockstep", "--twin", "none.toml"],
        &["none.toml"],
    );
}

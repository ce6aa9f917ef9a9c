//! A twin of a joint in a session.

use std::time::{Duration, Instant};

use ferntast_msgs::topics;
use ferntast_tests::{
    PATIENCE, Session, await_enabled, experiment_on_joint_2, keep_enabled, messages, number, rearm,
    recording, run, set_parameter, start, wait_for,
};

#[test]
fn in_a_session_it_is_a_node_like_the_others() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let mut process = start(&session, &["--twin", "joint.toml", "--ros-commands"]);
    await_enabled(&session, &mut process);
    let end = Instant::now() + Duration::from_secs(7);
    keep_enabled(&session, || Instant::now() < end);
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert_eq!(summary["nodes"]["twin"]["alive"], true, "{summary:#}");
    assert!(number(&summary["twins"][0], "residual_rms_Nm") > 0.0);
    assert_eq!(summary["twins"][0]["verdict"], "pending");
    let predicted = messages(&recording(&session), topics::TWIN_MOTOR_JS);
    let measured = messages(&recording(&session), topics::FOLLOWER_MEASURED_JS);
    // About a tenth of a second behind the samples that it is about.
    let last = predicted.last().expect("predictions").message.stamp;
    let behind = measured
        .last()
        .expect("samples")
        .message
        .stamp
        .seconds_since(last);
    assert!(behind > 0.0 && behind < 1.0, "{behind} s");
}

#[test]
fn played_into_a_live_twin_it_answers_too() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let arguments = [
        "play",
        "first",
        "--twin",
        "joint.toml",
        "--rate",
        "4",
        "--json",
    ];
    let arguments = [&arguments[..], &["--session", session.name()]].concat();
    let played = run(&session, &arguments).success().json();
    assert_eq!(played["twins"][0]["joint"], "joint_2", "{played:#}");
    assert!(number(&played["twins"][0], "residual_rms_Nm") > 0.0);
}

#[test]
fn in_a_session_the_servo_is_told_and_tells_back() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let mut process = start(&session, &["--twin", "joint.toml", "--ros-commands"]);
    await_enabled(&session, &mut process);
    let twin = |what: &str| {
        let arguments = ["twin", what, "--session", session.name(), "--json"];
        run(&session, &arguments)
    };
    let told = twin("friction").success().json();
    assert_eq!(told[1]["source"], "configured", "{told:#}");
    // Until the twin has seen enough motion it is refused.
    let taken = wait_for(PATIENCE, || {
        rearm(&session);
        let ended = twin("take-over");
        match ended.status.code() {
            Some(0) => Some(ended.json()),
            code => {
                assert_eq!(code, Some(2), "{ended:#?}");
                assert!(ended.stderr.contains("refused"), "{ended:#?}");
                None
            }
        }
    });
    let taken = taken.expect("certain after half a minute");
    assert_eq!(taken[1]["source"], "twin", "{taken:#}");
    let told = twin("give-back").success().json();
    assert_eq!(told[1]["source"], "configured", "{told:#}");
    // The servo may refuse a later model of the twin's, and goes back by itself.
    let stays = wait_for(PATIENCE, || {
        let set = set_parameter(&session, ["/servo", "friction", "twin"]);
        assert_eq!(set["before"], "configured", "{set:#}");
        assert_eq!(set["after"], "twin", "{set:#}");
        let told = twin("friction").success().json();
        let by_twin = told[1]["source"] == "twin";
        assert!(by_twin || told[1]["refused"].is_string(), "{told:#}");
        by_twin.then_some(())
    });
    stays.expect("the servo takes the twin's model");
    process.interrupt();
    process.wait(PATIENCE).success();
}

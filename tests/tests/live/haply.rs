//! A Haply Inverse3 as the hand, by what its service says: an emulator of the published messages.

use std::fs;

use ferntast_msgs::topics;
use ferntast_tests::{
    PATIENCE, Process, Session, await_armed, free_tcp_port, messages, number, recording, signal,
    start, state_of_follower, wait_until,
};

/// The hand goes away from the operator, which is x of the arm, and presses on the edge there by 3 mm.
#[test]
fn a_haply_drives_the_arm_feels_the_edge_and_lets_go_where_its_service_is_silent() {
    let session = Session::alone();
    let port = free_tcp_port();
    let shipped = ferntast_tests::root().join("config/scenarios/operator.toml");
    let text = fs::read_to_string(shipped).expect("a scenario");
    let text = text.replace(
        "source = \"crtk\"",
        &format!("source = \"haply\"\nhaply = {{ url = \"ws://127.0.0.1:{port}\" }}"),
    );
    fs::write(session.folder().join("haply.toml"), text).expect("scratch");
    let port = port.to_string();
    let mut service = Process::spawn(session.peer("haply_service.py", &["--port", &port]));
    service.await_stderr("ready", PATIENCE);
    let mut process = start(&session, &["--scenario", "haply.toml"]);
    await_armed(&session, &mut process);
    let hand = i32::try_from(service.id()).expect("a process id");
    signal(hand, libc::SIGUSR1);
    let told = service.wait(PATIENCE).success().json();
    println!("{told:#}");
    // The service fell silent: the arm holds.
    let held = wait_until(PATIENCE, || state_of_follower(&session) == "PAUSED");
    assert!(held, "{}", state_of_follower(&session));
    process.interrupt();
    process.wait(PATIENCE);

    assert_eq!(told["bad"], 0);
    assert!(
        number(&told, "answers") > 0.2 * number(&told, "frames"),
        "{told:#}"
    );
    // Pushed back to the operator, along the device's y; at first not at all.
    let peak: Vec<f64> = (0..3)
        .filter_map(|axis| told["peak"][axis].as_f64())
        .collect();
    assert!((-10.0..-0.3).contains(&peak[1]), "{peak:?}");
    assert!(peak[0].abs() < -peak[1] && peak[2].abs() < 0.1, "{peak:?}");
    assert!(number(&told, "first_N") < 0.2, "{told:#}");
    // It fell silent while the tip pressed: no force stays on the hand.
    assert!(number(&told, "before_N") > 0.3, "{told:#}");
    assert_eq!(told["last_N"], 0.0, "{told:#}");

    let poses = messages(&recording(&session), topics::LEADER_MEASURED_CP);
    let far = poses.iter().map(|own| own.message.position[0]);
    assert!((far.fold(0.0, f64::max) - 0.033).abs() < 1e-6);
    assert!(poses.iter().all(|own| own.message.position[1].abs() < 1e-9));
    // The grip turns about z, which the axes leave.
    let turned = poses.iter().map(|own| own.message.orientation[2].abs());
    assert!(turned.fold(0.0, f64::max) > 0.05);
}

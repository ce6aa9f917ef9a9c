//! A session that runs is not disturbed by what is refused; it says what it lacks.

use std::os::unix::process::CommandExt;

use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, free_tcp_port, number, refused, start,
};

#[test]
fn a_session_that_runs_already_and_a_recording_that_exists() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    let name = session.name().to_owned();
    let other = format!("tcp/127.0.0.1:{}", free_tcp_port());
    let arguments = ["session", "--session", &name, "--link-endpoint", &other];
    refused(&session, &arguments, &[&name]);
    let free = [
        "session",
        "--session",
        "x",
        "--link-endpoint",
        &other,
        "--record",
        "run",
    ];
    refused(&session, &free, &["run", "--record"]);
    // It was not disturbed.
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert_eq!(summary["recorder"]["lost"], 0);
}

#[test]
fn no_permission_for_real_time_priority_is_told_and_it_runs_on() {
    let session = Session::new();
    let mut command = session.ferntast_here(&["session", "--json", "--duration", "2"]);
    // SAFETY: both calls are async-signal-safe; the limits are those of the child.
    unsafe {
        command.pre_exec(|| {
            const CAP_SYS_NICE: libc::c_ulong = 23;
            let none = libc::rlimit {
                rlim_cur: 0,
                rlim_max: 0,
            };
            libc::setrlimit(libc::RLIMIT_RTPRIO, &none);
            // Refused without privilege, which then has not got it either.
            libc::prctl(libc::PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0);
            Ok(())
        });
    }
    let ended = Process::spawn(command).wait(PATIENCE).success();
    assert!(
        ended.stderr.contains("no real-time priority"),
        "{}",
        ended.stderr
    );
    assert!(ended.stderr.contains("ferntast doctor"), "{}", ended.stderr);
    let summary = ended.json();
    let faults = summary["nodes"]["servo"]["faults"]
        .as_array()
        .expect("faults");
    assert!(
        faults.contains(&serde_json::json!("no realtime priority")),
        "{summary:#}"
    );
    // It runs on; how late it is then is the machine's affair.
    let visited = summary["states"]["follower"]["visited"]
        .as_array()
        .expect("states");
    assert!(
        visited.contains(&serde_json::json!("ENABLED")),
        "{summary:#}"
    );
    assert!(number(&summary, "servo.rate_hz") > 300.0, "{summary:#}");
}

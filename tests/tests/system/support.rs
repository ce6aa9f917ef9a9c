//! What these tests have in common.

use std::{
    fs,
    panic::{self, AssertUnwindSafe},
    path::{Path, PathBuf},
    time::Duration,
};

use ferntast_bus::{Received, mcap::BagReader};
use ferntast_msgs::{Message, topics::Topic};
use ferntast_tests::{Process, Session, wait_for};

/// How long anything may take on a machine that is busy.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// `ferntast session` in its own session, recording into `run`, with these arguments.
pub fn start(session: &Session, arguments: &[&str]) -> Process {
    let mut command = session.ferntast_here(&["session", "--json", "--record", "run"]);
    command.args(arguments);
    Process::spawn(command)
}

/// Where [`start`] records.
pub fn recording(session: &Session) -> PathBuf {
    session.folder().join("run")
}

/// Waits until the arm is armed: until something is recorded while it moves.
pub fn await_enabled(session: &Session, process: &mut Process) {
    process.await_stderr("follower ENABLED", PATIENCE);
    assert!(recording(session).is_dir());
}

/// Every message of `topic` in the recording at `path`.
pub fn messages<M: Message>(path: &Path, topic: Topic<M>) -> Vec<Received<M>> {
    let reader = BagReader::open(path).unwrap_or_else(|error| panic!("{error}"));
    let messages = reader
        .messages::<M>(topic.name)
        .unwrap_or_else(|error| panic!("{error}"));
    messages
        .map(|message| {
            let message = message.unwrap_or_else(|error| panic!("{}: {error}", topic.name));
            Received {
                message: message.message,
                received: message.log_time,
                source: 0,
            }
        })
        .collect()
}

/// Process id of the node `name` of the session.
pub fn node(session: &Session, name: &str) -> i32 {
    wait_for(PATIENCE, || {
        session.processes().into_iter().find_map(|process| {
            let command = fs::read(format!("/proc/{process}/cmdline")).ok()?;
            let mut words = command.split(|&byte| byte == 0).skip(1);
            let found = words.next()? == b"node" && words.next()? == name.as_bytes();
            found.then(|| i32::try_from(process).ok()).flatten()
        })
    })
    .unwrap_or_else(|| panic!("node {name} does not run"))
}

/// Sends `signal` to a process of the session.
pub fn signal(process: i32, signal: libc::c_int) {
    // SAFETY: kill takes no pointers; the process was found by the session's mark.
    assert_eq!(unsafe { libc::kill(process, signal) }, 0);
}

/// Runs `ferntast` with these arguments to its end.
pub fn run(session: &Session, arguments: &[&str]) -> ferntast_tests::Ended {
    Process::spawn(session.ferntast(arguments)).wait(PATIENCE)
}

/// Gives a state command to the session.
pub fn state(session: &Session, device: &str, word: &str) -> ferntast_tests::Ended {
    run(
        session,
        &["state", device, word, "--session", session.name(), "--json"],
    )
}

/// The state that the arm of the session is in.
pub fn state_of_follower(session: &Session) -> String {
    let arguments = ["state", "follower", "--session", session.name(), "--json"];
    let told = run(session, &arguments).success().json();
    told["state"].as_str().unwrap_or("").to_owned()
}

/// Path of a recorded hand, such as `hand_2.csv`.
pub fn hand(name: &str) -> String {
    let path = ferntast_tests::data().join("hand").join(name);
    path.to_str().expect("a path in UTF-8").to_owned()
}

/// Sets a ROS 2 parameter (node, name, value) of the session as `ros2 param set` does.
pub fn set_parameter(session: &Session, [node, name, value]: [&str; 3]) -> serde_json::Value {
    let arguments = ["--node", node, "--name", name, "--value", value];
    Process::spawn(session.peer("set_parameter.py", &arguments))
        .wait(PATIENCE)
        .success()
        .json()
}

/// Runs `ferntast` with these arguments; it has to refuse its input: exit
/// code 2, nothing on stdout, one line on stderr with all of these words.
pub fn refused(session: &Session, arguments: &[&str], words: &[&str]) {
    let ended = run(session, arguments);
    assert_eq!(ended.status.code(), Some(2), "{ended:#?}");
    assert_eq!(ended.stdout, "", "{ended:#?}");
    for word in words {
        assert!(ended.stderr.contains(word), "no {word:?} in {ended:#?}");
    }
    let panicked = ended.stderr.contains("panicked");
    assert!(!panicked && ended.stderr.lines().count() <= 6, "{ended:#?}");
}

/// The number at `path`, as in `servo.rate_hz`, of a JSON object.
pub fn number(json: &serde_json::Value, path: &str) -> f64 {
    path.split('.')
        .fold(json, |value, key| &value[key])
        .as_f64()
        .unwrap_or_else(|| panic!("no number {path} in {json:#}"))
}

/// Runs a test whose bounds hold only while the machine lets the session run:
/// what else it does may stop every process for tens of milliseconds. It
/// passes if one of three attempts does; a failure that is the program's own
/// fails them all.
pub fn attempts(test: impl Fn()) {
    for attempt in 1..3 {
        match panic::catch_unwind(AssertUnwindSafe(&test)) {
            Ok(()) => return,
            Err(_) => eprintln!("attempt {attempt} of 3 failed; once more"),
        }
    }
    test();
}

//! A session in real time, and how it is told what to do.

use std::{
    fs,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use serde_json::Value;

use crate::{Ended, PATIENCE, Process, Session, data, run, wait_for, wait_until};

/// `ferntast session` in its own session, recording into `run`, with these arguments. Nobody
/// arms its arm again but the test.
pub fn start(session: &Session, arguments: &[&str]) -> Process {
    let mut command =
        session.ferntast_here(&["session", "--json", "--record", "run", "--no-rearm"]);
    command.args(arguments);
    Process::spawn(command)
}

/// Where [`start`] records.
pub fn recording(session: &Session) -> PathBuf {
    session.folder().join("run")
}

/// Waits until every node runs and the arm is enabled, by a word of ours where the
/// machine stalled while the session armed it.
///
/// # Panics
///
/// It does not get there.
pub fn await_armed(session: &Session, process: &mut Process) {
    process.await_stderr("nodes alive", PATIENCE);
    rearmed(session);
}

/// Waits until the arm is armed: until something is recorded while it moves.
///
/// # Panics
///
/// It is not.
pub fn await_enabled(session: &Session, process: &mut Process) {
    await_armed(session, process);
    assert!(recording(session).is_dir());
}

/// Process id of the node `name` of the session.
///
/// # Panics
///
/// It does not run.
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
///
/// # Panics
///
/// It is gone.
pub fn signal(process: i32, signal: libc::c_int) {
    // SAFETY: kill takes no pointers; the process was found by the session's mark.
    assert_eq!(unsafe { libc::kill(process, signal) }, 0);
}

/// Gives a state command to the session.
pub fn state(session: &Session, device: &str, word: &str) -> Ended {
    run(
        session,
        &["state", device, word, "--session", session.name(), "--json"],
    )
}

/// The state that the arm of the session is in.
///
/// # Panics
///
/// It is not told.
pub fn state_of_follower(session: &Session) -> String {
    let arguments = ["state", "follower", "--session", session.name(), "--json"];
    let told = run(session, &arguments).success().json();
    told["state"].as_str().unwrap_or("").to_owned()
}

/// Takes the arm one step nearer to `ENABLED`, out of a hold or a fault that a
/// machine that stalls may cause; gives the state that it was in.
pub fn rearm(session: &Session) -> String {
    let told = state_of_follower(session);
    let word = match told.as_str() {
        "PAUSED" => "resume",
        "FAULT" => "disable",
        "DISABLED" => "enable",
        _ => return told,
    };
    // What is refused now is tried again with the next look at the state.
    state(session, "follower", word);
    told
}

/// Brings the arm to `ENABLED`.
///
/// # Panics
///
/// It does not get there.
pub fn rearmed(session: &Session) {
    assert!(
        wait_until(PATIENCE, || rearm(session) == "ENABLED"),
        "the arm cannot be enabled"
    );
}

/// Keeps the arm enabled as long as `condition` holds.
///
/// On a busy machine a peer may itself be silent for 25 ms, or the arm for
/// 20 ms. That is a hold, or a fault, as it should be, and is left again.
pub fn keep_enabled(session: &Session, mut condition: impl FnMut() -> bool) {
    while condition() {
        thread::sleep(Duration::from_millis(500));
        rearm(session);
    }
}

/// Path of the file in which [`operated`] tells the arm's state: `--arm-state` of an operator,
/// who waits while it stands.
pub fn arm_state(session: &Session) -> String {
    text(&session.folder().join("arm_state"))
}

/// Keeps the arm enabled until `operator` ends, who is told its state; gives how that ended.
///
/// # Panics
///
/// The state cannot be written.
pub fn operated(session: &Session, mut operator: Process) -> Ended {
    let path = arm_state(session);
    let new = format!("{path}.new");
    while operator.is_running() {
        // Whole or not at all.
        fs::write(&new, rearm(session)).expect("the session's folder");
        fs::rename(&new, &path).expect("the session's folder");
        thread::sleep(Duration::from_millis(300));
    }
    operator.wait(PATIENCE)
}

/// Path of a recorded human hand, such as `hand_2.csv`: an outside recording.
///
/// # Panics
///
/// It is not there.
pub fn human_hand(name: &str) -> String {
    text(&data().join("hand").join(name))
}

/// Writes the motion of a hand, times \[s\] and positions \[m\] between which
/// peers interpolate; gives the file's path.
///
/// # Panics
///
/// It cannot be written.
pub fn hand_through(session: &Session, name: &str, points: &[(f64, f64, f64)]) -> String {
    let rows = points.iter().map(|(t, x, y)| format!("{t},{x},{y}\n"));
    let path = session.folder().join(name);
    fs::write(&path, format!("t_s,x_m,y_m\n{}", rows.collect::<String>()))
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text(&path)
}

/// A hand that presses and slides on both bare edges, 15 s long: the contour
/// lies 30 mm away from the middle.
pub fn hand_of_strokes(session: &Session) -> String {
    let points = [
        (0.0, 0.0, 0.0),
        (1.5, 0.0, -0.027),
        (2.5, 0.0, -0.034),
        (4.5, -0.020, -0.034),
        (6.5, 0.010, -0.034),
        (8.0, 0.0, 0.0),
        (9.5, 0.027, 0.0),
        (10.5, 0.034, 0.0),
        (12.5, 0.034, 0.020),
        (14.0, 0.0, 0.020),
        (15.0, 0.0, 0.0),
    ];
    hand_through(session, "strokes.csv", &points)
}

/// Sets a ROS 2 parameter (node, name, value) of the session as `ros2 param set` does.
///
/// # Panics
///
/// It is not answered.
pub fn set_parameter(session: &Session, [node, name, value]: [&str; 3]) -> Value {
    let arguments = ["--node", node, "--name", name, "--value", value];
    Process::spawn(session.peer("set_parameter.py", &arguments))
        .wait(PATIENCE)
        .success()
        .json()
}

fn text(path: &Path) -> String {
    let text = path.to_str().map(str::to_owned);
    text.unwrap_or_else(|| panic!("{} is not UTF-8", path.display()))
}

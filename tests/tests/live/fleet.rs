//! Twins of several sessions, heard by `ferntast fleet watch` over Zenoh.

use std::fs;

use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, experiment_on_joint_2, free_tcp_port, keep_enabled,
    number, run,
};
use serde_json::Value;

const ROBOTS: [&str; 2] = ["left", "right"];

/// A session of that robot, with a twin, whose router connects to the one at `fleet`.
fn robot(session: &Session, name: &str, fleet: &str, domain: u32) -> Process {
    let domain = domain.to_string();
    let config = format!(
        "{{ mode: \"router\", listen: {{ endpoints: [\"{}\"] }}, connect: {{ endpoints: [\"{fleet}\"] }} }}",
        session.router_endpoint()
    );
    let file = session.folder().join("router.json5");
    fs::write(&file, config).expect("scratch folder");
    let file = file.to_str().expect("UTF-8");
    let arguments = [
        "session",
        "--json",
        "--no-rearm",
        "--record",
        "run",
        "--middleware",
        "zenoh",
        "--domain",
        &domain,
    ];
    let mut command = session.ferntast(&arguments);
    command.args([
        "--namespace",
        name,
        "--twin",
        "joint.toml",
        "--router-config",
        file,
    ]);
    command.args([
        "--session",
        session.name(),
        "--link-endpoint",
        &session.link_endpoint(),
    ]);
    Process::spawn(command)
}

/// It is the router that the robots' own connect to; what it heard is in the journal when
/// Ctrl-C ends it.
#[test]
fn sessions_in_namespaces_are_heard_over_one_router() {
    // Two robots and who watches are as much as two processors carry.
    let watching = Session::alone();
    let listen = format!("tcp/127.0.0.1:{}", free_tcp_port());
    let domain = watching.domain().to_string();
    let arguments = [
        "fleet",
        "watch",
        "--listen",
        &listen,
        "--domain",
        &domain,
        "--journal",
        "fleet.jsonl",
        "--json",
    ];
    let mut watch = Process::spawn(watching.ferntast(&arguments));
    watch.await_stderr("listening", PATIENCE);

    let sessions: Vec<Session> = ROBOTS.iter().map(|_| Session::new()).collect();
    let mut robots: Vec<Process> = Vec::new();
    for (session, name) in sessions.iter().zip(ROBOTS) {
        experiment_on_joint_2(session);
        robots.push(robot(session, name, &listen, watching.domain()));
    }
    for (session, process) in sessions.iter().zip(&mut robots) {
        await_enabled(session, process);
    }
    // Until each twin's motion told something of its parameters.
    let end = std::time::Instant::now() + std::time::Duration::from_secs(12);
    keep_enabled(&sessions[0], || std::time::Instant::now() < end);
    watch.interrupt();
    let ended = watch.wait(PATIENCE).success();
    for process in &mut robots {
        process.interrupt();
    }
    for process in robots {
        process.wait(PATIENCE).success();
    }

    let events: Vec<Value> = ended
        .stdout
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    for name in ROBOTS {
        let heard = |own: &&Value| {
            own["event"] == "heard" && own["robot"] == name && own["joint"] == "joint_2"
        };
        assert_eq!(
            events.iter().filter(heard).count(),
            1,
            "{name}: {events:#?}"
        );
    }
    let journal = fs::read_to_string(watching.folder().join("fleet.jsonl")).expect("a journal");
    let days: Vec<Value> = journal
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    for name in ROBOTS {
        let day = days
            .iter()
            .find(|own| own["robot"] == name)
            .unwrap_or_else(|| panic!("no {name}: {days:#?}"));
        assert!(number(day, "samples") > 20.0, "{day:#}");
        // One of whose parameters the strokes tell.
        let b_0 = number(day, "parameters.b0.value");
        assert!((10.0..15.0).contains(&b_0), "{day:#}");
        assert!(
            (-40.0..60.0).contains(&number(day, "temperature_degC")),
            "{day:#}"
        );
    }
    // The journal is one that the command reads.
    let told = run(&watching, &["fleet", "watch", "fleet.jsonl", "--json"])
        .success()
        .json();
    assert_eq!(told["robots"], ROBOTS.len(), "{told:#}");
}

/// Without a router there is nothing to hear: said at once, not waited for.
#[test]
fn a_router_that_is_not_there_is_told() {
    let session = Session::new();
    let nobody = format!("tcp/127.0.0.1:{}", free_tcp_port());
    let ended = run(&session, &["fleet", "watch", "--router", &nobody]);
    assert_eq!(ended.status.code(), Some(1), "{ended:#?}");
    assert!(ended.stderr.contains(&nobody), "{ended:#?}");
}

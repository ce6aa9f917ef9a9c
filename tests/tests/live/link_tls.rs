//! Over QUIC, within TLS, a stranger is not let in: with a certificate that nobody knows, or with none,
//! it hears nothing, says nothing, and the arm does not care.

use std::{thread, time::Duration};

use ferntast_bus::frames::LinkTls;
use ferntast_msgs::{
    sample::{Fault, LinkStatusSample},
    topics,
};
use ferntast_seal::PrivateKey;
use ferntast_tests::{
    PATIENCE, Process, Session, Stranger, certificate_of, messages, refused, wait_until,
};

/// How long a stranger tries.
const TRIES: Duration = Duration::from_secs(4);

/// A host that knows the session's, and is not known by it.
fn unknown(secret: &str) -> LinkTls {
    LinkTls {
        seed: PrivateKey::from_random([77; 32]).certificate_seed(),
        known: certificate_of(secret).known,
    }
}

/// What it hears in a while, saying hello all the time.
fn heard(mut stranger: Stranger) -> usize {
    let mut heard = 0;
    for _ in 0..TRIES.as_millis() / 10 {
        stranger.send(&[0x41]);
        thread::sleep(Duration::from_millis(10));
        heard += stranger.heard().len();
    }
    heard
}

#[test]
fn who_has_no_known_certificate_is_not_let_in() {
    let session = Session::new();
    let endpoint = session.quic_endpoint();
    let mut command = session.ferntast(&["session", "--json", "--no-console"]);
    command.args(["--session", session.name(), "--link-endpoint", &endpoint]);
    command.args(["--record", "recording"]);
    command.env("XDG_RUNTIME_DIR", session.folder());
    let process = Process::spawn(command);
    let enabled = || {
        let mut asked = session.ferntast(&["state", "follower", "--json"]);
        asked.args(["--session", session.name()]);
        asked.env("XDG_RUNTIME_DIR", session.folder());
        let told = Process::spawn(asked).wait(PATIENCE);
        told.status.success() && told.stdout.contains("ENABLED")
    };
    assert!(wait_until(PATIENCE, enabled), "the arm is not armed");

    let secret = session.link_secret();
    let stranger = |tls| Stranger::new(session.name(), &endpoint, tls);
    assert_eq!(heard(stranger(Some(unknown(&secret)))), 0);
    let plain = session.link_endpoint().replace("tcp/", "udp/");
    assert_eq!(heard(Stranger::new(session.name(), &plain, None)), 0);
    // So one hears who has stolen a certificate; frames are sealed all the same.
    assert!(heard(stranger(Some(certificate_of(&secret)))) > 100);
    // A machine that stalls pauses the arm too: then it goes on at a word.
    let goes_on = || {
        let going = enabled();
        if !going {
            let mut told = session.ferntast(&["state", "follower", "resume", "--json"]);
            told.args(["--session", session.name()]);
            told.env("XDG_RUNTIME_DIR", session.folder());
            Process::spawn(told).wait(PATIENCE);
        }
        going
    };
    assert!(wait_until(PATIENCE, goes_on), "the arm does not go on");
    process.interrupt();
    process.wait(PATIENCE).success();

    let status = messages(
        &session.folder().join("recording"),
        topics::LINK_FOLLOWER_STATUS,
    );
    let last: LinkStatusSample = status.last().expect("a status").message;
    assert!(last.received > 500, "{last:?}");
    let told = messages(&session.folder().join("recording"), topics::DIAGNOSTICS);
    let told: Vec<_> = told
        .iter()
        .map(|own| &own.message)
        .filter(|own| own.node.as_str() == "link_follower")
        .filter(|own| own.faults.has(Fault::StrangerOnLink))
        .map(|own| own.message.as_str())
        .filter(|words| words.contains("not let in"))
        .collect();
    println!("{:?}", told.first());
    assert!(!told.is_empty(), "nobody told of the strangers");
}

#[test]
fn beyond_this_host_plain_tcp_and_udp_are_refused_in_words() {
    let session = Session::new();
    for (plain, protected) in [
        ("tcp/0.0.0.0:7448", "quic/0.0.0.0:7448"),
        ("udp/10.0.0.2:7448", "quic/10.0.0.2:7448"),
    ] {
        let name = session.name();
        let arguments = ["session", "--session", name, "--link-endpoint", plain];
        refused(&session, &arguments, &[plain, protected]);
        let arguments = ["node", "link_follower", "--session", name];
        let arguments = [&arguments[..], &["--link-endpoint", plain]].concat();
        refused(&session, &arguments, &[plain, protected]);
    }
}

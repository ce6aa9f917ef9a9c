//! A stranger at the link of a running session, who hears what the arm's end says:
//! reflects, damages, forges, asks for keys of its own. Nothing is acted on. (What
//! is played again the tests of `seal` and `ferntast faults` have: no frame of the operator's
//! end passes by a third one here.)

use std::{thread, time::Duration};

use ferntast_msgs::{
    sample::{Fault, LinkStatusSample},
    topics,
};
use ferntast_seal::{PrivateKey, Role, SecureEnd};
use ferntast_tests::{
    PATIENCE, Session, Stranger, await_enabled, messages, now, rearmed, recording, start,
};

/// How often each kind is sent.
const TIMES: usize = 200;

#[test]
fn of_a_stranger_are_told_by_kind_and_the_arm_does_not_care() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    let mut stranger = Stranger::new(session.name(), &session.link_endpoint(), None);
    thread::sleep(Duration::from_secs(2));
    let heard_so_far = stranger.heard();
    let back: Vec<_> = heard_so_far.iter().filter(|own| own.len() == 60).collect();
    assert!(back.len() > 500, "{} frames heard", back.len());

    let arm = PrivateKey::from_random([1; 32]).public();
    let mut forger = SecureEnd::new(
        PrivateKey::from_random([2; 32]),
        Role::Operator { peer: arm },
        session.name(),
        [3; 32],
    );
    for time in 0..TIMES {
        let own = back[time % back.len()];
        let mut damaged = own.clone();
        damaged[10 + time % 50] ^= 1 << (time % 8);
        // The newest number there is, and then some.
        let mut ahead = back[back.len() - 1].clone();
        ahead[2..6].copy_from_slice(&(u32::MAX / 4 + time as u32).to_le_bytes());
        let mut other_key = own.clone();
        other_key[1] ^= 0xff;
        let mut version = own.clone();
        version[0] ^= 0x10;
        for bad in [&own[..40], own, &damaged, &ahead, &other_key, &version] {
            assert!(stranger.send(bad), "an open link");
        }
        // Keys of its own: asks, and answers what it is asked.
        for message in stranger.heard() {
            forger.received(&message, now().nanos());
        }
        if let Some(message) = forger.message(now().nanos()) {
            assert!(stranger.send(message.bytes()), "an open link");
        }
        thread::sleep(Duration::from_millis(10));
    }
    thread::sleep(Duration::from_secs(1));
    // Where the machine was held up meanwhile it may have paused.
    rearmed(&session);
    assert!(forger.established().is_none(), "the arm took a stranger");
    drop(stranger);
    process.interrupt();
    process.wait(PATIENCE).success();

    let recording = recording(&session);
    let last = |topic| -> LinkStatusSample {
        let status = messages(&recording, topic);
        status.last().expect("a status").message
    };
    let refused = last(topics::LINK_FOLLOWER_STATUS);
    let most = 3 * TIMES as u64;
    // Frames are dropped rather than queued, so that some of them do not arrive.
    for (kind, count) in [
        ("length", refused.refused_length),
        ("damaged or forged", refused.refused_checksum),
        ("other key, handshake", refused.refused_session),
        ("version", refused.refused_version),
    ] {
        assert!((1..=most).contains(&count), "{kind}: {refused:?}");
    }
    // Of the peer's own frames none is missing.
    let sent = last(topics::LINK_STATUS).sent;
    assert!(
        (sent - sent / 50..=sent).contains(&refused.received),
        "{} of {sent}",
        refused.received
    );
    let told = messages(&recording, topics::DIAGNOSTICS);
    let told: Vec<_> = told
        .iter()
        .filter(|own| own.message.faults.has(Fault::StrangerOnLink))
        .map(|own| own.message.node)
        .collect();
    assert!(
        told.iter().any(|own| own.as_str() == "link_follower"),
        "{told:?}"
    );
    // The hand of the script stays within 0.05 m of its middle.
    let commands = messages(&recording, topics::FOLLOWER_SERVO_CP);
    assert!(commands.len() > 500);
    for own in commands {
        let [x, y, _] = own.message.position;
        assert!((x - 0.35355).hypot(y) < 0.08, "{:?}", own.message);
    }
}

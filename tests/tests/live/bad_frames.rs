//! A stranger who sends frames to the arm's end of a running link.

use std::{sync::Arc, thread, time::Duration};

use ferntast_bus::frames::{LinkDirection, LinkEndpoint, ZenohLink, ZenohLinkConfig};
use ferntast_control::{
    delay::Packet,
    frame::{self, FRAME_LENGTH, LinkFrame},
    operating::OperatingState,
};
use ferntast_msgs::{Time, topics};
use ferntast_tests::{
    PATIENCE, Session, await_enabled, messages, recording, start, state_of_follower,
};

/// How often each kind is sent.
const TIMES: u64 = 20;

fn now() -> Time {
    let since = std::time::UNIX_EPOCH.elapsed().expect("a clock after 1970");
    Time::from_nanos(i64::try_from(since.as_nanos()).expect("a clock before 2262"))
}

/// The session's identity in frames: FNV-1a of its name, 32 bits folded to 16.
fn identity(name: &str) -> u16 {
    let mut hash = 2_166_136_261_u32;
    for byte in name.bytes() {
        hash = (hash ^ u32::from(byte)).wrapping_mul(16_777_619);
    }
    ((hash >> 16) ^ (hash & 0xffff)) as u16
}

/// Far away, so that it would be seen if it were acted on.
fn frame(session: u16, sent: Time) -> LinkFrame {
    LinkFrame {
        session,
        sequence: 0,
        sent_ns: sent.nanos(),
        echo: None,
        hold: false,
        state: OperatingState::Enabled,
        arming: 0,
        law: 0,
        packet: Packet {
            valid: true,
            position: [0.2, 0.2, 0.0],
            ..Packet::default()
        },
    }
}

fn bytes(frame: &LinkFrame) -> Vec<u8> {
    let mut bytes = [0; FRAME_LENGTH];
    frame::encode(frame, &mut bytes);
    bytes.to_vec()
}

#[test]
fn are_counted_by_kind_and_the_arm_does_not_care() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    let mut stranger = ZenohLink::open(ZenohLinkConfig {
        session: session.name().to_owned(),
        endpoint: LinkEndpoint::Connect(session.link_endpoint()),
        sends: LinkDirection::Forward,
        clock: Arc::new(now),
    })
    .unwrap_or_else(|error| panic!("{error}"));
    thread::sleep(Duration::from_secs(2));
    let own = identity(session.name());
    for _ in 0..TIMES {
        let good = frame(own, now());
        let mut nan = good;
        nan.packet.position[0] = f32::NAN;
        let mut damaged = bytes(&good);
        damaged[25] ^= 1;
        let past = frame(own, now().plus_nanos(-20_000_000_000));
        let future = frame(own, now().plus_nanos(1_000_000_000));
        for bad in [
            bytes(&good)[..40].to_vec(),
            damaged,
            bytes(&frame(own ^ 1, now())),
            bytes(&past),
            bytes(&future),
            bytes(&nan),
            vec![0x55; FRAME_LENGTH],
        ] {
            stranger
                .sender
                .send(now(), &bad)
                .unwrap_or_else(|error| panic!("{error}"));
            thread::sleep(Duration::from_millis(3));
        }
    }
    thread::sleep(Duration::from_secs(1));
    assert_eq!(state_of_follower(&session), "ENABLED");
    drop(stranger);
    process.interrupt();
    process.wait(PATIENCE).success();

    let status = messages(&recording(&session), topics::LINK_FOLLOWER_STATUS);
    let refused = status.last().expect("a status").message;
    // Frames are dropped rather than queued, so that some of them do not arrive.
    for (kind, count, sent) in [
        ("length", refused.refused_length, TIMES),
        ("checksum", refused.refused_checksum, 2 * TIMES),
        ("session", refused.refused_session, TIMES),
        ("time", refused.refused_time, 2 * TIMES),
        ("value", refused.refused_value, TIMES),
    ] {
        assert!((1..=sent).contains(&count), "{kind}: {refused:?}");
    }
    // The hand of the script stays within 0.05 m of its middle.
    let commands = messages(&recording(&session), topics::FOLLOWER_SERVO_CP);
    assert!(commands.len() > 500);
    for own in commands {
        let [x, y, _] = own.message.position;
        assert!((x - 0.35355).hypot(y) < 0.08, "{:?}", own.message);
    }
}

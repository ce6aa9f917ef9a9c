//! The link's frames between two ends.

use std::{sync::Arc, thread, time::Duration};

use ferntast_bus::{
    OpenError,
    frames::{LinkDirection, LinkEndpoint, MAX_FRAME, ZenohLink, ZenohLinkConfig},
};
use ferntast_msgs::Time;
use zenoh::Wait;

use crate::world::{Way, World};

/// The link's frames, over a session of their own.
#[test]
fn frames_cross_a_link_and_bad_ones_keep_their_length() {
    let world = World::new(Way::Memory);
    let endpoint = world.endpoint.clone();
    let open = |endpoint: LinkEndpoint, sends| {
        ZenohLink::open(ZenohLinkConfig {
            session: world.name.clone(),
            endpoint,
            sends,
            tls: None,
            clock: Arc::new(|| Time::from_nanos(42)),
        })
    };
    // The connecting end comes first, and waits for the other.
    let mut leader = open(
        LinkEndpoint::Connect(endpoint.clone()),
        LinkDirection::Forward,
    )
    .unwrap();
    leader.sender.send(world.now(), b"nobody hears").unwrap();
    for life in 0..2_u8 {
        let mut follower =
            open(LinkEndpoint::Listen(endpoint.clone()), LinkDirection::Back).unwrap();
        let mut buffer = [0; MAX_FRAME];
        let mut heard = None;
        for _ in 0..10_000 {
            leader.sender.send(world.now(), &[life; 64]).unwrap();
            heard = follower.receiver.receive(world.now(), &mut buffer);
            if heard.is_some() {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(heard, Some((64, Time::from_nanos(42))), "life {life}");
        assert_eq!(buffer[..64], [life; 64]);

        follower.sender.send(world.now(), b"back").unwrap();
        let mut heard = None;
        for _ in 0..5_000 {
            heard = leader.receiver.receive(world.now(), &mut buffer);
            if heard.is_some() {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(heard.map(|(length, _)| length), Some(4), "life {life}");
        assert_eq!(&buffer[..4], b"back");

        let taken = open(LinkEndpoint::Listen(endpoint.clone()), LinkDirection::Back);
        assert!(
            matches!(taken, Err(OpenError::PortTaken { .. })),
            "{taken:?}"
        );
    }
}

/// Whatever a stranger puts on the link's key comes out bounded, with a
/// length that is no frame's.
#[test]
fn oversized_payloads_are_cut() {
    let world = World::new(Way::Memory);
    let mut end = ZenohLink::open(ZenohLinkConfig {
        session: world.name.clone(),
        endpoint: LinkEndpoint::Listen(world.endpoint.clone()),
        sends: LinkDirection::Back,
        tls: None,
        clock: Arc::new(|| Time::from_nanos(1)),
    })
    .unwrap();
    let stranger = world.stranger();
    let key = format!("ferntast/{}/link/forward", world.name);
    let mut lengths = Vec::new();
    for length in [MAX_FRAME + 1, 1_000_000, 0, MAX_FRAME, 5] {
        // Blocking: behind a large one the next is else dropped where the machine is busy.
        let put = stranger.put(&key, vec![0xff; length]);
        let put = put.congestion_control(zenoh::qos::CongestionControl::Block);
        put.wait().unwrap();
    }
    let mut buffer = [0; MAX_FRAME];
    for _ in 0..5_000 {
        while let Some((length, _)) = end.receiver.receive(world.now(), &mut buffer) {
            lengths.push(length);
        }
        if lengths.len() == 5 {
            break;
        }
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(lengths, [MAX_FRAME, MAX_FRAME, 0, MAX_FRAME, 5]);
}

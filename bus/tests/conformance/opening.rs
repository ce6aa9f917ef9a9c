//! Buses that cannot be opened say why, and how to correct it.

use std::net::TcpListener;

use ferntast_bus::{
    CreateError, DdsBus, DdsConfig, Depth, OpenError, SharedMemoryBus, SharedMemoryConfig,
    ZenohBus, ZenohConfig, ZenohMode,
};
use ferntast_msgs::{sample::JointSample, topics::Delivery};

use crate::world::{Way, World, free_port};

fn zenoh(mode: ZenohMode, domain_id: u32, node_name: &str) -> Result<ZenohBus, OpenError> {
    ZenohBus::open(&ZenohConfig {
        mode,
        domain_id,
        node_name: node_name.into(),
        namespace: "/".to_owned(),
    })
}

#[test]
fn a_port_that_is_taken_is_named() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let listen = format!("tcp/{}", listener.local_addr().unwrap());
    let error = zenoh(
        ZenohMode::Router {
            listen: listen.clone(),
        },
        0,
        "node",
    )
    .unwrap_err();
    assert!(
        matches!(&error, OpenError::PortTaken { endpoint, .. } if *endpoint == listen),
        "{error:?}"
    );
    assert!(error.to_string().contains("ss -ltnp"), "{error}");
}

#[test]
fn a_router_that_does_not_answer_is_named() {
    let endpoint = format!("tcp/127.0.0.1:{}", free_port());
    let error = zenoh(ZenohMode::Connect { endpoint }, 0, "node").unwrap_err();
    assert!(matches!(error, OpenError::Unreachable { .. }), "{error:?}");
}

#[test]
fn endpoints_and_names_are_checked() {
    let listen = "udp/127.0.0.1:7447".to_owned();
    let error = zenoh(ZenohMode::Router { listen }, 0, "node").unwrap_err();
    assert!(matches!(error, OpenError::BadEndpoint { .. }), "{error:?}");

    let endpoint = "tcp/127.0.0.1:7447".to_owned();
    for name in ["", "two words", "1st", "a/b", "ü"] {
        let mode = ZenohMode::Connect {
            endpoint: endpoint.clone(),
        };
        let error = zenoh(mode, 0, name).unwrap_err();
        assert!(
            matches!(error, OpenError::BadName { .. }),
            "{name}: {error:?}"
        );
        let error = DdsBus::open(&DdsConfig {
            domain_id: 0,
            node_name: name.into(),
            namespace: "/".into(),
        })
        .unwrap_err();
        assert!(
            matches!(error, OpenError::BadName { .. }),
            "{name}: {error:?}"
        );
    }
    for session in ["", "a.b", "a/b", &"x".repeat(49)] {
        let config = SharedMemoryConfig {
            session: session.into(),
        };
        let error = SharedMemoryBus::open(&config).unwrap_err();
        assert!(
            matches!(error, OpenError::BadName { .. }),
            "{session}: {error:?}"
        );
    }
}

#[test]
fn a_domain_out_of_range_is_refused() {
    let mode = ZenohMode::Connect {
        endpoint: "tcp/127.0.0.1:7447".into(),
    };
    let error = zenoh(mode, 233, "node").unwrap_err();
    assert_eq!(error, OpenError::DomainOutOfRange { domain_id: 233 });
    let error = DdsBus::open(&DdsConfig {
        domain_id: 233,
        node_name: "node".into(),
        namespace: "/".into(),
    })
    .unwrap_err();
    assert_eq!(error, OpenError::DomainOutOfRange { domain_id: 233 });
}

#[test]
fn a_queue_too_short_or_too_long_is_refused() {
    for way in [Way::Memory, Way::SharedMemory, Way::Dds, Way::Zenoh] {
        let world = World::new(way);
        let topic = world.topic::<JointSample>("events", Delivery::Event);
        for depth in [0, 1 << 21] {
            let error = world.participant().subscriber(topic, Depth::Queue(depth));
            assert!(
                matches!(error, Err(CreateError::BadDepth { .. })),
                "{way:?} {error:?}"
            );
        }
    }
}

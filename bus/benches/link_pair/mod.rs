//! Both ends of a link, which know each other's certificate.

use std::{process, sync::Arc};

use ferntast_bus::frames::{LinkDirection, LinkEndpoint, LinkTls, ZenohLink, ZenohLinkConfig};
use ferntast_msgs::Time;

/// The seed of both ends' certificates, and its Ed25519 key.
const SEED: [u8; 32] = [7; 32];
const KEY_OF_SEED: [u8; 32] = [
    0xea, 0x4a, 0x6c, 0x63, 0xe2, 0x9c, 0x52, 0x0a, 0xbe, 0xf5, 0x50, 0x7b, 0x13, 0x2e, 0xc5, 0xf9,
    0x95, 0x47, 0x76, 0xae, 0xbe, 0xbe, 0x7b, 0x92, 0x42, 0x1e, 0xea, 0x69, 0x14, 0x46, 0xd2, 0x2c,
];

/// The end that listens at `listen`, and the one that connects to `connect`, which is there
/// or leads there; both go by `clock`.
pub fn open(
    listen: String,
    connect: String,
    clock: impl Fn() -> Time + Copy + Send + Sync + 'static,
) -> Result<[ZenohLink; 2], String> {
    let end = |endpoint, sends| {
        ZenohLink::open(ZenohLinkConfig {
            session: format!("bench_{}", process::id()),
            endpoint,
            sends,
            tls: Some(LinkTls {
                seed: SEED,
                known: vec![KEY_OF_SEED],
            }),
            clock: Arc::new(clock),
        })
        .map_err(|error| error.to_string())
    };
    Ok([
        end(LinkEndpoint::Listen(listen), LinkDirection::Back)?,
        end(LinkEndpoint::Connect(connect), LinkDirection::Forward)?,
    ])
}

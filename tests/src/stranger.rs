//! Somebody on a session's link whom nobody asked for.

use std::sync::Arc;

use ferntast_bus::frames::{
    LinkDirection, LinkEndpoint, LinkTls, MAX_FRAME, ZenohLink, ZenohLinkConfig,
};
use ferntast_seal::PrivateKey;

use crate::now;

/// The certificate of the host of that private key, which knows itself and nobody else.
///
/// # Panics
///
/// It is no key.
pub fn certificate_of(secret: &str) -> LinkTls {
    let own = PrivateKey::from_text(secret).unwrap_or_else(|error| panic!("{error}"));
    LinkTls {
        seed: own.certificate_seed(),
        known: vec![own.public().certificate()],
    }
}

/// Sends to the arm's end, and hears what that says.
#[derive(Debug)]
pub struct Stranger(ZenohLink);

impl Stranger {
    /// On the link of `session` at `endpoint`, with that certificate.
    ///
    /// # Panics
    ///
    /// The link cannot be opened.
    pub fn new(session: &str, endpoint: &str, tls: Option<LinkTls>) -> Stranger {
        let config = ZenohLinkConfig {
            session: session.to_owned(),
            endpoint: LinkEndpoint::Connect(endpoint.to_owned()),
            sends: LinkDirection::Forward,
            tls,
            clock: Arc::new(now),
        };
        Stranger(ZenohLink::open(config).unwrap_or_else(|error| panic!("{error}")))
    }

    /// Sends `bytes`; whether they went out.
    pub fn send(&mut self, bytes: &[u8]) -> bool {
        self.0.sender.send(now(), bytes).is_ok()
    }

    /// All that arrived since it was last asked.
    pub fn heard(&mut self) -> Vec<Vec<u8>> {
        let mut buffer = [0; MAX_FRAME];
        std::iter::from_fn(|| {
            let (length, _) = self.0.receiver.receive(now(), &mut buffer)?;
            Some(buffer[..length].to_vec())
        })
        .collect()
    }
}

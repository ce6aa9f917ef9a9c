//! Keys of the link, and what stands in for the system's randomness.

use ferntast_bus::frames::LinkDirection;
use ferntast_nodes::process::{SessionContext, link_end::seeded_end};
use ferntast_seal::SecureEnd;

/// The key of both ends of a session, and what they draw.
pub struct Keys {
    session: String,
    seed: u64,
    /// Which host's.
    host: u8,
    /// Ends that were started.
    drawn: u8,
}

impl Keys {
    /// Those of `host` in a world of that seed.
    pub fn new(session: &SessionContext, seed: u64, host: u8) -> Keys {
        Keys {
            session: session.session.clone(),
            seed,
            host,
            drawn: 0,
        }
    }

    /// An end that is started now: no two draw the same.
    pub fn end(&mut self, sends: LinkDirection) -> SecureEnd {
        // Zero is the key's own.
        self.drawn = self.drawn % u8::MAX + 1;
        seeded_end(&self.session, self.seed, self.host, self.drawn, sends)
    }
}

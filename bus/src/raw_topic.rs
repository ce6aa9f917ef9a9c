//! A topic of whatever type, as others recorded it.

use crate::error::CreateError;

/// A topic of any type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawTopic {
    /// Full name, outside of any namespace.
    pub name: String,
    /// Its type, `package/msg/Type`.
    pub interface: String,
    /// RIHS01 hash of the type; empty where it is not known. Zenoh needs it.
    pub type_hash: String,
    /// Whether lost messages are sent again.
    pub reliable: bool,
    /// Whether late joiners get the last ones.
    pub transient_local: bool,
    /// How many messages wait, or are kept for late joiners; at least 1.
    pub depth: usize,
}

impl RawTopic {
    /// Package and type.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`]: the interface is no message's.
    pub(crate) fn kind(&self, transport: &'static str) -> Result<(&str, &str), CreateError> {
        let kind = self.interface.split_once("/msg/");
        kind.ok_or_else(|| {
            self.refused(
                transport,
                format!("{:?} is no package/msg/Type", self.interface),
            )
        })
    }

    pub(crate) fn refused(&self, transport: &'static str, reason: String) -> CreateError {
        CreateError::Middleware {
            transport,
            topic: self.name.clone(),
            what: "publisher",
            reason,
        }
    }
}

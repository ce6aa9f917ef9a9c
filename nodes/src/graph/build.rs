//! What a node is made from.

use ferntast_bus::{Bus, frames::LinkDirection};

use crate::{
    link::LinkWire,
    node::{HealthMeter, Ports, Runner, Ticking},
    process::{NodeError, SessionContext},
};

/// Opens the end of the link that sends in a direction: over Zenoh in a
/// session, in memory in virtual time.
pub type OpenLink<'a> = dyn FnMut(LinkDirection) -> Result<LinkWire, NodeError> + 'a;

/// What a node is made from.
pub struct Build<'a> {
    /// What the session is made of.
    pub session: &'a SessionContext,
    /// The bus that its ports meet.
    pub bus: &'a Bus,
    /// Whether time is virtual: it waits for whatever takes long, so that the
    /// result is there at a known time.
    pub virtual_time: bool,
    /// The link.
    pub open_link: &'a mut OpenLink<'a>,
    /// Measures the node's loop.
    pub meter: HealthMeter,
}

impl Build<'_> {
    /// Joins a node and its ports.
    ///
    /// # Errors
    ///
    /// `/diagnostics` cannot be opened.
    pub fn join<P: Ports + 'static>(
        self,
        node: P::Node,
        ports: P,
    ) -> Result<Box<dyn Ticking>, NodeError> {
        Ok(Box::new(Runner::new(self.bus, node, ports, self.meter)?))
    }
}

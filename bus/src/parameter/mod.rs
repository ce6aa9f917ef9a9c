//! A parameter on ROS 2 that is one choice among several, for `ros2 param`.
//!
//! It belongs to a node of its own beside the bus's, so that its name is short
//! (`ros2 param set /link law wave`). Whoever opens it hears what others wish,
//! and reports the result.

mod dds;
mod zenoh;

use std::fmt;

use crate::{Bus, DdsBus, error::OpenError};

/// A parameter and the node that it belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Name of the node, in the root namespace.
    pub node: String,
    /// Name of the parameter.
    pub name: String,
    /// What it is, for `ros2 param describe`.
    pub description: String,
    /// What may be chosen.
    pub choices: Vec<String>,
    /// What is chosen at first.
    pub value: String,
    /// Why peers may look and not choose, where that is so.
    pub closed: Option<String>,
}

impl Choice {
    /// What may be chosen, in words.
    fn constraint(&self) -> String {
        format!("one of: {}", self.choices.join(", "))
    }

    /// Whether peers may choose.
    fn check_open(&self) -> Result<(), String> {
        self.closed.clone().map_or(Ok(()), Err)
    }

    /// Whether `value` may be chosen.
    fn check(&self, value: Option<&str>) -> Result<(), String> {
        match value.is_some_and(|own| self.choices.iter().any(|is| is == own)) {
            true => Ok(()),
            false => Err(format!("{} may be {}", self.name, self.constraint())),
        }
    }
}

/// The parameter, as long as it lives.
#[derive(Debug)]
pub struct ParameterNode {
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Dds(Box<dds::DdsParameter>),
    Zenoh(Box<zenoh::ZenohParameter>),
}

impl ParameterNode {
    /// Offers `choice` on the ROS 2 that `bus` is on; `None` on a bus that is not ROS 2. Over DDS
    /// peers are answered when [`ParameterNode::wish`] is called. Reported to by
    /// [`ParameterNode::tell`] from this thread.
    ///
    /// # Errors
    ///
    /// [`OpenError::BadName`], [`OpenError::Middleware`].
    pub fn open(bus: &Bus, choice: &Choice) -> Result<Option<ParameterNode>, OpenError> {
        let kind = match bus {
            Bus::Dds(bus) => Kind::Dds(Box::new(dds::open(bus, choice)?)),
            Bus::Zenoh(bus) => Kind::Zenoh(Box::new(zenoh::open(bus, choice)?)),
            Bus::Memory(_) | Bus::SharedMemory(_) | Bus::Mcap(_) | Bus::Foxglove(_) => {
                return Ok(None);
            }
        };
        Ok(Some(ParameterNode { kind }))
    }

    /// The last wish since the last call.
    pub fn wish(&mut self) -> Option<String> {
        match &mut self.kind {
            Kind::Dds(parameter) => parameter.wish(),
            Kind::Zenoh(parameter) => parameter.wish(),
        }
    }

    /// Publishes what is in effect. Gives the library's reason where it refuses.
    ///
    /// # Errors
    ///
    /// As said; the value that others see is then the old one.
    pub fn tell(&mut self, value: &str) -> Result<(), String> {
        match &mut self.kind {
            Kind::Dds(parameter) => parameter.tell(value),
            Kind::Zenoh(parameter) => parameter.tell(value),
        }
    }
}

/// The parameter services of a bus's own node, which has none but those of every node: who lists
/// the parameters of all nodes, as `ros2 param list`, waits for an answer of each.
pub struct BusParameters {
    bus: DdsBus,
    services: dds::ParameterServices,
}

impl BusParameters {
    /// Offers them; `None` where the bus is not ROS 2 over DDS (over Zenoh they answer by themselves).
    ///
    /// # Errors
    ///
    /// [`OpenError::Middleware`].
    pub fn open(bus: &Bus) -> Result<Option<BusParameters>, OpenError> {
        let Bus::Dds(bus) = bus else {
            return Ok(None);
        };
        let services = dds::ParameterServices::open(&mut bus.node(), None)?;
        Ok(Some(BusParameters {
            bus: bus.clone(),
            services,
        }))
    }

    /// Answers who asked since the last call.
    pub fn answer(&self) {
        self.services.answer(&self.bus.node());
    }
}

impl fmt::Debug for BusParameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BusParameters")
            .field("bus", &self.bus)
            .finish_non_exhaustive()
    }
}

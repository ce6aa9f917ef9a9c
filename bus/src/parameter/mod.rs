//! A parameter on ROS 2 that is one choice among several, for `ros2 param`.
//!
//! It belongs to a node of its own beside the bus's, so that its name is short
//! (`ros2 param set /link law wave`). Whoever opens it hears what others wish,
//! and reports the result.

mod dds;
mod zenoh;

use std::{
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::{self, ThreadId},
};

use crate::{Bus, error::OpenError};

/// Wishes that may wait; past that, further ones are refused.
const WAITING: usize = 16;

/// A parameter and the node that it belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Name of the node, in the root namespace.
    pub node: String,
    /// Name of the parameter.
    pub name: String,
    /// What it is, for `ros2 param describe` (over DDS not passed on by the library).
    pub description: String,
    /// What may be chosen.
    pub choices: Vec<String>,
    /// What is chosen at first.
    pub value: String,
}

/// The parameter, as long as it lives.
#[derive(Debug)]
pub struct ParameterNode {
    kind: Kind,
    wishes: Receiver<String>,
}

#[derive(Debug)]
enum Kind {
    Dds(Box<dds::DdsParameter>),
    Zenoh(Box<zenoh::ZenohParameter>),
}

impl ParameterNode {
    /// Offers `choice` on the ROS 2 that `bus` is on; `None` on a bus that is
    /// not ROS 2. Reported to by [`ParameterNode::tell`] from this thread.
    ///
    /// # Errors
    ///
    /// [`OpenError::BadName`], [`OpenError::Middleware`].
    pub fn open(bus: &Bus, choice: Choice) -> Result<Option<ParameterNode>, OpenError> {
        let (wish, wishes) = sync_channel(WAITING);
        let judge = Judge {
            name: choice.name.clone(),
            choices: choice.choices.clone(),
            teller: thread::current().id(),
            wish,
        };
        let kind = match bus {
            Bus::Dds(bus) => Kind::Dds(Box::new(dds::open(bus, &choice, judge)?)),
            Bus::Zenoh(bus) => Kind::Zenoh(Box::new(zenoh::open(bus, &choice, judge)?)),
            Bus::Memory(_) | Bus::SharedMemory(_) | Bus::Mcap(_) | Bus::Foxglove(_) => {
                return Ok(None);
            }
        };
        Ok(Some(ParameterNode { kind, wishes }))
    }

    /// The last wish since the last call.
    pub fn wish(&mut self) -> Option<String> {
        self.wishes.try_iter().last()
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

/// Says whether a new value is taken, and passes it on as a wish.
struct Judge {
    name: String,
    choices: Vec<String>,
    /// What this thread sets is the truth, not a wish.
    teller: ThreadId,
    wish: SyncSender<String>,
}

impl Judge {
    /// Whether `value` may be chosen for parameter `name`; other parameters are
    /// the library's own.
    fn check(&self, name: &str, value: Option<&str>) -> Result<(), String> {
        if name != self.name || value.is_some_and(|own| self.choices.iter().any(|is| is == own)) {
            return Ok(());
        }
        Err(format!(
            "{} may be one of: {}",
            self.name,
            self.choices.join(", ")
        ))
    }

    /// Takes what [`Judge::check`] found good.
    fn take(&self, name: &str, value: Option<&str>) -> Result<(), String> {
        let Some(value) = value.filter(|_| name == self.name) else {
            return Ok(());
        };
        if thread::current().id() == self.teller {
            return Ok(());
        }
        self.wish
            .try_send(value.to_owned())
            .map_err(|_| "busy with earlier wishes; try again".to_owned())
    }
}

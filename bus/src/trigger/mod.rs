//! Services of type `std_srvs/srv/Trigger`, as buttons and scripts of other people call them: a
//! call without content, answered by whether it was done and a text.
//!
//! The service belongs to the bus's own node. Calls wait until they are asked for; nothing is
//! done in a thread of its own.

mod dds;
mod zenoh;

use crate::{Bus, error::OpenError};

/// A service, as long as it lives.
#[derive(Debug)]
pub struct TriggerService {
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Dds(Box<dds::DdsTrigger>),
    Zenoh(Box<zenoh::ZenohTrigger>),
}

/// Somebody who called, and waits for the answer.
#[derive(Debug)]
pub struct Call {
    kind: CallKind,
}

#[derive(Debug)]
enum CallKind {
    Dds(dds::DdsCall),
    Zenoh(Box<zenoh::ZenohCall>),
}

impl TriggerService {
    /// Offers the service `name`, as `/follower/pause`, on the ROS 2 that `bus` is on; `None` on a
    /// bus that is not ROS 2.
    ///
    /// # Errors
    ///
    /// [`OpenError::BadName`], [`OpenError::Middleware`].
    pub fn open(bus: &Bus, name: &str) -> Result<Option<TriggerService>, OpenError> {
        let kind = match bus {
            Bus::Dds(bus) => Kind::Dds(Box::new(dds::DdsTrigger::open(bus, name)?)),
            Bus::Zenoh(bus) => Kind::Zenoh(Box::new(zenoh::ZenohTrigger::open(bus, name)?)),
            Bus::Memory(_) | Bus::SharedMemory(_) | Bus::Mcap(_) | Bus::Foxglove(_) => {
                return Ok(None);
            }
        };
        Ok(Some(TriggerService { kind }))
    }

    /// The next call that waits. What cannot be read is no call: whoever made it is not answered.
    pub fn call(&mut self) -> Option<Call> {
        let kind = match &mut self.kind {
            Kind::Dds(service) => CallKind::Dds(service.call()?),
            Kind::Zenoh(service) => CallKind::Zenoh(Box::new(service.call()?)),
        };
        Some(Call { kind })
    }

    /// Answers `call`, which this service gave. An answer that cannot be sent is lost, as on a
    /// network: the caller stops waiting by itself.
    pub fn answer(&self, call: Call, success: bool, message: &str) {
        match (&self.kind, call.kind) {
            (Kind::Dds(service), CallKind::Dds(call)) => service.answer(call, success, message),
            (_, CallKind::Zenoh(call)) => call.answer(success, message),
            // Another service's.
            (Kind::Zenoh(_), CallKind::Dds(_)) => {}
        }
    }
}

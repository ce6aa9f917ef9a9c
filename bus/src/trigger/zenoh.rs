//! The service over Zenoh.

use std::fmt;

use hiroz::{
    Builder,
    entity::{TypeHash, TypeInfo},
    msg::{SerdeCdrSerdes, ZMessage, ZService},
    service::{ServiceRequest, ZServer},
};
use serde::{Deserialize, Serialize};

use crate::{error::OpenError, namespace::within, zenoh_ros::ZenohBus};

/// The hash of `std_srvs/srv/Trigger`, as its package states it (std_srvs 5.5.1,
/// `share/std_srvs/srv/Trigger.json`).
const TYPE_HASH: &str = "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f";

/// `std_srvs/srv/Trigger_Request`: a message without fields has one byte on the wire.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Request {
    structure_needs_at_least_one_member: u8,
}

/// `std_srvs/srv/Trigger_Response`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Response {
    success: bool,
    message: String,
}

/// The service's type.
pub(super) struct Trigger;

impl ZMessage for Request {
    type Serdes = SerdeCdrSerdes<Request>;
}

impl ZMessage for Response {
    type Serdes = SerdeCdrSerdes<Response>;
}

impl ZService for Trigger {
    type Request = Request;
    type Response = Response;
}

pub(super) struct ZenohTrigger {
    name: String,
    server: ZServer<Trigger>,
}

pub(super) struct ZenohCall(ServiceRequest<Trigger>);

impl ZenohTrigger {
    pub(super) fn open(bus: &ZenohBus, name: &str) -> Result<ZenohTrigger, OpenError> {
        let name = within(bus.namespace(), name);
        let middleware = |reason: String| OpenError::Middleware {
            transport: "Zenoh",
            reason: format!("service {name}: {reason}"),
        };
        let hash = TypeHash::from_rihs_string(TYPE_HASH)
            .ok_or_else(|| middleware(format!("{TYPE_HASH} is no RIHS01 type hash")))?;
        let kind = TypeInfo::new("std_srvs::srv::dds_::Trigger_", hash);
        let server = bus
            .node()
            .create_service_impl::<Trigger>(&name, Some(kind))
            .build()
            .map_err(|error| middleware(error.to_string()))?;
        Ok(ZenohTrigger { name, server })
    }

    pub(super) fn call(&mut self) -> Option<ZenohCall> {
        self.server.try_take_request().ok().flatten().map(ZenohCall)
    }
}

impl ZenohCall {
    pub(super) fn answer(self, success: bool, message: &str) {
        let message = message.to_owned();
        let _ = self.0.reply_blocking(&Response { success, message });
    }
}

impl fmt::Debug for ZenohTrigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZenohTrigger")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for ZenohCall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZenohCall").finish_non_exhaustive()
    }
}

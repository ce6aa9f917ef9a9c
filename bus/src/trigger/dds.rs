//! The service over DDS.

use std::fmt;

use ros2_client::{Message, Name, RmwRequestId, Server, ServiceMapping, ServiceTypeName};
use serde::{Deserialize, Serialize};

use crate::{
    dds::{DdsBus, service_qos},
    error::OpenError,
    namespace::within,
};

/// `std_srvs/srv/Trigger_Request`: a message without fields has one byte on the wire.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Request {
    structure_needs_at_least_one_member: u8,
}
impl Message for Request {}

/// `std_srvs/srv/Trigger_Response`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Response {
    success: bool,
    message: String,
}
impl Message for Response {}

pub(super) struct DdsTrigger {
    name: String,
    server: Server<Request, Response>,
}

#[derive(Debug)]
pub(super) struct DdsCall(RmwRequestId);

impl DdsTrigger {
    pub(super) fn open(bus: &DdsBus, name: &str) -> Result<DdsTrigger, OpenError> {
        let mut node = bus.node();
        let name = within(node.namespace(), name);
        let parsed = Name::parse(&name).map_err(|error| OpenError::BadName {
            what: "service",
            name: name.clone(),
            reason: format!("{error:?}"),
        })?;
        let qos = service_qos();
        let server = node.create_server(
            ServiceMapping::Enhanced,
            &parsed,
            &ServiceTypeName::new("std_srvs", "Trigger"),
            qos.clone(),
            qos,
        );
        let server = server.map_err(|error| OpenError::Middleware {
            transport: "DDS",
            reason: format!("service {name}: {error}"),
        })?;
        Ok(DdsTrigger { name, server })
    }

    pub(super) fn call(&mut self) -> Option<DdsCall> {
        let (call, _) = self.server.receive_request().ok().flatten()?;
        Some(DdsCall(call))
    }

    pub(super) fn answer(&self, call: DdsCall, success: bool, message: &str) {
        let message = message.to_owned();
        let _ = self
            .server
            .send_response(call.0, Response { success, message });
    }
}

impl fmt::Debug for DdsTrigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DdsTrigger")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

//! What is checked before a node is started.

use std::{fs, path::Path};

use ferntast_bus::frames::check_endpoint as check_link;

use super::SessionError;
use crate::process::{End, SessionContext};

/// Whether the ports and the recording's folder are free.
///
/// # Errors
///
/// What is taken.
pub fn check(context: &SessionContext) -> Result<(), SessionError> {
    if let Some(bag) = &context.bag
        && bag.exists()
        && !is_empty_folder(bag)
    {
        return Err(SessionError::RecordingExists { path: bag.clone() });
    }
    let scenario = &context.loaded.scenario;
    check_link(&scenario.link.endpoint)?;
    // The arm's end listens.
    if End::Arm.is_at(context.end) {
        check_endpoint(
            "the link's endpoint",
            &scenario.link.endpoint,
            "--link-endpoint",
        )?;
    }
    if let Some(listen) = context.console.as_ref().and_then(|console| console.listen) {
        check_endpoint("the page's address", &format!("tcp/{listen}"), "--listen")?;
    }
    if let Some(listen) = context.foxglove {
        check_endpoint("Foxglove's address", &format!("tcp/{listen}"), "--foxglove")?;
    }
    if let Some(endpoint) = scenario.gateway.own_router() {
        check_endpoint("the Zenoh router's endpoint", endpoint, "--router-endpoint")?;
    }
    Ok(())
}

fn check_endpoint(
    what: &'static str,
    endpoint: &str,
    option: &'static str,
) -> Result<(), SessionError> {
    let bound = match endpoint.split_once('/') {
        Some(("tcp", address)) => std::net::TcpListener::bind(address).map(drop),
        Some(("udp" | "quic", address)) => std::net::UdpSocket::bind(address).map(drop),
        // The node that opens it says what is wrong.
        _ => return Ok(()),
    };
    match bound {
        Ok(()) => Ok(()),
        Err(source) => Err(SessionError::PortTaken {
            what,
            endpoint: endpoint.to_owned(),
            source,
            option,
        }),
    }
}

fn is_empty_folder(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}

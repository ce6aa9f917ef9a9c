//! Opening Zenoh as rmw_zenoh does it.

use std::{
    thread,
    time::{Duration, Instant},
};

use hiroz::{
    Builder,
    config::{RouterConfigBuilder, SessionConfigBuilder},
    context::{ZContext, ZContextBuilder},
    node::ZNode,
};
use zenoh::Wait;

use super::{ZenohConfig, ZenohMode, router};
use crate::{dds::MAX_DOMAIN, endpoint, error::OpenError, zenoh_words::words};

/// How long the router may take to answer.
const ROUTER_WAIT: Duration = Duration::from_secs(3);

pub(super) fn open(config: &ZenohConfig) -> Result<(ZContext, ZNode), OpenError> {
    if config.domain_id > MAX_DOMAIN {
        return Err(OpenError::DomainOutOfRange {
            domain_id: config.domain_id,
        });
    }
    check_name(&config.node_name)?;
    check_namespace(&config.namespace)?;
    let settings = settings(&config.mode)?;
    let endpoint = match &config.mode {
        ZenohMode::Router { listen: endpoint } | ZenohMode::Connect { endpoint } => {
            endpoint.clone()
        }
        ZenohMode::RouterOf { .. } => router::endpoints(&settings).join(", "),
    };
    let context = ZContextBuilder::default()
        .with_zenoh_config(settings)
        .with_domain_id(config.domain_id as usize)
        .disable_multicast_scouting()
        .build()
        .map_err(|error| endpoint::open_error(&endpoint, "Zenoh", &error))?;
    let node = context
        .create_node(&config.node_name)
        .with_namespace(&config.namespace)
        .build()
        .map_err(middleware)?;
    if let ZenohMode::Connect { endpoint } = &config.mode {
        wait_for_router(&node, endpoint)?;
    }
    Ok((context, node))
}

/// Zenoh's settings of a mode.
pub(super) fn settings(mode: &ZenohMode) -> Result<zenoh::Config, OpenError> {
    let settings = match mode {
        ZenohMode::Router { listen } => {
            endpoint::check(listen)?;
            RouterConfigBuilder::new()
                .with_listen_endpoint(listen)
                .build_config()
        }
        ZenohMode::RouterOf { config } => return router::settings(config),
        ZenohMode::Connect { endpoint } => {
            endpoint::check(endpoint)?;
            SessionConfigBuilder::new()
                .with_router_endpoint(endpoint)
                .build_config()
        }
    };
    settings.map_err(middleware)
}

fn middleware(error: zenoh::Error) -> OpenError {
    OpenError::Middleware {
        transport: "Zenoh",
        reason: words(error),
    }
}

/// The session goes on trying for ever by itself; whoever starts a node wants
/// to be told.
fn wait_for_router(node: &ZNode, endpoint: &str) -> Result<(), OpenError> {
    let start = Instant::now();
    while node.session().info().routers_zid().wait().next().is_none() {
        if start.elapsed() > ROUTER_WAIT {
            return Err(OpenError::Unreachable {
                endpoint: endpoint.into(),
                reason: format!("waited for {} s", ROUTER_WAIT.as_secs()),
            });
        }
        thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}

/// Node names as ROS 2 has them.
fn check_name(name: &str) -> Result<(), OpenError> {
    check_word("node", name, name)
}

/// A namespace: `/`, or such names behind slashes.
fn check_namespace(namespace: &str) -> Result<(), OpenError> {
    let names = namespace.strip_prefix('/').unwrap_or_default();
    if namespace == "/" {
        return Ok(());
    }
    let mut names = names.split('/');
    names.try_for_each(|name| check_word("namespace", namespace, name))
}

/// One word of the `name` of `what`.
fn check_word(what: &'static str, name: &str, word: &str) -> Result<(), OpenError> {
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    if word.is_empty()
        || word.starts_with(|c: char| c.is_ascii_digit())
        || !word.bytes().all(allowed)
    {
        return Err(OpenError::BadName {
            what,
            name: name.into(),
            reason: "use letters, digits and _, not beginning with a digit".into(),
        });
    }
    Ok(())
}

//! Zenoh endpoints: `tcp/HOST:PORT`; for the link also `udp/HOST:PORT`.

use crate::error::OpenError;

/// Whether `endpoint` is `tcp/HOST:PORT`.
pub(crate) fn check(endpoint: &str) -> Result<(), OpenError> {
    check_kind(endpoint, &["tcp/"])
}

/// Whether `endpoint` is `tcp/HOST:PORT` or `udp/HOST:PORT`.
pub(crate) fn check_link(endpoint: &str) -> Result<(), OpenError> {
    check_kind(endpoint, &["tcp/", "udp/"])
}

fn check_kind(endpoint: &str, kinds: &[&str]) -> Result<(), OpenError> {
    let bad = |reason: &str| {
        Err(OpenError::BadEndpoint {
            endpoint: endpoint.into(),
            reason: reason.into(),
        })
    };
    let Some(address) = kinds.iter().find_map(|kind| endpoint.strip_prefix(kind)) else {
        return bad(&format!("it does not begin with {}", kinds.join(" or ")));
    };
    let Some((host, port)) = address.rsplit_once(':') else {
        return bad("it has no port");
    };
    if host.is_empty() {
        return bad("it has no host");
    }
    if host.contains(['?', '#', '/', ' ']) {
        return bad("the host holds a character that no host has");
    }
    match port.parse::<u16>() {
        Ok(_) => Ok(()),
        Err(_) => bad("the port is no number from 0 to 65535"),
    }
}

/// What a session that did not open says of its endpoint.
pub(crate) fn open_error(
    endpoint: &str,
    transport: &'static str,
    error: &zenoh::Error,
) -> OpenError {
    let reason = error.to_string();
    // Zenoh's errors are texts; the system's own words stand in them.
    if reason.contains("Address already in use") || reason.contains("os error 98") {
        OpenError::PortTaken {
            endpoint: endpoint.into(),
            reason: "address already in use".into(),
        }
    } else if reason.contains("Can not create a new TCP listener")
        || reason.contains("Cannot assign requested address")
        || reason.contains("failed to lookup address")
    {
        OpenError::BadEndpoint {
            endpoint: endpoint.into(),
            reason,
        }
    } else {
        OpenError::Middleware { transport, reason }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints() {
        for good in ["tcp/127.0.0.1:7447", "tcp/localhost:0", "tcp/[::]:7447"] {
            assert_eq!(check(good), Ok(()), "{good}");
        }
        assert_eq!(check_link("udp/127.0.0.1:7447"), Ok(()));
        assert_eq!(check_link("tcp/127.0.0.1:7447"), Ok(()));
        assert!(check_link("quic/127.0.0.1:7447").is_err());
        for bad in [
            "",
            "127.0.0.1:7447",
            "udp/127.0.0.1:7447",
            "tcp/127.0.0.1",
            "tcp/:7447",
            "tcp/h:65536",
            "tcp/h:-1",
            "tcp/a b:1",
            "tcp/h:1#so_sndbuf=0",
        ] {
            assert!(
                matches!(check(bad), Err(OpenError::BadEndpoint { .. })),
                "{bad}"
            );
        }
    }
}

//! Zenoh endpoints: `tcp/HOST:PORT`; for the link also `udp/…` and `quic/…`.

use std::net::IpAddr;

use crate::{error::OpenError, zenoh_words::words};

/// How the link's ends meet: QUIC, which is TLS 1.3 over UDP, and what is for the loopback.
/// Zenoh's `tls/` is none of them: it reads and writes one TLS stream from two threads at
/// once, which ends the process by a bad access where frames go both ways
/// (eclipse-zenoh/zenoh#2557; seen here with 1.10.2 after some seconds).
const LINK: [&str; 4] = ["quic/", "sealed-udp/", "tcp/", "udp/"];

/// Asks for datagrams without TLS in so many words: long ways that lose frames, where QUIC
/// makes them wait. Frames are sealed all the same.
const SEALED_UDP: &str = "sealed-udp/";

/// Whether `endpoint` is `tcp/HOST:PORT`.
pub(crate) fn check(endpoint: &str) -> Result<(), OpenError> {
    check_kind(endpoint, &["tcp/"])
}

/// Whether `endpoint` is one that the link's ends may meet at: `quic/HOST:PORT`,
/// `sealed-udp/HOST:PORT`, on the loopback also `tcp/…` and `udp/…`.
///
/// # Errors
///
/// [`OpenError::BadEndpoint`], [`OpenError::Unprotected`].
pub fn check_link(endpoint: &str) -> Result<(), OpenError> {
    if let Some(address) = endpoint.strip_prefix("tls/") {
        return Err(OpenError::TlsStream {
            endpoint: endpoint.into(),
            instead: format!("quic/{address}"),
        });
    }
    check_kind(endpoint, &LINK)?;
    let plain = endpoint
        .split_once('/')
        .filter(|_| !endpoint.starts_with("quic/") && !endpoint.starts_with(SEALED_UDP));
    match plain {
        Some((_, address)) if !is_loopback(endpoint) => Err(OpenError::Unprotected {
            endpoint: endpoint.into(),
            instead: format!("quic/{address}"),
        }),
        _ => Ok(()),
    }
}

/// Whether an end can ask for a certificate of the host at `endpoint`.
pub(crate) fn check_server(endpoint: &str) -> Result<(), OpenError> {
    if is_protected(endpoint) && endpoint.contains('[') {
        return Err(OpenError::BadEndpoint {
            endpoint: endpoint.into(),
            reason: "over QUIC an IPv6 address cannot be connected to; give the host a name".into(),
        });
    }
    Ok(())
}

/// Whether the ends show certificates at `endpoint`.
pub(crate) fn is_protected(endpoint: &str) -> bool {
    endpoint.starts_with("tls/") || endpoint.starts_with("quic/")
}

/// Whether `endpoint`, `KIND/HOST:PORT`, stays on this host.
pub fn is_loopback(endpoint: &str) -> bool {
    let host = endpoint
        .split_once('/')
        .and_then(|(_, address)| address.rsplit_once(':'))
        .map(|(host, _)| host.trim_matches(['[', ']']));
    host.is_some_and(|host| {
        host == "localhost" || host.parse::<IpAddr>().is_ok_and(|own| own.is_loopback())
    })
}

/// Where an end connects to whose other end listens at `endpoint`: what listens at all addresses of
/// this host is met on its loopback.
pub(crate) fn to_connect_to(endpoint: &str) -> String {
    ["/0.0.0.0:", "/[::]:"]
        .iter()
        .fold(endpoint.to_owned(), |own, all| {
            own.replace(all, "/localhost:")
        })
}

/// The link's endpoint as Zenoh writes it: datagrams of QUIC, not its streams.
pub(crate) fn of_zenoh(endpoint: &str) -> String {
    match endpoint.strip_prefix(SEALED_UDP) {
        Some(address) => format!("udp/{address}"),
        None if endpoint.starts_with("quic/") => format!("{endpoint}?rel=0"),
        None => endpoint.to_owned(),
    }
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
    let reason = words(error);
    // Zenoh's errors are texts; the system's own words stand in them.
    if reason.contains("Address already in use") || reason.contains("os error 98") {
        OpenError::PortTaken {
            endpoint: endpoint.into(),
            reason: "address already in use".into(),
        }
    } else if ["TCP", "TLS", "QUIC"]
        .iter()
        .any(|kind| reason.contains(&format!("Can not create a new {kind} listener")))
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

    #[test]
    fn beyond_this_host_the_link_is_protected() {
        for good in [
            "tcp/127.0.0.1:7448",
            "udp/localhost:7448",
            "quic/127.0.0.1:7448",
            "quic/10.0.0.2:7448",
            "quic/arm.local:7448",
            "quic/[::]:7448",
            "sealed-udp/10.0.0.2:7448",
        ] {
            assert_eq!(check_link(good), Ok(()), "{good}");
        }
        for (bad, instead) in [
            ("tcp/10.0.0.2:7448", "quic/10.0.0.2:7448"),
            ("udp/arm.local:7448", "quic/arm.local:7448"),
            ("tcp/0.0.0.0:7448", "quic/0.0.0.0:7448"),
            ("tls/127.0.0.1:7448", "quic/127.0.0.1:7448"),
        ] {
            let error = check_link(bad).unwrap_err();
            assert!(error.to_string().contains(instead), "{error}");
        }
        for bad in ["ws/127.0.0.1:7448", "quic/h:1?rel=1", "quic/h"] {
            let error = check_link(bad).unwrap_err();
            assert!(matches!(error, OpenError::BadEndpoint { .. }), "{error}");
        }
        assert_eq!(of_zenoh("sealed-udp/10.0.0.2:7448"), "udp/10.0.0.2:7448");
        assert!(check_server("quic/[::1]:7448").is_err());
        assert!(check_server("tcp/[::1]:7448").is_ok());
    }

    #[test]
    fn what_listens_everywhere_is_met_on_the_loopback() {
        assert_eq!(to_connect_to("quic/0.0.0.0:7448"), "quic/localhost:7448");
        assert_eq!(to_connect_to("quic/[::]:7448"), "quic/localhost:7448");
        assert_eq!(to_connect_to("quic/10.0.0.0:7448"), "quic/10.0.0.0:7448");
    }

    #[test]
    fn what_stays_on_this_host_is_told_from_what_leaves_it() {
        for here in [
            "tcp/127.0.0.1:7448",
            "udp/localhost:1",
            "tcp/[::1]:1",
            "quic/127.3.2.1:1",
        ] {
            assert!(is_loopback(here), "{here}");
        }
        for there in [
            "udp/10.0.0.2:7448",
            "tcp/0.0.0.0:1",
            "tcp/[::]:1",
            "tcp/arm.local:1",
            "",
        ] {
            assert!(!is_loopback(there), "{there}");
        }
    }
}

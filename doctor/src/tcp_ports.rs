//! Whether the ports that a session listens on are free, and who has them.

use std::collections::BTreeSet;
use std::io;
use std::net::SocketAddr;

use super::host::Host;
use super::network_table::{Holder, holders, sockets};
use super::options::{DoctorOptions, TcpEndpoint};
use super::report::{Check, Status};

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let mut check = Check::ok("tcp_ports", "TCP ports", "");
    let mut free = Vec::new();
    let mut taken = Vec::new();
    for endpoint in &options.tcp_endpoints {
        match examine(host, endpoint) {
            Ok(()) => free.push(format!("{} ({})", endpoint.address, endpoint.purpose)),
            Err(trouble) => {
                let found = format!(
                    "{} ({}) {}",
                    endpoint.address, endpoint.purpose, trouble.found
                );
                check.add(Status::Fail, &found, trouble.mend);
                taken.push(endpoint.address.clone());
            }
        }
    }
    if !free.is_empty() {
        let others = std::mem::take(&mut check.found);
        let separator = if others.is_empty() { "" } else { "\n" };
        check.found = format!("free: {}{separator}{others}", free.join(", "));
    } else if options.tcp_endpoints.is_empty() {
        check.found = "none is needed".to_owned();
    }
    check.with("free", free.len()).with("not_free", taken)
}

struct Trouble {
    found: String,
    mend: String,
}

fn examine(host: &dyn Host, endpoint: &TcpEndpoint) -> Result<(), Trouble> {
    let address = endpoint
        .address
        .strip_prefix("tcp/")
        .unwrap_or(&endpoint.address);
    let addresses = host.resolve(address).map_err(|error| Trouble {
        found: format!("is no endpoint: {error}"),
        mend: "write tcp/HOST:PORT, for example tcp/127.0.0.1:7447".to_owned(),
    })?;
    for address in addresses {
        let refused = host.try_listening(address);
        refused.map_err(|error| explain(host, address, &error))?;
    }
    Ok(())
}

fn explain(host: &dyn Host, address: SocketAddr, error: &io::Error) -> Trouble {
    match error.kind() {
        io::ErrorKind::AddrInUse => {
            let holders = holders_of(host, address);
            let names: BTreeSet<String> = holders.iter().map(ToString::to_string).collect();
            let names = Vec::from_iter(names).join(", ");
            let seen = |holder: &Holder| matches!(holder, Holder::Process { .. });
            let found = if names.is_empty() {
                "is taken; by whom cannot be seen".to_owned()
            } else {
                format!("is taken by {names}")
            };
            let mend = if !holders.is_empty() && holders.iter().all(seen) {
                format!("stop {names}, or choose another port")
            } else {
                let port = address.port();
                format!(
                    "`sudo ss -ltnp 'sport = :{port}'` names who listens; stop it, or choose another port"
                )
            };
            Trouble { found, mend }
        }
        io::ErrorKind::AddrNotAvailable => Trouble {
            found: format!(
                "cannot be listened on: {} is no address of this machine",
                address.ip()
            ),
            mend: "use one that `ip -brief address` lists, or 127.0.0.1".to_owned(),
        },
        io::ErrorKind::PermissionDenied => Trouble {
            found: format!("is refused: {error}"),
            mend: "choose a port from 1024 on".to_owned(),
        },
        _ => Trouble {
            found: format!("cannot be listened on: {error}"),
            mend: "choose another address or port".to_owned(),
        },
    }
}

fn holders_of(host: &dyn Host, address: SocketAddr) -> Vec<Holder> {
    let sockets = sockets(host, "tcp").unwrap_or_default();
    let on_port: Vec<_> = sockets
        .iter()
        .filter(|socket| socket.port == address.port() && socket.listening)
        .collect();
    holders(host, &on_port)
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::network_table::tests::table;
    use super::*;

    fn options(addresses: &[&str]) -> DoctorOptions {
        let endpoint = |address: &&str| TcpEndpoint {
            purpose: "link".to_owned(),
            address: (*address).to_owned(),
        };
        DoctorOptions {
            tcp_endpoints: addresses.iter().map(endpoint).collect(),
            ..DoctorOptions::default()
        }
    }

    fn refusing(kind: io::ErrorKind) -> Fake {
        let mut fake = Fake::good();
        let address = "127.0.0.1:7447".parse().expect("an address");
        fake.tcp.insert(address, kind);
        fake
    }

    #[test]
    fn free_ports_are_good_and_so_is_none() {
        let check_none = check(&Fake::good(), &options(&[]));
        assert_eq!(check_none.found, "none is needed");
        let check = check(&Fake::good(), &options(&["tcp/127.0.0.1:7447", "[::1]:80"]));
        assert_eq!(check.status, Status::Ok);
        assert_eq!(
            check.found,
            "free: tcp/127.0.0.1:7447 (link), [::1]:80 (link)"
        );
    }

    #[test]
    fn a_taken_port_is_told_with_its_holder() {
        let fake = refusing(io::ErrorKind::AddrInUse)
            .file(
                "/proc/net/tcp",
                &table(&[(7447, "0A", 0, 5), (7447, "01", 0, 6)]),
            )
            .process(31, "rmw_zenohd", &["socket:[5]"])
            .process(32, "client", &["socket:[6]"]);
        let check = check(&fake, &options(&["127.0.0.1:7447", "127.0.0.1:7448"]));
        assert_eq!(check.status, Status::Fail);
        assert_eq!(
            check.found,
            "free: 127.0.0.1:7448 (link)\n127.0.0.1:7447 (link) is taken by rmw_zenohd (process 31)"
        );
        assert_eq!(
            check.values["not_free"],
            serde_json::json!(["127.0.0.1:7447"])
        );
        assert!(
            check
                .mend
                .is_some_and(|mend| mend.starts_with("stop rmw_zenohd"))
        );
    }

    #[test]
    fn an_unseen_holder_leaves_the_command_that_names_it() {
        let fake = refusing(io::ErrorKind::AddrInUse);
        let of_another = table(&[(7447, "0A", 33, 5)]);
        for (fake, words) in [
            (fake.clone(), "by whom cannot be seen"),
            (
                fake.file("/proc/net/tcp", &of_another),
                "by a process of user 33",
            ),
        ] {
            let check = check(&fake, &options(&["127.0.0.1:7447"]));
            assert!(check.found.contains(words), "{}", check.found);
            assert!(check.mend.is_some_and(|mend| mend.contains("ss -ltnp")));
        }
    }

    #[test]
    fn other_refusals_say_what_they_are() {
        for (kind, words) in [
            (
                io::ErrorKind::AddrNotAvailable,
                "no address of this machine",
            ),
            (io::ErrorKind::PermissionDenied, "is refused"),
            (io::ErrorKind::Other, "cannot be listened on"),
        ] {
            let check = check(&refusing(kind), &options(&["127.0.0.1:7447"]));
            assert_eq!(check.status, Status::Fail);
            assert!(check.found.contains(words), "{}", check.found);
        }
        let check = check(&Fake::good(), &options(&["no endpoint"]));
        assert!(check.found.contains("is no endpoint"));
    }
}

//! The UDP ports of DDS in the ROS domain, and the participants that have some.

use super::host::Host;
use super::network_table::{holders, sockets};
use super::options::DoctorOptions;
use super::report::Check;
use super::ros_domain::{DomainPorts, domain};

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let empty = Check::ok("discovery_ports", "DDS ports (UDP)", "");
    let domain = domain(host, options).ok();
    let Some((domain, ports)) = domain.and_then(|id| Some((id, DomainPorts::of(id)?))) else {
        return empty.fail(
            "none without a valid ROS domain",
            "correct the ROS domain first",
        );
    };
    let shared = ports.discovery_multicast();
    let sharing = host.try_sharing_udp_port(shared);
    let mut check = empty.with("discovery_port", shared);

    let sockets = match sockets(host, "udp") {
        Ok(sockets) => sockets,
        Err(error) => {
            check.found = format!("discovery port {shared}; participants unknown");
            return check.warn(&format!("/proc/net/udp: {error}"), "mount /proc");
        }
    };
    let mut participants: Vec<_> = sockets
        .iter()
        .filter_map(|socket| Some((ports.participant(socket.port)?, socket)))
        .collect();
    participants.sort_by_key(|(index, _)| *index);
    participants.dedup_by_key(|(index, _)| *index);
    let theirs: Vec<_> = participants.iter().map(|(_, socket)| *socket).collect();
    let names: Vec<String> = holders(host, &theirs)
        .iter()
        .map(ToString::to_string)
        .collect();

    let count = names.len();
    check.found = match count {
        0 => format!("discovery port {shared}; nobody on this machine is in domain {domain}"),
        1 => format!(
            "discovery port {shared}; one participant on this machine: {}",
            names[0]
        ),
        _ => format!(
            "discovery port {shared}; {count} participants on this machine: {}",
            names.join(", ")
        ),
    };
    check = check.with("participants", names);

    if let Err(error) = sharing {
        let on_port: Vec<_> = sockets
            .iter()
            .filter(|socket| socket.port == shared)
            .collect();
        let names = holders(host, &on_port);
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        let (whom, stop) = if names.is_empty() {
            (
                String::new(),
                "find who has it with `sudo ss -lunp`, stop it,".to_owned(),
            )
        } else {
            let names = names.join(", ");
            (format!(", held by {names}"), format!("stop {names}"))
        };
        check = check.fail(
            &format!("port {shared} cannot be shared ({error}){whom}: nobody would be discovered"),
            format!("{stop} or choose another ROS_DOMAIN_ID"),
        );
    }
    if count >= ports.participants() as usize {
        check = check.fail(
            "every participant's port is taken: no further node can join",
            "stop nodes that are not needed, or choose another ROS_DOMAIN_ID",
        );
    }
    check
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::network_table::tests::table;
    use super::super::report::Status;
    use super::*;

    #[test]
    fn an_empty_domain_is_good() {
        let check = check(&Fake::good(), &DoctorOptions::default());
        assert_eq!(
            (check.status, &check.values["discovery_port"]),
            (Status::Ok, &7400.into())
        );
        assert_eq!(check.values["participants"], serde_json::json!([]));
    }

    #[test]
    fn participants_are_named_by_their_ports() {
        // Domain 1: 7650 shared, 7660 and 7662 discovery, 7661 user data.
        let udp = [
            (7650, "07", 0, 1),
            (7662, "07", 0, 4),
            (7660, "07", 0, 2),
            (7661, "07", 0, 3),
        ];
        let fake = Fake::good()
            .variable("ROS_DOMAIN_ID", "1")
            .file("/proc/net/udp", &table(&udp))
            .process(8, "talker", &["socket:[1]", "socket:[2]", "socket:[3]"])
            .process(9, "listener", &["socket:[4]"]);
        let check = check(&fake, &DoctorOptions::default());
        assert_eq!(check.status, Status::Ok);
        let names = serde_json::json!(["talker (process 8)", "listener (process 9)"]);
        assert_eq!(check.values["participants"], names);
    }

    #[test]
    fn a_discovery_port_that_is_not_shared_fails() {
        let mut fake = Fake::good()
            .file("/proc/net/udp", &table(&[(7400, "07", 0, 1)]))
            .process(8, "greedy", &["socket:[1]"]);
        fake.taken_udp.insert(7400);
        let check = check(&fake, &DoctorOptions::default());
        assert_eq!(check.status, Status::Fail);
        assert!(check.found.contains("held by greedy (process 8)"));
    }

    #[test]
    fn a_full_domain_fails() {
        let mut udp: Vec<_> = (0..119)
            .map(|index| (7410 + 2 * index, "07", 0, 1))
            .collect();
        let options = DoctorOptions::default();
        let fake = Fake::good().file("/proc/net/udp", &table(&udp));
        assert_eq!(check(&fake, &options).status, Status::Ok);
        udp.push((7410 + 2 * 119, "07", 0, 1));
        let fake = Fake::good().file("/proc/net/udp", &table(&udp));
        assert_eq!(check(&fake, &options).status, Status::Fail);
    }

    #[test]
    fn no_domain_and_no_table_are_said() {
        let bad = Fake::good().variable("ROS_DOMAIN_ID", "300");
        assert_eq!(check(&bad, &DoctorOptions::default()).status, Status::Fail);
        let blind = Fake::good().without_file("/proc/net/udp");
        assert_eq!(
            check(&blind, &DoctorOptions::default()).status,
            Status::Warn
        );
    }
}

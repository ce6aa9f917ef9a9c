//! Whether DDS's discovery, multicast to 239.255.0.1, gets through a network
//! interface. Tried on the machine itself: nothing leaves it.

use std::net::Ipv4Addr;

use super::host::Host;
use super::report::Check;

/// DDSI-RTPS 2.5, section 9.6.2.4.1: the group in which participants meet.
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);

pub(super) fn check(host: &dyn Host) -> Check {
    let empty = Check::ok("multicast", "Multicast", "");
    let interfaces = match host.interfaces() {
        Ok(interfaces) => interfaces,
        Err(error) => {
            return empty.fail(
                &format!("network interfaces cannot be listed: {error}"),
                "`ip link` should list at least lo; a sandbox may forbid it",
            );
        }
    };
    let mut working = Vec::new();
    let mut failing = Vec::new();
    for interface in interfaces.iter().filter(|interface| interface.running) {
        for address in &interface.addresses {
            if !interface.multicast {
                continue;
            }
            match host.try_multicast(GROUP, *address) {
                Ok(()) => working.push((interface, *address)),
                Err(error) => failing.push(format!("{} ({address}): {error}", interface.name)),
            }
        }
    }
    let names: Vec<String> = working
        .iter()
        .map(|(interface, address)| format!("{} ({address})", interface.name))
        .collect();
    let loopback = interfaces
        .iter()
        .find(|interface| interface.loopback && interface.running);
    let mut check = empty
        .with("interfaces", names.clone())
        .with("loopback", loopback.is_some())
        .with(
            "loopback_multicast",
            loopback.is_some_and(|lo| lo.multicast),
        );
    if !names.is_empty() {
        check.found = format!("{GROUP} works through {}", names.join(", "));
    }
    if loopback.is_none() {
        check = check.fail(
            "no loopback interface is up: the nodes of a session cannot talk to each other",
            "`sudo ip link set lo up`",
        );
    }
    let beyond = working.iter().any(|(interface, _)| !interface.loopback);
    if working.is_empty() {
        check = check.warn(
            "no interface that is up carries multicast: ROS 2 nodes are not discovered",
            "for nodes on this host: `sudo ip link set lo multicast on`; for others: connect a network, or start the session with --middleware zenoh",
        );
    } else if !beyond {
        check = check.warn(
            "the loopback interface alone: nodes of other hosts are not discovered",
            "connect a network, or start the session with --middleware zenoh",
        );
    }
    if !failing.is_empty() {
        check = check.warn(
            &format!("refused through {}", failing.join(", ")),
            "let UDP to 239.255.0.1 and ports 7400 to 7650 through the firewall (`sudo ufw allow in proto udp to 239.255.0.0/16`)",
        );
    }
    check
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    #[test]
    fn an_interface_with_multicast_is_good() {
        let check = check(&Fake::good());
        assert_eq!(check.status, Status::Ok);
        assert_eq!(check.found, "239.255.0.1 works through eth0 (192.168.1.5)");
        assert_eq!(check.values["loopback_multicast"], false);
    }

    #[test]
    fn offline_without_multicast_on_loopback_warns() {
        let mut fake = Fake::good();
        fake.interfaces[1].running = false;
        let before = check(&fake);
        assert_eq!(before.status, Status::Warn);
        assert!(
            before
                .mend
                .is_some_and(|mend| mend.contains("lo multicast on"))
        );
        // Mended so, this host's own nodes are found.
        fake.interfaces[0].multicast = true;
        fake.multicast.insert(Ipv4Addr::LOCALHOST);
        assert!(check(&fake).found.contains("loopback interface alone"));
    }

    #[test]
    fn a_firewall_warns_and_names_the_interface() {
        let mut fake = Fake::good();
        fake.multicast.clear();
        let check = check(&fake);
        assert_eq!(check.status, Status::Warn);
        assert!(
            check
                .found
                .contains("eth0 (192.168.1.5): did not come back")
        );
    }

    #[test]
    fn no_loopback_fails() {
        let mut fake = Fake::good();
        fake.interfaces.remove(0);
        assert_eq!(check(&fake).status, Status::Fail);
        assert_eq!(check(&Fake::empty()).status, Status::Fail);
    }
}

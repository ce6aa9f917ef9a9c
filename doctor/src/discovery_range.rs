//! Variables that keep stock ROS 2 nodes, started in this shell, from finding
//! others.

use super::host::Host;
use super::report::Check;

pub(super) fn check(host: &dyn Host) -> Check {
    let set = |name| host.variable(name).filter(|value| !value.is_empty());
    let mut check = Check::ok("discovery_range", "ROS discovery range", "");
    let mut restricted = false;

    // Deprecated since Jazzy, yet it overrides the newer variable.
    let local = set("ROS_LOCALHOST_ONLY").is_some_and(|value| value == "1");
    let range = set("ROS_AUTOMATIC_DISCOVERY_RANGE");
    if local {
        restricted = true;
        check = check.with("ros_localhost_only", true).warn(
            "ROS_LOCALHOST_ONLY=1: ROS 2 nodes started here use 127.0.0.1 alone; a session does not, and nodes of other hosts are not found",
            "`unset ROS_LOCALHOST_ONLY`",
        );
    }
    if let Some(range) = &range {
        check = check.with("ros_automatic_discovery_range", range.as_str());
        let trouble = match range.to_ascii_uppercase().as_str() {
            "SUBNET" | "SYSTEM_DEFAULT" => None,
            "LOCALHOST" => Some("nodes of other hosts are not found"),
            "OFF" => Some("ROS 2 nodes started here find nobody, not even a session on this host"),
            _ => Some("is none of SUBNET, LOCALHOST, OFF, SYSTEM_DEFAULT"),
        };
        if let Some(trouble) = trouble {
            restricted = true;
            check = check.warn(
                &format!("ROS_AUTOMATIC_DISCOVERY_RANGE={range}: {trouble}"),
                "`export ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET`",
            );
        }
    }
    if let Some(server) = set("ROS_DISCOVERY_SERVER") {
        restricted = true;
        check = check.with("ros_discovery_server", server.as_str()).warn(
            &format!("ROS_DISCOVERY_SERVER={server}: Fast DDS nodes started here ask that server and are not found by a session"),
            "`unset ROS_DISCOVERY_SERVER`",
        );
    }
    if !restricted {
        check.found = match range {
            Some(range) => format!("{range} (ROS_AUTOMATIC_DISCOVERY_RANGE)"),
            None => "not restricted".to_owned(),
        };
    }
    check
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    #[test]
    fn what_does_not_restrict_is_good() {
        assert_eq!(check(&Fake::empty()).found, "not restricted");
        for (name, value) in [
            ("ROS_LOCALHOST_ONLY", "0"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "system_default"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", ""),
        ] {
            let check = check(&Fake::empty().variable(name, value));
            assert_eq!(check.status, Status::Ok, "{name}={value}");
            assert!(!check.found.is_empty());
        }
    }

    #[test]
    fn what_restricts_warns_and_is_named() {
        for (name, value) in [
            ("ROS_LOCALHOST_ONLY", "1"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "FAR"),
            ("ROS_DISCOVERY_SERVER", "10.0.0.1:11811"),
        ] {
            let check = check(&Fake::empty().variable(name, value));
            assert_eq!(check.status, Status::Warn, "{name}={value}");
            assert!(check.found.contains(&format!("{name}={value}")));
            assert!(check.mend.is_some_and(|mend| mend.contains(name)));
        }
    }
}

//! The ROS domain, and whether DDS has ports of its own in it.

use super::host::Host;
use super::options::{DoctorOptions, RosMiddleware};
use super::report::Check;

/// The largest domain whose first port is a port: 7400 + 250·232 = 65400.
pub(super) const LARGEST: u32 = 232;

/// The largest index of a participant, by the ports' formula: 10 + 2·119 + 1
/// is the last below the next domain's 250.
const LARGEST_PARTICIPANT: u32 = 119;

/// Linux's own range for ports that nobody asked for by number.
const EPHEMERAL: (u16, u16) = (32768, 60999);

/// The UDP ports of a domain (DDSI-RTPS 2.5, section 9.6.2.4: PB = 7400,
/// DG = 250, PG = 2, d0 = 0, d1 = 10, d2 = 1, d3 = 11).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DomainPorts {
    base: u16,
}

impl DomainPorts {
    /// `None` beyond [`LARGEST`].
    pub(super) fn of(domain: u32) -> Option<DomainPorts> {
        if domain > LARGEST {
            return None;
        }
        let base = u16::try_from(7400 + 250 * domain).ok()?;
        Some(DomainPorts { base })
    }

    /// Discovery, multicast, shared by all participants: PB + DG·domain + d0.
    pub(super) fn discovery_multicast(self) -> u16 {
        self.base
    }

    /// How many participants have both of their ports: 120, fewer in the last domain.
    pub(super) fn participants(self) -> u32 {
        let room = (u32::from(u16::MAX) - u32::from(self.base) - 11) / 2 + 1;
        room.min(LARGEST_PARTICIPANT + 1)
    }

    /// The participant whose unicast discovery port this is: PB + DG·domain +
    /// d1 + PG·index.
    pub(super) fn participant(self, port: u16) -> Option<u32> {
        let offset = u32::from(port.checked_sub(self.base)?).checked_sub(10)?;
        let index = offset / 2;
        (offset % 2 == 0 && index < self.participants()).then_some(index)
    }

    fn last(self) -> u16 {
        self.base.saturating_add(249)
    }
}

/// The domain in force: of the options, else `ROS_DOMAIN_ID`, else 0. The
/// error is the text that is no domain.
pub(super) fn domain(host: &dyn Host, options: &DoctorOptions) -> Result<u32, String> {
    match options.ros_domain {
        Some(domain) => Ok(domain),
        None => of_environment(host).unwrap_or(Ok(0)),
    }
}

fn of_environment(host: &dyn Host) -> Option<Result<u32, String>> {
    let text = host.variable("ROS_DOMAIN_ID")?;
    if text.is_empty() {
        return None;
    }
    Some(text.trim().parse().map_err(|_| text))
}

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let empty = Check::ok("ros_domain", "ROS domain", "");
    let domain = match domain(host, options) {
        Ok(domain) => domain,
        Err(text) => {
            return empty.with("ros_domain_id", text.as_str()).fail(
                &format!("ROS_DOMAIN_ID is {text:?}, which is no whole number"),
                format!("`export ROS_DOMAIN_ID=0`, or another from 0 to {LARGEST}"),
            );
        }
    };
    let environment = of_environment(host);
    let source = match (&environment, options.ros_domain) {
        (_, Some(_)) => "configured",
        (Some(_), None) => "ROS_DOMAIN_ID",
        (None, None) => "the default",
    };
    let mut check = empty.with("domain", domain);
    check.found = format!("{domain} ({source})");
    // The stock tools, started here, look where the environment says.
    let tools = environment.unwrap_or(Ok(0));
    if options.ros_domain.is_some() && tools != Ok(domain) {
        let tools = tools.map_or_else(|text| format!("{text:?}"), |number| number.to_string());
        check = check.warn(
            &format!("ros2 tools started in this shell are in domain {tools}: they see nothing of the session"),
            format!("`export ROS_DOMAIN_ID={domain}`"),
        );
    }
    if options.middleware == RosMiddleware::Zenoh {
        return check;
    }
    let Some(ports) = DomainPorts::of(domain) else {
        return check.fail(
            "DDS has no ports for it",
            format!("`export ROS_DOMAIN_ID=0`, or another from 0 to {LARGEST}"),
        );
    };
    let (first, last) = ephemeral(host);
    if ports.base <= last && ports.last() >= first {
        let free = u32::from(first.saturating_sub(7400 + 250)) / 250;
        check = check.warn(
            &format!(
                "its ports {}–{} lie among those that the kernel hands to any program ({first}–{last}): one may be gone when a node starts",
                ports.base,
                ports.last()
            ),
            format!("choose a domain from 0 to {free}"),
        );
    }
    check
}

fn ephemeral(host: &dyn Host) -> (u16, u16) {
    let parse = |text: String| {
        let mut words = text.split_whitespace();
        Some((words.next()?.parse().ok()?, words.next()?.parse().ok()?))
    };
    let text = host.read("/proc/sys/net/ipv4/ip_local_port_range");
    text.ok().and_then(parse).unwrap_or(EPHEMERAL)
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    fn with_environment(value: &str) -> Check {
        let fake = Fake::good().variable("ROS_DOMAIN_ID", value);
        check(&fake, &DoctorOptions::default())
    }

    #[test]
    fn ports_follow_the_formula() {
        let ports = DomainPorts::of(0).expect("in range");
        assert_eq!(ports.discovery_multicast(), 7400);
        assert_eq!(ports.participant(7410), Some(0));
        assert_eq!(ports.participant(7412), Some(1));
        assert_eq!(ports.participant(7648), Some(119));
        for none in [7400, 7401, 7411, 7650, 80] {
            assert_eq!(ports.participant(none), None, "{none}");
        }
        let last = DomainPorts::of(232).expect("in range");
        assert_eq!(last.discovery_multicast(), 65400);
        // 65400 + 11 + 2·62 = 65535, the last port there is.
        assert_eq!(last.participants(), 63);
        assert_eq!(DomainPorts::of(233), None);
    }

    #[test]
    fn unset_empty_and_small_are_good() {
        let unset = check(&Fake::good(), &DoctorOptions::default());
        assert_eq!(
            (unset.status, unset.found.as_str()),
            (Status::Ok, "0 (the default)")
        );
        assert_eq!(with_environment("").status, Status::Ok);
        assert_eq!(with_environment("42").found, "42 (ROS_DOMAIN_ID)");
        // 7400 + 250·100 + 249 = 32649: the last below 32768.
        assert_eq!(with_environment("100").status, Status::Ok);
    }

    #[test]
    fn a_domain_among_the_ephemeral_ports_warns() {
        assert_eq!(with_environment("102").status, Status::Warn);
        assert_eq!(with_environment("214").status, Status::Warn);
        assert_eq!(with_environment("215").status, Status::Ok);
        let mend = with_environment("150").mend;
        assert!(mend.is_some_and(|mend| mend.ends_with("from 0 to 100")));
    }

    #[test]
    fn no_domain_fails() {
        for bad in ["233", "-1", "red", "4294967296"] {
            let check = with_environment(bad);
            assert_eq!(check.status, Status::Fail, "{bad}");
            assert!(check.mend.is_some());
        }
    }

    #[test]
    fn over_zenoh_any_number_is_a_domain() {
        let options = DoctorOptions {
            middleware: RosMiddleware::Zenoh,
            ros_domain: Some(1000),
            ..DoctorOptions::default()
        };
        let fake = Fake::good().variable("ROS_DOMAIN_ID", "1000");
        assert_eq!(check(&fake, &options).status, Status::Ok);
    }

    #[test]
    fn a_configured_domain_that_the_shell_does_not_share_warns() {
        let options = DoctorOptions {
            ros_domain: Some(7),
            ..DoctorOptions::default()
        };
        for fake in [Fake::good(), Fake::good().variable("ROS_DOMAIN_ID", "x")] {
            let check = check(&fake, &options);
            assert_eq!(check.status, Status::Warn);
            assert!(
                check
                    .mend
                    .is_some_and(|mend| mend.contains("ROS_DOMAIN_ID=7"))
            );
        }
        let same = Fake::good().variable("ROS_DOMAIN_ID", "7");
        assert_eq!(check(&same, &options).status, Status::Ok);
    }
}

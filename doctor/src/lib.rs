//! The doctor: what this machine offers and lacks for a session, and how to
//! mend it.
//!
//! One check a file. A check is a function of the options and the
//! [`Host`]; it never fails: what cannot be found out is said so in
//! its [`Check`].

mod clock_source;
mod devices;
mod discovery_ports;
mod discovery_range;
mod disk;
mod kernel;
mod leftovers;
mod limits;
mod machine;
mod multicast;
mod network_table;
mod options;
mod peers;
mod processor;
mod processor_quota;
mod real_time_priority;
mod report;
mod ros_distribution;
mod ros_domain;
mod shared_memory;

mod host;
mod tcp_ports;
mod text;
mod units;
mod wake_up_lateness;

#[cfg(test)]
mod fake;

pub use host::{FileSystem, Host, Interface, WakeUps};
pub use machine::Machine;
pub use options::{Device, DoctorOptions, Place, RosMiddleware, TcpEndpoint};
pub use peers::{Peer, PeerKind};
pub use report::{Check, Report, Status};
pub use text::ReportText;

/// Examines this machine. Takes about twice
/// [`DoctorOptions::wake_up_duration`] plus what `peers` takes.
///
/// `peers` looks for ROS 2 peers for [`DoctorOptions::peers_duration`] over
/// the session's middleware; its error says why it could not.
pub fn examine(options: &DoctorOptions, peers: &dyn Fn() -> Result<Vec<Peer>, String>) -> Report {
    examine_in(&Machine, options, peers)
}

/// Examines any [`Host`]; otherwise as [`examine`].
pub fn examine_in(
    host: &dyn Host,
    options: &DoctorOptions,
    peers: &dyn Fn() -> Result<Vec<Peer>, String>,
) -> Report {
    let mut checks = vec![
        kernel::check(host),
        clock_source::check(host),
        processor::check(host),
        processor_quota::check(host),
        real_time_priority::check(host, options),
        wake_up_lateness::check(host, options),
        shared_memory::check(host, options),
        leftovers::check(host, options),
        disk::check(host, options),
        tcp_ports::check(host, options),
        ros_distribution::check(host, options),
        ros_domain::check(host, options),
    ];
    // rmw_zenoh peers meet at a router over TCP: no ports of DDS, no multicast.
    if options.middleware == RosMiddleware::Dds {
        checks.push(discovery_range::check(host));
        checks.push(discovery_ports::check(host, options));
        checks.push(multicast::check(host));
    }
    checks.extend(devices::check(host, options));
    checks.push(peers::check(options, peers));
    Report { checks }
}

#[cfg(test)]
mod tests {
    use super::fake::Fake;
    use super::*;

    #[test]
    fn a_good_machine_has_no_failure_and_each_check_its_own_id() {
        let fake = Fake::good();
        let report = examine_in(&fake, &DoctorOptions::default(), &|| {
            Ok(vec![Peer::node("/talker")])
        });
        let not_ok: Vec<_> = report
            .checks
            .iter()
            .filter(|check| check.status != Status::Ok)
            .collect();
        assert!(not_ok.is_empty(), "{not_ok:?}");
        let mut ids: Vec<_> = report.checks.iter().map(|check| check.id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 16);
        assert_eq!(report.checks.len(), 16);
    }

    #[test]
    fn over_zenoh_nothing_of_dds_is_examined() {
        let options = DoctorOptions {
            middleware: RosMiddleware::Zenoh,
            ..DoctorOptions::default()
        };
        let report = examine_in(&Fake::good(), &options, &|| Ok(Vec::new()));
        for id in ["discovery_ports", "discovery_range", "multicast"] {
            assert!(report.checks.iter().all(|check| check.id != id), "{id}");
        }
    }

    #[test]
    fn a_machine_that_answers_nothing_is_reported_without_a_panic() {
        let report = examine_in(&Fake::empty(), &DoctorOptions::default(), &|| {
            Err("no network".to_owned())
        });
        assert_eq!(report.exit_code(), 1);
        for check in &report.checks {
            assert!(!check.found.is_empty(), "{}", check.id);
            assert!(
                check.status == Status::Ok || check.mend.is_some(),
                "{}",
                check.id
            );
        }
    }

    #[test]
    fn this_machine_is_examined_for_real() {
        let options = DoctorOptions {
            wake_up_duration: std::time::Duration::from_millis(20),
            ..DoctorOptions::default()
        };
        let report = examine(&options, &|| Ok(Vec::new()));
        let lateness = report
            .checks
            .iter()
            .find(|check| check.id == "wake_up_lateness")
            .expect("the check is in the list");
        let worst = lateness.values["normal_worst_us"].as_f64();
        assert!(worst.is_some_and(|worst| worst > 0.0), "{lateness:?}");
        let kernel = &report.checks[0];
        assert_eq!((kernel.id, kernel.status), ("kernel", Status::Ok));
    }
}

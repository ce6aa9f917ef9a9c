//! Which ROS 2 is here, and whether its nodes understand a session.

use super::host::Host;
use super::options::{DoctorOptions, RosMiddleware};
use super::report::Check;

const FOLDER: &str = "/opt/ros";

/// Before Iron: no type hashes, and longer ids in the node graph.
const OLD: [&str; 8] = [
    "ardent", "bouncy", "crystal", "dashing", "eloquent", "foxy", "galactic", "humble",
];

/// The last ones of ROS 1, which can stand in the same folder.
const ROS_1: [&str; 4] = ["indigo", "kinetic", "melodic", "noetic"];

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let set = |name| host.variable(name).filter(|value| !value.is_empty());
    let mut installed = host.list(FOLDER).unwrap_or_default();
    installed.retain(|name| {
        let files = host.list(&format!("{FOLDER}/{name}"));
        files.is_ok_and(|files| files.iter().any(|file| file == "setup.bash"))
    });
    let sourced = set("ROS_DISTRO");
    let rmw = set("RMW_IMPLEMENTATION");

    let mut found = if installed.is_empty() {
        format!("none under {FOLDER}; a session needs none, nodes of other hosts can join")
    } else {
        format!("installed: {}", installed.join(", "))
    };
    match &sourced {
        Some(name) => found += &format!("; this shell uses {name}"),
        None if installed.is_empty() => {}
        None => found += "; this shell uses none",
    }
    if let Some(rmw) = &rmw {
        found += &format!("; RMW_IMPLEMENTATION={rmw}");
    }
    let mut check = Check::ok("ros_distribution", "ROS distribution", found)
        .with("installed", installed)
        .with("ros_distro", sourced.clone())
        .with("rmw_implementation", rmw.clone());

    if let Some(name) = sourced.as_deref() {
        if ROS_1.contains(&name) {
            check = check.warn(
                &format!("{name} is ROS 1: its nodes speak neither DDS nor Zenoh"),
                "source a ROS 2 distribution in a new shell, for example /opt/ros/jazzy/setup.bash",
            );
        } else if OLD.contains(&name) {
            let trouble = match options.middleware {
                RosMiddleware::Dds => "its tools show the session's topics, but not its nodes",
                RosMiddleware::Zenoh => {
                    "it knows no type hashes, by which nodes over Zenoh match: no message gets across"
                }
            };
            check = check.warn(
                &format!("{name}: {trouble}"),
                "use Iron or later; a session is built for Jazzy",
            );
        }
    }
    // What stock nodes take when nothing is said.
    let default = "rmw_fastrtps_cpp";
    let zenoh = rmw.as_deref().unwrap_or(default).starts_with("rmw_zenoh");
    let concerned = rmw.is_some() || sourced.is_some();
    match options.middleware {
        RosMiddleware::Dds if zenoh => check.warn(
            "nodes started here speak Zenoh, the session DDS: they do not meet",
            "`unset RMW_IMPLEMENTATION`, or start the session with --middleware zenoh",
        ),
        RosMiddleware::Zenoh if !zenoh && concerned => check.warn(
            "nodes started here speak DDS, the session Zenoh: they do not meet",
            "`export RMW_IMPLEMENTATION=rmw_zenoh_cpp`, or start the session with --middleware dds",
        ),
        _ => check,
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    fn over(middleware: RosMiddleware, fake: &Fake) -> Check {
        let options = DoctorOptions {
            middleware,
            ..DoctorOptions::default()
        };
        check(fake, &options)
    }

    #[test]
    fn none_is_needed() {
        for middleware in [RosMiddleware::Dds, RosMiddleware::Zenoh] {
            assert_eq!(over(middleware, &Fake::empty()).status, Status::Ok);
        }
    }

    #[test]
    fn those_with_a_setup_are_listed() {
        let fake = Fake::good()
            .file("/opt/ros/broken/README", "")
            .variable("ROS_DISTRO", "jazzy");
        let check = over(RosMiddleware::Dds, &fake);
        assert_eq!(check.status, Status::Ok);
        assert_eq!(check.found, "installed: jazzy; this shell uses jazzy");
    }

    #[test]
    fn old_ones_warn() {
        let humble = Fake::good().variable("ROS_DISTRO", "humble");
        assert!(
            over(RosMiddleware::Dds, &humble)
                .found
                .contains("not its nodes")
        );
        let zenoh = humble.variable("RMW_IMPLEMENTATION", "rmw_zenoh_cpp");
        assert!(
            over(RosMiddleware::Zenoh, &zenoh)
                .found
                .contains("no type hashes")
        );
        let noetic = Fake::good().variable("ROS_DISTRO", "noetic");
        assert!(over(RosMiddleware::Dds, &noetic).found.contains("is ROS 1"));
    }

    #[test]
    fn another_middleware_than_the_session_warns() {
        let zenoh = Fake::good().variable("RMW_IMPLEMENTATION", "rmw_zenoh_cpp");
        let cyclone = Fake::good().variable("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp");
        let default = Fake::good().variable("ROS_DISTRO", "jazzy");
        let status = |middleware, fake| over(middleware, fake).status;
        assert_eq!(status(RosMiddleware::Dds, &zenoh), Status::Warn);
        assert_eq!(status(RosMiddleware::Zenoh, &zenoh), Status::Ok);
        assert_eq!(status(RosMiddleware::Dds, &cyclone), Status::Ok);
        assert_eq!(status(RosMiddleware::Zenoh, &cyclone), Status::Warn);
        assert_eq!(status(RosMiddleware::Zenoh, &default), Status::Warn);
    }
}

//! The ROS 2 nodes and topics that the caller's discovery has seen.

use serde::Serialize;

use super::options::{DoctorOptions, RosMiddleware};
use super::report::Check;

/// What a peer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PeerKind {
    /// A node of another program.
    Node,
    /// A topic that another program publishes or subscribes to.
    Topic,
}

/// Something of another program, seen over the session's middleware.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Peer {
    /// What it is.
    pub kind: PeerKind,
    /// Its full name, `/talker`.
    pub name: String,
    /// A topic's type, `std_msgs/msg/String`.
    pub type_name: Option<String>,
}

impl Peer {
    /// A node.
    pub fn node(name: impl Into<String>) -> Peer {
        Peer {
            kind: PeerKind::Node,
            name: name.into(),
            type_name: None,
        }
    }

    /// A topic and its type.
    pub fn topic(name: impl Into<String>, type_name: impl Into<String>) -> Peer {
        Peer {
            kind: PeerKind::Topic,
            name: name.into(),
            type_name: Some(type_name.into()),
        }
    }
}

/// More names than this do not help a reader; all are in the values.
const MAX_NAMES: usize = 6;

pub(super) fn check(
    options: &DoctorOptions,
    look: &dyn Fn() -> Result<Vec<Peer>, String>,
) -> Check {
    let empty = Check::ok("peers", "ROS peers", "");
    let middleware = match options.middleware {
        RosMiddleware::Dds => "DDS",
        RosMiddleware::Zenoh => "Zenoh",
    };
    let mut peers = match look() {
        Ok(peers) => peers,
        Err(error) => {
            let mend = match options.middleware {
                RosMiddleware::Dds => {
                    "correct what is wrong with ports, domain or multicast (above) first"
                }
                RosMiddleware::Zenoh => {
                    "start a router (`ros2 run rmw_zenoh_cpp rmw_zenohd`, or a session), or correct its endpoint"
                }
            };
            return empty.fail(
                &format!("cannot look for any over {middleware}: {error}"),
                mend,
            );
        }
    };
    peers.sort();
    peers.dedup();
    let seconds = options.peers_duration.as_secs_f64();
    let of = |kind| peers.iter().filter(move |peer| peer.kind == kind);
    let nodes: Vec<String> = of(PeerKind::Node).map(|peer| peer.name.clone()).collect();
    let topics: Vec<String> = of(PeerKind::Topic)
        .map(|peer| match &peer.type_name {
            Some(type_name) => format!("{} [{type_name}]", peer.name),
            None => peer.name.clone(),
        })
        .collect();
    let mut check = empty
        .with("nodes", nodes.clone())
        .with("topics", topics.clone())
        .with("looked_for_s", seconds);
    if peers.is_empty() {
        return check.warn(
            &format!("none seen over {middleware} in {seconds} s"),
            "nothing to correct if none runs; else compare its ROS_DOMAIN_ID and RMW_IMPLEMENTATION with this shell's, and see ports and multicast above",
        );
    }
    let line = |what, names: &[String]| format!("{what}: {}", shortened(names));
    let lines = [line("nodes", &nodes), line("topics", &topics)];
    check.found = format!(
        "seen over {middleware} in {seconds} s\n{}",
        lines.join("\n")
    );
    check
}

fn shortened(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    let shown: Vec<&str> = names.iter().take(MAX_NAMES).map(String::as_str).collect();
    match names.len() - shown.len() {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::report::Status;
    use super::*;

    #[test]
    fn nodes_and_topics_are_named_once_each() {
        let look = || {
            Ok(vec![
                Peer::topic("/chatter", "std_msgs/msg/String"),
                Peer::node("/talker"),
                Peer::node("/talker"),
            ])
        };
        let check = check(&DoctorOptions::default(), &look);
        assert_eq!(check.status, Status::Ok);
        assert_eq!(
            check.found,
            "seen over DDS in 3 s\nnodes: /talker\ntopics: /chatter [std_msgs/msg/String]"
        );
        assert_eq!(check.values["nodes"], serde_json::json!(["/talker"]));
    }

    #[test]
    fn many_are_shortened_for_people_only() {
        let look = || {
            Ok((0..20)
                .map(|number| Peer::node(format!("/n{number:02}")))
                .collect())
        };
        let check = check(&DoctorOptions::default(), &look);
        assert!(check.found.contains("/n05 and 14 more\ntopics: none"));
        assert_eq!(check.values["nodes"].as_array().map(Vec::len), Some(20));
    }

    #[test]
    fn none_warns_and_no_discovery_fails() {
        let options = DoctorOptions::default();
        assert_eq!(check(&options, &|| Ok(Vec::new())).status, Status::Warn);
        let failed = check(&options, &|| Err("no socket".to_owned()));
        assert_eq!(failed.status, Status::Fail);
        assert!(failed.found.contains("no socket"));
    }
}

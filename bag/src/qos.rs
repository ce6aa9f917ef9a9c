//! Quality of service as rosbag2 writes it.

use ferntast_msgs::topics::{Delivery, EVENT_QUEUE};
use serde::{Deserialize, Serialize};

/// A publisher's quality of service, in the words of rosbag2's metadata
/// version 9. Deadline, lifespan and lease are always "infinite", which is
/// what all publishers of this project offer and most others do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct QosProfile {
    /// `keep_last`, `keep_all`, `system_default` or `unknown`.
    pub history: String,
    /// Length of the queue.
    pub depth: u64,
    /// `reliable`, `best_effort`, `system_default` or `unknown`.
    pub reliability: String,
    /// `transient_local`, `volatile`, `system_default` or `unknown`.
    pub durability: String,
    /// `automatic`, `manual_by_topic`, `system_default` or `unknown`.
    pub liveliness: String,
}

/// rmw's `RMW_DURATION_INFINITE`, split as `rmw_time_t` is.
const INFINITE: &str = "\n    sec: 9223372036\n    nsec: 854775807";

const HISTORY: &[&str] = &["system_default", "keep_last", "keep_all", "unknown"];
const RELIABILITY: &[&str] = &[
    "system_default",
    "reliable",
    "best_effort",
    "unknown",
    "best_available",
];
const DURABILITY: &[&str] = &[
    "system_default",
    "transient_local",
    "volatile",
    "unknown",
    "best_available",
];
const LIVELINESS: &[&str] = &[
    "system_default",
    "automatic",
    "manual_by_node",
    "manual_by_topic",
    "unknown",
];

impl QosProfile {
    /// What a topic of that delivery is offered with.
    pub fn for_delivery(delivery: Delivery) -> QosProfile {
        let (depth, reliability, durability) = match delivery {
            Delivery::Stream => (1, "best_effort", "volatile"),
            Delivery::State => (1, "reliable", "transient_local"),
            Delivery::Event => (EVENT_QUEUE as u64, "reliable", "volatile"),
        };
        QosProfile {
            history: "keep_last".to_owned(),
            depth,
            reliability: reliability.to_owned(),
            durability: durability.to_owned(),
            liveliness: "automatic".to_owned(),
        }
    }

    /// The profiles in a channel's `offered_qos_profiles`, whether policies
    /// are given by number (up to version 8) or by name. What cannot be read
    /// is left out: it never keeps a recording from being opened.
    pub fn parse(text: &str) -> Vec<QosProfile> {
        let profiles: Vec<Written> = serde_saphyr::from_str(text).unwrap_or_default();
        profiles.into_iter().map(Written::named).collect()
    }
}

/// The profiles as YAML.
pub(crate) fn to_yaml(profiles: &[QosProfile]) -> String {
    let profile = |own: &QosProfile| {
        let QosProfile {
            history,
            depth,
            reliability,
            durability,
            liveliness,
        } = own;
        format!(
            "- history: {history}\n  depth: {depth}\n  reliability: {reliability}\n  \
             durability: {durability}\n  deadline:{INFINITE}\n  lifespan:{INFINITE}\n  \
             liveliness: {liveliness}\n  liveliness_lease_duration:{INFINITE}\n  \
             avoid_ros_namespace_conventions: false\n"
        )
    };
    profiles.iter().map(profile).collect()
}

/// Every line behind `indent` spaces.
pub(crate) fn indented(text: &str, indent: usize) -> String {
    text.lines()
        .map(|line| format!("{:indent$}{line}\n", ""))
        .collect()
}

/// A profile as found in a file.
#[derive(Deserialize)]
struct Written {
    history: Policy,
    depth: u64,
    reliability: Policy,
    durability: Policy,
    liveliness: Policy,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Policy {
    Code(usize),
    Name(String),
}

impl Policy {
    fn named(self, names: &[&str]) -> String {
        let name = match &self {
            Policy::Code(code) => names.get(*code).copied(),
            Policy::Name(name) => names.iter().find(|known| *known == name).copied(),
        };
        name.unwrap_or("unknown").to_owned()
    }
}

impl Written {
    fn named(self) -> QosProfile {
        QosProfile {
            history: self.history.named(HISTORY),
            depth: self.depth,
            reliability: self.reliability.named(RELIABILITY),
            durability: self.durability.named(DURABILITY),
            liveliness: self.liveliness.named(LIVELINESS),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        for delivery in [Delivery::Stream, Delivery::State, Delivery::Event] {
            let profile = QosProfile::for_delivery(delivery);
            let text = to_yaml(std::slice::from_ref(&profile));
            assert_eq!(QosProfile::parse(&text), [profile]);
        }
    }

    #[test]
    fn the_text_is_rosbag2s() {
        let text = to_yaml(&[QosProfile::for_delivery(Delivery::State)]);
        let expected = "- history: keep_last\n  depth: 1\n  reliability: reliable\n  \
            durability: transient_local\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  \
            lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: automatic\n  \
            liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  \
            avoid_ros_namespace_conventions: false\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn numbers_of_version_8_are_read() {
        let text = "- history: 3\n  depth: 0\n  reliability: 1\n  durability: 2\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false";
        let profiles = QosProfile::parse(text);
        assert_eq!(profiles.len(), 1);
        assert_eq!(profiles[0].history, "unknown");
        assert_eq!(profiles[0].reliability, "reliable");
        assert_eq!(profiles[0].durability, "volatile");
        assert_eq!(profiles[0].liveliness, "automatic");
    }

    #[test]
    fn garbage_is_no_profile() {
        for text in ["", "nothing", "- history: [", "{}", "- 7"] {
            assert_eq!(QosProfile::parse(text), []);
        }
    }
}

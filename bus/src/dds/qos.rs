//! A topic's delivery as ROS 2 quality of service.

use std::time::Duration;

use ferntast_msgs::topics::{Delivery, EVENT_QUEUE};
use ros2_client::{
    QosProfile,
    dds::rustdds::{QosPolicies, policy::ResourceLimits},
    qos::{Durability, History, WhenFull},
};

/// Samples of a state that a writer holds at most.
///
/// RustDDS 0.15.1 keeps of a reliable writer of durability transient local all
/// samples that not every reader has confirmed; without a reader it takes none
/// as confirmed, whatever the depth of the history, and its own limit is 8192
/// samples a topic. So many are enough for readers whose confirmation is on its
/// way.
const MAX_STATES: i32 = 64;

/// What is offered on a topic, with limits that a ROS 2 profile does not have.
pub(super) fn offered(delivery: Delivery) -> QosPolicies {
    let limits = match delivery {
        Delivery::Stream | Delivery::Event => QosPolicies::qos_none(),
        Delivery::State => QosPolicies::builder()
            .resource_limits(ResourceLimits {
                max_samples: MAX_STATES,
                max_instances: 1,
                max_samples_per_instance: MAX_STATES,
            })
            .build(),
    };
    QosPolicies::from(&qos(delivery)).modify_by(&limits)
}

/// How long a reliable writer waits for space before it gives up on a message.
pub(super) const WAIT: WhenFull = WhenFull::Wait(Duration::from_millis(10));

/// What is offered, and, with the reader's own depth, asked for.
pub(super) fn qos(delivery: Delivery) -> QosProfile {
    let base = QosProfile::subscription_default();
    match delivery {
        Delivery::Stream => base
            .reliability_best_effort()
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: 1 }),
        Delivery::State => base
            .reliability_reliable(WAIT)
            .durability(Durability::TransientLocal)
            .history(History::KeepLast { depth: 1 }),
        Delivery::Event => base
            .reliability_reliable(WAIT)
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: EVENT_QUEUE }),
    }
}

/// What a service and its callers have: as services of ROS 2 by default.
pub(crate) fn service_qos() -> QosProfile {
    QosProfile::subscription_default()
        .reliability_reliable(WAIT)
        .history(History::KeepLast { depth: 10 })
}

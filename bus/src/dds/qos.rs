//! A topic's delivery as ROS 2 quality of service.

use std::time::Duration;

use ferntast_msgs::topics::{Delivery, EVENT_QUEUE};
use ros2_client::{
    QosProfile,
    qos::{Durability, History, WhenFull},
};

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

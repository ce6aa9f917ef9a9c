//! A topic's delivery as ROS 2 quality of service.

use std::num::NonZeroUsize;

use ferntast_msgs::topics::{Delivery, EVENT_QUEUE};
use hiroz::qos::{QosDurability, QosHistory, QosProfile, QosReliability};

/// What is offered or asked for; `places` is the depth of history.
pub(super) fn qos(delivery: Delivery, places: usize) -> QosProfile {
    let (reliability, durability) = match delivery {
        Delivery::Stream => (QosReliability::BestEffort, QosDurability::Volatile),
        Delivery::State => (QosReliability::Reliable, QosDurability::TransientLocal),
        Delivery::Event => (QosReliability::Reliable, QosDurability::Volatile),
    };
    QosProfile {
        reliability,
        durability,
        history: QosHistory::KeepLast(NonZeroUsize::new(places).unwrap_or(NonZeroUsize::MIN)),
        ..QosProfile::default()
    }
}

/// Depth of history that a publisher offers.
pub(super) fn places(delivery: Delivery) -> usize {
    match delivery {
        Delivery::Stream | Delivery::State => 1,
        Delivery::Event => EVENT_QUEUE,
    }
}

//! The gateway: carries every topic out to ROS 2, and commands in.
//!
//! It is the only process that touches ROS 2, so that no 1 kHz loop shares a
//! process with DDS or a Zenoh router.

use ferntast_bus::{Bus, DdsBus, DdsConfig, ZenohBus, ZenohConfig, ZenohMode};
use ferntast_msgs::{
    sample::PoseSample,
    topics::{self, Delivery},
};

use super::{
    choice_parameter::ChoiceParameter,
    forwarder::{Carrier, Carry, Stamp},
    forwarding_loop::Relay,
};
use crate::{
    config::{GatewaySection, HandSource, Middleware},
    process::{NodeError, ProcessContext},
};

/// Opens the ROS 2 side.
///
/// # Errors
///
/// A domain out of range, a port that is taken.
pub fn open_ros(section: &GatewaySection) -> Result<Bus, ferntast_bus::OpenError> {
    Ok(match section.middleware {
        Middleware::Dds => Bus::Dds(DdsBus::open(&DdsConfig {
            domain_id: section.domain_id,
            node_name: section.node_name.clone(),
            namespace: "/".to_owned(),
        })?),
        Middleware::Zenoh => Bus::Zenoh(ZenohBus::open(&ZenohConfig {
            mode: ZenohMode::Router {
                listen: section.router_endpoint.clone(),
            },
            domain_id: section.domain_id,
            node_name: section.node_name.clone(),
        })?),
    })
}

/// Topics that come in from ROS 2 and are not sent out.
fn comes_in(topic: &str, crtk: bool) -> bool {
    topic == topics::FOLLOWER_STATE_COMMAND.name
        || topic == topics::LEADER_STATE_COMMAND.name
        || topic == topics::LINK_LAW_COMMAND.name
        || topic == topics::FOLLOWER_FRICTION_COMMAND.name
        || topic == topics::FOLLOWER_SERVO_JP.name
        || topic == topics::LINK_COMMAND.name
        || topic == topics::RECORDER_COMMAND.name
        || (crtk && topic == topics::LEADER_MEASURED_CP.name)
}

/// How a topic goes out to those who watch.
pub fn goes_out(topic: &str, delivery: Delivery, section: &GatewaySection) -> Carry {
    match delivery {
        Delivery::State => Carry::Newest { period_nanos: 0 },
        Delivery::Event => Carry::Every { queue: 64 },
        Delivery::Stream => {
            let rate = if topic.starts_with("/leader/") {
                section.leader_rate
            } else {
                section.stream_rate
            };
            Carry::Newest {
                period_nanos: (1e9 / rate) as i64,
            }
        }
    }
}

/// Runs the gateway until it is told to stop.
///
/// # Errors
///
/// ROS 2 or a topic that cannot be opened.
pub fn run(process: &ProcessContext) -> Result<(), NodeError> {
    let scenario = &process.session.loaded.scenario;
    let section = &scenario.gateway;
    let crtk = scenario.hand.source == HandSource::Crtk;
    let ros = open_ros(section)?;
    let mut carrier = Carrier::default();
    carrier.add_topics(&process.bus, &ros, Stamp::Round, |topic, delivery| {
        if comes_in(topic, crtk) {
            Carry::Not
        } else {
            goes_out(topic, delivery, section)
        }
    })?;
    let every = Carry::Every { queue: 64 };
    let (bus, stamp) = (&process.bus, Stamp::Round);
    for topic in [topics::FOLLOWER_STATE_COMMAND, topics::LEADER_STATE_COMMAND] {
        carrier.add(topic, &ros, bus, stamp, every, |_, _| {})?;
    }
    carrier.add(topics::LINK_LAW_COMMAND, &ros, bus, stamp, every, |_, _| {})?;
    let friction = topics::FOLLOWER_FRICTION_COMMAND;
    carrier.add(friction, &ros, bus, stamp, every, |_, _| {})?;
    carrier.add(
        topics::FOLLOWER_SERVO_JP,
        &ros,
        bus,
        stamp,
        every,
        |_, _| {},
    )?;
    carrier.add(topics::LINK_COMMAND, &ros, bus, stamp, every, |_, _| {})?;
    carrier.add(topics::RECORDER_COMMAND, &ros, bus, stamp, every, |_, _| {})?;
    if crtk {
        carrier.add(
            topics::LEADER_MEASURED_CP,
            &ros,
            bus,
            stamp,
            every,
            // The master tells hands apart by their sender.
            |pose: &mut PoseSample, source| pose.source = source,
        )?;
    }

    let mut parameters = [
        ChoiceParameter::law(process, &ros)?,
        ChoiceParameter::friction(process, &ros)?,
    ];
    let mut relay = Relay::new(process)?;
    relay.begin(carrier);
    process.run(|wake| {
        for parameter in &mut parameters {
            parameter.round(wake.now);
        }
        relay.round(wake.now, wake, |_, _| {})
    });
    Ok(())
}

//! The gateway: carries every topic out to ROS 2, and commands in.
//!
//! It is the only process that touches ROS 2, so that no 1 kHz loop shares a
//! process with DDS or a Zenoh router.

use ferntast_bus::{Bus, DdsBus, DdsConfig, ZenohBus, ZenohConfig, ZenohMode};
use ferntast_msgs::topics::{Authority, Delivery, EVENT_QUEUE, Row, Switch};

use super::{
    choice_parameter::ChoiceParameter,
    forwarder::{Forwarder, Forwarding, Stamp},
    forwarding_loop::ForwardingLoop,
};
use crate::{
    config::{GatewaySection, HandSource, Middleware, Scenario},
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

/// Whether peers on ROS 2 may publish a topic of that authority into a session
/// of that scenario. What comes in does not go out.
pub fn comes_in(authority: Authority, scenario: &Scenario) -> bool {
    match authority {
        Authority::Never => false,
        Authority::Always => true,
        Authority::ByScenario(Switch::ServoJp) => scenario.gateway.servo_jp,
        Authority::ByScenario(Switch::CrtkHand) => scenario.hand.source == HandSource::Crtk,
    }
}

/// How a topic goes out to those who watch.
pub fn goes_out(topic: Row, section: &GatewaySection) -> Forwarding {
    match topic.delivery {
        Delivery::State => Forwarding::Newest { period_nanos: 0 },
        Delivery::Event => Forwarding::Every { queue: EVENT_QUEUE },
        Delivery::Stream => {
            let rate = if topic.name.starts_with("/leader/") {
                section.leader_rate
            } else {
                section.stream_rate
            };
            Forwarding::Newest {
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
    let ros = open_ros(section)?;
    let mut forwarder = Forwarder::default();
    let joints = process.session.joints();
    forwarder.add_topics(
        &process.bus,
        &ros,
        Stamp::Round,
        &joints,
        |topic| match comes_in(topic.authority, scenario) {
            true => Forwarding::Not,
            false => goes_out(topic, section),
        },
    )?;
    forwarder.add_topics(
        &ros,
        &process.bus,
        Stamp::Round,
        &joints,
        |topic| match comes_in(topic.authority, scenario) {
            true => Forwarding::Every { queue: EVENT_QUEUE },
            false => Forwarding::Not,
        },
    )?;

    let mut parameters = [
        ChoiceParameter::law(process, &ros)?,
        ChoiceParameter::friction(process, &ros)?,
    ];
    let mut forwarding = ForwardingLoop::new(process)?;
    forwarding.begin(forwarder);
    process.run(|wake| {
        for parameter in &mut parameters {
            parameter.round(wake.now);
        }
        forwarding.round(wake.now, wake, |_, _| {})
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::{
        Message,
        sample::JointNames,
        topics::{self, Topic, TopicName, Visitor},
    };

    use super::*;

    struct ComesIn<'a>(&'a Scenario, Vec<TopicName>);

    impl Visitor for ComesIn<'_> {
        fn topic<M: Message>(&mut self, topic: Topic<M>) {
            if comes_in(topic.authority, self.0) {
                self.1.push(topic.name);
            }
        }
    }

    fn incoming(scenario: &Scenario) -> Vec<TopicName> {
        let mut visitor = ComesIn(scenario, Vec::new());
        topics::visit(&JointNames::numbered(2), &mut visitor).unwrap();
        visitor.1
    }

    #[test]
    fn joint_positions_come_in_only_where_the_scenario_says_so() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../config/scenarios");
        let text = std::fs::read_to_string(folder.join("rokviss.toml")).unwrap();
        let mut scenario: Scenario = toml::from_str(&text).unwrap();
        scenario.hand.source = HandSource::Scripted;
        let usual = [
            "/follower/state_command",
            "/follower/friction_command",
            "/leader/state_command",
            "/link/law_command",
            "/link/command",
            "/recorder/command",
        ];
        assert_eq!(incoming(&scenario), usual);
        scenario.gateway.servo_jp = true;
        scenario.hand.source = HandSource::Crtk;
        let all = incoming(&scenario);
        assert!(all.contains(&topics::FOLLOWER_SERVO_JP.name));
        assert!(all.contains(&topics::LEADER_MEASURED_CP.name));
        assert_eq!(all.len(), usual.len() + 2);
    }
}

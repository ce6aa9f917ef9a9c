//! The gateway: carries every topic out to ROS 2, and commands in.
//!
//! It is the only process that touches ROS 2, so that no 1 kHz loop shares a
//! process with DDS or a Zenoh router.

use ferntast_bus::{Bus, BusParameters, DdsBus, DdsConfig, ZenohBus, ZenohConfig, ZenohMode};
use ferntast_config::{GatewaySection, HandSource, Middleware, Scenario};
use ferntast_msgs::{
    Time,
    topics::{Authority, Delivery, EVENT_QUEUE, Row, Switch},
};

use super::{
    choice_parameter::ChoiceParameter,
    forwarder::{Forwarder, Forwarding, Stamp},
    forwarding_loop::ForwardingLoop,
    state_services::StateServices,
};
use crate::process::{NodeError, ProcessContext, end_after_a_stop};

/// How often it looks for what is said seldom: states, events, calls of services \[ns\].
const SELDOM_NANOS: i64 = 5_000_000;

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
            namespace: section.namespace.clone(),
        })?),
        Middleware::Zenoh => Bus::Zenoh(ZenohBus::open(&ZenohConfig {
            mode: router(section),
            domain_id: section.domain_id,
            node_name: section.node_name.clone(),
            namespace: section.namespace.clone(),
        })?),
    })
}

fn router(section: &GatewaySection) -> ZenohMode {
    match &section.router_config {
        Some(config) => ZenohMode::RouterOf {
            config: config.clone(),
        },
        None => ZenohMode::Router {
            listen: section.router_endpoint.clone(),
        },
    }
}

/// Says so where whoever reaches the session's router is let in.
fn warn_of_strangers(section: &GatewaySection) -> Result<(), ferntast_bus::OpenError> {
    if section.middleware == Middleware::Zenoh
        && let Some(endpoint) = ZenohBus::unprotected(&router(section))?
    {
        eprintln!(
            "node gateway: whoever reaches the Zenoh router at {endpoint} hears every topic and may pause the arm: it \
             asks for no certificate. --router-config FILE with TLS changes that (docs/who_may_do_what.md)"
        );
    }
    Ok(())
}

/// How a topic of that authority comes in from peers on ROS 2, in a session of that
/// scenario. What comes in does not go out.
pub fn comes_in(authority: Authority, scenario: &Scenario) -> Forwarding {
    let all = Forwarding::Every { queue: EVENT_QUEUE };
    let all_if = |allowed| if allowed { all } else { Forwarding::Not };
    match authority {
        Authority::Never => Forwarding::Not,
        Authority::Commands if scenario.gateway.commands => all,
        Authority::Commands => Forwarding::Stops { queue: EVENT_QUEUE },
        Authority::ByScenario(Switch::ServoJp) => all_if(scenario.gateway.servo_jp),
        Authority::ByScenario(Switch::CrtkHand) => all_if(scenario.hand.source == HandSource::Crtk),
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
    if process.generation == 0 {
        warn_of_strangers(section)?;
    }
    if section.middleware == Middleware::Dds {
        // The event loops of RustDDS 0.15 end when a signal interrupts them, silently, and
        // calls into it may then wait for ever.
        end_after_a_stop(
            "node gateway: it was stopped for a while, which its DDS does not survive",
        )
        .map_err(NodeError::own)?;
    }
    let ros = open_ros(section)?;
    let mut forwarder = Forwarder::default().looking_seldom(SELDOM_NANOS);
    let joints = process.session.joints();
    forwarder.add_topics(
        &process.bus,
        &ros,
        Stamp::Round,
        &joints,
        |topic| match comes_in(topic.authority, scenario) {
            Forwarding::Not => goes_out(topic, section),
            _ => Forwarding::Not,
        },
    )?;
    forwarder.add_topics(&ros, &process.bus, Stamp::Round, &joints, |topic| {
        comes_in(topic.authority, scenario)
    })?;

    let mut parameters = [
        ChoiceParameter::law(process, &ros)?,
        ChoiceParameter::friction(process, &ros)?,
    ];
    let own_parameters = BusParameters::open(&ros)?;
    let mut states = StateServices::open(&process.bus, &ros, section.commands)?;
    let mut forwarding = ForwardingLoop::new(process)?;
    forwarding.begin(forwarder);
    let mut due = Time::INVALID;
    process.run(|wake| {
        if wake.now >= due {
            due = wake.now.plus_nanos(SELDOM_NANOS);
            if let Some(own) = &own_parameters {
                own.answer();
            }
            states.round(wake.now);
            for parameter in &mut parameters {
                parameter.round(wake.now);
            }
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

    struct ComesIn<'a>(&'a Scenario, Vec<(TopicName, Forwarding)>);

    impl Visitor for ComesIn<'_> {
        fn topic<M: Message>(&mut self, topic: Topic<M>) {
            match comes_in(topic.authority, self.0) {
                Forwarding::Not => {}
                how => self.1.push((topic.name, how)),
            }
        }
    }

    fn incoming(scenario: &Scenario) -> Vec<(TopicName, Forwarding)> {
        let mut visitor = ComesIn(scenario, Vec::new());
        topics::visit(&JointNames::numbered(2), &mut visitor).unwrap();
        visitor.1
    }

    #[test]
    fn more_than_a_stop_comes_in_only_where_the_scenario_says_so() {
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
        let (names, how): (Vec<TopicName>, Vec<Forwarding>) =
            incoming(&scenario).into_iter().unzip();
        assert_eq!(names, usual);
        assert!(
            how.iter()
                .all(|own| *own == Forwarding::Stops { queue: EVENT_QUEUE })
        );
        scenario.gateway.commands = true;
        scenario.gateway.servo_jp = true;
        scenario.hand.source = HandSource::Crtk;
        let all = incoming(&scenario);
        let every = Forwarding::Every { queue: EVENT_QUEUE };
        assert!(all.contains(&(topics::FOLLOWER_SERVO_JP.name, every)));
        assert!(all.contains(&(topics::LEADER_MEASURED_CP.name, every)));
        assert!(all.iter().all(|(_, how)| *how == every));
        assert_eq!(all.len(), usual.len() + 2);
    }
}

//! `ferntast interfaces`.

use std::{any::TypeId, process::ExitCode};

use ferntast_config::ARM;
use ferntast_drivers::simulated;
use ferntast_msgs::{
    Message, RosMessage, interface,
    sample::StateCommandSample,
    topics::{self, Authority, Topic, Visitor},
};
use ferntast_nodes::bridge::state_services;
use serde::Serialize;

use super::{Failure, output::print_json};

/// List the topics with their types and whether peers on ROS 2 may publish them, the services that they may call, and
/// the types with hash and schema.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Arm whose joints there are topics of.
    #[arg(long, default_value = "rokviss", value_name = "NAME|FILE",
        help = format!("Arm whose joints there are topics of: a shipped one ({}) or a file", ARM.listed()))]
    arm: String,
}

#[derive(Debug, Serialize)]
struct Listing {
    topics: Vec<TopicLine>,
    services: Vec<ServiceLine>,
    interfaces: Vec<InterfaceLine>,
}

#[derive(Debug, Serialize)]
struct TopicLine {
    name: String,
    r#type: &'static str,
    delivery: String,
    publishers: &'static [&'static str],
    from_ros_2: &'static str,
}

#[derive(Debug, Serialize)]
struct ServiceLine {
    name: String,
    r#type: &'static str,
    from_ros_2: &'static str,
}

/// With what peers may say all that there is to say.
const COMMANDS: &str = "with [gateway] commands = true (--ros-commands)";

/// Whether peers on ROS 2 may publish a topic into a session.
fn from_ros_2<M: Message>(authority: Authority) -> &'static str {
    match authority {
        Authority::Never => "never",
        // Words that stop a device are heard of everybody.
        Authority::Commands if TypeId::of::<M>() == TypeId::of::<StateCommandSample>() => {
            "pause and disable; all with [gateway] commands = true (--ros-commands)"
        }
        Authority::Commands => COMMANDS,
        Authority::ByScenario(switch) => switch.setting(),
    }
}

/// The services by which peers on ROS 2 set operating states.
fn services() -> Vec<ServiceLine> {
    let line = |(name, open): (String, bool)| ServiceLine {
        name,
        r#type: "std_srvs/srv/Trigger",
        from_ros_2: if open { "always" } else { COMMANDS },
    };
    state_services::offered().into_iter().map(line).collect()
}

#[derive(Debug, Serialize)]
struct InterfaceLine {
    name: String,
    hash: String,
    schema: String,
}

struct List(Vec<TopicLine>);

impl Visitor for List {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        self.0.push(TopicLine {
            name: topic.name.into(),
            r#type: M::Ros::INTERFACE,
            delivery: format!("{:?}", topic.delivery).to_lowercase(),
            publishers: topic.publishers,
            from_ros_2: from_ros_2::<M>(topic.authority),
        });
    }
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let arm = simulated::load_arm(&arguments.arm).map_err(Failure::refused)?;
    let mut list = List(Vec::new());
    topics::visit(&arm.model.joint_names(), &mut list).map_err(Failure::refused)?;
    let mut interfaces = Vec::new();
    for name in interface::names() {
        interfaces.push(InterfaceLine {
            name: name.to_owned(),
            hash: interface::type_hash(name).map_err(Failure::failed)?,
            schema: interface::schema(name).map_err(Failure::failed)?,
        });
    }
    let listing = Listing {
        topics: list.0,
        services: services(),
        interfaces,
    };
    if json {
        print_json(&listing)?;
        return Ok(ExitCode::SUCCESS);
    }
    for topic in &listing.topics {
        let TopicLine {
            name,
            r#type,
            delivery,
            from_ros_2,
            ..
        } = topic;
        println!("{name:34} {type:36} {delivery:8} from ROS 2: {from_ros_2}");
    }
    println!();
    for ServiceLine {
        name,
        r#type,
        from_ros_2,
    } in &listing.services
    {
        println!("{name:34} {type:36} service  from ROS 2: {from_ros_2}");
    }
    println!();
    for interface in &listing.interfaces {
        println!("{:36} {}", interface.name, interface.hash);
    }
    Ok(ExitCode::SUCCESS)
}

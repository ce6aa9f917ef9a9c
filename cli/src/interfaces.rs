//! `ferntast interfaces`.

use std::process::ExitCode;

use ferntast_drivers::simulated;
use ferntast_msgs::{
    Message, RosMessage, interface,
    topics::{self, Authority, Topic, Visitor},
};
use serde::Serialize;

use super::{Failure, output::print_json};

/// List the topics with their types and whether peers on ROS 2 may publish them, and the types with hash and schema.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Arm whose joints there are topics of: a shipped one (rokviss) or a file.
    #[arg(long, default_value = "rokviss", value_name = "NAME|FILE")]
    arm: String,
}

#[derive(Debug, Serialize)]
struct Listing {
    topics: Vec<TopicLine>,
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

/// Whether peers on ROS 2 may publish a topic into a session.
fn from_ros_2(authority: Authority) -> &'static str {
    match authority {
        Authority::Never => "never",
        Authority::Commands => "stops; all with [gateway] commands = true",
        Authority::ByScenario(switch) => switch.setting(),
    }
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
            from_ros_2: from_ros_2(topic.authority),
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
    for interface in &listing.interfaces {
        println!("{:36} {}", interface.name, interface.hash);
    }
    Ok(ExitCode::SUCCESS)
}

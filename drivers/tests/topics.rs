//! The table of topics against the ports of the nodes: who publishes what.

use ferntast_msgs::{
    Message,
    sample::JointNames,
    topics::{self, Row, Topic, Visitor},
};
use ferntast_nodes::{graph::Make, session_graph};

/// Who publishes and is no node of the graph.
const NO_NODES: [&str; 2] = ["command_line", "every"];

#[derive(Default)]
struct Table(Vec<Row>);

impl Visitor for Table {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        self.0.push(topic.row());
    }
}

#[test]
fn the_publishers_in_the_table_are_those_of_the_graph() {
    let joints = JointNames::new(["shoulder", "elbow", "wrist"]).unwrap();
    let mut table = Table::default();
    topics::visit(&joints, &mut table).unwrap();
    let graph = session_graph(ferntast_drivers::rows());
    for node in graph.rows() {
        // A service goes by the table itself.
        let Make::Step { .. } = node.make else {
            continue;
        };
        let name = node.name;
        let published = node.outputs(&joints).unwrap();
        for row in &table.0 {
            let (topic, said) = (row.name, row.publishers.contains(&name));
            let done = published.contains(&topic);
            assert_eq!(
                said, done,
                "{topic} from {name}: in the table, by the ports"
            );
        }
        let taken = node.inputs(&joints).unwrap();
        for topic in published.iter().chain(&taken) {
            let known = table.0.iter().any(|row| row.name == *topic);
            assert!(known, "{topic} of {name} is not in the table");
        }
    }
    for row in &table.0 {
        for name in row.publishers {
            let known = NO_NODES.contains(name) || graph.row(name).is_ok();
            assert!(known, "{}: no node {name}", row.name);
        }
    }
}

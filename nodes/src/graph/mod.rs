//! The graph of nodes: a table with a row a node, and what makes a running
//! node of a row.

mod build;
pub mod process;
mod row;

pub use build::{Build, OpenLink};
pub use row::{Make, NodeRow, STEP_NANOS, TopicNames, When, always, never};

/// The nodes that there are, in the order in which a session stops them.
#[derive(Clone, Debug)]
pub struct Graph {
    rows: Vec<NodeRow>,
}

/// A name that no node has.
#[derive(Debug, thiserror::Error)]
#[error("no node {name:?}; there are: {known}")]
pub struct UnknownNode {
    name: String,
    known: String,
}

impl Graph {
    /// A graph of these rows.
    pub fn new(rows: Vec<NodeRow>) -> Graph {
        Graph { rows }
    }

    /// Every row.
    pub fn rows(&self) -> impl Iterator<Item = &NodeRow> {
        self.rows.iter()
    }

    /// The row of that name.
    ///
    /// # Errors
    ///
    /// No node has it.
    pub fn row(&self, name: &str) -> Result<&NodeRow, UnknownNode> {
        let row = self.rows().find(|row| row.name == name);
        row.ok_or_else(|| {
            let known: Vec<&str> = self.rows().map(|row| row.name).collect();
            UnknownNode {
                name: name.to_owned(),
                known: known.join(", "),
            }
        })
    }
}

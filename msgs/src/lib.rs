//! The messages of ferntast.
//!
//! Two forms of every message stand side by side:
//!
//! * the **sample** ([`sample`]): `repr(C)`, fixed size, no pointers. Nodes
//!   read and write samples; they cross shared memory as they are;
//! * the **ROS 2 form** ([`ros`]): the standard type that a stock ROS 2 knows,
//!   with strings and sequences. It exists on DDS, on Zenoh and in recordings.
//!
//! [`Message`] ties the two together. A message of ferntast's own is declared
//! once (`sample/own.rs`): its sample, ROS 2 form, conversions, checks and
//! `.msg` text come from that, and `msgs/msg/` is written by a test. Names of topics are in [`topics`], the
//! `.msg` texts, schemas and RIHS01 type hashes in [`interface`], messages as bytes in [`cdr`].
//!
//! This folder is at the same time the ROS 2 package `ferntast_msgs`
//! (`package.xml`, `CMakeLists.txt`, `msg/`).

pub mod cdr;
pub mod interface;
mod layout;
mod message;
pub mod ros;
pub mod sample;
mod text;
mod time;
pub mod topics;

pub use layout::Sample;
pub use message::{InvalidMessage, Message, RosMessage};
pub use text::{Text, counted};
pub use time::Time;

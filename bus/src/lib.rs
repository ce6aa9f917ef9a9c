//! How a message gets across: memory, shared memory, ROS 2 over DDS or
//! Zenoh, MCAP, to Foxglove, behind one interface ([`Bus`]).
//!
//! Every way takes and gives the same samples; the ROS 2 form exists only
//! inside the ways that need it. [`frames`] carries the short raw records of
//! the teleoperation link, which have no ROS 2 form.

mod bus;
pub mod dds;
mod endpoint;
mod ends;
pub mod error;
pub mod foxglove;
pub mod frames;
pub mod mcap;
pub mod memory;
mod namespace;
pub mod parameter;
mod raw;
mod raw_topic;
mod sequence_gaps;
pub mod shared_memory;
pub mod trigger;
mod types;
pub mod zenoh_ros;
mod zenoh_words;

pub use self::mcap::McapBus;
pub use bus::{Bus, Publisher, Subscriber};
pub use dds::{DdsBus, DdsConfig};
pub use ends::{Receives, Sends};
pub use error::{CleanUpError, CreateError, OpenError, PublishError, RawPublishError, SendError};
pub use foxglove::{FoxgloveBus, FoxgloveConfig};
pub use memory::MemoryBus;
pub use parameter::{BusParameters, Choice, ParameterNode};
pub use raw::RawPublisher;
pub use raw_topic::RawTopic;
pub use shared_memory::{SharedMemoryBus, SharedMemoryConfig};
pub use trigger::{Call, TriggerService};
pub use types::{Depth, Received, SubscriberCounts};
pub use zenoh_ros::{ZenohBus, ZenohConfig, ZenohMode};

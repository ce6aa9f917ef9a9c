//! Recordings: rosbag2 directories with MCAP inside, no middleware.
//!
//! A recording is a directory `NAME/` with `NAME_0.mcap`, after 128 MiB
//! `NAME_1.mcap` and so on, and `metadata.yaml`, in the form that rosbag2 writes and reads: MCAP profile `ros2`, schemas as
//! `ros2msg`, messages as CDR, `metadata.yaml` of version 9. rosbag2,
//! Foxglove, PlotJuggler and the Python packages `rosbags` and
//! `mcap-ros2-support` open it as it is.
//!
//! * [`BagWriter`] records; what it was given is on disk half a second of log
//!   time later, also when the process is killed,
//! * [`BagReader`] reads any rosbag2 directory or MCAP file, its own or not,
//!   in the order of log time and a chunk at a time,
//! * [`info`] says what a recording holds, [`repair`] restores one that was cut
//!   off; schemas and channels are repeated between chunks, so that a damaged
//!   chunk takes no other along.
//!
//! The `mcap` crate (0.26) parses, unpacks and compares checksums; finding and
//! ordering messages is done here, because its `SummaryReader` panics at a
//! short attachment record, and its `IndexedReader` asserts on the content of
//! chunks, asks for ever for one that cannot be unpacked, reads no messages
//! outside chunks, compares no checksum and does not say where a message is
//! (`bag/tests/garbage.rs` has such files).
//!
//! The same messages give the same bytes: nothing in a recording comes from a
//! clock, from chance or from the order of a hash table.

mod block;
mod chunk_search;
mod copy;
mod cursor;
mod definitions;
mod directory;
mod error;
mod file_writer;
mod full_files;
mod info;
mod layout;
mod messages;
mod metadata;
mod opening;
mod options;
mod qos;
mod reader;
mod repair;
mod rosbag2_record;
mod scan;
mod sink;
mod text;
mod topic;
mod write_behind;
mod writer;

pub use directory::bag_files;
pub use error::{
    CreateBagError, FinishBagError, InfoError, OpenBagError, ReadMessageError, RepairError,
    SelectTopicError, WriteBagError,
};
pub use info::{BagInfo, Break, FileInfo, Gap, TopicInfo, info};
pub use messages::{Messages, Place, RawMessage, RawMessages, TypedMessage};
pub use options::{BagOptions, BagSummary, ChunkCompression, TopicCount};
pub use qos::QosProfile;
pub use reader::BagReader;
pub use repair::{RepairReport, RepairedFile, repair};
pub use topic::BagTopic;
pub use writer::{BagWriter, ChannelId};

//! Messages of types that we do not know, as bytes, to ROS 2: what other people's recordings
//! hold.

use ferntast_msgs::cdr;

use crate::{
    bus::Bus,
    dds::RawDdsPublisher,
    error::{CreateError, RawPublishError},
    raw_topic::RawTopic,
    zenoh_ros::RawZenohPublisher,
};

/// Longest message that is sent: a picture of full HD and some more.
const MAX_LENGTH: usize = 16 * 1024 * 1024;

/// Sends bytes on one topic.
pub enum RawPublisher {
    /// ROS 2 over DDS.
    Dds(Box<RawDdsPublisher>),
    /// ROS 2 over Zenoh.
    Zenoh(Box<RawZenohPublisher>),
}

impl RawPublisher {
    /// Publishes `bytes`: a message in CDR with its header. Allocates, and may wait on
    /// reliable topics: not for the control path.
    ///
    /// # Errors
    ///
    /// [`RawPublishError`]; the publisher stays usable.
    pub fn publish(&mut self, bytes: &[u8]) -> Result<(), RawPublishError> {
        if bytes.len() > MAX_LENGTH {
            return Err(RawPublishError::TooLong {
                length: bytes.len(),
                limit: MAX_LENGTH,
            });
        }
        if !cdr::is_little_endian(bytes) {
            return Err(RawPublishError::Encoding);
        }
        match self {
            RawPublisher::Dds(publisher) => publisher.publish(bytes),
            RawPublisher::Zenoh(publisher) => publisher.publish(bytes),
        }
    }
}

impl Bus {
    /// A publisher of bytes on `topic`, whatever its type.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`]: a name or type that ROS 2 does not take, over Zenoh one
    /// without a hash; a bus that is not ROS 2.
    pub fn raw_publisher(&self, topic: &RawTopic) -> Result<RawPublisher, CreateError> {
        match self {
            Bus::Dds(bus) => {
                let publisher = bus.raw_publisher(topic)?;
                Ok(RawPublisher::Dds(Box::new(publisher)))
            }
            Bus::Zenoh(bus) => {
                let publisher = bus.raw_publisher(topic)?;
                Ok(RawPublisher::Zenoh(Box::new(publisher)))
            }
            Bus::Memory(_) | Bus::SharedMemory(_) | Bus::Mcap(_) | Bus::Foxglove(_) => Err(topic
                .refused(
                    "this bus",
                    "it carries the topics of the table only".to_owned(),
                )),
        }
    }
}

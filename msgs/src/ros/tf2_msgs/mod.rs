//! `tf2_msgs`.

mod tf_message;

pub use tf_message::TFMessage;

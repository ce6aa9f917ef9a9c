//! Recordings as a way across like the others: publish into one, subscribe to one.

mod bus;
mod publisher;
mod shared;
mod subscriber;

pub use bus::McapBus;
pub use publisher::McapPublisher;
pub use subscriber::McapSubscriber;

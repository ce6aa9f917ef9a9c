//! What stands in for a person and for a bad link in a live session, seeded:
//! the hand that moves the master, the channel that delays and loses frames.

pub mod channel;
pub mod hand;
pub mod random;

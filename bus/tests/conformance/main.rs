//! One suite of cases, run on each of the five ways across.

#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod cases;
mod every_topic;
mod frames;
mod garbage;
mod opening;
mod recording;
mod shared_memory;
mod world;

use world::{Way, World};

macro_rules! suite {
    ($($way:ident: $variant:ident;)*) => {$(
        mod $way {
            use super::*;

            #[test]
            fn what_is_published_arrives_in_order() {
                cases::delivery(&World::new(Way::$variant));
            }

            #[test]
            fn the_newest_wins() {
                cases::newest_wins(&World::new(Way::$variant));
            }

            #[test]
            fn a_full_queue_drops_the_oldest() {
                cases::full_queue(&World::new(Way::$variant));
            }

            #[test]
            fn a_late_joiner_of_a_stream_gets_the_next() {
                cases::late_joiner_of_a_stream(&World::new(Way::$variant));
            }

            #[test]
            fn a_late_joiner_of_a_state_gets_the_last() {
                cases::late_joiner_of_a_state(&World::new(Way::$variant));
            }

            #[test]
            fn a_publisher_may_start_anew() {
                cases::publisher_restart(&World::new(Way::$variant));
            }

            #[test]
            fn two_publishers_share_a_topic() {
                cases::two_publishers(&World::new(Way::$variant));
            }

            #[test]
            fn a_wrong_type_is_refused() {
                cases::wrong_type(&World::new(Way::$variant));
            }

            #[test]
            fn what_check_refuses_is_never_handed_out() {
                cases::invalid(&World::new(Way::$variant));
            }

            #[test]
            fn garbage_and_oversized_bytes_are_refused() {
                garbage::garbage(&World::new(Way::$variant));
            }
        }
    )*};
}

suite! {
    memory: Memory;
    shared_memory_bus: SharedMemory;
    dds: Dds;
    zenoh: Zenoh;
    mcap: Mcap;
}

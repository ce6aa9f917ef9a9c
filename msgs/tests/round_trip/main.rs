//! Samples to ROS 2 and back, and everything that may come from outside.

mod declared;
mod messages;
mod outside;
mod samples;

use ferntast_msgs::{
    InvalidMessage, Message, Time,
    sample::*,
    topics::{self, Topic, Visitor},
};
use proptest::prelude::*;

/// Equality bit for bit: NaN stands for "not measured", and is equal to itself.
fn bytes<M: Message>(sample: &M) -> Vec<u8> {
    let data = std::ptr::from_ref(sample).cast::<u8>();
    // SAFETY: the samples have no padding (asserted where they are defined),
    // so every byte of one is set.
    unsafe { std::slice::from_raw_parts(data, size_of::<M>()) }.to_vec()
}

/// A sample of any bytes, as shared memory may hold it.
fn from_bytes<M: Message>(bytes: &[u8]) -> M {
    assert!(bytes.len() >= size_of::<M>());
    // SAFETY: long enough, and every bit pattern is a value of a message.
    unsafe { bytes.as_ptr().cast::<M>().read_unaligned() }
}

fn there_and_back<M: Message>(sample: M) -> Result<(), TestCaseError> {
    prop_assert_eq!(sample.check(), Ok(()));
    let back = M::from_ros(&sample.to_ros());
    prop_assert_eq!(
        back.as_ref().map(bytes),
        Ok(bytes(&sample)),
        "{:?} came back as {:?}",
        sample,
        back
    );
    Ok(())
}

/// Holds, prints, checks and converts it; what passes the check passes the way there and back.
fn any_bits<M: Message>(bits: &[u8]) -> Result<(), TestCaseError> {
    let sample = from_bytes::<M>(bits);
    let _ = format!("{sample:?}");
    let back = M::from_ros(&sample.to_ros());
    if sample.check().is_ok() {
        prop_assert!(back.is_ok(), "{:?} of {:?}", back, sample);
    } else if sample.stamp().is_valid() && sample.stamp().fits_ros() {
        // A flag of 2 becomes true, an unknown fault bit is dropped, and a
        // quantity that is not given is not sent; nothing else that is wrong
        // may heal on the way.
        let heals = matches!(sample.check(), Err(InvalidMessage::Unknown { .. }));
        if !heals && let Ok(healed) = &back {
            prop_assert_eq!(healed.to_ros(), sample.to_ros());
        }
    }
    Ok(())
}

/// Whatever comes in: an error, or a sample that passes the check.
fn from_outside<M: Message>(ros: &M::Ros) -> Result<(), TestCaseError> {
    if let Ok(sample) = M::from_ros(ros) {
        prop_assert_eq!(sample.check(), Ok(()));
    }
    Ok(())
}

macro_rules! properties {
    ($($name:ident: $sample:ty;)*) => {
        proptest! {
            $(#[test]
            fn $name(
                sample in samples::$name(),
                outside in messages::$name(),
                bits in prop::collection::vec(any::<u8>(), size_of::<$sample>()),
            ) {
                there_and_back(sample)?;
                from_outside::<$sample>(&outside)?;
                any_bits::<$sample>(&bits)?;
                // Bits with a stamp that is one get further.
                let mut bits = bits;
                bits[..8].copy_from_slice(&1_700_000_000_000_000_000_i64.to_ne_bytes());
                any_bits::<$sample>(&bits)?;
            })*
        }
    };
}

properties! {
    health: HealthSample;
    joint: JointSample;
    pose: PoseSample;
    robot_description: RobotDescriptionSample;
    transforms: TransformsSample;
    wrench: WrenchSample;
}

proptest! {
    #[test]
    fn a_stamp_reads_back(nanos in any::<i64>()) {
        let time = Time::from_nanos(nanos);
        let back = Time::from_ros(time.ros_sec(), time.ros_nanosec());
        prop_assert_eq!(back == time, time.fits_ros());
    }
}

#[test]
fn every_message_is_tested_one_way_or_the_other() {
    struct ByHand(Vec<&'static str>);
    impl Visitor for ByHand {
        fn topic<M: Message>(&mut self, _: Topic<M>) {
            if M::FIELDS.is_empty() {
                self.0
                    .extend(std::any::type_name::<M>().rsplit("::").next());
            }
        }
    }
    let mut by_hand = ByHand(Vec::new());
    topics::visit(&JointNames::numbered(1), &mut by_hand).unwrap();
    by_hand.0.sort_unstable();
    by_hand.0.dedup();
    // Those of `properties` above.
    let tested = "Health Joint Pose RobotDescription Transforms Wrench";
    let tested: Vec<String> = tested
        .split(' ')
        .map(|name| format!("{name}Sample"))
        .collect();
    assert_eq!(by_hand.0, tested);
}

//! What an end counts comes out as a message.

use ferntast_control::{delay::Law, switching::Laws};
use ferntast_msgs::{Time, sample::LinkEnd};

use super::{FollowerLinkInput, FollowerLinkNode, FollowerLinkOutput, FrameInput};
use crate::node::{Node, Output};

#[test]
fn the_status_says_every_10_ms_what_was_refused() {
    let mut node = FollowerLinkNode::new(Laws::new(Law::default()), 7, 0.0);
    let input = FollowerLinkInput {
        frames: FrameInput::of(&[&[0; 60], &[0; 59]], Time::from_nanos(1)),
        ..FollowerLinkInput::default()
    };
    let mut output = FollowerLinkOutput::default();
    let mut told = Vec::new();
    for tick in 0..21 {
        output.clear();
        let now = Time::from_nanos(1_700_000_000_000_000_000 + tick * 1_000_000);
        node.step(now, &input, &mut output);
        told.extend(output.status);
    }
    assert_eq!(told.len(), 3);
    let last = told[2];
    assert_eq!((last.refused_checksum, last.refused_length), (21, 21));
    assert_eq!(
        (last.end, last.session, last.connected),
        (LinkEnd::FOLLOWER, 7, 0)
    );
    assert_eq!(last.law.as_str(), Law::default().name());
    assert_eq!(output.health.refused, 42);
}

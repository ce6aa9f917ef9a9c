//! Something of each joint.

use std::ops::{Deref, DerefMut};

use ferntast_msgs::sample::MAX_JOINTS;

/// Something of each joint, by the joint's place in the arm; it has room for as
/// many as an arm can have, and reads as a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PerJoint<T>([T; MAX_JOINTS]);

impl<T> Deref for PerJoint<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T> DerefMut for PerJoint<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

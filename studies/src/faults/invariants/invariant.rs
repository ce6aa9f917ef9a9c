//! What an invariant is.

use super::super::{facts::Facts, log::Log, seen::Seen};

/// Something that holds whatever goes wrong, checked at every step.
pub trait Invariant {
    /// Its name.
    fn name(&self) -> &'static str;

    /// Looks at a step; tells what is violated.
    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String>;
}

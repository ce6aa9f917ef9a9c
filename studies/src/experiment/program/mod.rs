//! Motions of the identification experiments: what the servo is told to do.

mod contact;
mod sine;
mod spring;
mod stiffness;

pub use contact::{ContactMotion, Press};
pub use sine::SineMotion;
pub use spring::{SpringMotion, Stroke};
pub use stiffness::StiffnessMotion;

use ferntast_sim::arm::JOINTS;

/// Where the servo is told to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Joint positions \[rad\], on `servo_jp`.
    Joints([f64; JOINTS]),
    /// Tip \[m\], base frame, on `servo_cp`.
    Tip([f64; 2]),
}

/// What a motion may look at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// F_N as estimated \[N\]; zero without contact.
    pub normal_force: f64,
}

/// Goes on from piece `current` to the one in which `time` \[s\] lies; the last
/// one is never left. `starts` tells when a piece begins \[s\].
fn advance<P>(pieces: &[P], current: &mut usize, time: f64, starts: impl Fn(&P) -> f64) {
    while let Some(next) = pieces.get(*current + 1)
        && starts(next) <= time
    {
        *current += 1;
    }
}

/// A motion: targets over time.
pub trait Program: Send {
    /// How long it takes \[s\].
    fn duration(&self) -> f64;

    /// The target `time` \[s\] after its begin, `dt` \[s\] after the one before.
    /// Before its begin `time` is zero: the arm goes to where the motion starts.
    fn target(&mut self, time: f64, dt: f64, seen: &Seen) -> Target;
}

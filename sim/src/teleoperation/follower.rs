//! What is between the link's tip command and the surface.

use ferntast_control::link::FollowerReadings;

/// Where the tip is to be, base frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipCommand {
    /// When it counts as made [ns].
    pub made_ns: i64,
    /// [m]
    pub position: [f64; 3],
}

/// What is true of the tip, from the surface's origin on: along x and y.
#[derive(Clone, Copy, Debug)]
pub struct TrueTip {
    /// \[m\]
    pub position: [f64; 2],
    /// Of the contact on it \[N\].
    pub force: [f64; 2],
    /// Of the contact on it since the start, in all directions \[J\].
    pub work: f64,
}

/// A follower with what it touches.
pub(super) trait Follower {
    /// Moves on by a tick to `now_ns`; the surface began to move `since` [s] ago. A command
    /// holds until there is another one.
    fn step(&mut self, now_ns: i64, since: f64, command: Option<TipCommand>);
    /// What is true now.
    fn truth(&self) -> TrueTip;
    /// What the link's end is told, base frame.
    fn readings(&self) -> FollowerReadings;
}

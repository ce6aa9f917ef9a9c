//! The arm holds in time.

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// From the last valid frame to the end of commanded motion \[steps\].
pub const HOLD: i64 = 30;
/// Setpoints slower than this do not move \[rad/s\].
const STILL: f64 = 1e-9;
/// A servo that was held up is patient for so long \[steps\].
const PATIENCE: i64 = 6;

/// 30 ms after the last frame by which the arm may move has arrived, no motion is
/// commanded. A frame is such a one if it is genuine and undamaged and was sent
/// while the master was enabled or had died no more than 4 ms ago, the hand was heard of
/// within 25 ms, and frames came back within 30 ms. Time that frames wait to be played out is added, and
/// what the page's sliders ask for.
#[derive(Default)]
pub struct HoldInTime;

impl Invariant for HoldInTime {
    fn name(&self) -> &'static str {
        "hold_in_time"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let (_, velocity) = seen.setpoint?;
        let moves = velocity.iter().any(|speed| speed.abs() > STILL);
        if !moves || !seen.follower.enabled() || seen.tick - seen.arm_side_stalled <= PATIENCE {
            return None;
        }
        let allowed = HOLD + facts.buffer + log.channel_delay;
        let since = seen.tick - seen.forth.valid.unwrap_or(0);
        (since > allowed).then(|| {
            let any = seen.tick - seen.forth.genuine.unwrap_or(0);
            format!(
                "the setpoint moves at {velocity:.4?} rad/s {since} ms after the last valid frame \
                 ({any} ms after the last one of the other end; {allowed} ms are allowed)"
            )
        })
    }
}

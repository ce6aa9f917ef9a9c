//! Arming again by itself after a short gap in the link, where a scenario allows it.
//!
//! Only the link may have been away: the same two processes talk under the same
//! keys, the operator's device was and is ENABLED, and the arm was ENABLED when the
//! gap began. That it paused for silent commands and for nothing else the servo
//! checks ([`StateCommand::ResumeAfterGap`](crate::operating::StateCommand)). The way
//! back is the servo's ramp.

use crate::nanoseconds;
use crate::operating::OperatingState;

/// Frames flow while the newest is not older than this \[s\]: less than what pauses
/// the arm.
const FLOW: f64 = 0.010;
/// Frames must have flowed again for this long \[s\].
const STEADY: f64 = 0.050;

/// What the arm's end sees of the link at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flow {
    /// Time since the newest frame \[s\].
    pub silence: f64,
    /// The operator's end asks to hold.
    pub hold: bool,
    /// State of the operator's device.
    pub operator: OperatingState,
    /// State of the arm.
    pub arm: OperatingState,
}

/// Watches gaps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GapWatch {
    /// Gaps as long as this are bridged \[ns\]; zero: none.
    longest_ns: i64,
    gap_since_ns: Option<i64>,
    flowing_since_ns: Option<i64>,
    /// Both devices were ENABLED when the gap began.
    was_enabled: bool,
}

impl GapWatch {
    /// Bridges gaps of up to `longest` \[s\].
    pub fn new(longest: f64) -> GapWatch {
        GapWatch {
            longest_ns: nanoseconds(longest),
            ..GapWatch::default()
        }
    }

    /// Another process is at the other end: there is nothing to go on with.
    pub fn restart(&mut self) {
        self.gap_since_ns = None;
        self.flowing_since_ns = None;
    }

    /// Whether the arm is to go on after a gap.
    pub fn step(&mut self, now_ns: i64, flow: &Flow) -> bool {
        if self.longest_ns == 0 {
            return false;
        }
        if flow.operator != OperatingState::Enabled {
            self.restart();
            return false;
        }
        if flow.hold || flow.silence > FLOW {
            self.flowing_since_ns = None;
            if self.gap_since_ns.is_none() {
                let silence_ns = nanoseconds(flow.silence.min(FLOW));
                self.gap_since_ns = Some(now_ns.saturating_sub(silence_ns));
                self.was_enabled = flow.arm == OperatingState::Enabled;
            }
            return false;
        }
        let Some(gap_since_ns) = self.gap_since_ns else {
            return false;
        };
        let flowing_since_ns = *self.flowing_since_ns.get_or_insert(now_ns);
        if now_ns.saturating_sub(flowing_since_ns) < nanoseconds(STEADY) {
            return false;
        }
        self.restart();
        let gap_ns = flowing_since_ns.saturating_sub(gap_since_ns);
        self.was_enabled && gap_ns <= self.longest_ns && flow.arm == OperatingState::Paused
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use OperatingState::{Disabled, Enabled, Paused};

    const MS: i64 = 1_000_000;

    /// A gap of `gap` \[ms\]; in it the arm pauses.
    fn words(longest: f64, gap: i64, operator: OperatingState, arm: OperatingState) -> usize {
        let mut watch = GapWatch::new(longest);
        let mut words = 0;
        for ms in 0..2000 {
            let in_gap = (100..100 + gap).contains(&ms);
            let silence = if in_gap { (ms - 99) as f64 * 1e-3 } else { 0.0 };
            let flow = Flow {
                silence,
                hold: false,
                operator: if ms < 100 { Enabled } else { operator },
                arm: if ms < 126 { arm } else { Paused },
            };
            words += usize::from(watch.step(ms * MS, &flow));
        }
        words
    }

    #[test]
    fn only_a_short_gap_of_an_enabled_pair_is_bridged() {
        assert_eq!(words(0.5, 300, Enabled, Enabled), 1);
        assert_eq!(words(0.5, 490, Enabled, Enabled), 1);
        assert_eq!(words(0.5, 520, Enabled, Enabled), 0);
        assert_eq!(words(0.0, 300, Enabled, Enabled), 0);
        assert_eq!(words(0.5, 300, Disabled, Enabled), 0);
        assert_eq!(words(0.5, 300, Enabled, Paused), 0);
        assert_eq!(words(0.5, 0, Enabled, Enabled), 0);
    }

    #[test]
    fn another_peer_ends_a_gap() {
        let mut watch = GapWatch::new(0.5);
        let flow = |silence| Flow {
            silence,
            hold: false,
            operator: Enabled,
            arm: Enabled,
        };
        watch.step(0, &flow(0.0));
        watch.step(20 * MS, &flow(0.020));
        watch.restart();
        for ms in 21..200 {
            let paused = Flow {
                arm: Paused,
                ..flow(0.0)
            };
            assert!(!watch.step(ms * MS, &paused));
        }
    }
}

//! An arm that is measured where it cannot be is not driven.

use ferntast_model::Joints;
use ferntast_msgs::Time;

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// Beyond what a joint at its largest speed moves, a measured step is none \[rad\].
const BEYOND: f64 = 0.02;
/// From the measurement to the end of the drive \[steps\].
const IN_TIME: i64 = 3;

/// A joint that is measured elsewhere at once, further than it can have moved since it was
/// measured before, is not driven by that measurement: the servo is in FAULT. How long that was
/// ago its host's clock says: one that jumps in the same moment hides as much of the way.
#[derive(Default)]
pub struct EncoderWatched {
    before: Option<(Joints<f64>, i64, Time)>,
    jumped: Option<i64>,
}

impl EncoderWatched {
    /// Whether a joint is measured where it cannot have got to.
    fn jumps(&mut self, seen: &Seen, facts: &Facts) -> bool {
        // What is measured while the servo does not run it never sees.
        let measured = seen.measured.filter(|_| seen.servo_stepped);
        let Some(measured) = measured.filter(|own| own.iter().all(|q| q.is_finite())) else {
            return false;
        };
        let now = (measured, seen.tick, seen.measured_at);
        let Some((before, tick, at)) = self.before.replace(now) else {
            return false;
        };
        let by_clock = seen.measured_at.seconds_since(at);
        let passed = by_clock.max((seen.tick - tick) as f64 * 1e-3);
        (0..measured.len()).any(|joint| {
            (measured[joint] - before[joint]).abs() > facts.overspeed[joint] * passed + BEYOND
        })
    }
}

impl Invariant for EncoderWatched {
    fn name(&self) -> &'static str {
        "encoder_watched"
    }

    fn step(&mut self, seen: &Seen, _: &Log, facts: &Facts) -> Option<String> {
        let driven = seen.follower.enabled() || seen.follower.paused();
        if self.jumps(seen, facts) && driven {
            self.jumped = Some(seen.tick);
        }
        // Time in which the servo did not run is not counted.
        let running = seen.tick - seen.arm_side_stalled > IN_TIME;
        if !driven || !running {
            self.jumped = self.jumped.filter(|_| driven);
            return None;
        }
        let jumped = self.jumped?;
        (seen.tick - jumped > IN_TIME).then(|| {
            format!(
                "the arm is driven {} ms after a joint was measured where it cannot have got to",
                seen.tick - jumped
            )
        })
    }
}

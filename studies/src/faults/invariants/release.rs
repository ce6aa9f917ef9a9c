//! What the operator does not feel is let go of.

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
    hold::HOLD,
};

/// From the silence of the return link to the release \[steps\].
const RELEASE: i64 = 200;
/// What may be left of the force then \[N\].
const LEFT: f64 = 5.0;

/// When frames do not come back, the arm presses with 5 N at most 200 ms after the
/// operator's end can have said so, as long as its servo runs and no torque sensor is wrong.
#[derive(Default)]
pub struct Release {
    /// Since when the arm's end has been told nothing but to hold \[step\].
    silent: Option<i64>,
    /// A sensor was wrong in that time: by that the arm gave way, once, and wrongly.
    misled: bool,
}

impl Invariant for Release {
    fn name(&self) -> &'static str {
        "release"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let last = seen.back.genuine.unwrap_or(0);
        let silent = seen.tick - last > HOLD && seen.leader.enabled();
        let heard = seen.forth.genuine.is_some_and(|at| seen.tick - at <= HOLD);
        if !(silent && heard && seen.servo_stepped && seen.follower.enabled()) {
            self.silent = None;
            self.misled = false;
            return None;
        }
        self.misled |= seen.tick <= log.sensor_wrong;
        let since = *self.silent.get_or_insert(seen.tick);
        let force = seen.truth.pressing();
        let length = seen.tick - since;
        // What is said goes there by the way forth, which is no longer than this.
        let allowed = RELEASE + facts.buffer + log.channel_delay + 100;
        (length > allowed && force > LEFT && !self.misled).then(|| {
            format!("pressing {force:.1} N though the operator has felt nothing for {length} ms")
        })
    }
}

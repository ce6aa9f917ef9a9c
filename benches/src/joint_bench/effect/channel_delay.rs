//! One channel is stamped late: at time t it says what was true at t − d.
//! Proportional to the channel's rate of change.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, about, channel::Channel};

/// Readings kept, one a millisecond: more than the longest delay.
const KEPT: usize = 512;

#[derive(Clone)]
struct ChannelDelay {
    channel: Channel,
    /// d \[s\].
    delay: f64,
    /// The last readings, the newest at `newest`.
    kept: [f64; KEPT],
    newest: usize,
    started: bool,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    // Load and position are smooth: their delay has to be longer to show.
    let (channel, longest) = Channel::draw([0.04, 0.11, 0.1], random);
    Box::new(ChannelDelay {
        channel,
        delay: strength * about(longest, random),
        kept: [0.0; KEPT],
        newest: 0,
        started: false,
    })
}

impl Effect for ChannelDelay {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        let names = ["motor_torque_delay", "joint_torque_delay", "position_delay"];
        let name = self.channel.of(names);
        vec![(name, self.delay, "s")]
    }

    fn reset(&mut self) {
        self.started = false;
    }

    fn read(&mut self, _command: f64, reading: &mut Reading) {
        let value = self.channel.read(reading);
        if !self.started {
            self.kept = [*value; KEPT];
            self.started = true;
        }
        self.newest = (self.newest + 1) % KEPT;
        self.kept[self.newest] = *value;
        let late = (self.delay * 1000.0).min((KEPT - 2) as f64);
        let whole = late.floor();
        let at = |ago: usize| self.kept[(self.newest + KEPT - ago) % KEPT];
        let (newer, older) = (at(whole as usize), at(whole as usize + 1));
        *value = newer + (late - whole) * (older - newer);
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

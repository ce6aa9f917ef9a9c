//! One channel comes from a recorder of its own, whose clock runs fast: what it says at time t of
//! the session was true at t (1 − d). Proportional to the channel's rate of change, and to the time.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, about, channel::Channel};

#[derive(Clone)]
struct ClockDrift {
    channel: Channel,
    /// d \[s/s\].
    drift: f64,
    /// The channel since the session's start, one reading a millisecond.
    read: Vec<f64>,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    // Over a minute as late in the mean square as the channels of `channel_delay`. Load and
    // position are smooth: their drift has to be larger to show.
    let (channel, largest) = Channel::draw([0.001, 0.0027, 0.0025], random);
    Box::new(ClockDrift {
        channel,
        drift: strength * about(largest, random),
        read: Vec::new(),
    })
}

impl Effect for ClockDrift {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        let names = ["motor_torque_drift", "joint_torque_drift", "position_drift"];
        let name = self.channel.of(names);
        vec![(name, self.drift, "s/s")]
    }

    fn reset(&mut self) {
        self.read.clear();
    }

    fn read(&mut self, _command: f64, reading: &mut Reading) {
        let value = self.channel.read(reading);
        self.read.push(*value);
        let place = (self.read.len() - 1) as f64 * (1.0 - self.drift);
        let before = place as usize;
        let at = |place: usize| self.read[place.min(self.read.len() - 1)];
        *value = at(before) + (place - before as f64) * (at(before + 1) - at(before));
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

//! The torque sensor's gain is wrong.
//! Over τ, whatever the direction.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, either_sign};

#[derive(Clone)]
struct TorqueSensorGain {
    /// Reading divided by truth, minus 1 \[-\].
    gain: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(TorqueSensorGain {
        gain: strength * either_sign(0.2, random),
    })
}

impl Effect for TorqueSensorGain {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("gain", self.gain, "-")]
    }

    fn read(&mut self, _command: f64, reading: &mut Reading) {
        reading.joint_torque *= 1.0 + self.gain;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

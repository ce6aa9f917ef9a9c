//! The torque sensor's gain and zero are wrong at once.
//! A line over τ, whatever the direction.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, either_sign};

#[derive(Clone)]
struct TorqueSensorCalibration {
    /// Reading divided by truth, minus 1, but for the offset \[-\].
    gain: f64,
    /// Reading free of load \[Nm\].
    offset: f64,
}

/// Each as large as where it is wrong alone.
pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(TorqueSensorCalibration {
        gain: strength * either_sign(0.2, random),
        offset: strength * either_sign(1.5, random),
    })
}

impl Effect for TorqueSensorCalibration {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("gain", self.gain, "-"), ("offset", self.offset, "Nm")]
    }

    fn read(&mut self, _command: f64, reading: &mut Reading) {
        reading.joint_torque = (1.0 + self.gain) * reading.joint_torque + self.offset;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

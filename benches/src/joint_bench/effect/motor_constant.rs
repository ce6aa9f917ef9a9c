//! Current is turned into motor torque by a wrong motor constant k_m (equation (1)).
//! Proportional to τ_m.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, either_sign};

#[derive(Clone)]
struct MotorConstant {
    /// Reading divided by truth, minus 1 \[-\].
    gain: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(MotorConstant {
        gain: strength * either_sign(0.08, random),
    })
}

impl Effect for MotorConstant {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("gain", self.gain, "-")]
    }

    fn read(&mut self, _command: f64, reading: &mut Reading) {
        reading.motor_torque *= 1.0 + self.gain;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

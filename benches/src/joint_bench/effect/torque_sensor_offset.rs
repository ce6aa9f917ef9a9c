//! The torque sensor's zero is wrong.
//! A constant, whatever the direction.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, either_sign};

#[derive(Clone)]
struct TorqueSensorOffset {
    /// Reading minus truth \[Nm\].
    offset: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(TorqueSensorOffset {
        offset: strength * either_sign(1.5, random),
    })
}

impl Effect for TorqueSensorOffset {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("offset", self.offset, "Nm")]
    }

    fn read(&mut self, _command: f64, reading: &mut Reading) {
        reading.joint_torque += self.offset;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

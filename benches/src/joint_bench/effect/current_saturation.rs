//! Motor torque is clipped at a limit, in one of two places that logs know:
//! the current sensor's range ends and the reading stays at the limit, or the
//! drive's current ends there and the log has what was asked for.
//! Only at the limit.

use ferntast_emulation::random::Random;

use super::{Effect, Reading, about};
use crate::joint_bench::parameters::JointParameters;

#[derive(Clone)]
struct CurrentSaturation {
    /// \[Nm\]
    limit: f64,
    /// True where the motor is clipped and the log has the command.
    in_drive: bool,
}

pub(super) fn draw(strength: f64, joint: &JointParameters, random: &mut Random) -> Box<dyn Effect> {
    // What 40 °/s needs at the end of the standard motion's strokes.
    let peak = about(30.0, random) + 0.4 * joint.spring;
    let in_drive = random.chance(0.5);
    // A motor that is clipped falls behind, so that the log soon asks for far more.
    let depth = if in_drive { 0.1 } else { 0.3 };
    Box::new(CurrentSaturation {
        limit: peak * (1.0 - depth * strength),
        in_drive,
    })
}

impl Effect for CurrentSaturation {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("limit", self.limit, "Nm"),
            ("in_drive", f64::from(u8::from(self.in_drive)), "-"),
        ]
    }

    fn motor_torque(&self, command: f64) -> f64 {
        if self.in_drive {
            command.clamp(-self.limit, self.limit)
        } else {
            command
        }
    }

    fn read(&mut self, command: f64, reading: &mut Reading) {
        reading.motor_torque = if self.in_drive {
            command
        } else {
            reading.motor_torque.clamp(-self.limit, self.limit)
        };
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

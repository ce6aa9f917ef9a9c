//! What is true of the simulated arm, of however many joints.

use ferntast_model::Joints;
use ferntast_sim::{arm, serial_arm};

/// What is true, for judges only.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Positions of the links \[rad\].
    pub position: Joints<f64>,
    /// Positions of the motors \[rad\].
    pub motor_position: Joints<f64>,
    /// Velocities of the motors \[rad/s\].
    pub motor_velocity: Joints<f64>,
    /// Velocity of the tip \[m/s\], base frame.
    pub tip_velocity: [f64; 3],
    /// Contact force on the tip \[N\], base frame.
    pub force: [f64; 3],
}

impl Truth {
    /// How much force that is \[N\].
    pub fn pressing(&self) -> f64 {
        length(self.force)
    }
}

/// Length of a vector; of one in the plane x, y as it is there.
pub fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

impl From<arm::Truth> for Truth {
    fn from(own: arm::Truth) -> Truth {
        let in_space = |[x, y]: [f64; 2]| [x, y, 0.0];
        Truth {
            position: own.position.into(),
            motor_position: own.motor_position.into(),
            motor_velocity: own.motor_velocity.into(),
            tip_velocity: in_space(own.tip_velocity),
            force: in_space(own.force),
        }
    }
}

impl From<serial_arm::Truth> for Truth {
    fn from(own: serial_arm::Truth) -> Truth {
        Truth {
            position: own.position,
            motor_position: own.motor_position,
            motor_velocity: own.motor_velocity,
            tip_velocity: own.tip_velocity.into(),
            force: own.force.into(),
        }
    }
}

//! A channel of the recording, and what it reads.

use ferntast_emulation::random::Random;

use super::Reading;

#[derive(Clone, Copy)]
pub(super) enum Channel {
    MotorTorque,
    JointTorque,
    Position,
}

impl Channel {
    /// Draws one, and the value of `each` for it: motor torque, joint torque, position.
    pub(super) fn draw(each: [f64; 3], random: &mut Random) -> (Channel, f64) {
        let [motor_torque, joint_torque, position] = each;
        match random.uniform() {
            which if which < 0.4 => (Channel::MotorTorque, motor_torque),
            which if which < 0.7 => (Channel::JointTorque, joint_torque),
            _ => (Channel::Position, position),
        }
    }

    /// The one of `each` that is of it.
    pub(super) fn of<T>(self, each: [T; 3]) -> T {
        let [motor_torque, joint_torque, position] = each;
        match self {
            Channel::MotorTorque => motor_torque,
            Channel::JointTorque => joint_torque,
            Channel::Position => position,
        }
    }

    /// What it reads.
    pub(super) fn read(self, reading: &mut Reading) -> &mut f64 {
        self.of([
            &mut reading.motor_torque,
            &mut reading.joint_torque,
            &mut reading.position,
        ])
    }
}

//! What the joints of a serial arm carry of its links: their weight where the arm is, and what
//! the setpoint's motion takes.
//!
//! τ = M(q) q̈_d + C(q, q̇_d) q̇_d + g(q), added to what the joints' laws give: gravity
//! compensation at the measured position is the slope of a potential, so that it adds no
//! energy to what the arm touches; the motion is the setpoint's, so that no noise of a
//! measurement gets in (C. Ott, Cartesian Impedance Control of Redundant and Flexible-Joint
//! Robots, Springer 2008, ch. 4, with motor positions in place of those of the links).
//!
//! An arm that has weight is carried, and damped, while it is disabled or faulty, too: it
//! would fall else. Without a measurement nothing can be carried: then the motors get
//! nothing, and brakes have to hold it.

use super::{JointTuning, Measurement, ServoOutput, Setpoint};
use crate::operating::OperatingState;
use ferntast_model::Joints;
use ferntast_model::rigid_body::Posture;
use ferntast_model::serial_arm::SerialArm;

/// The links with how the joints hold them.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    arm: SerialArm,
    tuning: Joints<JointTuning>,
}

impl Carried {
    pub(super) fn new(arm: &SerialArm, tuning: &Joints<JointTuning>) -> Carried {
        Carried {
            arm: arm.clone(),
            tuning: *tuning,
        }
    }

    /// The arm that it is of.
    pub(super) fn arm(&self) -> &SerialArm {
        &self.arm
    }

    /// The links at `position` \[rad\], and what the joints carry of their weight there \[Nm\].
    pub(super) fn posture(&self, position: &Joints<f64>) -> (Posture, Joints<f64>) {
        let posture = self.arm.chain().posture(position);
        let weight = self.arm.weight_in(&posture);
        (posture, weight)
    }

    /// Where the motors are when the links are at `position` \[rad\], at rest and free: the
    /// gears give way under the weight.
    pub(super) fn motor_positions(&self, position: &Joints<f64>) -> Joints<f64> {
        let (weight, joints) = (self.arm.weight(position), self.arm.joints());
        Joints::from_fn(position.count(), |joint| {
            joints[joint].motor_position(position[joint], weight[joint])
        })
    }

    /// Adds it to the torques of `output`, within the drives' limits, in the posture that is
    /// measured.
    pub(super) fn add(
        &self,
        measured: &Measurement,
        (posture, weight): &(Posture, Joints<f64>),
        setpoint: &Joints<Setpoint>,
        output: &mut ServoOutput,
    ) {
        let driven = match output.state {
            OperatingState::Enabled => self.arm.inverse_dynamics_in(
                posture,
                &setpoint.map(|own| own.velocity),
                &setpoint.map(|own| own.acceleration),
            ),
            OperatingState::Paused => *weight,
            OperatingState::Disabled | OperatingState::Fault => {
                Joints::from_fn(weight.count(), |joint| {
                    weight[joint] - self.tuning[joint].hold_damping * measured.velocity[joint]
                })
            }
        };
        for (joint, torque) in output.torque.iter_mut().enumerate() {
            let wanted = *torque + driven[joint];
            let limit = self.arm.joints()[joint].motor_torque_limit;
            // NaN would pass `clamp`: an undefined torque is no torque.
            *torque = match wanted.is_finite() {
                true => wanted.clamp(-limit, limit),
                false => 0.0,
            };
            output.effort_limited |= *torque != wanted;
        }
    }
}

//! Joint torques from motor currents, with the friction that the servo feeds forward.

use ferntast_control::estimator::{
    EstimatorParameters, MotorMeasurement, TorqueByMotorCurrent, TorqueFromMotor,
};
use ferntast_control::servo::{FoundParameter, TakeOverConfig};
use ferntast_model::friction::name_of_key;
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, ParameterError};
use ferntast_msgs::sample::{
    FrictionSource, FrictionStatusSample, JointSample, MAX_TWIN_PARAMETERS,
};

use super::{EstimatorInput, efforts, positions};

/// Joint torques without torque sensors.
pub(super) struct ByMotors {
    torques: TorqueByMotorCurrent,
}

impl ByMotors {
    pub(super) fn new(
        joints: &[JointParameters],
        parameters: &EstimatorParameters,
        take_over: TakeOverConfig,
    ) -> Result<ByMotors, ParameterError> {
        let torques = TorqueByMotorCurrent::new(joints, parameters, take_over)?;
        Ok(ByMotors { torques })
    }

    /// Believes of friction what the servo does, and of temperatures what is measured.
    pub(super) fn hear(&mut self, input: &EstimatorInput) {
        let joints = input.friction.iter().zip(input.temperature.iter());
        for (joint, (friction, temperature)) in joints.enumerate() {
            let Some(own) = self.torques.friction_mut(joint) else {
                return;
            };
            if let Some(sample) = temperature.message {
                own.set_temperature(sample.temperature);
            }
            let Some(status) = friction.fresh() else {
                continue;
            };
            let taken_over = status.source == FrictionSource::TWIN;
            if !taken_over && own.is_taken_over() {
                own.give_back();
            }
            let target = |name: &str| own.parameters().find(|other| other.name == name);
            let differs = (0..status.len()).any(|i| {
                let own = target(status.names[i].as_str());
                own.is_none_or(|own| own.target != status.targets[i])
            });
            if taken_over && differs {
                // The servo has judged it, by the same bounds.
                let _ = own.take_over(found(status).get(..status.len()).unwrap_or_default());
            }
        }
    }

    /// Torques of so many joints `dt` \[s\] after the last ones.
    pub(super) fn step(
        &mut self,
        dt: f64,
        joints: JointCount,
        measured: Option<&JointSample>,
        motor: Option<&JointSample>,
    ) -> TorqueFromMotor {
        let measurement = MotorMeasurement {
            position: positions(joints, measured),
            torque: efforts(joints, motor),
        };
        self.torques.step(dt, &measurement)
    }
}

/// What the servo is on its way to, as found for certain.
fn found(status: &FrictionStatusSample) -> [FoundParameter<'_>; MAX_TWIN_PARAMETERS] {
    std::array::from_fn(|i| FoundParameter {
        name: name_of_key(status.names[i].as_str()).unwrap_or(status.names[i].as_str()),
        value: status.targets[i],
        std_error: 0.0,
        excitation: 1.0,
    })
}

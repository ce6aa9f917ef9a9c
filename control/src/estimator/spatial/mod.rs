//! Contact forces of a serial arm in three dimensions.
//!
//! Equation (5) gives the torque of the contact in each joint, τ_c = J_vᵀ F, by the same
//! forms and filters as for the planar arm. A contact at the tip makes a force and no
//! moment, so that all joints together tell three numbers: F is what fits their torques best
//! ([`force`]). Where there are six joints or more they tell force and torque of whatever pushes and
//! turns the tool, too, if a force at the tip is not enough ([`wrench`]). Equation (6)'s split is
//! along the believed planes, or, where none is near, along and across the tip's motion ([`split`]).

mod estimate;
mod force;
mod split;
#[cfg(test)]
mod tests;
mod wrench;

pub use estimate::SpatialEstimate;

use super::intake::Intake;
use super::systematic::SensorErrors;
use super::zeroing::Zeroing;
use super::{ContactState, EstimatorParameters, Form, JointMeasurement, TorqueFromMotor};
use ferntast_model::serial_arm::SerialArm;
use ferntast_model::{JointCount, Joints, ParameterError};
use force::TipForce;
use nalgebra::Vector3;
use split::{Motion, Split};
use wrench::Wrench;

/// Estimates contact forces of a serial arm step by step.
#[derive(Clone, Debug)]
pub struct SpatialEstimator {
    arm: SerialArm,
    parameters: EstimatorParameters,
    intake: Intake,
    zeroing: Zeroing,
    /// How much a joint's torque counts \[-\].
    weights: Joints<f64>,
    /// Of the torque sensors \[Nm\].
    ranges: Joints<f64>,
    wrench: Wrench,
    split: Split,
    last: SpatialEstimate,
}

impl SpatialEstimator {
    /// An estimator that believes `arm`.
    ///
    /// # Errors
    ///
    /// The first parameter that is out of bounds.
    pub fn new(arm: &SerialArm, parameters: &EstimatorParameters) -> Result<Self, ParameterError> {
        let (intake, parameters) = Intake::new(arm.joints(), parameters)?;
        let range = |joint: usize| arm.joints()[joint].torque_sensor_range;
        let ranges = Joints::from_fn(intake.joints(), range);
        Ok(Self {
            arm: arm.clone(),
            parameters,
            zeroing: Zeroing::new(ranges),
            weights: force::weights(&ranges),
            ranges,
            wrench: Wrench::default(),
            split: Split::new(arm.surfaces()),
            last: SpatialEstimate::unknown(intake.joints()),
            intake,
        })
    }

    /// How many joints it has measurements of.
    pub fn joints(&self) -> JointCount {
        self.intake.joints()
    }

    /// Takes in a measurement `dt` \[s\] after the last one.
    ///
    /// Never fails: with an unusable measurement or time step it gives what
    /// it gave before, marked as invalid, and after `longest_gap` of that no
    /// forces and no contact any more.
    pub fn step(&mut self, dt: f64, measurement: &JointMeasurement) -> SpatialEstimate {
        self.step_with(dt, measurement, false)
    }

    /// The same with joint torques by motor currents. While a joint rests or turns its
    /// torque is not determined, and what is told counts as near rest.
    pub fn step_by_motors(&mut self, dt: f64, torque: &TorqueFromMotor) -> SpatialEstimate {
        let undetermined = torque.undetermined.contains(&true);
        self.step_with(dt, &torque.measurement, undetermined)
    }

    fn step_with(
        &mut self,
        dt: f64,
        measurement: &JointMeasurement,
        undetermined: bool,
    ) -> SpatialEstimate {
        let Some(taken) = self.intake.step(&self.arm, dt, measurement) else {
            return self.without_input();
        };
        let motion = &taken.motion;
        let zero = self.zeroing.zero();
        let torque = Joints::from_fn(zero.count(), |joint| {
            motion.contact_torque[joint] - zero[joint]
        });
        let jacobian = self.arm.chain().jacobian(&motion.position);
        let singularity = self.parameters.singularity;
        let solver = TipForce::new(&jacobian, &self.weights, singularity);
        let force = solver.force(&torque);
        // By motor currents no torque is told: what is not known of friction would be one.
        let whole = (self.parameters.form != Form::MotorCurrent)
            .then(|| wrench::whole(&jacobian, &self.weights, singularity, &torque))
            .flatten();
        let wrench = self
            .wrench
            .step(taken.passed, &torque, &self.ranges, &solver, whole);
        let tip = self.arm.chain().forward(&taken.link);
        let velocity = force::velocity(&jacobian, &motion.velocity);

        let mut estimate = SpatialEstimate {
            position: taken.link,
            velocity: motion.velocity,
            tip: tip.translation.into(),
            orientation: tip.quaternion(),
            tip_velocity: velocity.into(),
            force: force.into(),
            wrench,
            state: ContactState {
                valid: !solver.is_singular() && !taken.sensors.saturated && taken.settled,
                singular: solver.is_singular(),
                saturated: taken.sensors.saturated,
                stuck: taken.sensors.stuck,
                ..self.last.state.without_contact()
            },
            ..SpatialEstimate::unknown(self.joints())
        };
        if estimate.state.valid {
            let free = self.split.is_free(&self.parameters, &tip.translation);
            let with_zero = &motion.contact_torque;
            self.zeroing.learn(
                &self.parameters,
                taken.passed,
                free,
                with_zero,
                force.norm(),
            );
        }
        let uncertainty = &self.parameters.uncertainty;
        let (zeroing, alike) = (&self.zeroing, self.intake.alike());
        let errors = || {
            let zeros = zeroing.standard_error(alike, uncertainty.torque_zero);
            let alone = |joint: usize, error: f64| solver.of_joint(joint, error);
            let none = Vector3::zeros();
            SensorErrors::new(&torque, &zeros, uncertainty.torque_gain, none, alone)
        };
        let motion = Motion {
            tip: tip.translation,
            errors: &errors,
            velocity,
            present_velocity: force::velocity(&jacobian, &motion.present_velocity),
            delay: self.intake.delay(),
            undetermined,
        };
        self.split.step(
            &self.parameters,
            &self.last,
            taken.passed,
            &motion,
            &force,
            &mut estimate,
        );
        self.last = estimate;
        estimate
    }

    /// The estimate where there is no measurement.
    fn without_input(&mut self) -> SpatialEstimate {
        if self.intake.is_lost() {
            self.last = SpatialEstimate {
                position: self.last.position,
                tip: self.last.tip,
                orientation: self.last.orientation,
                state: self.last.state.without_contact(),
                ..SpatialEstimate::unknown(self.joints())
            };
        }
        self.last.state.input_invalid = true;
        self.last.state.valid = false;
        self.last
    }
}

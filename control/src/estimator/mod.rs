//! Contact forces from joint torques: equations (5) and (6).
//!
//! The torque sensors sit behind the gears, so gear friction does not get
//! into the estimate. The link-side position is q = θ − τ/K, since the motor
//! already turns while the tip still rests (Fig. 16); all channels go through
//! the same causal filter; then equation (5) gives the contact's torque in
//! one of the forms of [`Form`], and
//!
//! F = J⁻ᵀ (Jᵀ F),  F = F_N ∇Φ − F_T ṙ/|ṙ|.
//!
//! Which surface is touched follows from geometry; that it is touched, from
//! the normal force, with hysteresis. While the tip is surely free, the torque
//! sensors' zeros are found and taken off ([`zeroing_time`](EstimatorParameters::zeroing_time));
//! while it slides their gains and the contour's turn, where that is asked for
//! ([`calibration_time`](EstimatorParameters::calibration_time)).

mod calibration;
mod coefficient;
mod contact_state;
mod estimate;
mod intake;
mod motor_current;
mod parameters;
mod sensors;
mod spatial;
mod split;
mod systematic;
mod touch;
mod zeroing;

pub use crate::contact_torque::{DerivativeFilter, Form};
pub use calibration::{Calibrated, Calibration, Push, SelfCalibration};
pub use coefficient::{Coefficient, CoefficientEstimator};
pub use contact_state::ContactState;
pub use estimate::{ContactEstimate, JointMeasurement};
pub use motor_current::{
    MotorCurrentParameters, MotorMeasurement, TorqueByMotorCurrent, TorqueFromMotor,
};
pub use parameters::EstimatorParameters;
pub use spatial::{SpatialEstimate, SpatialEstimator};
pub use systematic::{
    ERRORS, SensorErrors, SplitErrors, Uncertainty, independent_gains, sensor_errors, split_errors,
};

use ferntast_model::arm::Arm;
use ferntast_model::contour::Surface;
use ferntast_model::kinematics::planar;
use ferntast_model::{ArmModel, JointCount, ParameterError, Vector2};
use intake::Intake;
use split::{Motion, Split};
use zeroing::Zeroing;

/// Estimates contact forces of a planar arm step by step.
#[derive(Clone, Debug)]
pub struct ContactEstimator {
    arm: Arm,
    parameters: EstimatorParameters,
    intake: Intake,
    zeroing: Zeroing,
    calibration: Option<SelfCalibration>,
    split: Split,
    last: ContactEstimate,
}

impl ContactEstimator {
    /// An estimator that believes `model`.
    ///
    /// # Errors
    ///
    /// The first parameter that is out of bounds.
    pub fn new(model: &ArmModel, parameters: &EstimatorParameters) -> Result<Self, ParameterError> {
        model.validate()?;
        let joints = model.arm.joints_of_links(&model.joint)?;
        let ranges = joints.each_ref().map(|joint| joint.torque_sensor_range);
        let (intake, parameters) = Intake::new(&model.joint, parameters)?;
        let features = model.contour.features();
        let calibration = (parameters.calibration_time > 0.0)
            .then(|| SelfCalibration::new(parameters.uncertainty, features.len()));
        Ok(Self {
            arm: Arm::new(&model.arm),
            parameters,
            zeroing: Zeroing::new(ranges.into()),
            calibration,
            split: Split::new(features),
            last: ContactEstimate::unknown(intake.joints()),
            intake,
        })
    }

    /// How many joints it has measurements of.
    pub fn joints(&self) -> JointCount {
        self.intake.joints()
    }

    /// What sliding tells of gains and turns, where that is asked for.
    pub fn calibration(&self) -> Option<&SelfCalibration> {
        self.calibration.as_ref()
    }

    /// Takes in a measurement `dt` \[s\] after the last one.
    ///
    /// Never fails: with an unusable measurement or time step it gives what
    /// it gave before, marked as invalid, and after `longest_gap` of that no
    /// forces and no contact any more.
    pub fn step(&mut self, dt: f64, measurement: &JointMeasurement) -> ContactEstimate {
        self.step_with(dt, measurement, false)
    }

    /// The same with joint torques by motor currents. While a joint rests or turns its
    /// torque is not determined, and what is told counts as near rest.
    pub fn step_by_motors(&mut self, dt: f64, torque: &TorqueFromMotor) -> ContactEstimate {
        let undetermined = torque.undetermined.contains(&true);
        self.step_with(dt, &torque.measurement, undetermined)
    }

    fn step_with(
        &mut self,
        dt: f64,
        measurement: &JointMeasurement,
        undetermined: bool,
    ) -> ContactEstimate {
        let Some(taken) = self.intake.step(&self.arm, dt, measurement) else {
            return self.without_input();
        };
        let (step, motion, sensors) = (taken.passed, taken.motion, taken.sensors);
        // The arm's model is of its own joints: `new` has seen to that.
        let vectors = planar(&motion.position).zip(planar(&motion.velocity));
        let vectors = vectors.zip(planar(&motion.present_velocity));
        let torques = planar(&motion.contact_torque).zip(planar(&self.zeroing.zero()));
        let (Some(((q, qd), present_qd)), Some((with_zero, zero)), Some(link)) =
            (vectors, torques, planar(&taken.link))
        else {
            return self.without_input();
        };

        let kinematics = *self.arm.kinematics();
        let singularity = self.parameters.singularity;
        let unscaled = with_zero - zero;
        let felt = self.arm.gravity(&q) - unscaled;
        let torque = match &mut self.calibration {
            Some(own) => {
                own.step(step);
                unscaled + own.correction(&felt)
            }
            None => unscaled,
        };
        let force = kinematics.tip_force(&q, &torque, singularity);
        let singular = force.is_none();
        let force = force.unwrap_or_else(Vector2::zeros);
        let tip = kinematics.forward(&link);
        let jacobian = kinematics.jacobian(&q);
        let tip_velocity = jacobian * qd;

        let mut estimate = ContactEstimate {
            position: link.into(),
            velocity: qd.into(),
            tip: tip.into(),
            tip_velocity: tip_velocity.into(),
            force: force.into(),
            state: ContactState {
                valid: !singular && !sensors.saturated && taken.settled,
                singular,
                saturated: sensors.saturated,
                stuck: sensors.stuck,
                ..self.last.state.without_contact()
            },
            ..ContactEstimate::unknown(self.joints())
        };
        if estimate.state.valid {
            let free = self.split.is_free(&self.parameters, &tip);
            let torque = &motion.contact_torque;
            self.zeroing
                .learn(&self.parameters, step, free, torque, force.norm());
        }
        let uncertainty = &self.parameters.uncertainty;
        let alike = self.intake.alike();
        let (zeroing, calibration) = (&self.zeroing, self.calibration.as_ref());
        let errors = || {
            let zeros = zeroing.standard_error(alike, uncertainty.torque_zero);
            let gains = match calibration {
                Some(own) => own.calibration().errors(&felt),
                None => independent_gains(&torque, uncertainty.torque_gain),
            };
            let zeros = planar(&zeros).unwrap_or_else(Vector2::zeros);
            sensor_errors(&kinematics, &q, &zeros, &gains, singularity)
        };
        let motion = Motion {
            tip,
            errors: &errors,
            velocity: tip_velocity,
            present_velocity: jacobian * present_qd,
            delay: self.intake.delay(),
            calibration,
            undetermined,
        };
        self.split.step(
            &self.parameters,
            &self.last,
            step,
            &motion,
            &force,
            &mut estimate,
        );
        self.calibrate(step, alike, &q, &unscaled, &estimate);
        self.last = estimate;
        estimate
    }

    /// Learns gains and turns from `torque` of the contact \[Nm\], by sensors as they are.
    fn calibrate(
        &mut self,
        dt: f64,
        alike: f64,
        q: &Vector2<f64>,
        torque: &Vector2<f64>,
        estimate: &ContactEstimate,
    ) {
        let features = self.split.features();
        let touched = estimate
            .feature
            .and_then(|at| Some((at, features.get(at)?)));
        let usable = estimate.state.in_contact && estimate.state.valid && !estimate.state.corner;
        let (Some(own), Some((at, feature)), true) = (&mut self.calibration, touched, usable)
        else {
            return;
        };
        let (kinematics, singularity) = (self.arm.kinematics(), self.parameters.singularity);
        let felt = self.arm.gravity(q) - torque;
        let by_ratio = Vector2::new(0.5 * felt.x, -0.5 * felt.y);
        let force = |torque| kinematics.tip_force(q, torque, singularity);
        let Some((force, by_ratio)) = force(torque).zip(force(&by_ratio)) else {
            return;
        };
        let push = Push {
            feature,
            tip: kinematics.forward(q),
            force,
            by_ratio,
            direction: self.split.direction(),
            dt,
            alike,
        };
        let memory = self.parameters.calibration_time;
        match feature.surface {
            Surface::Spring => own.press(memory, &push),
            _ if !estimate.state.near_rest => own.slide(at, memory, &push),
            _ => {}
        }
    }

    /// The estimate where there is no measurement.
    fn without_input(&mut self) -> ContactEstimate {
        if self.intake.is_lost() {
            self.last = ContactEstimate {
                position: self.last.position,
                tip: self.last.tip,
                state: self.last.state.without_contact(),
                ..ContactEstimate::unknown(self.joints())
            };
        }
        self.last.state.input_invalid = true;
        self.last.state.valid = false;
        self.last
    }
}

#[cfg(test)]
mod tests;

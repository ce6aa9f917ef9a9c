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
mod estimate;
mod filter;
mod form;
mod motor_current;
mod observer;
mod parameters;
mod sensors;
mod split;
mod systematic;
mod zeroing;

pub use calibration::{Calibrated, Calibration, Push, SelfCalibration};
pub use coefficient::{Coefficient, CoefficientEstimator};
pub use estimate::{ContactEstimate, JointMeasurement};
pub use filter::DerivativeFilter;
pub use form::Form;
pub use motor_current::{
    MotorCurrentParameters, MotorMeasurement, TorqueByMotorCurrent, TorqueFromMotor,
};
pub use parameters::EstimatorParameters;
pub use systematic::{
    ERRORS, SensorErrors, SplitErrors, Uncertainty, independent_gains, sensor_errors, split_errors,
};

use ferntast_model::arm::Arm;
use ferntast_model::contour::Surface;
use ferntast_model::joint::JointParameters;
use ferntast_model::kinematics::planar;
use ferntast_model::{ArmModel, JointCount, Joints, ParameterError, Vector2};
use form::TorqueOfContact;
use sensors::SensorWatch;
use split::{Motion, Split};
use zeroing::Zeroing;

/// Beyond these a measurement is broken, whatever the arm.
const LARGEST_POSITION: f64 = 1e3;
const LARGEST_TORQUE: f64 = 1e6;

/// Estimates contact forces step by step.
#[derive(Clone, Debug)]
pub struct ContactEstimator {
    arm: Arm,
    count: JointCount,
    /// As many as `count` says.
    joints: Vec<JointParameters>,
    parameters: EstimatorParameters,
    contact: TorqueOfContact,
    sensors: SensorWatch,
    zeroing: Zeroing,
    calibration: Option<SelfCalibration>,
    split: Split,
    last: ContactEstimate,
    /// Time since the filters were last moved on \[s\].
    gap: f64,
    /// Time until the filters have forgotten a start or a sensor that failed \[s\].
    settling: f64,
    started: bool,
}

impl ContactEstimator {
    /// An estimator that believes `model`.
    ///
    /// # Errors
    ///
    /// The first parameter that is out of bounds.
    pub fn new(model: &ArmModel, parameters: &EstimatorParameters) -> Result<Self, ParameterError> {
        model.validate()?;
        parameters
            .validate()
            .map_err(|error| error.within("estimator"))?;
        let count = JointCount::new(model.joint.len())?;
        let joints = model.arm.joints_of_links(&model.joint)?;
        let ranges = Vector2::from(joints.each_ref().map(|joint| joint.torque_sensor_range));
        let mut parameters = *parameters;
        if parameters.form == Form::MotorCurrent {
            parameters.zeroing_time = 0.0;
            parameters.calibration_time = 0.0;
        }
        let features = model.contour.features();
        let calibration = (parameters.calibration_time > 0.0)
            .then(|| SelfCalibration::new(parameters.uncertainty, features.len()));
        Ok(Self {
            arm: Arm::new(&model.arm),
            count,
            joints: model.joint.clone(),
            parameters,
            contact: TorqueOfContact::new(parameters.form, parameters.cut_off, count),
            sensors: SensorWatch::new(count),
            zeroing: Zeroing::new(ranges),
            calibration,
            split: Split::new(features),
            last: ContactEstimate::unknown(count),
            gap: 0.0,
            settling: 0.0,
            started: false,
        })
    }

    /// How many joints it has measurements of.
    pub fn joints(&self) -> JointCount {
        self.count
    }

    /// What sliding tells of gains and turns, where that is asked for.
    pub fn calibration(&self) -> Option<&SelfCalibration> {
        self.calibration.as_ref()
    }

    /// Time that the filters take to forget \[s\].
    fn settling_time(&self) -> f64 {
        1.0 / self.parameters.cut_off
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
        let passes = dt > 0.0 && dt.is_finite();
        if !(passes && is_usable(self.count, measurement)) {
            self.gap += if passes { dt } else { 0.0 };
            return self.without_input();
        }
        let step = self.gap + dt;
        self.gap = 0.0;
        let link = self.filter(step, measurement);
        let memory = self.settling_time();
        let sensors = self.sensors.step(step, memory, &self.joints, measurement);
        if sensors.stuck.contains(&true) {
            self.settling = memory;
        }
        // The arm's model is of its own joints: `new` has seen to that.
        let motion = self.contact.motion(&self.arm, step).zip(planar(&link));
        let Some((motion, link)) = motion else {
            return self.without_input();
        };
        let (q, qd) = (motion.position, motion.velocity);

        let kinematics = *self.arm.kinematics();
        let singularity = self.parameters.singularity;
        let unscaled = motion.contact_torque - self.zeroing.zero();
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
            friction: self.last.friction,
            singular,
            saturated: sensors.saturated,
            stuck: sensors.stuck,
            valid: !singular && !sensors.saturated && self.settling <= 0.0,
            ..ContactEstimate::unknown(self.count)
        };
        if estimate.valid {
            let features = self.split.features();
            self.zeroing.learn(
                &self.parameters,
                features,
                step,
                &tip,
                &motion.contact_torque,
                &force,
            );
        }
        let uncertainty = &self.parameters.uncertainty;
        // Behind a low-pass of bandwidth f samples within 1/(2 f) are alike.
        let alike = 0.5 * self.settling_time();
        let zeros = self.zeroing.standard_error(alike, uncertainty.torque_zero);
        let gains = match &self.calibration {
            Some(own) => own.calibration().errors(&felt),
            None => independent_gains(&torque, uncertainty.torque_gain),
        };
        let errors = sensor_errors(&kinematics, &q, &zeros, &gains, singularity);
        let motion = Motion {
            tip,
            errors,
            velocity: tip_velocity,
            present_velocity: jacobian * motion.present_velocity,
            delay: self.contact.delay(),
            calibration: self.calibration.as_ref(),
            undetermined,
        };
        let last = self.last;
        self.split.step(
            &self.parameters,
            &last,
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
        let usable = estimate.in_contact && estimate.valid && !estimate.corner;
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
            _ if !estimate.near_rest => own.slide(at, memory, &push),
            _ => {}
        }
    }

    /// The estimate where there is no measurement.
    fn without_input(&mut self) -> ContactEstimate {
        if self.gap > self.parameters.longest_gap {
            self.last = ContactEstimate {
                position: self.last.position,
                tip: self.last.tip,
                friction: self.last.friction,
                ..ContactEstimate::unknown(self.count)
            };
        }
        self.last.input_invalid = true;
        self.last.valid = false;
        self.last
    }

    /// Filters all channels; gives the newest link-side position \[rad\].
    fn filter(&mut self, dt: f64, measurement: &JointMeasurement) -> Joints<f64> {
        let anew = !self.started || dt > self.parameters.longest_gap;
        self.settling = if anew {
            self.settling_time()
        } else {
            (self.settling - dt).max(0.0)
        };
        self.started = true;
        let torque = measurement.joint_torque;
        let link = Joints::from_fn(self.count, |joint| {
            let (own, motor) = (&self.joints[joint], measurement.motor_position[joint]);
            // Beyond its range a sensor says nothing, least of all how far the gear is wound.
            let range = own.torque_sensor_range;
            own.link_position(motor, torque[joint].clamp(-range, range))
        });
        if anew {
            self.contact.reset(&self.arm, &link, &torque);
        } else {
            self.contact.step(dt, &link, &torque);
        }
        link
    }
}

/// Whether the numbers are such as an arm of so many joints can give.
fn is_usable(joints: JointCount, measurement: &JointMeasurement) -> bool {
    // NaN fails the comparison.
    let within = |values: &Joints<f64>, largest: f64| {
        values.count() == joints && values.iter().all(|value| value.abs() <= largest)
    };
    within(&measurement.motor_position, LARGEST_POSITION)
        && within(&measurement.joint_torque, LARGEST_TORQUE)
}

#[cfg(test)]
mod tests;

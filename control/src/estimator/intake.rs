//! From measurements to the torque of the contact: the part of the estimator that does not
//! depend on how an arm is made.

use super::sensors::{SensorState, SensorWatch};
use super::{EstimatorParameters, Form, JointMeasurement};
use crate::contact_torque::{FilteredMotion, Links, MeasuredContact};
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, Joints, ParameterError};

/// Beyond these a measurement is broken, whatever the arm.
const LARGEST_POSITION: f64 = 1e3;
const LARGEST_TORQUE: f64 = 1e6;

/// What a measurement comes to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taken {
    /// Time since the last one that could be used \[s\].
    pub(super) passed: f64,
    /// Newest link-side positions \[rad\], not filtered.
    pub(super) link: Joints<f64>,
    /// Filtered motion and the torque of the contact.
    pub(super) motion: FilteredMotion,
    /// Whether the torque sensors can be believed.
    pub(super) sensors: SensorState,
    /// The filters have forgotten how they began, and sensors that failed.
    pub(super) settled: bool,
}

/// Filters measurements and watches the sensors.
#[derive(Clone, Debug)]
pub(super) struct Intake {
    count: JointCount,
    cut_off: f64,
    longest_gap: f64,
    contact: MeasuredContact,
    sensors: SensorWatch,
    /// Time since the filters were last moved on \[s\].
    gap: f64,
    /// Time until the filters have forgotten a start or a sensor that failed \[s\].
    settling: f64,
}

impl Intake {
    /// For these joints as believed. Gives also the parameters as they are used.
    ///
    /// # Errors
    ///
    /// The first parameter that is out of bounds, a number of joints that there is not.
    pub(super) fn new(
        joints: &[JointParameters],
        parameters: &EstimatorParameters,
    ) -> Result<(Intake, EstimatorParameters), ParameterError> {
        parameters
            .validate()
            .map_err(|error| error.within("estimator"))?;
        let count = JointCount::new(joints.len())?;
        let mut parameters = *parameters;
        if parameters.form == Form::MotorCurrent {
            parameters.zeroing_time = 0.0;
            parameters.calibration_time = 0.0;
        }
        let intake = Intake {
            count,
            cut_off: parameters.cut_off,
            longest_gap: parameters.longest_gap,
            contact: MeasuredContact::new(
                joints,
                count,
                parameters.form,
                parameters.cut_off,
                parameters.longest_gap,
            ),
            sensors: SensorWatch::new(count),
            gap: 0.0,
            settling: 0.0,
        };
        Ok((intake, parameters))
    }

    /// How many joints it has measurements of.
    pub(super) fn joints(&self) -> JointCount {
        self.count
    }

    /// How late everything filtered is \[s\].
    pub(super) fn delay(&self) -> f64 {
        self.contact.delay()
    }

    /// Behind a low-pass of bandwidth f samples within 1/(2 f) are alike \[s\].
    pub(super) fn alike(&self) -> f64 {
        0.5 * self.settling_time()
    }

    /// There was no measurement for longer than can be bridged.
    pub(super) fn is_lost(&self) -> bool {
        self.gap > self.longest_gap
    }

    /// Time that the filters take to forget \[s\].
    fn settling_time(&self) -> f64 {
        1.0 / self.cut_off
    }

    /// Takes in a measurement `dt` \[s\] after the last one; `None` where it, or the time, is
    /// not usable.
    pub(super) fn step(
        &mut self,
        links: &impl Links,
        dt: f64,
        measurement: &JointMeasurement,
    ) -> Option<Taken> {
        let passes = dt > 0.0 && dt.is_finite();
        if !(passes && is_usable(self.count, measurement)) {
            self.gap += if passes { dt } else { 0.0 };
            return None;
        }
        let passed = self.gap + dt;
        self.gap = 0.0;
        let (position, torque) = (&measurement.motor_position, &measurement.joint_torque);
        let contact = self.contact.step(links, passed, position, torque);
        let memory = self.settling_time();
        self.settling = match contact.anew {
            true => memory,
            false => (self.settling - passed).max(0.0),
        };
        let joints = self.contact.joints();
        let sensors = (self.sensors).step(passed, memory, joints, measurement);
        if sensors.stuck.contains(&true) {
            self.settling = memory;
        }
        Some(Taken {
            passed,
            link: contact.link,
            motion: contact.motion,
            sensors,
            settled: self.settling <= 0.0,
        })
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

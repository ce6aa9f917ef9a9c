//! How hard the arm pressed.
//!
//! There is no topic of what is true of the arm. The force comes from what the arm itself
//! measured, by the estimator's law, run again over the recording: so it is there too while
//! the session's own estimator is dead.

use ferntast_control::estimator::{ContactEstimator, JointMeasurement};
use ferntast_model::{JointCount, Joints as Each};
use ferntast_msgs::Time;
use ferntast_studies::faults;

use super::{recorded::Joints, run::SCENARIO};

/// Normal force of the contact \[N\] at the time of every measurement.
pub fn forces(measured: &[Joints]) -> Vec<(Time, f64)> {
    let arm = faults::load(SCENARIO).expect("the scenario").arm;
    let mut estimator = ContactEstimator::new(arm.model.planar().expect("planar"), &arm.estimator)
        .expect("an estimator");
    let two = JointCount::new(2).expect("two joints");
    let mut last: Option<Time> = None;
    let step = |own: &Joints| {
        let passed = last.map_or(0.0, |last| own.at.seconds_since(last));
        last = Some(own.at);
        let measurement = JointMeasurement {
            motor_position: Each::from_fn(two, |joint| own.position[joint]),
            joint_torque: Each::from_fn(two, |joint| own.effort[joint]),
        };
        let estimate = estimator.step(passed, &measurement);
        let force = if estimate.state.valid {
            estimate.state.normal_force
        } else {
            0.0
        };
        (own.at, force)
    };
    measured.iter().map(step).collect()
}

/// The largest force from `from` to `to` \[N\].
pub fn peak(forces: &[(Time, f64)], from: Time, to: Time) -> f64 {
    let first = forces.partition_point(|own| own.0 < from);
    let last = forces.partition_point(|own| own.0 <= to).max(first);
    forces[first..last]
        .iter()
        .map(|own| own.1)
        .fold(0.0, f64::max)
}

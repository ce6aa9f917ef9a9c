//! What is wrong with the joints' torque sensors all the time: it does not average out, and
//! so no scatter within a recording tells of it.
//!
//! Each source changes the recorded torque by one standard uncertainty, and what is identified
//! is identified again; the changes are independent and add up in squares (JCGM 100:2008,
//! equation (10), with the sensitivities of its 5.1.4 found numerically).

use ferntast_control::estimator::{EstimatorParameters, Uncertainty};
use ferntast_identification::Dataset;
use ferntast_identification::numerics::statistics::mean_error;

/// The torque over which a loop of hysteresis turns over, as a multiple of its whole width.
const TURNS_OVER: f64 = 10.0;

/// One thing that is wrong with a joint's torque sensor; joints from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Its zero.
    Zero(usize),
    /// Its gain.
    Gain(usize),
    /// Its hysteresis.
    Hysteresis(usize),
}

impl Source {
    /// All of one joint.
    #[must_use]
    pub fn of_joint(joint: usize) -> [Source; 3] {
        [
            Source::Zero(joint),
            Source::Gain(joint),
            Source::Hysteresis(joint),
        ]
    }

    /// By how much a standard uncertainty of it changes the recorded `torque` \[Nm\], sample by
    /// sample; `None` where nothing is stated of it.
    #[must_use]
    pub fn change(self, torque: &[f64], uncertainty: &Uncertainty) -> Option<Vec<f64>> {
        let size = match self {
            Source::Zero(_) => uncertainty.torque_zero,
            Source::Gain(_) => uncertainty.torque_gain,
            Source::Hysteresis(_) => uncertainty.torque_hysteresis,
        };
        (size > 0.0).then(|| match self {
            Source::Zero(_) => vec![size; torque.len()],
            Source::Gain(_) => torque.iter().map(|torque| size * torque).collect(),
            Source::Hysteresis(_) => trail(torque, size),
        })
    }

    /// The recordings with the joint torque changed so.
    #[must_use]
    pub fn dataset(self, dataset: &Dataset, uncertainty: &Uncertainty) -> Option<Dataset> {
        let mut changed = dataset.clone();
        let sessions = changed.sessions.iter_mut();
        for torque in sessions.filter_map(|session| session.joint_torque.as_mut()) {
            let change = self.change(torque, uncertainty)?;
            for (torque, change) in torque.iter_mut().zip(change) {
                *torque += change;
            }
        }
        Some(changed)
    }
}

/// How far a reading trails `torque` \[Nm\] in a loop of half width `half` \[Nm\].
fn trail(torque: &[f64], half: f64) -> Vec<f64> {
    let mut last = torque.first().copied().unwrap_or(0.0);
    let mut trail: f64 = 0.0;
    torque
        .iter()
        .map(|&torque| {
            trail = (trail + (torque - last) / TURNS_OVER).clamp(-half, half);
            last = torque;
            -trail
        })
        .collect()
}

/// Standard uncertainty of a zero \[Nm\] that the estimator found on line: the mean of the torque
/// while `free` \[Nm\], by stretches of it; as stated where it does not look for zeros, and no more
/// than that.
pub fn zero_after_zeroing(estimator: &EstimatorParameters, free: &[f64]) -> f64 {
    const STRETCHES: usize = 10;
    let stated = estimator.uncertainty.torque_zero;
    if estimator.zeroing_time <= 0.0 || free.len() < 2 * STRETCHES {
        return stated;
    }
    let means: Vec<f64> = (0..STRETCHES)
        .map(|part| {
            let (from, to) = (
                part * free.len() / STRETCHES,
                (part + 1) * free.len() / STRETCHES,
            );
            free[from..to].iter().sum::<f64>() / (to - from) as f64
        })
        .collect();
    mean_error(&means).1.min(stated)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNCERTAINTY: Uncertainty = Uncertainty {
        torque_zero: 0.3,
        torque_gain: 0.03,
        torque_hysteresis: 0.1,
        spring_stiffness: 0.0,
        contour_turn: 0.0,
    };

    #[test]
    fn each_source_changes_the_torque_as_a_sensor_would_have_it_wrong() {
        let up: Vec<f64> = (0..=100).map(|k| 0.1 * f64::from(k)).collect();
        let torque: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
        let of = |source: Source| source.change(&torque, &UNCERTAINTY).unwrap();
        assert!(of(Source::Zero(0)).iter().all(|change| *change == 0.3));
        let gain = of(Source::Gain(1));
        assert!((gain[50] - 0.15).abs() < 1e-12);
        // Upwards it reads too little, downwards too much.
        let hysteresis = of(Source::Hysteresis(0));
        assert!((hysteresis[50] + 0.1).abs() < 1e-12 && (hysteresis[151] - 0.1).abs() < 1e-12);
        let known = Uncertainty::default();
        assert!(Source::Gain(0).change(&torque, &known).is_none());
    }
}

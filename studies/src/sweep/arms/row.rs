//! One arm on one wall, over the link and without delay, and which bounds that keeps.

use serde::Serialize;

use super::super::{BOUND, Row};

/// Hand less tip at the end, at most \[mm\].
const DRIFT: f64 = 1.0;
/// Force on the tip by that without delay, at most \[-\].
const PEAK: f64 = 1.5;
/// How far the stiffness that is felt may be from that without delay \[-\].
const FELT: f64 = 0.25;

/// An arm on a wall at a task.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmRow {
    /// The arm.
    pub arm: String,
    /// How many joints it has.
    pub joints: usize,
    /// What stood in place of it.
    pub driver: String,
    /// Over the link.
    #[serde(flatten)]
    pub own: Row,
    /// Virtual time over the link \[s\].
    pub duration_s: f64,
    /// The same without delay, jitter and loss.
    pub without_delay: Row,
    /// Greatest force on the tip by that without delay \[-\].
    pub peak_ratio: f64,
    /// Stiffness that is felt by that without delay \[-\]; `null` where none is.
    pub felt_ratio: Option<f64>,
    /// Bounds that it breaks.
    pub misses: Vec<Miss>,
}

/// A bound that is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Miss {
    /// Hand and tip gave out more than 0.02 J.
    Energy,
    /// Hand and tip are more than 1 mm apart in the end.
    Drift,
    /// The tip met the wall more than 1.5 times as hard as without delay.
    Peak,
    /// The stiffness felt is more than 25 % off that without delay.
    Felt,
    /// The task was not done in time.
    Task,
}

impl Miss {
    /// As in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Miss::Energy => "energy",
            Miss::Drift => "drift",
            Miss::Peak => "peak",
            Miss::Felt => "felt",
            Miss::Task => "task",
        }
    }
}

impl ArmRow {
    pub(super) fn new(
        arm: &super::driven::ArmOfSweep,
        driver: String,
        duration: f64,
        own: Row,
        without_delay: Row,
    ) -> ArmRow {
        let felt = own.felt_stiffness.zip(without_delay.felt_stiffness);
        let felt_ratio = felt.map(|(own, other)| own / other);
        let peak_ratio = own.peak_force / without_delay.peak_force;
        // What is no number keeps no bound.
        let kept = [
            (Miss::Energy, own.true_energy >= -BOUND),
            (Miss::Drift, own.drift_mm <= DRIFT),
            (Miss::Peak, peak_ratio <= PEAK),
            (
                Miss::Felt,
                felt_ratio.is_none_or(|own| (own - 1.0).abs() <= FELT),
            ),
            (Miss::Task, own.done && without_delay.done),
        ];
        let misses = kept.into_iter().filter(|(_, kept)| !kept);
        ArmRow {
            arm: arm.name.clone(),
            joints: arm.joints,
            driver,
            duration_s: duration,
            misses: misses.map(|(miss, _)| miss).collect(),
            own,
            without_delay,
            peak_ratio,
            felt_ratio,
        }
    }
}

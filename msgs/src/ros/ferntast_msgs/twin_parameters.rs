//! `ferntast_msgs/msg/TwinParameters`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// What the twin of a joint says. The lists go together, one element a parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwinParameters {
    /// When the samples that it is about were measured; no frame.
    pub header: Header,
    /// Which joint: joint_1 or joint_2.
    pub joint: String,
    /// Names of the parameters, as in the lab.
    pub names: Vec<String>,
    /// Values now.
    pub values: Vec<f64>,
    /// Values as identified from the experiment's recordings.
    pub off_line: Vec<f64>,
    /// Standard errors of the values now.
    pub std_errors: Vec<f64>,
    /// 0 where the motion told nothing of a parameter, towards 1 where it told all \[1\].
    pub excitation: Vec<f64>,
    /// Root mean square of the latest residuals \[Nm\].
    pub residual_rms: f64,
    /// Standard deviation of the residual off line \[Nm\].
    pub band: f64,
    /// The residual has left its band.
    pub out_of_band: bool,
    /// Parameter that moved away from its value off line; empty where none did.
    pub changed: String,
    /// How it moved: step or drift.
    pub change_kind: String,
    /// Its value before.
    pub change_before: f64,
    /// Its value after.
    pub change_after: f64,
    /// When half of the way was done, after the twin's first sample \[s\].
    pub change_time: f64,
    /// The lab's verdict: pending, complete, missing or unexplained.
    pub verdict: String,
    /// When it was given, after the twin's first sample \[s\].
    pub assessed_at: f64,
    /// The missing effect.
    pub candidate: String,
    /// Signals that the residual depends on most.
    pub goes_with: String,
}

impl RosMessage for TwinParameters {
    const INTERFACE: &'static str = "ferntast_msgs/msg/TwinParameters";
}

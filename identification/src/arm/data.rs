//! Recordings of all joints of an arm.

use std::collections::BTreeMap;

use crate::data::stated_filter::StatedFilter;

/// One session of all joints, sampled together at a uniform period.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmSession {
    /// Origin, in words.
    pub name: String,
    /// Start \[s\] since the first session's start.
    pub start: f64,
    /// Time \[s\] from the start of the recording that it is a piece of.
    pub into_recording: f64,
    /// Sampling period \[s\].
    pub period: f64,
    /// q of each joint \[rad\] or \[m\].
    pub position: Vec<Vec<f64>>,
    /// τ_m of each joint, on the joint side of the gear \[Nm\] or \[N\].
    pub motor_torque: Vec<Vec<f64>>,
    /// Conditions that stay as they are during the session, by name.
    pub conditions: BTreeMap<String, f64>,
}

/// The recordings of an arm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmDataset {
    /// Names of the joints, from the base on.
    pub joints: Vec<String>,
    /// What the model is fitted to.
    pub sessions: Vec<ArmSession>,
    /// Never fitted, only predicted; may be empty.
    pub held_out: Vec<ArmSession>,
    /// Filters stated by the user; `None`: chosen from the noise, joint by joint.
    pub filter: Option<StatedFilter>,
}

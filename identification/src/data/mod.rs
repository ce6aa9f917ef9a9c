//! What the engine is given: recordings cut into sessions, and the model that
//! is believed.

pub mod check;
pub mod error;
pub mod stated_filter;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use ferntast_model::friction::{JointType, Subject};

use stated_filter::StatedFilter;

/// One session of a recording: channels sampled together at a uniform period, no gap inside.
///
/// All channels are as long as `position`. Joint quantities are on the joint
/// side of the gear. For a prismatic joint read m for rad and N for Nm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordedSession {
    /// Origin, in words: "stribeck-0.mcap, session 3".
    pub name: String,
    /// Start \[s\] since the first session's start; days between sessions are kept.
    pub start: f64,
    /// Time \[s\] from the start of the recording that it is a piece of: its clocks went on.
    #[serde(default)]
    pub into_recording: f64,
    /// Sampling period \[s\].
    pub period: f64,
    /// q \[rad\]; of a contact the place of the tip along the contour \[m\].
    pub position: Vec<f64>,
    /// τ_m \[Nm\]; of a contact F_T \[N\], positive where it opposes a motion
    /// towards larger `position`.
    pub motor_torque: Vec<f64>,
    /// τ \[Nm\], what the joint torque sensor feels, or a model in its place says; `None` where
    /// there is neither.
    pub joint_torque: Option<Vec<f64>>,
    /// F_N \[N\] of a contact, positive when it pushes the tip out; else `None`.
    #[serde(default)]
    pub normal_force: Option<Vec<f64>>,
    /// Temperature \[degC\].
    pub temperature: Option<Vec<f64>>,
    /// Other signals by name: searched for dependences of the residual, usable in
    /// expressions.
    pub extra: BTreeMap<String, Vec<f64>>,
    /// Conditions that stay as they are during the session, by name, in units of their own: a
    /// gain, a mass. They enter no model; what varies together with them is told.
    #[serde(default)]
    pub conditions: BTreeMap<String, f64>,
    /// Whether the session is known to be free of load: beyond the torque sensor
    /// there is nothing but the link, so that the sensor's zero can be read.
    #[serde(default)]
    pub unloaded: bool,
    /// Whether `joint_torque` is what a model says, rather than what a sensor feels: its gain
    /// and its zero may be wrong.
    #[serde(default)]
    pub torque_is_modelled: bool,
    /// Whether `joint_torque` is what the model of an arm says that its links take, whose
    /// errors are effects of the arm.
    #[serde(default)]
    pub torque_is_of_links: bool,
    /// Inertia of an arm's links that the joint turns, the others held, over its mean over the
    /// recordings \[-\].
    #[serde(default)]
    pub relative_links_inertia: Option<Vec<f64>>,
}

/// The recordings of one joint, or of one contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dataset {
    /// What models are fitted to.
    pub sessions: Vec<RecordedSession>,
    /// Never fitted, only predicted; may be empty: then sessions, or blocks of
    /// time of a single session, are left out in turn.
    pub held_out: Vec<RecordedSession>,
    /// Kind of joint.
    pub joint: JointType,
    /// Filters stated by the user; `None`: chosen from the noise.
    #[serde(default)]
    pub filter: Option<StatedFilter>,
}

/// Inertia J in τ_m = J q̈ + τ + τ_F.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Inertia {
    /// Known \[kg m²\].
    Given(f64),
    /// A parameter like any other, reported as `inertia`.
    Fit,
}

/// The believed model: equation (2) with these effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelSpec {
    /// J, given or fitted.
    pub inertia: Inertia,
    /// Motor turns in one turn of the joint; for a prismatic joint, in one turn of the screw \[1\].
    pub gear_ratio: Option<f64>,
    /// Effects of τ_F, of a contact of F_T.
    pub effects: Vec<Term>,
}

/// One effect of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Term {
    /// By its id in the [catalogue](crate::catalogue).
    Catalogue(String),
    /// By a formula of the user's own.
    Custom(CustomEffect),
}

/// An effect of the user's own: a torque \[Nm\] that is added to τ_F.
///
/// Names in the expression that are neither signals nor functions are
/// parameters. Those with bounds are searched within them; the others must
/// enter linearly and are fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CustomEffect {
    /// Its name in results.
    pub name: String,
    /// Over `q`, `qd`, `qdd`, `tau`, `tau_m`, `T` \[degC\], `t` (seconds since the first session's start) and extra
    /// signals; of a contact over `r` \[m\], `rd` \[m/s\], `rdd`, `F_N`, `F_T` \[N\], `T`, `t` and extra signals.
    pub expression: String,
    /// Lower and upper bound of the parameters that are searched.
    pub bounds: BTreeMap<String, [f64; 2]>,
}

impl RecordedSession {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }
}

impl Term {
    /// Id or name, as in files and results.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Catalogue(id) => id,
            Self::Custom(custom) => &custom.name,
        }
    }
}

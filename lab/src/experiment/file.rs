//! The experiment file as TOML.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::Lineage;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) recording: Paths,
    #[serde(default)]
    pub(super) held_out: Paths,
    #[serde(default)]
    pub(super) unloaded: Paths,
    pub(super) filter: Option<ferntast_identification::StatedFilter>,
    pub(super) joint: Option<Joint>,
    pub(super) contact: Option<Contact>,
    pub(super) signals: SignalsTable,
    pub(super) model: Model,
    pub(super) lineage: Option<Lineage>,
}

/// One path or a list.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a path or a list of paths")]
pub(super) enum Paths {
    One(String),
    Many(Vec<String>),
}

impl Default for Paths {
    fn default() -> Paths {
        Paths::Many(Vec::new())
    }
}

impl Paths {
    pub(super) fn list(self) -> Vec<String> {
        match self {
            Paths::One(path) => vec![path],
            Paths::Many(paths) => paths,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Joint {
    #[serde(default, rename = "type")]
    pub(super) kind: ferntast_identification::JointType,
}

/// What is touched.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Contact {
    /// Its corners in order, in the frame of the tip's position \[m\].
    pub(super) contour: Option<Vec<[f64; 2]>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SignalsTable {
    pub(super) position: Option<String>,
    /// Of a contact, in place of the position: x and y of the tip.
    pub(super) tip: Option<[String; 2]>,
    pub(super) motor_torque: Option<String>,
    pub(super) joint_torque: Option<String>,
    pub(super) tangential_force: Option<String>,
    pub(super) normal_force: Option<String>,
    pub(super) temperature: Option<String>,
    pub(super) valid: Option<String>,
    pub(super) time: Option<String>,
    #[serde(default)]
    pub(super) extra: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Model {
    pub(super) inertia: Option<Inertia>,
    pub(super) gear_ratio: Option<f64>,
    pub(super) effects: Vec<Effect>,
}

#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number (kg m², for a prismatic joint kg) or { fit = true }"
)]
pub(super) enum Inertia {
    Given(f64),
    Fit(FitTable),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FitTable {
    pub(super) fit: bool,
}

#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected an effect's id, or { name = \"…\", expression = \"…\", parameter = [lower, upper] }"
)]
pub(super) enum Effect {
    Catalogue(String),
    Custom(Custom),
}

#[derive(Debug, Deserialize)]
pub(super) struct Custom {
    pub(super) name: String,
    pub(super) expression: String,
    /// Bounds of the parameters that are searched.
    #[serde(flatten)]
    pub(super) bounds: BTreeMap<String, [f64; 2]>,
}

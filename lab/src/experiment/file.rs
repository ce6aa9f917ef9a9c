//! The experiment file as TOML.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::{
    Lineage,
    reading::{ColumnNames, Join, Readings},
};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) recording: Recordings,
    /// Names of columns, where a table has none or others are wanted.
    #[serde(default)]
    pub(super) columns: ColumnNames,
    pub(super) rate_hz: Option<f64>,
    pub(super) join: Option<Join>,
    pub(super) readings: Option<Readings>,
    #[serde(default)]
    pub(super) held_out: Recordings,
    #[serde(default)]
    pub(super) unloaded: Recordings,
    pub(super) filter: Option<ferntast_identification::StatedFilter>,
    pub(super) joint: Option<Joint>,
    pub(super) contact: Option<Contact>,
    pub(super) arm: Option<Arm>,
    pub(super) signals: SignalsTable,
    pub(super) model: Model,
    pub(super) lineage: Option<Lineage>,
}

/// One path, or a list of paths and of lists: files that are joined.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a path, a list of paths, or in that list a list of files to be joined: [[\"position.csv\", \"current.csv\"]]"
)]
pub(super) enum Recordings {
    One(String),
    Many(Vec<Files>),
}

/// One recording: a file, or several that are joined, with what is stated of it or without.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a path, a list of files to be joined, or { file = \"…\", date = 2026-03-09T14:30:00, conditions = { kp = 100 } }"
)]
pub(super) enum Files {
    One(String),
    Joined(Vec<String>),
    Stated(Stated),
}

/// A recording, when it began, and the conditions that it was made under.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Stated {
    pub(super) file: SameFiles,
    pub(super) date: Option<toml::value::Datetime>,
    #[serde(default)]
    pub(super) conditions: BTreeMap<String, f64>,
}

/// A recording in a list.
pub(super) struct Listed {
    /// The one that gives the time first.
    pub(super) files: Vec<String>,
    pub(super) stated: StatedOfRecording,
}

/// What is stated of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StatedOfRecording {
    pub(super) date: Option<toml::value::Datetime>,
    pub(super) conditions: BTreeMap<String, f64>,
}

/// One file, or several that are joined.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a path, or a list of files to be joined"
)]
pub(super) enum SameFiles {
    One(String),
    Joined(Vec<String>),
}

impl Default for Recordings {
    fn default() -> Recordings {
        Recordings::Many(Vec::new())
    }
}

impl Recordings {
    /// Each recording.
    pub(super) fn list(self) -> Vec<Listed> {
        let alone = |files| Listed {
            files,
            stated: StatedOfRecording::default(),
        };
        match self {
            Recordings::One(path) => vec![alone(vec![path])],
            Recordings::Many(paths) => {
                let paths = paths.into_iter().map(|files| match files {
                    Files::One(path) => alone(vec![path]),
                    Files::Joined(paths) => alone(paths),
                    Files::Stated(own) => Listed {
                        files: match own.file {
                            SameFiles::One(path) => vec![path],
                            SameFiles::Joined(paths) => paths,
                        },
                        stated: StatedOfRecording {
                            date: own.date,
                            conditions: own.conditions,
                        },
                    },
                });
                paths.collect()
            }
        }
    }
}

/// Where a signal is: a message path or column, or that with its unit.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a column or message path, { column = \"…\", unit = \"…\" }, or of an arm a list of these"
)]
pub(super) enum Source {
    Path(String),
    /// Of an arm, one for each joint.
    Each(Vec<OneSource>),
    Table(SourceTable),
}

/// Where one of several signals is.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a column or message path, or { column = \"…\", unit = \"…\" }"
)]
pub(super) enum OneSource {
    Path(String),
    Table(SourceTable),
}

impl From<OneSource> for Source {
    fn from(one: OneSource) -> Source {
        match one {
            OneSource::Path(path) => Source::Path(path),
            OneSource::Table(table) => Source::Table(table),
        }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SourceTable {
    #[serde(alias = "path")]
    pub(super) column: String,
    pub(super) unit: Option<String>,
    /// The column that is this signal's own time.
    pub(super) time: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Joint {
    #[serde(default, rename = "type")]
    pub(super) kind: ferntast_identification::JointType,
    #[serde(default)]
    pub(super) torque_is_modelled: bool,
}

/// What is touched.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Contact {
    /// Its corners in order, in the frame of the tip's position \[m\].
    pub(super) contour: Option<Vec<[f64; 2]>>,
}

/// A whole arm.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Arm {
    pub(super) urdf: String,
    /// From the base on.
    pub(super) joints: Option<Vec<String>>,
    /// In place of joints, the link that they begin at …
    pub(super) base: Option<String>,
    /// … and that they end at.
    pub(super) tip: Option<String>,
    pub(super) armature: Option<Vec<f64>>,
    pub(super) gravity: Option<[f64; 3]>,
    pub(super) gear_ratio: Option<Vec<f64>>,
    /// What torque a unit of `motor_torque` is, gear included.
    pub(super) drive_gain: Option<Vec<f64>>,
    /// Joints that count the other way round, …
    pub(super) reversed: Option<Vec<String>>,
    /// … whose torque does, …
    pub(super) torque_reversed: Option<Vec<String>>,
    /// … and what is added to positions.
    pub(super) zero: Option<BTreeMap<String, f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SignalsTable {
    pub(super) position: Option<Source>,
    /// Of a contact, in place of the position: x and y of the tip.
    pub(super) tip: Option<[OneSource; 2]>,
    pub(super) motor_torque: Option<Source>,
    pub(super) joint_torque: Option<Source>,
    pub(super) tangential_force: Option<Source>,
    pub(super) normal_force: Option<Source>,
    pub(super) temperature: Option<Source>,
    pub(super) valid: Option<Source>,
    pub(super) time: Option<Source>,
    #[serde(default)]
    pub(super) extra: BTreeMap<String, Source>,
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

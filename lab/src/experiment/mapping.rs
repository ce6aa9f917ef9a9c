//! What a person says of recordings of their own: which files, which of their
//! numbers are which signals, and the model to begin with. Read out of an
//! experiment file, it can be changed and written into that again.
//!
//! A mapping has every signal by itself: each joint's of an arm, each coordinate of a tip.

use std::{collections::BTreeMap, path::Path};

use ferntast_identification::{Inertia, JointType};
use serde::{Deserialize, Serialize};

use super::{Experiment, ExperimentError, Join, data_folder, file, of_each, reading::ColumnNames};

/// Where a signal is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Column or message path.
    pub column: String,
    /// Its unit; nothing: SI.
    #[serde(default)]
    pub unit: Option<String>,
    /// The column that is this signal's own time.
    #[serde(default)]
    pub time: Option<String>,
}

/// A whole arm in place of a joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmPart {
    /// The URDF; a relative path counts from the experiment file's folder.
    pub urdf: String,
    /// Its joints from the base on.
    pub joints: Vec<String>,
    /// Inertia of motor and gear of each joint \[kg m²\] or \[kg\]; nothing: fitted.
    #[serde(default)]
    pub armature: Option<Vec<f64>>,
    /// Motor turns in one turn of each joint \[1\].
    #[serde(default)]
    pub gear_ratio: Option<Vec<f64>>,
    /// Torque at each joint for a unit of what is recorded as its motor's, gear included: \[Nm/A\]
    /// and the like; nothing: torques are recorded.
    #[serde(default)]
    pub drive_gain: Option<Vec<f64>>,
}

/// Files, signals and a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mapping {
    /// Recordings to fit, each with the files that it is joined from; relative ones
    /// count from the experiment file's folder.
    pub recordings: Vec<Vec<String>>,
    /// Recordings that are never fitted.
    #[serde(default)]
    pub held_out: Vec<Vec<String>>,
    /// Names of the columns in place of those in the files.
    #[serde(default)]
    pub columns: Vec<String>,
    /// Rows in a second, in place of time \[Hz\].
    #[serde(default)]
    pub rate_hz: Option<f64>,
    /// How the files of a recording are joined.
    #[serde(default)]
    pub join: Option<Join>,
    /// Kind of joint, or a contact; of an arm that of its first joint.
    #[serde(default)]
    pub joint: JointType,
    /// The arm, where it is about one.
    #[serde(default)]
    pub arm: Option<ArmPart>,
    /// Corners \[m\] of what the tip of a contact slides along.
    #[serde(default)]
    pub contour: Option<Vec<[f64; 2]>>,
    /// Signals by key: position, motor_torque, and what else there is of
    /// joint_torque, temperature, valid, time; of a contact position, or `tip[0]` and `tip[1]`,
    /// tangential_force, normal_force; of an arm `position@JOINT` and `motor_torque@JOINT`;
    /// `extra.NAME` is an extra signal.
    pub signals: BTreeMap<String, Place>,
    /// J; a contact has none, and an arm one for each joint.
    pub inertia: Inertia,
    /// Motor turns in one turn of the joint \[1\].
    #[serde(default)]
    pub gear_ratio: Option<f64>,
    /// Ids of effects of the catalogue; of an arm with `@JOINT` where they are of one joint.
    pub effects: Vec<String>,
}

/// The mapping of an experiment file, and what else is in there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mapped {
    /// The mapping.
    pub mapping: Mapping,
    /// What no mapping has, and what stays as it is when that is changed.
    pub kept: Vec<String>,
}

impl Mapping {
    /// The signals without which nothing can be fitted.
    #[must_use]
    pub fn needed(&self) -> Vec<String> {
        let forces = ["tangential_force", "normal_force"];
        let by_tip = self.contour.is_some()
            || of_each::TIP
                .iter()
                .any(|key| self.signals.contains_key(*key));
        let keys: Vec<&str> = match (&self.arm, self.joint) {
            (Some(arm), _) => {
                let each = arm.joints.iter();
                let both = each.flat_map(|joint| {
                    ["position", "motor_torque"].map(|key| format!("{key}@{joint}"))
                });
                return both.collect();
            }
            (None, JointType::Contact) if by_tip => [&of_each::TIP[..], &forces].concat(),
            (None, JointType::Contact) => [&["position"], &forces[..]].concat(),
            (None, _) => vec!["position", "motor_torque"],
        };
        keys.into_iter().map(str::to_owned).collect()
    }

    /// The mapping in `text`, the content of the experiment file at `path`.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`]: it is no experiment file; the URDF that it names cannot be read.
    pub fn parse(text: &str, path: &Path) -> Result<Mapped, ExperimentError> {
        let experiment = Experiment::parse(text, path, &data_folder())?;
        let file: file::File = toml::from_str(text).map_err(|error| ExperimentError::Syntax {
            path: path.to_owned(),
            message: error.to_string(),
        })?;
        let kept = kept(&file);
        let groups = |recordings: file::Recordings| -> Vec<Vec<String>> {
            let list = recordings.list().into_iter();
            list.map(|own| own.files).collect()
        };
        let catalogue = file.model.effects.iter().filter_map(|effect| match effect {
            file::Effect::Catalogue(id) => Some(id.clone()),
            file::Effect::Custom(_) => None,
        });
        let mapping = Mapping {
            effects: catalogue.collect(),
            recordings: groups(file.recording),
            held_out: groups(file.held_out),
            columns: match file.columns {
                ColumnNames::Same(names) => names,
                ColumnNames::Each(_) => Vec::new(),
            },
            rate_hz: file.rate_hz,
            join: file.join,
            joint: experiment.joint,
            signals: match &experiment.arm {
                Some(_) => of_arm(&experiment, file.signals),
                None => signals(file.signals),
            },
            arm: file
                .arm
                .zip(experiment.arm.as_ref())
                .map(|(own, arm)| ArmPart {
                    urdf: own.urdf,
                    joints: arm.joints().to_vec(),
                    armature: own.armature,
                    gear_ratio: own.gear_ratio,
                    drive_gain: own.drive_gain,
                }),
            contour: file.contact.and_then(|own| own.contour),
            inertia: experiment.model.inertia,
            gear_ratio: experiment.model.gear_ratio,
        };
        Ok(Mapped { mapping, kept })
    }
}

/// What the file has that no mapping has, by its keys.
fn kept(file: &file::File) -> Vec<String> {
    let own = file.model.effects.iter().filter_map(|effect| match effect {
        file::Effect::Custom(custom) => Some(format!("effect {}", custom.name)),
        file::Effect::Catalogue(_) => None,
    });
    let arm = file.arm.as_ref();
    let names = matches!(file.columns, ColumnNames::Each(_));
    let there = [
        ("columns", names),
        (
            "unloaded",
            !matches!(&file.unloaded, file::Recordings::Many(list) if list.is_empty()),
        ),
        ("filter", file.filter.is_some()),
        ("arm.gravity", arm.is_some_and(|own| own.gravity.is_some())),
        ("lineage", file.lineage.is_some()),
    ];
    let there = there.into_iter().filter(|(_, there)| *there);
    there.map(|(name, _)| name.to_owned()).chain(own).collect()
}

fn signals(table: file::SignalsTable) -> BTreeMap<String, Place> {
    let named = [
        ("position", table.position),
        ("motor_torque", table.motor_torque),
        ("joint_torque", table.joint_torque),
        ("tangential_force", table.tangential_force),
        ("normal_force", table.normal_force),
        ("temperature", table.temperature),
        ("valid", table.valid),
        ("time", table.time),
    ];
    let named = named
        .into_iter()
        .filter_map(|(key, source)| Some((key.to_owned(), source?)));
    let tip = table.tip.into_iter().flatten();
    let tip = of_each::TIP.iter().zip(tip);
    let extra = table.extra.into_iter();
    named
        .chain(tip.map(|(key, source)| ((*key).to_owned(), source.into())))
        .chain(extra.map(|(name, source)| (format!("extra.{name}"), source)))
        .filter_map(|(key, source)| Some((key, place(source)?)))
        .collect()
}

/// Position and torque of each joint, and what else a file about an arm has.
fn of_arm(experiment: &Experiment, table: file::SignalsTable) -> BTreeMap<String, Place> {
    let others = [("valid", table.valid), ("time", table.time)];
    let others = others
        .into_iter()
        .filter_map(|(key, source)| Some((key.to_owned(), place(source?)?)));
    let each = experiment.places_in_arm().into_iter();
    let each = each.map(|(key, column, unit)| {
        let unit = unit.map(|unit| unit.name().to_owned());
        let place = Place {
            column,
            unit,
            time: None,
        };
        (key, place)
    });
    each.chain(others).collect()
}

fn place(source: file::Source) -> Option<Place> {
    match source {
        file::Source::Path(column) => Some(Place {
            column,
            ..Place::default()
        }),
        file::Source::Table(table) => Some(Place {
            column: table.column,
            unit: table.unit,
            time: table.time,
        }),
        // Of an arm, whose joints are taken one by one.
        file::Source::Each(_) => None,
    }
}

//! The experiment file: which recordings, which signals, which model.
//!
//! ```toml
//! recording = "run.mcap"        # or a list: rosbag2 directories, .mcap, tables (.csv, .npz, .mat, …);
//!                               # in the list [["q.csv", "i.csv"]]: files that are joined
//!                               # or with what stayed the same: { file = "a.csv", conditions = { kp = 100 } }
//!                               # and when it began, where its times do not say: date = 2026-03-09T14:30:00
//! columns = ["t", "q", "i"]     # tables only, optional: names in place of those in the file
//! rate_hz = 500                 # tables only, in place of time
//! join = "time"                 # or "row"; else by time where each file has one
//! readings = "as_recorded"      # optional: what can hardly have been measured is kept, too
//! unloaded = ["free.mcap"]      # optional: fitted too, run free of load: shows the torque sensor's zero
//! held_out = ["other.mcap"]     # optional: never fitted
//! [joint]
//! type = "revolute"             # or "prismatic": m, N, kg
//! torque_is_modelled = true     # optional: joint_torque is no sensor's, but a model's of the load
//! [signals]                     # message paths; in CSV names of columns
//! position = "/joint_states.position[0]"      # rad
//! motor_torque = "/motor.effort[0]"           # Nm; { column = "u", unit = "V" } where it is none
//! joint_torque = "/joint_states.effort[0]"    # Nm, optional
//! temperature = "/temperature.temperature"    # degC, optional
//! valid = "/drive.enabled"                    # optional: what counts, where it is above 0.5; holds until it changes
//! time = { column = "t", unit = "ms" }        # tables only: the column that is time
//! extra.supply = "/power.voltage"             # anything else
//! [filter]                      # optional: as published, else chosen from the noise
//! butterworth_hz = 100          # position, order 4, forwards and backwards
//! decimation = 10               # of every column, after its Chebyshev low-pass
//! least_speed = 0.1             # rad/s, optional: slower rows are left out
//! [model]
//! inertia = 1.1                 # kg m², or { fit = true }
//! gear_ratio = 160              # optional
//! effects = ["coulomb", { name = "cogging", expression = "a*sin(k*q)", k = [5.0, 7.0] }]
//! ```
//!
//! A contact in place of a joint, equation (6) in place of (2):
//!
//! ```toml
//! recording = "edge"
//! [contact]                     # m, N
//! contour = [[0.2, -0.03], [0.4, -0.03]]      # optional, for `tip`: corners in order [m]
//! [signals]
//! tangential_force = "/follower/contact_cf.wrench.force.x.@negative" # N, opposes motion to larger places
//! normal_force = "/follower/contact_cf.wrench.force.z"               # N, pushes the tip out
//! position = "/follower/measured_cp.pose.position.x"                 # place along the contour [m]
//! # tip = ["/follower/measured_cp.pose.position.x", "/follower/measured_cp.pose.position.y"]
//! # tip = [{ column = "x", unit = "mm" }, { column = "y", unit = "mm" }]    # in place of position
//! temperature = "/temperature.temperature"    # degC, optional; time and extra as of a joint
//! [model]
//! effects = ["contact_coulomb", { name = "film", expression = "c*F_N*rd" }]
//! ```
//!
//! A whole arm in place of a joint: a table `[arm]`, see `arm.rs` here.
//!
//! `position` goes along a straight contour as it is; `tip` is laid on the
//! `contour`. [`contact`](self::contact) has the rest.
//!
//! A signal is a path or column, or a table with its `column` (or `path`), its
//! `unit` ([`Unit`](crate::unit::Unit); else SI) and, in tables, its own `time`.
//!
//! Relative paths count from the file's folder. `${FERNTAST_DATA}` at the
//! beginning of a path stands for the folder of shared recordings: the
//! environment variable of that name, else `../shared/data` seen from the
//! working folder ([`data_folder`]).

mod arm;
mod change;
mod contact;
mod date;
mod error;
mod file;
mod joint_readings;
mod lineage;
mod mapping;
#[cfg(test)]
mod mapping_tests;
mod of_each;
mod own;
mod reading;
mod signals;
#[cfg(test)]
mod tests;
mod write;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_identification::{CustomEffect, Inertia, JointType, ModelSpec, StatedFilter, Term};

use crate::table::Format;

pub(crate) use arm::POSITION;
pub use arm::{ArmTable, units_of_joint};
pub use change::{Change, Changed};
pub use contact::Contour;
pub use error::{ExperimentError, WriteError};
pub use joint_readings::JointReading;
pub use lineage::{FittedParameter, HistoryStep, Lineage, data_hash, history};
pub use mapping::{ArmPart, Mapped, Mapping, Place};
pub use own::RECORD;
pub use reading::{Join, Reading};
pub use signals::{Signals, units_for};
pub use write::{NextStep, turned, write_child};

/// What stands for the folder of shared recordings in a path.
pub const DATA_VARIABLE: &str = "${FERNTAST_DATA}";

/// An experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Its file; `None` for a recording alone.
    pub path: Option<PathBuf>,
    /// For people: the file's name, or the joint's.
    pub title: String,
    /// What is fitted.
    pub recordings: Vec<PathBuf>,
    /// Files that are joined to a recording, by that.
    pub joined: BTreeMap<PathBuf, Vec<PathBuf>>,
    /// Conditions under which a recording was made, by that.
    pub conditions: BTreeMap<PathBuf, BTreeMap<String, f64>>,
    /// When a recording began \[ns since 1970\], by that: in place of what its times say.
    pub dates: BTreeMap<PathBuf, i64>,
    /// How tables are read.
    pub reading: Reading,
    /// What is never fitted.
    pub held_out: Vec<PathBuf>,
    /// What is fitted too, and was run free of load.
    pub unloaded: Vec<PathBuf>,
    /// Filters stated in the file.
    pub filter: Option<StatedFilter>,
    /// Kind of joint, or a contact.
    pub joint: JointType,
    /// Whether the joint torque is what a model of the load says, rather than a sensor's.
    pub torque_is_modelled: bool,
    /// Of a contact: what the tip is laid on, where it is not a place already.
    pub contour: Option<Contour>,
    /// Of a whole arm: its joints and links. Signals are then those of its first joint,
    /// and the others' extra ones.
    pub arm: Option<ArmTable>,
    /// Where the signals are.
    pub signals: Signals,
    /// The model that is believed; of an arm its effects as they are written, with `@joint`.
    pub model: ModelSpec,
    /// Where it came from.
    pub lineage: Option<Lineage>,
}

/// The folder of shared recordings: what the environment variable
/// `FERNTAST_DATA` says, else `../shared/data` seen from the working folder.
pub fn data_folder() -> PathBuf {
    std::env::var_os("FERNTAST_DATA").map_or_else(|| "../shared/data".into(), PathBuf::from)
}

/// Where a recording is that an experiment file in `folder` calls `text`; one that begins with
/// [`DATA_VARIABLE`] is in `data_folder`.
#[must_use]
pub fn recording_at(text: &str, folder: &Path, data_folder: &Path) -> PathBuf {
    match text.strip_prefix(DATA_VARIABLE) {
        Some(rest) => data_folder.join(rest.trim_start_matches('/')),
        None => folder.join(text),
    }
}

/// The folder that a file lies in.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

impl Experiment {
    /// The joint called `title` in one of our own recordings, no file beside it.
    #[must_use]
    pub fn of_joint(title: &str, recording: &Path, signals: Signals, model: ModelSpec) -> Self {
        Experiment {
            path: None,
            title: title.to_owned(),
            recordings: vec![recording.to_owned()],
            joined: BTreeMap::new(),
            conditions: BTreeMap::new(),
            dates: BTreeMap::new(),
            reading: Reading::default(),
            held_out: Vec::new(),
            unloaded: Vec::new(),
            filter: None,
            joint: JointType::Revolute,
            torque_is_modelled: false,
            contour: None,
            arm: None,
            signals,
            model,
            lineage: None,
        }
    }

    /// Reads what a command was given: an experiment file (`.toml`), or a
    /// recording of ferntast's own, which gives one experiment a joint.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`].
    pub fn open(path: &Path, data_folder: &Path) -> Result<Vec<Experiment>, ExperimentError> {
        if Format::of(path).is_some() && !path.is_dir() {
            return Err(ExperimentError::IsRecording {
                path: path.to_owned(),
            });
        }
        let is_recording = path.is_dir() || path.extension().is_some_and(|end| end == "mcap");
        match is_recording {
            true => own::of_recording(path),
            false => Ok(vec![Experiment::read(path, data_folder)?]),
        }
    }

    /// Every file that it reads, fitted ones first.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = [&self.recordings[..], &self.unloaded[..], &self.held_out[..]].concat();
        let joined = files.iter().filter_map(|own| self.joined.get(own));
        files.extend(joined.flatten().cloned().collect::<Vec<PathBuf>>());
        files
    }

    /// Reads an experiment file.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`]: file, line, key, and what is wrong.
    pub fn read(path: &Path, data_folder: &Path) -> Result<Experiment, ExperimentError> {
        let is_mcap = path.extension().is_some_and(|end| end == "mcap");
        if Format::of(path).is_some() || is_mcap {
            return Err(ExperimentError::IsRecording {
                path: path.to_owned(),
            });
        }
        let text = std::fs::read_to_string(path).map_err(|source| ExperimentError::Read {
            path: path.to_owned(),
            source,
        })?;
        Experiment::parse(&text, path, data_folder)
    }

    /// The experiment in `text`, the content of the file at `path`.
    ///
    /// # Errors
    ///
    /// As [`Experiment::read`].
    pub fn parse(
        text: &str,
        path: &Path,
        data_folder: &Path,
    ) -> Result<Experiment, ExperimentError> {
        let file: file::File = toml::from_str(text).map_err(|error| ExperimentError::Syntax {
            path: path.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })?;
        let refuse = |key: &str, reason: String| ExperimentError::Value {
            path: path.to_owned(),
            key: key.to_owned(),
            reason,
        };
        let folder = folder_of(path);
        let of_text = |text: String| recording_at(&text, &folder, data_folder);
        let mut joined = BTreeMap::new();
        let mut conditions = BTreeMap::new();
        let mut dates = BTreeMap::new();
        let mut known = BTreeMap::new();
        let mut resolve = |key: &str, recordings: file::Recordings| {
            let mut firsts = Vec::new();
            for file::Listed { files, stated } in recordings.list() {
                let mut files = files.into_iter().map(of_text);
                let Some(first) = files.next() else {
                    continue;
                };
                let others: Vec<PathBuf> = files.collect();
                // What belongs to a recording is found by its first file.
                let own = (others.clone(), stated.clone());
                if known
                    .insert(first.clone(), own.clone())
                    .is_some_and(|before| before != own)
                {
                    let first = first.display();
                    let reason = format!(
                        "{first} begins more than one recording: name another of the files that are joined first, and state the conditions of a recording once"
                    );
                    return Err(refuse(key, reason));
                }
                if !others.is_empty() {
                    joined.insert(first.clone(), others);
                }
                if let Some(date) = &stated.date {
                    let began = date::nanoseconds(date)
                        .map_err(|reason| refuse(&format!("{key}.date"), reason))?;
                    dates.insert(first.clone(), began);
                }
                if !stated.conditions.is_empty() {
                    conditions.insert(first.clone(), stated.conditions);
                }
                firsts.push(first);
            }
            Ok(firsts)
        };
        let recordings = resolve("recording", file.recording)?;
        let held_out = resolve("held_out", file.held_out)?;
        let unloaded = resolve("unloaded", file.unloaded)?;
        if recordings.is_empty() {
            return Err(refuse(
                "recording",
                "the list is empty: name a recording".to_owned(),
            ));
        }
        for (name, value) in conditions.values().flatten() {
            condition(name, *value, &refuse)?;
        }
        let arm = match file.arm {
            None => None,
            Some(_) if file.joint.is_some() || file.contact.is_some() => {
                let reason =
                    "there is a [joint] or [contact] too: an experiment is about one of the three";
                return Err(refuse("arm", reason.to_owned()));
            }
            Some(table) => {
                let urdf = of_text(table.urdf.clone());
                Some(arm::table(table, urdf, &refuse)?)
            }
        };
        let torque_is_modelled = file
            .joint
            .as_ref()
            .is_some_and(|own| own.torque_is_modelled);
        if torque_is_modelled && file.signals.joint_torque.is_none() {
            let reason = "there is no signals.joint_torque that a model gives";
            return Err(refuse("joint.torque_is_modelled", reason.to_owned()));
        }
        let (joint, contour) = match (file.joint, file.contact) {
            (None, None) if arm.is_some() => {
                (arm.as_ref().map(arm::joint_type).unwrap_or_default(), None)
            }
            (Some(_), Some(_)) => {
                let reason = "there is a [joint] too: an experiment is about one of the two";
                return Err(refuse("contact", reason.to_owned()));
            }
            (Some(joint), None) if joint.kind.is_contact() => {
                let reason = "a contact has a table of its own: write [contact] instead of [joint]";
                return Err(refuse("joint.type", reason.to_owned()));
            }
            (joint, None) => (joint.map(|joint| joint.kind).unwrap_or_default(), None),
            (None, Some(table)) => {
                let contour = contact::contour(table.contour, file.signals.tip.is_some(), &refuse)?;
                (JointType::Contact, contour)
            }
        };
        let title = path.file_name().unwrap_or(path.as_os_str());
        Ok(Experiment {
            path: Some(path.to_owned()),
            title: title.to_string_lossy().into_owned(),
            recordings,
            joined,
            conditions,
            dates,
            reading: reading::reading(
                file.columns,
                file.rate_hz,
                file.join,
                file.readings,
                &refuse,
            )?,
            held_out,
            unloaded,
            filter: filter(file.filter, &refuse)?,
            joint,
            torque_is_modelled,
            contour,
            signals: match &arm {
                Some(arm) => arm::signals(arm, file.signals, &refuse)?,
                None => signals::signals(file.signals, joint, &refuse)?,
            },
            model: model(file.model, joint, arm.is_some(), &refuse)?,
            arm,
            lineage: file.lineage,
        })
    }
}

fn condition(
    name: &str,
    value: f64,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<(), ExperimentError> {
    let key = format!("recording.conditions.{name}");
    if !is_name(name) {
        return Err(refuse(&key, NO_NAME.to_owned()));
    }
    if !value.is_finite() {
        return Err(refuse(&key, format!("{value} is no number")));
    }
    Ok(())
}

fn filter(
    stated: Option<StatedFilter>,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Option<StatedFilter>, ExperimentError> {
    if let Some(filter) = &stated {
        if !(0.01..=1e5).contains(&filter.butterworth_hz) {
            let reason = format!("{} is outside 0.01 … 100000 Hz", filter.butterworth_hz);
            return Err(refuse("filter.butterworth_hz", reason));
        }
        if !(1..=100).contains(&filter.decimation) {
            let reason = format!("{} is outside 1 … 100", filter.decimation);
            return Err(refuse("filter.decimation", reason));
        }
        if !(0.0..=1e3).contains(&filter.least_speed) {
            let reason = format!("{} is outside 0 … 1000", filter.least_speed);
            return Err(refuse("filter.least_speed", reason));
        }
    }
    Ok(stated)
}

const NO_NAME: &str = "a name is letters, digits and underscores, a letter first";

fn is_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn model(
    model: file::Model,
    joint: JointType,
    is_arm: bool,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<ModelSpec, ExperimentError> {
    let of_arm = [
        ("inertia", model.inertia.is_some()),
        ("gear_ratio", model.gear_ratio.is_some()),
    ];
    if let (Some((key, _)), true) = (of_arm.iter().find(|(_, given)| *given), is_arm) {
        let reason = "an arm has one for each joint: armature and gear_ratio in [arm]".to_owned();
        return Err(refuse(&format!("model.{key}"), reason));
    }
    let inertia = match is_arm {
        true => Inertia::Given(0.0),
        false => inertia(model.inertia, joint, refuse)?,
    };
    if let Some(ratio) = model.gear_ratio
        && !(ratio.is_finite() && (1e-3..=1e6).contains(&ratio))
    {
        let reason = format!("{ratio} is outside 0.001 … 1000000; set it within these bounds");
        return Err(refuse("model.gear_ratio", reason));
    }
    if model.gear_ratio.is_some() && joint.is_contact() {
        let reason = "a contact has no gear: leave it out".to_owned();
        return Err(refuse("model.gear_ratio", reason));
    }
    let mut effects: Vec<Term> = Vec::new();
    for (index, effect) in model.effects.into_iter().enumerate() {
        let key = format!("model.effects[{index}]");
        let term = match effect {
            file::Effect::Catalogue(id) => Term::Catalogue(id),
            file::Effect::Custom(custom) => Term::Custom(checked(custom, &key, refuse)?),
        };
        if effects.iter().any(|other| other.name() == term.name()) {
            return Err(refuse(&key, format!("{} is there twice", term.name())));
        }
        effects.push(term);
    }
    Ok(ModelSpec {
        inertia,
        gear_ratio: model.gear_ratio,
        effects,
    })
}

fn inertia(
    inertia: Option<file::Inertia>,
    joint: JointType,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Inertia, ExperimentError> {
    let reason = match (inertia, joint.is_contact()) {
        (None, true) => return Ok(Inertia::Given(0.0)),
        (Some(_), true) => "a contact has no inertia: leave it out".to_owned(),
        (None, false) => "it is missing: give a number, or { fit = true }".to_owned(),
        (Some(file::Inertia::Given(value)), false) if (0.0..=1e6).contains(&value) => {
            return Ok(Inertia::Given(value));
        }
        (Some(file::Inertia::Given(value)), false) => {
            format!("{value} is outside 0 … 1000000 kg m²; set it within these bounds")
        }
        (Some(file::Inertia::Fit(file::FitTable { fit: true })), false) => return Ok(Inertia::Fit),
        (Some(file::Inertia::Fit(_)), false) => {
            "give a number, or { fit = true } to have it fitted".to_owned()
        }
    };
    Err(refuse("model.inertia", reason))
}

fn checked(
    custom: file::Custom,
    key: &str,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<CustomEffect, ExperimentError> {
    // Of an arm the name may say of which joint.
    let (name, _) = custom.name.split_once('@').unwrap_or((&custom.name, ""));
    if !is_name(name) {
        return Err(refuse(&format!("{key}.name"), NO_NAME.to_owned()));
    }
    if custom.expression.trim().is_empty() {
        return Err(refuse(
            &format!("{key}.expression"),
            "it is empty".to_owned(),
        ));
    }
    for (parameter, [lower, upper]) in &custom.bounds {
        if !(lower.is_finite() && upper.is_finite() && lower < upper) {
            let reason = format!(
                "the bounds [{lower}, {upper}] exclude every value; give [lower, upper], lower below upper"
            );
            return Err(refuse(&format!("{key}.{parameter}"), reason));
        }
    }
    Ok(CustomEffect {
        name: custom.name,
        expression: custom.expression,
        bounds: custom.bounds,
    })
}

//! The experiment file: which recordings, which signals, which model.
//!
//! ```toml
//! recording = "run.mcap"        # or a list: rosbag2 directories, .mcap, .csv
//! unloaded = ["free.mcap"]      # optional: fitted too, run free of load: shows the torque sensor's zero
//! held_out = ["other.mcap"]     # optional: never fitted
//! [joint]
//! type = "revolute"             # or "prismatic": m, N, kg
//! [signals]                     # message paths; in CSV names of columns
//! position = "/joint_states.position[0]"      # rad
//! motor_torque = "/motor.effort[0]"           # Nm
//! joint_torque = "/joint_states.effort[0]"    # Nm, optional
//! temperature = "/temperature.temperature"    # degC, optional
//! time = "t_s"                  # CSV only: the column that is time [s]
//! extra.supply = "/power.voltage"             # anything else
//! [filter]                      # optional: as published, else chosen from the noise
//! butterworth_hz = 100          # position, order 4, forwards and backwards
//! decimation = 10               # of every column, after its Chebyshev low-pass
//! [model]
//! inertia = 1.1                 # kg m², or { fit = true }
//! gear_ratio = 160              # optional
//! effects = ["coulomb", { name = "cogging", expression = "a*sin(k*q)", k = [5.0, 7.0] }]
//! ```
//!
//! Relative paths count from the file's folder. `${FERNTAST_DATA}` at the
//! beginning of a path stands for the folder of shared recordings: the
//! environment variable of that name, else `../shared/data` seen from the
//! working folder ([`data_folder`]).

mod error;
mod file;
mod lineage;
mod own;
#[cfg(test)]
mod tests;
mod write;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_identification::{CustomEffect, Inertia, JointType, ModelSpec, StatedFilter, Term};

pub use error::{ExperimentError, WriteError};
pub use lineage::{FittedParameter, HistoryStep, Lineage, data_hash, history};
pub use own::RECORD;
pub use write::{NextStep, write_child};

/// What stands for the folder of shared recordings in a path.
pub const DATA_VARIABLE: &str = "${FERNTAST_DATA}";

/// Names that mean something in expressions already.
const TAKEN: [&str; 7] = ["q", "qd", "qdd", "tau", "tau_m", "T", "t"];

/// An experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Its file; `None` for a recording alone.
    pub path: Option<PathBuf>,
    /// For people: the file's name, or the joint's.
    pub title: String,
    /// What is fitted.
    pub recordings: Vec<PathBuf>,
    /// What is never fitted.
    pub held_out: Vec<PathBuf>,
    /// What is fitted too, and was run free of load.
    pub unloaded: Vec<PathBuf>,
    /// Filters stated in the file.
    pub filter: Option<StatedFilter>,
    /// Kind of joint.
    pub joint: JointType,
    /// Where the signals are.
    pub signals: Signals,
    /// The model that is believed.
    pub model: ModelSpec,
    /// Where it came from.
    pub lineage: Option<Lineage>,
}

/// Where the signals are: message paths, in CSV names of columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    /// q \[rad\].
    pub position: String,
    /// τ_m \[Nm\].
    pub motor_torque: String,
    /// τ \[Nm\].
    pub joint_torque: Option<String>,
    /// \[degC\].
    pub temperature: Option<String>,
    /// In CSV the column that is time \[s\].
    pub time: Option<String>,
    /// Anything else by name.
    pub extra: BTreeMap<String, String>,
}

/// The folder of shared recordings: what the environment variable
/// `FERNTAST_DATA` says, else `../shared/data` seen from the working folder.
pub fn data_folder() -> PathBuf {
    std::env::var_os("FERNTAST_DATA").map_or_else(|| "../shared/data".into(), PathBuf::from)
}

/// The folder that a file lies in.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

impl Experiment {
    /// Reads what a command was given: an experiment file (`.toml`), or a
    /// recording of ferntast's own, which gives one experiment a joint.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`].
    pub fn open(path: &Path, data_folder: &Path) -> Result<Vec<Experiment>, ExperimentError> {
        let is_recording = path.is_dir() || path.extension().is_some_and(|end| end == "mcap");
        match is_recording {
            true => own::of_recording(path),
            false => Ok(vec![Experiment::read(path, data_folder)?]),
        }
    }

    /// Reads an experiment file.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`]: file, line, key, and what is wrong.
    pub fn read(path: &Path, data_folder: &Path) -> Result<Experiment, ExperimentError> {
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
        let resolve = |paths: file::Paths| -> Vec<PathBuf> {
            let paths = paths.list().into_iter();
            let resolved = paths.map(|text| match text.strip_prefix(DATA_VARIABLE) {
                Some(rest) => data_folder.join(rest.trim_start_matches('/')),
                None => folder.join(text),
            });
            resolved.collect()
        };
        let recordings = resolve(file.recording);
        if recordings.is_empty() {
            return Err(refuse(
                "recording",
                "the list is empty: name a recording".to_owned(),
            ));
        }
        let title = path.file_name().unwrap_or(path.as_os_str());
        Ok(Experiment {
            path: Some(path.to_owned()),
            title: title.to_string_lossy().into_owned(),
            recordings,
            held_out: resolve(file.held_out),
            unloaded: resolve(file.unloaded),
            filter: filter(file.filter, &refuse)?,
            joint: file.joint.kind,
            signals: signals(file.signals, &refuse)?,
            model: model(file.model, &refuse)?,
            lineage: file.lineage,
        })
    }
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
    }
    Ok(stated)
}

fn signals(
    table: file::SignalsTable,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Signals, ExperimentError> {
    for name in table.extra.keys() {
        let key = format!("signals.extra.{name}");
        if TAKEN.contains(&name.as_str()) {
            let reason = format!(
                "the name is taken; choose another than {}",
                TAKEN.join(", ")
            );
            return Err(refuse(&key, reason));
        }
        if !is_name(name) {
            return Err(refuse(&key, NO_NAME.to_owned()));
        }
    }
    Ok(Signals {
        position: table.position,
        motor_torque: table.motor_torque,
        joint_torque: table.joint_torque,
        temperature: table.temperature,
        time: table.time,
        extra: table.extra,
    })
}

const NO_NAME: &str = "a name is letters, digits and underscores, a letter first";

fn is_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn model(
    model: file::Model,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<ModelSpec, ExperimentError> {
    let inertia = match model.inertia {
        file::Inertia::Given(value) if value.is_finite() && (0.0..=1e6).contains(&value) => {
            Inertia::Given(value)
        }
        file::Inertia::Given(value) => {
            let reason =
                format!("{value} is outside 0 … 1000000 kg m²; set it within these bounds");
            return Err(refuse("model.inertia", reason));
        }
        file::Inertia::Fit(file::FitTable { fit: true }) => Inertia::Fit,
        file::Inertia::Fit(_) => {
            let reason = "give a number, or { fit = true } to have it fitted".to_owned();
            return Err(refuse("model.inertia", reason));
        }
    };
    if let Some(ratio) = model.gear_ratio
        && !(ratio.is_finite() && (1e-3..=1e6).contains(&ratio))
    {
        let reason = format!("{ratio} is outside 0.001 … 1000000; set it within these bounds");
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

fn checked(
    custom: file::Custom,
    key: &str,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<CustomEffect, ExperimentError> {
    if !is_name(&custom.name) {
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

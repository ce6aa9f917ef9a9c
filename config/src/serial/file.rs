//! Reads an arm's file: a TOML file beside a URDF, or a URDF alone.
//!
//! ```toml
//! [arm]
//! urdf = "panda.urdf"      # beside this file
//! # base, tip: links; the whole arm where left out
//! # home: a posture; gravity; torque_sensors = false where the joints have none
//!
//! [[joint]]                # what is different from the defaults, by the URDF's names
//! name = "panda_joint1"
//! motor_inertia = 0.6
//!
//! [[surface]]              # planes that the tip can touch; a table below it where left out
//! name = "table"
//! point = [0.5, 0.0, 0.2]
//! normal = [0.0, 0.0, 1.0]
//!
//! # [servo] and [estimator]: as in a scenario and an arm's file, key by key
//! # [truth]: what only the simulated arm's driver reads; [driver.NAME]: what only that of hardware reads
//! ```

use std::{fs, path::Path};

use ferntast_control::estimator::Form;
use ferntast_model::serial_arm::Plane;
use ferntast_urdf::{Arm, Robot};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{SerialError, SerialFile, defaults::Defaults};
use crate::{ARM, ArmFile, ConfigError, file::find};

/// What the user writes.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    arm: ArmSection,
    #[serde(default)]
    joint: Vec<toml::Table>,
    surface: Option<Vec<Plane>>,
    #[serde(default)]
    servo: toml::Table,
    #[serde(default)]
    estimator: toml::Table,
    truth: Option<serde_json::Value>,
    driver: Option<serde_json::Value>,
}

/// The section `[arm]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct ArmSection {
    urdf: String,
    base: Option<String>,
    tip: Option<String>,
    home: Option<Vec<f64>>,
    gravity: Option<[f64; 3]>,
    torque_sensors: Option<bool>,
}

/// Loads the serial arm `name`: a URDF file, or a file of arms that names one. `None` where it
/// is another kind of file.
///
/// # Errors
///
/// What is wrong, in which file, and how to correct it.
pub fn load_serial(name: &str) -> Result<Option<ArmFile>, ConfigError> {
    let stem = |path: &str| {
        let stem = Path::new(path).file_stem();
        stem.map_or_else(|| path.to_owned(), |own| own.to_string_lossy().into_owned())
    };
    if has_ending(name, "urdf") {
        let written = Written {
            arm: ArmSection {
                urdf: name.to_owned(),
                ..ArmSection::default()
            },
            ..Written::default()
        };
        let text = read(Path::new(name))?;
        let file = resolved(stem(name), text, written).map_err(|error| (name, error))?;
        return ArmFile::serial(&file).map(Some);
    }
    let source = find(ARM, name)?;
    let table: toml::Table = match toml::from_str(&source.text) {
        Ok(table) => table,
        // Who reads the other kind says what is wrong.
        Err(_) => return Ok(None),
    };
    let arm = table.get("arm").and_then(toml::Value::as_table);
    if !arm.is_some_and(|arm| arm.contains_key("urdf")) {
        return Ok(None);
    }
    let written: Written = toml::from_str(&source.text).map_err(|error| ConfigError::Syntax {
        path: source.path.clone(),
        message: error.to_string().trim_end().to_owned(),
    })?;
    let text = match &source.folder {
        Some(folder) => read_beside(&stem(name), &folder.join(&written.arm.urdf))?,
        None => find_shipped_urdf(&stem(name), &written.arm.urdf)?,
    };
    let path = source.path.as_str();
    let file = resolved(stem(name), text, written).map_err(|error| (path, error))?;
    ArmFile::serial(&file).map(Some)
}

fn has_ending(name: &str, ending: &str) -> bool {
    let own = Path::new(name).extension();
    own.is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

fn read(path: &Path) -> Result<String, ConfigError> {
    let read = fs::read(path).map_err(|source| ConfigError::Read {
        path: path.to_owned(),
        source,
    })?;
    // What is no text the reader of URDF refuses, with the line.
    Ok(String::from_utf8_lossy(&read).into_owned())
}

/// The URDF beside the file of an arm, which may have come along without it.
fn read_beside(arm: &str, path: &Path) -> Result<String, ConfigError> {
    let came_along = |name: &str| crate::shipped::text(&format!("{}/{name}", ARM.folder)).is_some();
    let urdf = path.file_name().unwrap_or_default().to_string_lossy();
    if !path.exists() && came_along(&format!("{arm}.toml")) && !came_along(&urdf) {
        return Err(ConfigError::NoUrdf {
            arm: arm.to_owned(),
            path: path.to_owned(),
        });
    }
    read(path)
}

/// The URDF of an arm that comes along; what is below `config/` on disk comes first.
fn find_shipped_urdf(arm: &str, name: &str) -> Result<String, ConfigError> {
    let path = format!("{}/{name}", ARM.folder);
    let on_disk = Path::new("config").join(&path);
    if on_disk.is_file() {
        return read(&on_disk);
    }
    let text = crate::shipped::text(&path);
    text.map(str::to_owned).ok_or(ConfigError::NoUrdf {
        arm: arm.to_owned(),
        path: on_disk,
    })
}

/// The file with all that was left out.
fn resolved(name: String, urdf: String, written: Written) -> Result<SerialFile, SerialError> {
    let robot = Robot::read(urdf.as_bytes())?;
    let Written {
        arm: section,
        joint,
        surface,
        servo,
        estimator,
        truth,
        driver,
    } = written;
    let arm = arm(&robot, section.base.as_deref(), section.tip.as_deref())?;
    let mut defaults = Defaults::new(&arm, section.gravity, section.home)?;
    for (number, entry) in (1..).zip(joint) {
        let index = which(&arm, number, &entry)?;
        let mut entry = entry;
        entry.remove("name");
        let section = format!("joint \"{}\"", arm.joints[index]);
        defaults.joint[index] = merged(&defaults.joint[index], entry, &section)?;
    }
    // Gains go with the inertias of what was written.
    let own = defaults.servo(&arm)?;
    let mut forces = defaults.estimator();
    if section.torque_sensors == Some(false) {
        forces.form = Form::MotorCurrent;
    }
    let file = SerialFile {
        name,
        urdf,
        base: arm.base.clone(),
        tip: arm.tip.clone(),
        gravity: defaults.gravity,
        surface: surface.unwrap_or_else(|| vec![defaults.table(&arm)]),
        home: defaults.home,
        joint: defaults.joint,
        estimator: merged(&forces, estimator, "estimator")?,
        servo: merged(&own, servo, "servo")?,
        truth,
        driver,
    };
    file.believed()?;
    Ok(file)
}

/// The arm that the file means; a link that there is not is told with those that there are.
fn arm(robot: &Robot, base: Option<&str>, tip: Option<&str>) -> Result<Arm, SerialError> {
    let whole = match (base, tip) {
        (Some(base), Some(tip)) => return Ok(robot.between(base, tip)?),
        (None, None) => return Ok(robot.whole_arm()?),
        _ => robot.whole_arm()?,
    };
    let (base, tip) = (base.unwrap_or(&whole.base), tip.unwrap_or(&whole.tip));
    Ok(robot.between(base, tip)?)
}

/// The joint that an entry is about.
fn which(arm: &Arm, number: usize, entry: &toml::Table) -> Result<usize, SerialError> {
    let name = entry.get("name").and_then(toml::Value::as_str);
    let name = name.ok_or(SerialError::NoName(number))?;
    let found = arm.joints.iter().position(|own| own == name);
    found.ok_or_else(|| SerialError::NoSuchJoint {
        name: name.to_owned(),
        known: arm.joints.join(", "),
    })
}

/// `own` with what `entry` says in its place, key by key.
pub(super) fn merged<T: Serialize + DeserializeOwned>(
    own: &T,
    entry: toml::Table,
    section: &str,
) -> Result<T, SerialError> {
    let bad = |message: String| SerialError::Section {
        section: section.to_owned(),
        message,
    };
    let mut value = serde_json::to_value(own).map_err(|error| bad(error.to_string()))?;
    for (key, given) in entry {
        let given = serde_json::to_value(given).map_err(|error| bad(error.to_string()))?;
        value[key] = given;
    }
    serde_json::from_value(value).map_err(|error| bad(error.to_string()))
}

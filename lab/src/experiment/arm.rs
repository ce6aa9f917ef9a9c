//! An experiment on a whole arm in place of one joint.
//!
//! ```toml
//! recording = "run.mcap"
//! [arm]
//! urdf = "panda.urdf"
//! joints = ["panda_joint1", "panda_joint2"]   # from the base on; or base = "…", tip = "…" (links)
//! armature = [0.6, 0.6]                       # kg m², motor and gear of each joint; else fitted
//! gravity = [0.0, 0.0, -9.81]                 # m/s², in the base's frame; this is the default
//! gear_ratio = [100, 100]                     # optional
//! drive_gain = [14.9, 13.3]                   # Nm/A, gear included, where motor_torque is a current; Nm/V, …
//! reversed = ["panda_joint2"]                 # optional: whose position and torque count the other way round
//! torque_reversed = []                        # optional: whose torque does
//! zero = { panda_joint2 = 1.5708 }            # optional, rad: what is added to positions
//! [signals]                                   # arrays by joint name, or one path or column each:
//! position = "/joint_states.position"         # ["q1", { column = "q2", unit = "deg" }], "q_{joint}"
//! motor_torque = "/joint_states.effort"
//! [model]                                     # of every joint, of one, of the arm
//! effects = ["coulomb", "viscous", "stribeck@panda_joint2", "payload", "link_inertia@panda_joint1"]
//! ```

use std::{collections::BTreeMap, path::PathBuf};

use ferntast_identification::JointType;
use ferntast_urdf::{Arm, JointType as UrdfJointType, Robot};

use super::joint_readings::{self, JointReading};
use super::{Experiment, ExperimentError, Signals, file};
use crate::unit::{Quantity, Unit};

/// Gravity in the frame of a base that stands upright \[m/s²\].
const UPRIGHT: [f64; 3] = [0.0, 0.0, -9.81];
/// Extra signals that are a joint's position or torque have its name behind these.
pub(crate) const POSITION: &str = "position@";
const MOTOR_TORQUE: &str = "motor_torque@";

/// The table `[arm]`.
#[derive(Clone, Debug)]
pub struct ArmTable {
    /// The URDF.
    pub urdf: PathBuf,
    /// Joints and links of it.
    pub arm: Arm,
    /// Inertia of motor and gear of each joint \[kg m²\] or \[kg\]; `None`: fitted.
    pub armature: Option<Vec<f64>>,
    /// Gravity in the base frame \[m/s²\].
    pub gravity: [f64; 3],
    /// Gear ratio of each joint.
    pub gear_ratio: Option<Vec<f64>>,
    /// How position and torque of each joint are read.
    pub readings: Vec<JointReading>,
}

/// What the table says is what the file says.
impl PartialEq for ArmTable {
    fn eq(&self, other: &Self) -> bool {
        (self.urdf == other.urdf && self.arm.joints == other.arm.joints)
            && (self.armature == other.armature && self.gravity == other.gravity)
            && self.gear_ratio == other.gear_ratio
            && self.readings == other.readings
    }
}

impl ArmTable {
    /// Names of its joints, from the base on.
    #[must_use]
    pub fn joints(&self) -> &[String] {
        &self.arm.joints
    }

    /// Unit of the torque or force of the joint of that name; of none, as of an effect of the arm,
    /// that of all: of joints that turn and joints that slide both.
    #[must_use]
    pub fn torque_unit(&self, joint: Option<&str>) -> &'static str {
        let unit = |joint: &str| self.kind(joint).unwrap_or_default().force_unit();
        if let Some(joint) = joint {
            return unit(joint);
        }
        let all = |of: &str| self.joints().iter().all(|own| unit(own) == of);
        let same = ["Nm", "N"].into_iter().find(|of| all(of));
        same.unwrap_or("Nm or N")
    }

    /// Kind of the joint of that name.
    fn kind(&self, joint: &str) -> Option<JointType> {
        let at = self.arm.joints.iter().position(|own| own == joint)?;
        Some((*self.arm.chain.kinds().get(at)?).into())
    }
}

/// The units that a joint of an arm may have its `position` or `motor_torque` in. The torques of
/// the links are known, so that of what goes into a drive it has to be known what torque it makes.
#[must_use]
pub fn units_of_joint(key: &str, joint: JointType) -> Vec<&'static str> {
    match (key, joint) {
        ("position", JointType::Revolute) => Quantity::Angle.units(),
        ("position", _) => Quantity::Length.units(),
        (_, JointType::Revolute) => [Quantity::Torque, Quantity::Drive]
            .map(Quantity::units)
            .concat(),
        _ => [Quantity::Force, Quantity::Drive]
            .map(Quantity::units)
            .concat(),
    }
}

/// Reads the URDF that the table names.
pub(super) fn table(
    table: file::Arm,
    urdf: PathBuf,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<ArmTable, ExperimentError> {
    let bytes = std::fs::read(&urdf).map_err(|source| ExperimentError::Read {
        path: urdf.clone(),
        source,
    })?;
    let wrong = |reason: String| refuse("arm.urdf", format!("{}: {reason}", urdf.display()));
    let robot = Robot::read(&bytes).map_err(|error| wrong(error.to_string()))?;
    let arm = match (&table.joints, &table.base, &table.tip) {
        (Some(joints), _, _) => robot.of_joints(joints),
        (None, Some(base), Some(tip)) => robot.between(base, tip),
        (None, ..) => {
            let movable = |kind| kind != UrdfJointType::Fixed;
            let names = robot.joints.iter().filter(|own| movable(own.joint_type));
            let names: Vec<&str> = names.map(|own| own.name.as_str()).collect();
            let reason = format!(
                "it is missing: list the joints from the base on, of {}; or give the links base and tip",
                names.join(", ")
            );
            return Err(refuse("arm.joints", reason));
        }
    };
    let arm = arm.map_err(|error| wrong(error.to_string()))?;
    let count = arm.joints.len();
    let each = |key: &str, values: &Option<Vec<f64>>, least: f64| {
        let Some(values) = values else {
            return Ok(());
        };
        let reason = if values.len() != count {
            format!("{} values for {count} joints; give one each", values.len())
        } else if let Some(value) = values.iter().find(|own| !(least..=1e6).contains(*own)) {
            format!("{value} is outside {least} … 1000000")
        } else {
            return Ok(());
        };
        Err(refuse(key, reason))
    };
    each("arm.armature", &table.armature, 0.0)?;
    each("arm.gear_ratio", &table.gear_ratio, 1e-3)?;
    each("arm.drive_gain", &table.drive_gain, 1e-6)?;
    let gravity = table.gravity.unwrap_or(UPRIGHT);
    if !gravity.iter().all(|own| own.abs() <= 100.0) {
        let reason = format!("{gravity:?} is no acceleration within 100 m/s²");
        return Err(refuse("arm.gravity", reason));
    }
    let readings = joint_readings::readings(&table, &arm.joints, refuse)?;
    Ok(ArmTable {
        urdf,
        readings,
        arm,
        armature: table.armature,
        gravity,
        gear_ratio: table.gear_ratio,
    })
}

/// Where position and torque of every joint are: those of the first as of one joint, those of
/// the others as extra signals.
pub(super) fn signals(
    arm: &ArmTable,
    table: file::SignalsTable,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Signals, ExperimentError> {
    let of_others = [
        ("tip", table.tip.is_some()),
        ("tangential_force", table.tangential_force.is_some()),
        ("normal_force", table.normal_force.is_some()),
        ("joint_torque", table.joint_torque.is_some()),
        ("temperature", table.temperature.is_some()),
        ("extra", !table.extra.is_empty()),
    ];
    if let Some((key, _)) = of_others.iter().find(|(_, given)| *given) {
        let reason = "signals of an [arm] are position, motor_torque, valid and time".to_owned();
        return Err(refuse(&format!("signals.{key}"), reason));
    }
    let mut signals = Signals::default();
    let sources = [
        ("position", POSITION, table.position),
        ("motor_torque", MOTOR_TORQUE, table.motor_torque),
    ];
    for (key, prefix, source) in sources {
        let source = source.ok_or_else(|| {
            let reason = "it is missing: an array by joint name, as in \"/joint_states.position\"";
            refuse(&format!("signals.{key}"), reason.to_owned())
        })?;
        let places = places(arm, key, source, refuse)?;
        for (at, ((path, unit), joint)) in places.into_iter().zip(arm.joints()).enumerate() {
            let reading = arm.readings.get(at).filter(|_| key == "motor_torque");
            if let Some(wrong) = reading.and_then(|own| own.wrong_unit(unit, joint)) {
                return Err(refuse("signals.motor_torque", wrong));
            }
            let name = match at {
                0 => key.to_owned(),
                _ => format!("extra.{prefix}{joint}"),
            };
            if let Some(unit) = unit {
                signals.units.insert(name, unit);
            }
            match (at, key) {
                (0, "position") => signals.position = path,
                (0, _) => signals.motor_torque = path,
                _ => {
                    signals.extra.insert(format!("{prefix}{joint}"), path);
                }
            }
        }
    }
    let mut plain = |key: &str, source: Option<file::Source>| match source {
        None => Ok(None),
        Some(file::Source::Path(path)) => Ok(Some(path)),
        Some(file::Source::Table(table)) if table.time.is_none() => {
            if let Some(unit) = table.unit.as_deref().and_then(Unit::parse) {
                signals.units.insert(key.to_owned(), unit);
            }
            Ok(Some(table.column))
        }
        Some(_) => Err(refuse(
            &format!("signals.{key}"),
            "give one column".to_owned(),
        )),
    };
    let (valid, time) = (plain("valid", table.valid)?, plain("time", table.time)?);
    (signals.valid, signals.time) = (valid, time);
    Ok(signals)
}

/// Path or column of each joint, and its unit.
type Places = Vec<(String, Option<Unit>)>;

fn places(
    arm: &ArmTable,
    key: &str,
    source: file::Source,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Places, ExperimentError> {
    let joints = arm.joints();
    let wrong = |reason: String| refuse(&format!("signals.{key}"), reason);
    let one = |text: &str| -> Result<Vec<String>, ExperimentError> {
        if text.contains("{joint}") {
            let each = joints.iter().map(|joint| text.replace("{joint}", joint));
            return Ok(each.collect());
        }
        if !text.starts_with('/') || text.contains(['[', '{']) {
            return Err(wrong(format!(
                "{text:?} is of one joint: name an array (\"/joint_states.position\"), or list one path or column for each of {}",
                joints.join(", ")
            )));
        }
        let (array, function) = match text.find(".@") {
            Some(at) => text.split_at(at),
            None => (text, ""),
        };
        let each = joints.iter();
        Ok(each
            .map(|joint| format!("{array}[:]{{name=={joint:?}}}{function}"))
            .collect())
    };
    let stated = |text: Option<&str>| -> Result<Option<Unit>, ExperimentError> {
        let unit = text.and_then(Unit::parse);
        let allowed: &[Quantity] = match key {
            "position" => &[Quantity::Angle, Quantity::Length],
            _ => &[Quantity::Torque, Quantity::Force, Quantity::Drive],
        };
        let fits = unit.is_none_or(|unit| allowed.contains(&unit.quantity()));
        match text {
            Some(text) if unit.is_none() || !fits => {
                let names = allowed.iter().flat_map(|own| own.units());
                let names: Vec<&str> = names.collect();
                Err(wrong(format!(
                    "unit {text:?} is none of it; it can be one of {}",
                    names.join(", ")
                )))
            }
            _ => Ok(unit),
        }
    };
    let all = |paths: Vec<String>, unit: Option<Unit>| {
        let places = paths.into_iter().map(|path| (path, unit));
        places.collect::<Places>()
    };
    match source {
        file::Source::Path(text) => Ok(all(one(&text)?, None)),
        file::Source::Each(each) if each.len() == joints.len() => {
            let places = each.into_iter().map(|own| match own {
                file::OneSource::Path(path) => Ok((path, None)),
                file::OneSource::Table(table) => Ok((table.column, stated(table.unit.as_deref())?)),
            });
            places.collect()
        }
        file::Source::Each(each) => Err(wrong(format!(
            "{} paths for {} joints; give one each",
            each.len(),
            joints.len()
        ))),
        file::Source::Table(table) => {
            let unit = stated(table.unit.as_deref())?;
            Ok(all(one(&table.column)?, unit))
        }
    }
}

impl Experiment {
    /// Of what was read, positions and torques of all joints as the URDF counts them, session by session.
    pub(crate) fn of_joints(
        &self,
        position: &[f64],
        motor_torque: &[f64],
        extra: &BTreeMap<String, Vec<f64>>,
    ) -> Option<[Vec<Vec<f64>>; 2]> {
        let joints = self.arm.as_ref()?.joints();
        let all = |first: &[f64], prefix: &str| -> Option<Vec<Vec<f64>>> {
            let others = joints.iter().skip(1);
            let others = others.map(|joint| extra.get(&format!("{prefix}{joint}")).cloned());
            std::iter::once(Some(first.to_vec()))
                .chain(others)
                .collect()
        };
        let (mut positions, mut torques) =
            (all(position, POSITION)?, all(motor_torque, MOTOR_TORQUE)?);
        let readings = self.arm.as_ref()?.readings.iter();
        for ((reading, position), torque) in readings.zip(&mut positions).zip(&mut torques) {
            reading.apply(position, torque);
        }
        Some([positions, torques])
    }

    /// What the signals of an arm's first joint are called where each joint has one: `position@elbow`.
    pub(crate) fn key_in_arm(&self, signal: &str) -> Option<String> {
        let first = self.arm.as_ref()?.joints().first()?;
        match signal {
            "position" => Some(format!("{POSITION}{first}")),
            "motor_torque" => Some(format!("{MOTOR_TORQUE}{first}")),
            _ => None,
        }
    }

    /// The unit, after conversion, of a joint's signal of an arm as it is recorded.
    pub(super) fn unit_in_arm(&self, signal: &str) -> Option<&'static str> {
        let arm = self.arm.as_ref()?;
        let (key, joint) = signal.split_once('@')?;
        let is_first = arm.joints().first().is_some_and(|first| first == joint);
        let drive = match is_first {
            true => self.recorded_drive_unit(key),
            false => self.recorded_drive_unit(&format!("extra.{signal}")),
        };
        drive.or_else(|| units_of_joint(key, arm.kind(joint)?).first().copied())
    }

    /// Where positions and torques of an arm's joints are, by `position@elbow`, with units as they
    /// are stated.
    pub(super) fn places_in_arm(&self) -> Vec<(String, String, Option<Unit>)> {
        let Some(arm) = &self.arm else {
            return Vec::new();
        };
        let signals = &self.signals;
        let firsts = [
            ("position", POSITION, &signals.position),
            ("motor_torque", MOTOR_TORQUE, &signals.motor_torque),
        ];
        let mut places = Vec::new();
        for (at, joint) in arm.joints().iter().enumerate() {
            for (key, prefix, first) in firsts {
                let name = format!("{prefix}{joint}");
                let extra = format!("extra.{name}");
                let (path, key) = match at {
                    0 => (Some(first), key),
                    _ => (signals.extra.get(&name), extra.as_str()),
                };
                if let Some(path) = path {
                    places.push((name, path.clone(), signals.unit(key)));
                }
            }
        }
        places
    }
}

/// Kind of the first joint, whose signals stand for it.
pub(super) fn joint_type(arm: &ArmTable) -> JointType {
    let kinds = arm.arm.chain.kinds();
    kinds
        .first()
        .copied()
        .map(JointType::from)
        .unwrap_or_default()
}

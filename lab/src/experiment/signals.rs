//! Where the signals of an experiment are, and in which units.

use std::collections::BTreeMap;

use ferntast_identification::{JointType, effects::expression::signal_names};

use super::{Experiment, ExperimentError, NO_NAME, contact, file, is_name};
use crate::unit::{Quantity, Unit};

/// Where the signals are: message paths, in tables names of columns. Units are
/// those that signals have after conversion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals {
    /// q \[rad\]; of a contact the place along the contour \[m\], or x of the
    /// tip where there is a `tip_y`.
    pub position: String,
    /// y of the tip \[m\].
    pub tip_y: Option<String>,
    /// τ_m \[Nm\]; of a contact F_T \[N\].
    pub motor_torque: String,
    /// F_N \[N\] of a contact.
    pub normal_force: Option<String>,
    /// τ \[Nm\].
    pub joint_torque: Option<String>,
    /// \[degC\].
    pub temperature: Option<String>,
    /// Samples count where it is above 0.5, as while a drive is enabled.
    pub valid: Option<String>,
    /// In a table the column that is time \[s\].
    pub time: Option<String>,
    /// Anything else by name.
    pub extra: BTreeMap<String, String>,
    /// The units that are stated, by the signal's key (`extra.supply`).
    pub units: BTreeMap<String, Unit>,
    /// Columns that are the time of one signal alone, by the signal's key.
    pub times: BTreeMap<String, String>,
}

impl Signals {
    /// The unit that is stated for the signal with this key.
    #[must_use]
    pub fn unit(&self, key: &str) -> Option<Unit> {
        let key = match key {
            "tangential_force" => "motor_torque",
            key => key,
        };
        self.units.get(key).copied()
    }

    /// The signals of a joint that have a unit, with their paths.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let optional = [
            ("joint_torque", &self.joint_torque),
            ("normal_force", &self.normal_force),
            ("tip[1]", &self.tip_y),
            ("temperature", &self.temperature),
            ("time", &self.time),
        ];
        let optional = optional.into_iter();
        let optional = optional.filter_map(|(name, path)| Some((name, path.as_deref()?)));
        let place = match self.tip_y {
            Some(_) => "tip[0]",
            None => "position",
        };
        [
            (place, self.position.as_str()),
            ("motor_torque", self.motor_torque.as_str()),
        ]
        .into_iter()
        .chain(optional)
    }
}

impl Experiment {
    /// Unit of torques or forces: Nm or N, or what goes into the drive where no
    /// torque is known.
    #[must_use]
    pub fn force_unit(&self) -> &'static str {
        match self.drive_unit() {
            Some(unit) => unit,
            None => self.joint.force_unit(),
        }
    }

    /// The unit of what goes into the drive, where that stands for the torque; in an arm it is
    /// turned into one.
    #[must_use]
    pub fn drive_unit(&self) -> Option<&'static str> {
        match self.arm {
            Some(_) => None,
            None => self.recorded_drive_unit("motor_torque"),
        }
    }

    /// The unit of the signal with this key, where it is of what goes into a drive.
    pub(super) fn recorded_drive_unit(&self, key: &str) -> Option<&'static str> {
        let unit = self.signals.unit(key)?;
        (unit.quantity() == Quantity::Drive).then_some(unit.base())
    }

    /// The unit that the signal with this key has after conversion; empty where it
    /// has none.
    #[must_use]
    pub fn unit_of(&self, key: &str) -> String {
        let revolute = self.joint == JointType::Revolute;
        let unit = match key {
            "position" | "place" if revolute => "rad",
            "position" | "place" | "tip[0]" | "tip[1]" => "m",
            "motor_torque" | "joint_torque" | "normal_force" | "tangential_force" => {
                let recorded = self.recorded_drive_unit("motor_torque");
                recorded.unwrap_or_else(|| self.force_unit())
            }
            "temperature" => "degC",
            "time" => "s",
            key => match self.unit_in_arm(key) {
                Some(unit) => unit,
                None => self.signals.unit(key).map_or("", |unit| unit.name()),
            },
        };
        unit.to_owned()
    }
}

/// What a signal with this key may measure; empty for anything.
fn quantities(key: &str, joint: JointType) -> &'static [Quantity] {
    match (key, joint) {
        ("position", JointType::Revolute) => &[Quantity::Angle],
        ("position" | "tip[0]" | "tip[1]", _) => &[Quantity::Length],
        ("motor_torque" | "joint_torque", JointType::Revolute) => {
            &[Quantity::Torque, Quantity::Drive]
        }
        ("motor_torque" | "joint_torque" | "tangential_force" | "normal_force", _) => {
            &[Quantity::Force, Quantity::Drive]
        }
        ("temperature", _) => &[Quantity::Temperature],
        ("time", _) => &[Quantity::Time],
        _ => &[],
    }
}

/// The units that a signal with this key may have, the base unit of each quantity
/// before its others; none where any will do.
#[must_use]
pub fn units_for(key: &str, joint: JointType) -> Vec<&'static str> {
    let allowed = quantities(key, joint).iter();
    allowed.flat_map(|each| each.units()).collect()
}

/// What is wrong with a unit, and how to mend it.
fn wrong_unit(key: &str, joint: JointType, text: &str) -> String {
    let allowed = quantities(key, joint);
    let names: Vec<&str> = allowed.iter().flat_map(|each| each.units()).collect();
    let known = format!("it can be one of {}", names.join(", "));
    let Some(unit) = Unit::parse(text) else {
        return match names.is_empty() {
            true => format!("unit {text:?} is not known"),
            false => format!("unit {text:?} is not known; {known}"),
        };
    };
    match (unit.quantity(), joint) {
        (Quantity::Force | Quantity::Length | Quantity::Velocity, JointType::Revolute) => format!(
            "unit {:?} is one of a joint that moves along a line: write [joint] type = \"prismatic\", or turn it into that of a revolute joint, as in \"force.@mul(0.1)\" with its lever arm [m] and unit \"Nm\"; {known}",
            unit.name()
        ),
        (
            Quantity::Torque | Quantity::Angle | Quantity::AngularVelocity,
            JointType::Prismatic | JointType::Contact,
        ) => format!(
            "unit {:?} is one of a revolute joint: write [joint] type = \"revolute\"; {known}",
            unit.name()
        ),
        _ => format!("unit {:?} is none of this signal; {known}", unit.name()),
    }
}

/// The signals that a file gives.
pub(super) fn signals(
    table: file::SignalsTable,
    joint: JointType,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Signals, ExperimentError> {
    let taken = signal_names(joint.subject());
    for name in table.extra.keys() {
        let key = format!("signals.extra.{name}");
        if taken.contains(&name.as_str()) {
            let reason = format!(
                "the name is taken; choose another than {}",
                taken.join(", ")
            );
            return Err(refuse(&key, reason));
        }
        if !is_name(name) {
            return Err(refuse(&key, NO_NAME.to_owned()));
        }
    }
    let must = |key: &str, path: Option<file::Source>, what: &str| {
        path.ok_or_else(|| refuse(&format!("signals.{key}"), format!("it is missing: {what}")))
    };
    let contact_only = [
        ("tip", table.tip.is_some()),
        ("tangential_force", table.tangential_force.is_some()),
        ("normal_force", table.normal_force.is_some()),
    ];
    let joint_only = [
        ("motor_torque", table.motor_torque.is_some()),
        ("joint_torque", table.joint_torque.is_some()),
    ];
    let (others, of) = match joint.is_contact() {
        true => (&joint_only[..], "a joint, but this is a [contact]"),
        false => (
            &contact_only[..],
            "a contact: write [contact] into the file",
        ),
    };
    if let Some((name, _)) = others.iter().find(|(_, given)| *given) {
        return Err(refuse(
            &format!("signals.{name}"),
            format!("it is a signal of {of}"),
        ));
    }
    let (position, tip_y) = match (table.position, table.tip) {
        (Some(_), Some(_)) => {
            let reason = "there is a position too: name one of the two".to_owned();
            return Err(refuse("signals.tip", reason));
        }
        (position, None) => (must("position", position, contact::position(joint))?, None),
        (None, Some([x, y])) => (x.into(), Some(y.into())),
    };
    let place = if tip_y.is_some() {
        "tip[0]"
    } else {
        "position"
    };
    let (force, key, normal_force) = match joint.is_contact() {
        true => {
            let tangential = must(
                "tangential_force",
                table.tangential_force,
                contact::TANGENTIAL,
            )?;
            let normal = must("normal_force", table.normal_force, contact::NORMAL)?;
            (tangential, "tangential_force", Some(normal))
        }
        false => {
            let torque = must("motor_torque", table.motor_torque, contact::MOTOR)?;
            (torque, "motor_torque", None)
        }
    };
    let mut taker = Taker {
        joint,
        units: BTreeMap::new(),
        times: BTreeMap::new(),
        refuse,
    };
    let mut signals = Signals {
        position: taker.take(place, position)?,
        tip_y: taker.maybe("tip[1]", tip_y)?,
        motor_torque: taker.take(key, force)?,
        normal_force: taker.maybe("normal_force", normal_force)?,
        joint_torque: taker.maybe("joint_torque", table.joint_torque)?,
        temperature: taker.maybe("temperature", table.temperature)?,
        valid: taker.maybe("valid", table.valid)?,
        time: taker.maybe("time", table.time)?,
        ..Signals::default()
    };
    for (name, source) in table.extra {
        let path = taker.take(&format!("extra.{name}"), source)?;
        signals.extra.insert(name, path);
    }
    (signals.units, signals.times) = (taker.units, taker.times);
    same_force(&signals, key, refuse)?;
    Ok(signals)
}

/// That the forces of one equation are all torques, or all what goes into a drive.
fn same_force(
    signals: &Signals,
    key: &str,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<(), ExperimentError> {
    let drive = |key: &str| {
        let unit = signals.unit(key)?;
        (unit.quantity() == Quantity::Drive).then_some(unit.base())
    };
    let others = [
        ("joint_torque", &signals.joint_torque),
        ("normal_force", &signals.normal_force),
    ];
    for (other, path) in others {
        if path.is_some() && drive(other) != drive(key) {
            let named = |key| drive(key).unwrap_or("a torque or force");
            let reason = format!(
                "it is in {}, signals.{other} is in {}, and they stand in one equation: turn it into a torque by the motor's constant and the gear, as in \"{}.@mul(0.35)\", with unit \"Nm\" or \"N\"",
                named(key),
                named(other),
                signals.motor_torque
            );
            return Err(refuse(&format!("signals.{key}"), reason));
        }
    }
    Ok(())
}

/// Takes signals apart into path, unit and time.
struct Taker<'a, R> {
    joint: JointType,
    units: BTreeMap<String, Unit>,
    times: BTreeMap<String, String>,
    refuse: &'a R,
}

impl<R: Fn(&str, String) -> ExperimentError> Taker<'_, R> {
    fn take(&mut self, key: &str, source: file::Source) -> Result<String, ExperimentError> {
        let table = match source {
            file::Source::Path(path) => return Ok(path),
            file::Source::Each(_) => {
                let reason =
                    "a list is of the joints of an [arm]: give one path or column".to_owned();
                return Err((self.refuse)(&format!("signals.{key}"), reason));
            }
            file::Source::Table(table) => table,
        };
        let own = match key {
            "tangential_force" => "motor_torque",
            key => key,
        };
        if let Some(text) = &table.unit {
            let allowed = quantities(key, self.joint);
            let unit = Unit::parse(text).filter(|unit| {
                allowed.contains(&unit.quantity()) || (allowed.is_empty() && key != "valid")
            });
            let unit = unit.ok_or_else(|| {
                let reason = wrong_unit(key, self.joint, text);
                (self.refuse)(&format!("signals.{key}"), reason)
            })?;
            self.units.insert(own.to_owned(), unit);
        }
        if let Some(time) = table.time {
            self.times.insert(own.to_owned(), time);
        }
        Ok(table.column)
    }

    fn maybe(
        &mut self,
        key: &str,
        source: Option<file::Source>,
    ) -> Result<Option<String>, ExperimentError> {
        source.map(|source| self.take(key, source)).transpose()
    }
}

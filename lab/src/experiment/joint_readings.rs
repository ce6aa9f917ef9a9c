//! Joints of an arm that count otherwise than their URDF: the other way round, from another zero, in
//! what goes into their drives.
//!
//! ```toml
//! [arm]
//! reversed = ["elbow"]          # position and torque count the other way round
//! torque_reversed = ["wrist"]   # the torque does, or does not where the joint is reversed
//! zero = { elbow = 1.5708 }     # rad or m, added to the position
//! drive_gain = [14.9, 13.3]     # Nm/A: torque at the joint for a unit of motor_torque, gear included
//! ```

use ferntast_identification::arm::Misread;

use super::{ExperimentError, file};
use crate::unit::{Quantity, Unit};

/// How position and torque of a joint are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReading {
    /// Whether both count the other way round.
    pub reversed: bool,
    /// Whether the torque does, or does not where the joint is reversed.
    pub torque_reversed: bool,
    /// What is added to the position \[rad\] or \[m\].
    pub zero: f64,
    /// The drive gain (Gautier and Briot, 2014): torque at the joint \[Nm\] or force \[N\] for a unit
    /// of what is recorded as the motor's torque; `None`: that is a torque.
    pub drive_gain: Option<f64>,
}

impl JointReading {
    const AS_IN_URDF: Self = Self {
        reversed: false,
        torque_reversed: false,
        zero: 0.0,
        drive_gain: None,
    };

    /// Why `unit`, as it is stated, cannot be that of the motor torque of `joint`; `None`: it can.
    pub(super) fn wrong_unit(&self, unit: Option<Unit>, joint: &str) -> Option<String> {
        let unit = unit?;
        let is_drive = unit.quantity() == Quantity::Drive;
        let name = unit.name();
        match self.drive_gain {
            None if is_drive => Some(format!(
                "unit {name:?} of {joint}: the torques of an arm's links are in Nm, so that it has to be known what \
                 torque of each joint 1 {} makes, gear included: write [arm] drive_gain = [Nm/{}, one for each joint] \
                 (--drive-gain of `lab new`)",
                unit.base(),
                unit.base()
            )),
            Some(gain) if !is_drive && gain != 1.0 => Some(format!(
                "unit {name:?} of {joint} is one of torques or forces, and [arm] drive_gain makes {gain} of 1: give \
                 the unit of what goes into the drive (A, V, …), or the gain 1 for this joint"
            )),
            _ => None,
        }
    }

    /// Changes position and torque as recorded into those of the URDF's joint.
    pub(crate) fn apply(&self, position: &mut [f64], torque: &mut [f64]) {
        let turned = |reversed: bool| if reversed { -1.0 } else { 1.0 };
        if *self == Self::AS_IN_URDF {
            return;
        }
        let direction = turned(self.reversed);
        for own in position {
            *own = direction * *own + self.zero;
        }
        let torque_of_one =
            turned(self.reversed != self.torque_reversed) * self.drive_gain.unwrap_or(1.0);
        torque.iter_mut().for_each(|own| *own *= torque_of_one);
    }

    /// What was read so, read once more.
    pub(crate) fn then(self, next: &Misread) -> Self {
        let direction = if next.reversed { -1.0 } else { 1.0 };
        let turns = std::f64::consts::TAU;
        let zero = direction * self.zero + next.zero;
        Self {
            reversed: self.reversed != next.reversed,
            torque_reversed: self.torque_reversed != next.torque_reversed,
            // The nearest of those that are the same place.
            zero: zero - turns * (zero / turns).round(),
            drive_gain: self.drive_gain,
        }
    }
}

/// Of each of `joints`, as the table says.
pub(super) fn readings(
    table: &file::Arm,
    joints: &[String],
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Vec<JointReading>, ExperimentError> {
    let none: Vec<String> = Vec::new();
    let reversed = table.reversed.as_ref().unwrap_or(&none);
    let torque_reversed = table.torque_reversed.as_ref().unwrap_or(&none);
    let zeros = table.zero.as_ref();
    let known = |key: &str, name: &String| match joints.contains(name) {
        true => Ok(()),
        false => {
            let reason = format!(
                "{name:?} is no joint of the arm: they are {}",
                joints.join(", ")
            );
            Err(refuse(key, reason))
        }
    };
    for (key, names) in [
        ("arm.reversed", reversed),
        ("arm.torque_reversed", torque_reversed),
    ] {
        names.iter().try_for_each(|name| known(key, name))?;
    }
    for (name, zero) in zeros.into_iter().flatten() {
        known("arm.zero", name)?;
        if zero.is_nan() || zero.abs() > 100.0 {
            let reason = format!("{zero} of {name} is not within 100 rad or m");
            return Err(refuse("arm.zero", reason));
        }
    }
    let gain = |at: usize| table.drive_gain.as_ref()?.get(at).copied();
    let each = joints.iter().enumerate().map(|(at, joint)| JointReading {
        drive_gain: gain(at),
        reversed: reversed.contains(joint),
        torque_reversed: torque_reversed.contains(joint),
        zero: zeros.and_then(|own| own.get(joint)).copied().unwrap_or(0.0),
    });
    Ok(each.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: JointReading = JointReading {
        reversed: true,
        torque_reversed: true,
        zero: 0.5,
        drive_gain: Some(10.0),
    };

    #[test]
    fn positions_and_torques_are_turned_as_it_says() {
        let (mut position, mut torque) = ([0.2], [3.0]);
        OWN.apply(&mut position, &mut torque);
        assert_eq!((position, torque), ([0.3], [30.0]));
        let plain = JointReading {
            torque_reversed: false,
            zero: 0.0,
            drive_gain: None,
            ..OWN
        };
        plain.apply(&mut position, &mut torque);
        assert_eq!((position, torque), ([-0.3], [-30.0]));
    }

    #[test]
    fn read_twice_is_as_one_after_the_other() {
        let next = Misread {
            joint: String::new(),
            reversed: true,
            torque_reversed: false,
            zero: 3.0,
            is_read_as: None,
            torque_is_read_as: None,
            torque_of_one: None,
            error_before: 1.0,
            error_after: 0.1,
        };
        let both = OWN.then(&next);
        let (mut position, mut torque) = ([0.2], [3.0]);
        OWN.apply(&mut position, &mut torque);
        // As the misreading says: −q + 3, −τ.
        let expected = (-position[0] + 3.0, -torque[0]);
        let (mut position, mut torque) = ([0.2], [3.0]);
        both.apply(&mut position, &mut torque);
        assert!((position[0] - expected.0).abs() < 1e-12 && torque[0] == expected.1);
    }
}

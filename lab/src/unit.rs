//! Units of signals: which are converted, and into what.

use std::f64::consts::{PI, TAU};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Time, in s.
    Time,
    /// Angle, in rad.
    Angle,
    /// Length, in m.
    Length,
    /// Angular velocity, in rad/s.
    AngularVelocity,
    /// Velocity, in m/s.
    Velocity,
    /// Torque, in Nm.
    Torque,
    /// Force, in N.
    Force,
    /// Temperature, in degC.
    Temperature,
    /// What goes into a drive: a motor's current, its voltage, a share of either.
    /// What torque that is, only the drive knows.
    Drive,
}

/// A unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    name: &'static str,
    base: &'static str,
    quantity: Quantity,
    factor: f64,
    offset: f64,
}

const fn unit(quantity: Quantity, name: &'static str, base: &'static str, factor: f64) -> Unit {
    Unit {
        name,
        base,
        quantity,
        factor,
        offset: 0.0,
    }
}

use Quantity::{Angle, AngularVelocity, Drive, Force, Length, Temperature, Time, Torque, Velocity};

const DEGREE: f64 = PI / 180.0;

/// Every unit that is known, the base unit of a quantity before its others.
const UNITS: [Unit; 41] = [
    unit(Time, "s", "s", 1.0),
    unit(Time, "ms", "s", 1e-3),
    unit(Time, "us", "s", 1e-6),
    unit(Time, "ns", "s", 1e-9),
    unit(Time, "min", "s", 60.0),
    unit(Time, "h", "s", 3600.0),
    unit(Angle, "rad", "rad", 1.0),
    unit(Angle, "mrad", "rad", 1e-3),
    unit(Angle, "deg", "rad", DEGREE),
    unit(Angle, "rev", "rad", TAU),
    unit(Length, "m", "m", 1.0),
    unit(Length, "cm", "m", 1e-2),
    unit(Length, "mm", "m", 1e-3),
    unit(Length, "um", "m", 1e-6),
    unit(AngularVelocity, "rad/s", "rad/s", 1.0),
    unit(AngularVelocity, "deg/s", "rad/s", DEGREE),
    unit(AngularVelocity, "rpm", "rad/s", TAU / 60.0),
    unit(AngularVelocity, "rev/s", "rad/s", TAU),
    unit(Velocity, "m/s", "m/s", 1.0),
    unit(Velocity, "cm/s", "m/s", 1e-2),
    unit(Velocity, "mm/s", "m/s", 1e-3),
    unit(Torque, "Nm", "Nm", 1.0),
    unit(Torque, "mNm", "Nm", 1e-3),
    unit(Torque, "Ncm", "Nm", 1e-2),
    unit(Torque, "kNm", "Nm", 1e3),
    unit(Force, "N", "N", 1.0),
    unit(Force, "mN", "N", 1e-3),
    unit(Force, "kN", "N", 1e3),
    unit(Temperature, "degC", "degC", 1.0),
    Unit {
        offset: -273.15,
        ..unit(Temperature, "K", "degC", 1.0)
    },
    Unit {
        offset: -32.0 / 1.8,
        ..unit(Temperature, "degF", "degC", 1.0 / 1.8)
    },
    unit(Drive, "A", "A", 1.0),
    unit(Drive, "mA", "A", 1e-3),
    unit(Drive, "V", "V", 1.0),
    unit(Drive, "mV", "V", 1e-3),
    unit(Drive, "W", "W", 1.0),
    unit(Drive, "%", "%", 1.0),
    unit(Drive, "pwm", "pwm", 1.0),
    unit(Drive, "counts", "counts", 1.0),
    unit(Drive, "raw", "raw", 1.0),
    unit(Drive, "1", "1", 1.0),
];

/// Other spellings, in small letters.
const SPELLINGS: [(&str, &str); 44] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("millisecond", "ms"),
    ("milliseconds", "ms"),
    ("usec", "us"),
    ("µs", "us"),
    ("μs", "us"),
    ("microseconds", "us"),
    ("nsec", "ns"),
    ("nanoseconds", "ns"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("°", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("turn", "rev"),
    ("turns", "rev"),
    ("revolutions", "rev"),
    ("µm", "um"),
    ("μm", "um"),
    ("rads", "rad/s"),
    ("radps", "rad/s"),
    ("degs", "deg/s"),
    ("degps", "deg/s"),
    ("°/s", "deg/s"),
    ("rev/min", "rpm"),
    ("1/min", "rpm"),
    ("rps", "rev/s"),
    ("mps", "m/s"),
    ("n m", "Nm"),
    ("n.m", "Nm"),
    ("n*m", "Nm"),
    ("n·m", "Nm"),
    ("newton", "N"),
    ("°c", "degC"),
    ("celsius", "degC"),
    ("°f", "degF"),
    ("amp", "A"),
    ("ampere", "A"),
    ("volt", "V"),
    ("percent", "%"),
];

impl Unit {
    /// The unit that `text` stands for. Capitals count where they make a
    /// difference (mN, MN).
    #[must_use]
    pub fn parse(text: &str) -> Option<Unit> {
        let text = text.trim();
        let known = |name: &str| UNITS.iter().find(|unit| unit.name == name).copied();
        if let Some(unit) = known(text) {
            return Some(unit);
        }
        let small = text.to_lowercase();
        if let Some((_, name)) = SPELLINGS.iter().find(|(other, _)| *other == small) {
            return known(name);
        }
        // M is not m: mega, not milli.
        let is_milli = |unit: &&Unit| text.starts_with('M') && unit.name.starts_with('m');
        let mut alike = UNITS
            .iter()
            .filter(|unit| unit.name.to_lowercase() == small)
            .filter(|unit| !is_milli(unit));
        match (alike.next(), alike.next()) {
            (Some(unit), None) => Some(*unit),
            _ => None,
        }
    }

    /// Names of all units that are known, those of a quantity together.
    pub fn names() -> impl Iterator<Item = &'static str> {
        UNITS.iter().map(|unit| unit.name)
    }

    /// As it is written.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What values are converted into.
    #[must_use]
    pub fn base(&self) -> &'static str {
        self.base
    }

    /// What it measures.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// A value in this unit, in the base unit.
    #[must_use]
    pub fn convert(&self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// Whether values stay as they are.
    #[must_use]
    pub fn is_base(&self) -> bool {
        self.name == self.base
    }
}

impl Quantity {
    /// Names of its units, for messages.
    #[must_use]
    pub fn units(self) -> Vec<&'static str> {
        let own = UNITS.iter().filter(|unit| unit.quantity == self);
        own.map(Unit::name).collect()
    }
}

/// `unit` of a parameter of the catalogue in which torques (or forces) stand in
/// `drive` in place of Nm (or N): kg m² becomes A s²/rad, Nm s/rad A s/rad.
/// Units without a torque stay.
#[must_use]
pub fn in_drive_units(unit: &str, drive: &str) -> String {
    match unit {
        "kg m²" => return format!("{drive} s²/rad"),
        "kg" => return format!("{drive} s²/m"),
        _ => {}
    }
    let is_word = |c: char| c.is_alphanumeric();
    for torque in ["Nm", "N"] {
        let found = unit.find(torque).filter(|&at| {
            let before = unit.get(..at).and_then(|text| text.chars().next_back());
            let after = unit.get(at + torque.len()..);
            let after = after.and_then(|text| text.chars().next());
            !before.is_some_and(is_word) && !after.is_some_and(is_word)
        });
        if let Some(at) = found {
            let (before, after) = unit.split_at(at);
            return format!("{before}{drive}{}", after.trim_start_matches(torque));
        }
    }
    unit.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_and_converted() {
        for (text, value, base, converted) in [
            ("deg", 180.0, "rad", PI),
            ("°", 90.0, "rad", PI / 2.0),
            ("RPM", 60.0, "rad/s", TAU),
            ("ms", 1500.0, "s", 1.5),
            ("µs", 1500.0, "s", 1.5e-3),
            ("mA", 250.0, "A", 0.25),
            ("N m", 2.0, "Nm", 2.0),
            ("degF", 212.0, "degC", 100.0),
            ("K", 300.0, "degC", 26.85),
            ("mm", 5.0, "m", 5e-3),
        ] {
            let unit = Unit::parse(text).unwrap();
            assert_eq!(unit.base(), base, "{text}");
            let found = unit.convert(value);
            assert!((found - converted).abs() < 1e-9, "{text}: {found}");
        }
        for text in ["", "furlong", "MN", "q"] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
        assert_eq!(Unit::parse("mN").unwrap().quantity(), Force);
    }

    #[test]
    fn units_of_parameters_stand_in_what_goes_into_the_drive() {
        for (unit, drive, expected) in [
            ("Nm", "V", "V"),
            ("Nm s/rad", "A", "A s/rad"),
            ("Nm s/(rad K)", "A", "A s/(rad K)"),
            ("kg m²", "V", "V s²/rad"),
            ("kg", "V", "V s²/m"),
            ("N s/m", "V", "V s/m"),
            ("rad/Nm", "V", "rad/V"),
            ("rad/s", "V", "rad/s"),
            ("1", "V", "1"),
        ] {
            assert_eq!(in_drive_units(unit, drive), expected);
        }
    }

    #[test]
    fn every_unit_is_found_by_its_name_and_every_spelling_leads_to_one() {
        for unit in UNITS {
            assert_eq!(Unit::parse(unit.name), Some(unit));
        }
        for (text, name) in SPELLINGS {
            assert_eq!(
                Unit::parse(text).map(|unit| unit.name),
                Some(name),
                "{text}"
            );
        }
    }
}

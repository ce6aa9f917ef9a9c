//! Whether signals can be in the units that they are said to be in.

use serde::Serialize;

use crate::{
    guess::{angle_unit, time_unit, unit_in_name},
    unit::Unit,
};

/// A unit that a signal is hardly in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Doubt {
    /// The signal's key.
    pub signal: String,
    /// What is odd.
    pub text: String,
    /// The unit that it looks like.
    pub unit: String,
}

/// A signal as it is taken.
pub(super) struct Taken<'a> {
    pub(super) key: &'a str,
    pub(super) column: &'a str,
    /// The unit that it is said to be in.
    pub(super) unit: &'a str,
    /// Its first value, and the step from one to the next.
    pub(super) first: f64,
    pub(super) step: f64,
    /// From the least to the greatest value.
    pub(super) range: f64,
}

/// What is odd about these. Values are looked at where the unit is s or rad.
pub(super) fn doubts<'a>(signals: impl Iterator<Item = Taken<'a>>) -> Vec<Doubt> {
    signals.filter_map(|own| doubt(&own)).collect()
}

fn doubt(own: &Taken<'_>) -> Option<Doubt> {
    let told = |text: String, unit: &str| {
        Some(Doubt {
            signal: own.key.to_owned(),
            text,
            unit: unit.to_owned(),
        })
    };
    let taken = Unit::parse(own.unit)?;
    let (column, name) = (own.column, taken.name());
    if let Some(said) = unit_in_name(column).1
        && said.name() != name
    {
        let said = said.name();
        let text = format!("{column:?} is called as if it were in {said}, and taken for {name}");
        return told(text, said);
    }
    // Of an arm, position@elbow.
    let key = own.key.split('@').next().unwrap_or(own.key);
    match (key, name) {
        ("time", "s") => {
            let unit = time_unit(own.first, own.step)?;
            let text = match own.step {
                step if step >= 0.2 => {
                    format!("a sample every {step:.3} s is implausible, it looks like {unit}")
                }
                _ => format!(
                    "a clock at {:e} s is implausible, it looks like {unit}",
                    own.first
                ),
            };
            told(text, unit)
        }
        ("position", "rad") => {
            let unit = angle_unit(own.range)?;
            let turns = own.range / std::f64::consts::TAU;
            let text = format!(
                "it goes over {:.0} rad, {turns:.0} turns: it may be in {unit}",
                own.range
            );
            told(text, unit)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(
        key: &str,
        column: &str,
        unit: &str,
        step: f64,
        range: f64,
    ) -> Option<(String, String)> {
        let taken = Taken {
            key,
            column,
            unit,
            first: 0.0,
            step,
            range,
        };
        let doubt = doubts(std::iter::once(taken)).pop()?;
        Some((doubt.text, doubt.unit))
    }

    #[test]
    fn units_that_cannot_be_are_doubted_and_others_not() {
        let (text, unit) = told("time", "t", "s", 2.0, 3e4).unwrap();
        assert!(text.contains("every 2.000 s"), "{text}");
        assert_eq!(unit, "ms");
        let (text, unit) = told("position", "q", "rad", 0.1, 114.0).unwrap();
        assert!(text.contains("18 turns"), "{text}");
        assert_eq!(unit, "deg");
        let (text, unit) = told("position", "q_deg", "rad", 0.1, 2.0).unwrap();
        assert!(text.contains("in deg, and taken for rad"), "{text}");
        assert_eq!(unit, "deg");
        for (key, column, unit, step, range) in [
            ("time", "t", "s", 0.002, 30.0),
            ("time", "t", "ms", 2.0, 3e4),
            ("position", "q", "deg", 0.1, 114.0),
            ("position", "q_deg", "deg", 0.1, 114.0),
            ("position", "q", "rad", 0.1, 6.0),
            ("motor_torque", "i", "A", 0.1, 100.0),
            ("position", "q", "", 0.1, 100.0),
        ] {
            assert_eq!(
                told(key, column, unit, step, range),
                None,
                "{column} {unit}"
            );
        }
    }
}

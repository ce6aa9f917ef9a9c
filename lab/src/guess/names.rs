//! What a name says of a unit.

use crate::unit::Unit;

/// A column's name, or a message path, without its unit, and that: `q_deg`,
/// `q [deg]`, `current (A)`, `t/ms`.
#[must_use]
pub fn unit_in_name(name: &str) -> (&str, Option<Unit>) {
    // A path into messages, or with functions at its end, says nothing; the m of τ_m is
    // the motor, and the N of F_N the normal.
    if name.starts_with('/') || name.contains(".@") || name == "tau_m" {
        return (name, None);
    }
    if name == "F_N" {
        return (name, Unit::parse("N"));
    }
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = name.trim_end().strip_suffix(close)
            && let Some((bare, unit)) = inner.rsplit_once(open)
            && let Some(unit) = Unit::parse(unit)
        {
            return (bare.trim_end(), Some(unit));
        }
    }
    for (ending, unit) in [("_rad_s", "rad/s"), ("_deg_s", "deg/s"), ("_m_s", "m/s")] {
        if let Some(bare) = name.strip_suffix(ending) {
            return (bare, Unit::parse(unit));
        }
    }
    for sign in [" / ", "/", "_in_", "_", "-", " "] {
        if let Some((bare, unit)) = name.rsplit_once(sign)
            && !bare.is_empty()
            && let Some(unit) = with_long_names(unit)
        {
            return (bare, Some(unit));
        }
    }
    (name, None)
}

/// A unit behind an underscore: `m` and the like could be the number of a thing,
/// yet are far more often a unit.
fn with_long_names(text: &str) -> Option<Unit> {
    match text {
        // One that counts, not a unit.
        text if text.chars().all(|c| c.is_ascii_digit()) => None,
        "C" => Unit::parse("degC"),
        text => Unit::parse(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_their_unit() {
        for (name, bare, unit) in [
            ("q_deg", "q", Some("deg")),
            ("t_ms", "t", Some("ms")),
            ("current_A", "current", Some("A")),
            ("current (mA)", "current", Some("mA")),
            ("speed [rad/s]", "speed", Some("rad/s")),
            ("t/ms", "t", Some("ms")),
            ("torque_Nm", "torque", Some("Nm")),
            ("temp_C", "temp", Some("degC")),
            ("qd_rad_s", "qd", Some("rad/s")),
            ("q_1", "q_1", None),
            ("tau_m", "tau_m", None),
            ("F_N", "F_N", Some("N")),
            ("q", "q", None),
            ("/js.position_deg", "/js.position_deg", None),
        ] {
            let found = unit_in_name(name);
            assert_eq!(
                (found.0, found.1.map(|own| own.name())),
                (bare, unit),
                "{name}"
            );
        }
    }
}

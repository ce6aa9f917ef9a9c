//! What numbers say of their unit.

use std::f64::consts::TAU;

/// Slower than this \[s\] nobody samples a joint.
const SLOWEST: f64 = 0.2;
/// A clock that began this long ago \[s\], 1990, is a date.
const DATE: f64 = 6.3e8;
/// No joint whose friction is of interest turns that often in a recording.
const TURNS: f64 = 4.0;

/// The unit that times can be in, which begin at `first` with steps of `step`, if
/// they cannot be in s.
#[must_use]
pub fn time_unit(first: f64, step: f64) -> Option<&'static str> {
    // A date says it for certain: 2001 to 2286 in s have ten digits.
    let digits = [(1e3 * DATE, "ms"), (1e6 * DATE, "us"), (1e9 * DATE, "ns")];
    let dated = digits.iter().rfind(|(from, _)| first.abs() >= *from);
    if let Some((_, unit)) = dated {
        return Some(unit);
    }
    match step {
        step if step.is_nan() || step < SLOWEST => None,
        step if step < 60.0 => Some("ms"),
        step if step < 6e4 => Some("us"),
        _ => Some("ns"),
    }
}

/// The unit that angles within `range` can be in, if they are hardly in rad.
#[must_use]
pub fn angle_unit(range: f64) -> Option<&'static str> {
    (range > TURNS * TAU).then_some("deg")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_dates_tell_the_unit_of_time() {
        for (first, step, unit) in [
            (0.0, 0.001, None),
            (1.7e9, 0.01, None),
            (0.0, 1.0, Some("ms")),
            (0.0, 10.0, Some("ms")),
            (0.0, 1000.0, Some("us")),
            (0.0, 1e6, Some("ns")),
            (1.7e12, 1.0, Some("ms")),
            (1.7e15, 100.0, Some("us")),
            (1.7e18, 1e6, Some("ns")),
        ] {
            assert_eq!(time_unit(first, step), unit, "{first} {step}");
        }
        assert_eq!(angle_unit(6.0), None);
        assert_eq!(angle_unit(90.0), Some("deg"));
    }
}

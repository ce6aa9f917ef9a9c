//! Effects that have another one among their columns.

/// A whole, a part of it, and the column that the whole has beyond the part.
const PARTS: [(&str, &str, usize); 4] = [
    ("cable_spring", "asymmetric_coulomb", 0),
    ("cable_spring", "torque_sensor_offset", 0),
    ("nonlinear_viscous", "quadratic_viscous", 1),
    ("nonlinear_viscous", "cubic_viscous", 0),
];
/// Names of one column.
const SAME: [&str; 2] = ["asymmetric_coulomb", "torque_sensor_offset"];

/// The column that `whole` has beyond `part`, where it has `part` among its own.
pub(crate) fn column_beyond(whole: &str, part: &str) -> Option<usize> {
    let mut parts = PARTS.iter();
    let (.., column) = parts.find(|(w, p, _)| *w == whole && *p == part)?;
    Some(*column)
}

/// Whether `part` is among the columns of `whole`, or is its only one.
pub(crate) fn has(whole: &str, part: &str) -> bool {
    let same = whole != part && SAME.contains(&whole) && SAME.contains(&part);
    same || column_beyond(whole, part).is_some()
}

/// Ids of the parts that `whole` has.
pub(crate) fn of(whole: &str) -> impl Iterator<Item = &'static str> {
    let parts = PARTS.iter().filter(move |(w, ..)| *w == whole);
    parts.map(|(_, part, _)| *part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_an_effect_and_every_column_is_there() {
        for (whole, part, column) in PARTS {
            let whole = crate::effects::find(whole).unwrap();
            assert!(crate::effects::find(part).is_some() && column < whole.columns());
        }
        assert!(has("asymmetric_coulomb", "torque_sensor_offset") && !has("coulomb", "coulomb"));
        assert!(of("nonlinear_viscous").eq(["quadratic_viscous", "cubic_viscous"]));
    }
}

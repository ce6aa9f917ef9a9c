//! What a sweep over arms comes to, for a terminal.

use std::fmt::Write;

use super::ArmRow;

/// A line an arm, wall and task.
pub fn arms_table(rows: &[ArmRow]) -> String {
    let mut text = format!(
        "{:10} {:>6} {:12} {:10} {:16} {:>10} {:>9} {:>9} {:>6} {:>11} {:>6} {:>6}  misses",
        "arm",
        "joints",
        "law",
        "wall",
        "task",
        "energy [J]",
        "drift[mm]",
        "peak [N]",
        "ratio",
        "felt [N/m]",
        "ratio",
        "held[s]"
    );
    for row in rows {
        let own = &row.own;
        let number = |value: Option<f64>, digits: usize| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
        };
        let misses: Vec<&str> = row.misses.iter().map(|miss| miss.name()).collect();
        // Writing into a string does not fail.
        let _ = write!(
            text,
            "\n{:10} {:>6} {:12} {:10} {:16} {:>10.4} {:>9.2} {:>9.1} {:>6.2} {:>11} {:>6} {:>6.1}  {}",
            row.arm,
            row.joints,
            own.law,
            own.environment,
            own.task,
            own.true_energy,
            own.drift_mm,
            own.peak_force,
            row.peak_ratio,
            number(own.felt_stiffness, 0),
            number(row.felt_ratio, 2),
            own.held_s,
            match misses.is_empty() {
                true => "none".to_owned(),
                false => misses.join(", "),
            }
        );
    }
    let kept = rows.iter().filter(|row| row.misses.is_empty()).count();
    let _ = write!(text, "\n{kept} of {} keep every bound", rows.len());
    text
}

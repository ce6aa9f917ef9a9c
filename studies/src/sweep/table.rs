//! What a sweep comes to, for a terminal.

use std::fmt::Write;

use ferntast_identification::numerics::statistics::quantile;

use super::{Row, largest_stable};

/// For each law: the largest stable round trip on each environment, without
/// chance and with any; then in how many trials it was stable and did the task
/// in time, and what it costs, as medians of its stable trials.
pub fn table(rows: &[Row]) -> String {
    let stable = largest_stable(rows);
    let laws = distinct(stable.iter().map(|own| own.law));
    let environments = distinct(stable.iter().map(|own| own.environment));
    let mut text = String::from(
        "largest stable round trip [ms], without jitter and loss / with any of the sweep\n",
    );
    // Writing into a string does not fail.
    let _ = write!(text, "{:20}", "law");
    for environment in &environments {
        let _ = write!(text, " {environment:>18}");
    }
    for law in &laws {
        let _ = write!(text, "\n{law:20}");
        for environment in &environments {
            let own = stable
                .iter()
                .find(|own| own.law == *law && own.environment == *environment);
            let cell = own.map_or_else(String::new, |own| {
                format!("{} / {}", number(own.ideal_ms, 0), number(own.worst_ms, 0))
            });
            let _ = write!(text, " {cell:>18}");
        }
    }
    text.push_str("\n\nmedian of the stable trials\n");
    let _ = write!(
        text,
        "{:20} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9} {:>12} {:>8} {:>14}",
        "law",
        "stable",
        "done",
        "pos [mm]",
        "force [N]",
        "drift[mm]",
        "peak [N]",
        "transparency",
        "task [s]",
        "worst gain [J]"
    );
    for law in &laws {
        let own: Vec<&Row> = rows.iter().filter(|row| row.law == *law).collect();
        let good: Vec<&&Row> = own.iter().filter(|row| row.stable).collect();
        let of = |value: &dyn Fn(&Row) -> Option<f64>| {
            median(good.iter().filter_map(|row| value(row)).collect())
        };
        let done = own.iter().filter(|row| row.done).count();
        let gain = own.iter().map(|row| -row.true_energy).fold(0.0, f64::max);
        let _ = write!(
            text,
            "\n{law:20} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9} {:>12} {:>8} {:>14}",
            format!("{}/{}", good.len(), own.len()),
            format!("{done}/{}", own.len()),
            number(of(&|row| Some(row.position_rmse_m * 1e3)), 2),
            number(of(&|row| Some(row.force_rmse)), 2),
            number(of(&|row| Some(row.drift_mm)), 2),
            number(of(&|row| Some(row.peak_force)), 1),
            number(of(&|row| row.transparency), 3),
            number(of(&|row| row.task_time_s), 1),
            number(Some(gain), 4),
        );
    }
    text
}

fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    quantile(&mut values, 0.5, f64::total_cmp)
}

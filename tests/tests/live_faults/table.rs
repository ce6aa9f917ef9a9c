//! The tables, as people read them.

use std::fmt::Write;

use super::judge::{Hold, Outcome};

/// A line of the table of faults.
#[derive(Clone, Debug)]
pub struct Line {
    /// What went wrong.
    pub fault: String,
    /// With whom.
    pub party: String,
    /// What has to hold.
    pub must: String,
    /// What came of it.
    pub outcome: Outcome,
}

/// A line of a table of times to hold.
#[derive(Clone, Debug)]
pub struct Times {
    /// Who fell silent.
    pub party: String,
    /// Under which law.
    pub law: &'static str,
    /// Every hold.
    pub holds: Vec<Hold>,
}

/// The value below which a share of `values` lies.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted
        .get(place.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

/// `p50 / p95 / max` of `values` \[ms\]; a dash without any.
fn spread(values: &[f64]) -> String {
    match values {
        [] => "–".to_owned(),
        _ => format!(
            "{:.1} / {:.1} / {:.1}",
            1e3 * quantile(values, 0.5),
            1e3 * quantile(values, 0.95),
            1e3 * quantile(values, 1.0)
        ),
    }
}

fn each(holds: &[Hold], value: impl Fn(&Hold) -> f64) -> Vec<f64> {
    holds.iter().map(value).collect()
}

/// What was told most, and what else there is to say.
fn told(outcome: &Outcome) -> String {
    let mut told: Vec<(&String, &usize)> = outcome.told.iter().collect();
    told.sort_by_key(|own| (std::cmp::Reverse(*own.1), own.0.len()));
    let said = told.into_iter().filter(|own| 2 * own.1 > outcome.times);
    let said = said.take(2).map(|own| format!("“{}”", own.0));
    let all: Vec<String> = said.chain(outcome.remarks.iter().cloned()).collect();
    match all.is_empty() {
        true => "–".to_owned(),
        false => all.join("; ").replace('|', "/"),
    }
}

/// The table of faults.
pub fn faults(lines: &[Line]) -> String {
    let mut text = String::from(
        "| fault | party | times | must | held | last command to hold: p50 / p95 / max [ms] | fault to hold [ms] \
         | bare timer's worst [ms] | largest force: by the fault, after arming again [N] | start: step of setpoint [mrad], of torque [Nm] | restarts | told | verdict |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for Line {
        fault,
        party,
        must,
        outcome,
    } in lines
    {
        let holds = &outcome.holds;
        let worst = each(holds, |own| own.around)
            .into_iter()
            .fold(0.0, f64::max);
        let verdict = match outcome.failures.first() {
            None => "ok".to_owned(),
            Some(first) => format!("**fails**: {}", first.replace('|', "/")),
        };
        // Writing into a string cannot fail.
        let _ = writeln!(
            text,
            "| {fault} | {party} | {} | {must} | {} | {} | {} | {} | {:.1}, {:.1} | {:.2}, {:.1} | {} | {} | {verdict} |",
            outcome.times,
            holds.len(),
            spread(&each(holds, |own| own.after_command)),
            spread(&each(holds, |own| own.after_fault)),
            if holds.is_empty() {
                "–".to_owned()
            } else {
                format!("{:.1}", 1e3 * worst)
            },
            outcome.force,
            outcome.force_again,
            1e3 * outcome.jump,
            outcome.torque_step,
            outcome.restarts,
            told(outcome),
        );
    }
    text
}

/// A table of times to hold; `live` with what the machine stalled.
pub fn times(lines: &[Times], live: bool) -> String {
    let mut text = String::from(
        "| silent | law | times | last command to hold: p50 / p95 / max [ms] | fault to hold [ms] |",
    );
    text += if live {
        " bare timer's worst beside it [ms] |\n"
    } else {
        "\n"
    };
    text += "|---|---|---|---|---|";
    text += if live { "---|\n" } else { "\n" };
    for Times { party, law, holds } in lines {
        let _ = write!(
            text,
            "| {party} | {law} | {} | {} | {} |",
            holds.len(),
            spread(&each(holds, |own| own.after_command)),
            spread(&each(holds, |own| own.after_fault)),
        );
        if live {
            let _ = write!(text, " {} |", spread(&each(holds, |own| own.around)));
        }
        text.push('\n');
    }
    text
}

#[test]
fn a_spread_is_of_the_nearest_ranks() {
    let values: Vec<f64> = (1..=20).rev().map(|ms| f64::from(ms) * 1e-3).collect();
    assert_eq!(spread(&values), "10.0 / 19.0 / 20.0");
    assert_eq!(spread(&[]), "–");
}

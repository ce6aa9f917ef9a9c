//! Figs. 12 to 14: average damping against temperature in three ranges of speed.

use super::evidence::Evidence;
use super::item::{Chart, Curve, Item, Section};
use super::time::{CENTER, averages, trend};
use crate::experiment::campaign::RANGES;

/// How near the change has to come, as a share of the damping.
const TOLERANCE: f64 = 0.1;
const COLD: f64 = -5.0;

/// The three sections.
pub fn sections(evidence: &Evidence) -> Vec<Section> {
    let figures = [
        (
            12,
            0,
            20.0,
            -0.40,
            "The paper: near zero velocity damping \"at 20°C is approximately 40% lower compared to the value at -5°C\".",
        ),
        (
            13,
            1,
            25.0,
            0.0,
            "The paper: around 5 deg/s \"the temperature has almost no effect on the damping torque\"; taken as 0.",
        ),
        (
            14,
            2,
            25.0,
            0.40,
            "The paper: at higher velocities damping \"at around 25°C is approximately 40% higher than at -5°C\".",
        ),
    ];
    figures
        .into_iter()
        .map(|(number, range, warm, paper, text)| {
            section(evidence, number, range, warm, paper, text)
        })
        .collect()
}

fn section(
    evidence: &Evidence,
    number: usize,
    range: usize,
    warm: f64,
    paper: f64,
    text: &str,
) -> Section {
    let [from, to] = RANGES[range];
    let mut charts = Vec::new();
    let mut items = Vec::new();
    for joint in [1, 2] {
        let dates = averages(evidence, joint, range);
        let found = trend(&dates);
        // d(warm)/d(cold) − 1 in the middle of the mission; first order in the errors.
        let change = found.as_ref().map(|found| {
            let (level, slope) = (found.values[0], found.values[1]);
            let (at_cold, at_warm) = (
                level + slope * (COLD - CENTER),
                level + slope * (warm - CENTER),
            );
            let by_slope =
                ((warm - CENTER) * at_cold - (COLD - CENTER) * at_warm) / (at_cold * at_cold);
            let by_level = (at_cold - at_warm) / (at_cold * at_cold);
            let error = (by_slope * found.errors[1]).hypot(by_level * found.errors[0]);
            (at_warm / at_cold - 1.0, error)
        });
        items.push(Item::near(
            &format!("fig{number}/joint_{joint}/change_from_{COLD}_to_{warm}_degC"),
            "",
            paper,
            change.map(|change| change.0),
            change.map(|change| change.1),
            TOLERANCE,
        ));
        let mut curves = vec![Curve::dots(
            "every date",
            dates.iter().map(|date| (date.1, date.2)),
        )];
        if let Some(found) = &found {
            let line = |t: f64| (t, found.values[0] + found.values[1] * (t - CENTER));
            let least = dates
                .iter()
                .map(|date| date.1)
                .fold(f64::INFINITY, f64::min);
            let most = dates
                .iter()
                .map(|date| date.1)
                .fold(f64::NEG_INFINITY, f64::max);
            curves.push(Curve::line(
                "line, middle of the mission",
                [line(least), line(most)],
            ));
        }
        charts.push(Chart {
            title: format!("Joint {joint}: average damping at {from} to {to} deg/s"),
            x: "temperature [degC]".to_owned(),
            y: "damping torque [Nm]".to_owned(),
            curves,
        });
    }
    Section {
        name: format!("Fig. {number}"),
        title: format!("Damping against temperature at {from} to {to} deg/s"),
        text: format!(
            "{text} Here from all dates of the mission, by a straight line over temperature and date."
        ),
        charts,
        items,
    }
}

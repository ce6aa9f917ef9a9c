//! Figs. 16 (contact forces over time) and 17 (contact friction over the mission).

use ferntast_model::contour::Surface;

use super::evidence::Evidence;
use super::item::{Chart, Curve, Item, Section};
use crate::experiment::identify::Contact;

/// Samples drawn of Fig. 16: the last 12 s.
const DRAWN: usize = 1000;

/// Both sections.
pub fn sections(evidence: &Evidence) -> Vec<Section> {
    vec![
        forces(&evidence.contact.0, evidence.contact.1),
        over_the_mission(evidence),
    ]
}

/// Mean and standard deviation.
fn spread(values: &[f64]) -> (f64, f64) {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (
        mean,
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt(),
    )
}

fn forces(contact: &Contact, force: f64) -> Section {
    // F_T of equation (5) with the direction from the motors' positions, as
    // the paper has it: it turns before the tip does.
    let naive: Vec<f64> = contact
        .tangential
        .iter()
        .zip(&contact.velocity)
        .map(|(tangential, velocity)| -tangential * velocity.signum())
        .collect();
    // Pressed and past the first touch.
    let pressed: Vec<usize> = (0..naive.len())
        .filter(|&at| contact.in_contact[at] && contact.normal[at] > 0.5 * force)
        .collect();
    let sliding: Vec<f64> = pressed
        .iter()
        .filter(|&&at| contact.usable[at])
        .map(|&at| contact.opposing[at] / contact.normal[at])
        .collect();
    let (ratio, ratio_spread) = spread(&sliding);
    let normals: Vec<f64> = pressed
        .iter()
        .map(|&at| contact.normal[at] - force)
        .collect();
    let held =
        (normals.iter().map(|e| e * e).sum::<f64>() / normals.len().max(1) as f64).sqrt() / force;
    let turning: Vec<f64> = pressed
        .iter()
        .filter(|&&at| !contact.usable[at])
        .map(|&at| naive[at] / contact.normal[at])
        .collect();
    let least = turning.iter().copied().fold(f64::INFINITY, f64::min);
    let sliding_least = pressed
        .iter()
        .filter(|&&at| contact.usable[at])
        .map(|&at| naive[at] / contact.normal[at])
        .fold(f64::INFINITY, f64::min);
    let first = naive.len().saturating_sub(DRAWN);
    let over_time = |values: &[f64]| {
        Curve::line(
            "calculated",
            (first..values.len()).map(|at| (at as f64 * contact.period, values[at])),
        )
    };
    let chart = |title: &str, y: &str, values: &[f64]| Chart {
        title: title.to_owned(),
        x: "time [s]".to_owned(),
        y: y.to_owned(),
        curves: vec![over_time(values)],
    };
    Section {
        name: "Fig. 16".to_owned(),
        title: "Tangential and normal contact force".to_owned(),
        text: "Sinusoids along the unlubricated edge. The paper: the tangential force is nearly constant, and \"near zero \
               velocity the tangential force takes on negative values\": the motor already turns back while the tip still \
               rests. It gives no force in numbers. Negative values are counted as shares of the normal force."
            .to_owned(),
        charts: vec![
            chart("Tangential force, direction from the motors", "F_T [N]", &naive),
            chart("Normal force", "F_N [N]", &contact.normal),
        ],
        items: vec![
            Item::inside(
                "fig16/least_tangential_over_normal_near_zero_velocity",
                "",
                Some(least),
                None,
                [f64::NEG_INFINITY, -0.1 * ratio.abs()],
                "wrong sign near zero velocity",
            ),
            Item::inside(
                "fig16/least_tangential_over_normal_when_sliding",
                "",
                Some(sliding_least),
                None,
                [0.0, f64::INFINITY],
                "nowhere else",
            ),
            Item::inside(
                "fig16/spread_of_tangential_over_normal_when_sliding",
                "",
                Some(ratio_spread / ratio.abs().max(1e-9)),
                None,
                [0.0, 0.15],
                "nearly constant: standard deviation over the mean",
            ),
            Item::inside(
                "fig16/relative_error_of_the_normal_force",
                "",
                Some(held),
                None,
                [0.0, 0.2],
                "the normal force is held: RMS error over the force",
            ),
        ],
    }
}

fn over_the_mission(evidence: &Evidence) -> Section {
    let dates = |surface: Surface| -> Vec<(f64, f64, f64)> {
        let space = evidence.campaign.iter().filter(|run| !run.ground);
        space
            .filter_map(|run| run.contact.map(|found| (run.day, found)))
            .filter(|(_, found)| found.surface == surface)
            .map(|(day, found)| (day, found.friction.coefficient, found.friction.std_error))
            .collect()
    };
    let (bare, coated) = (dates(Surface::Unlubricated), dates(Surface::Lubricated));
    let later: Vec<f64> = bare.iter().skip(1).map(|date| date.1).collect();
    let (level, scatter) = spread(&later);
    let first = bare.first().map(|date| date.1);
    let trend = |dates: &[(f64, f64, f64)]| {
        let one = vec![1.0; dates.len()];
        let years: Vec<f64> = dates.iter().map(|date| date.0 / 365.25).collect();
        let values: Vec<f64> = dates.iter().map(|date| date.1).collect();
        ferntast_identification::numerics::regression::least_squares(&[&one, &years], &values)
    };
    let growth = trend(&coated);
    let gap = |date: Option<&(f64, f64, f64)>| date.map(|date| level - date.1);
    let closed = gap(coated.first())
        .zip(gap(coated.last()))
        .map(|(first, last)| 1.0 - last / first);
    let half = coated.len() / 2;
    let rate = |dates: &[(f64, f64, f64)]| trend(dates).map(|found| found.values[1]);
    let slows = rate(&coated[..half])
        .zip(rate(&coated[half..]))
        .map(|(early, late)| late / early);
    let chart = |title: &str, dates: &[(f64, f64, f64)]| Chart {
        title: title.to_owned(),
        x: "day of the mission [d]".to_owned(),
        y: "b_0T [-]".to_owned(),
        curves: vec![Curve::dots(
            "identified",
            dates.iter().map(|date| (date.0, date.1)),
        )],
    };
    Section {
        name: "Fig. 17".to_owned(),
        title: "Contact friction over the mission".to_owned(),
        text: "Equation (6) on every date. The paper: but for the first orbit friction is nearly constant on the unlubricated \
               surface; on the lubricated one it \"increases with time and slowly approaches the values obtained for the \
               unlubricated surface\". It gives no coefficient in the text."
            .to_owned(),
        charts: vec![chart("Unlubricated surface", &bare), chart("Lubricated surface", &coated)],
        items: vec![
            Item::inside(
                "fig17/unlubricated/scatter_after_the_first_orbit",
                "",
                Some(scatter / level.abs().max(1e-9)),
                None,
                [0.0, 0.05],
                "nearly constant: standard deviation over the mean",
            ),
            Item::inside(
                "fig17/unlubricated/first_orbit_differs",
                "",
                first.map(|first| (first / level - 1.0).abs()),
                None,
                [0.1, f64::INFINITY],
                "except for the first orbit",
            ),
            Item::grows(
                "fig17/lubricated/growth_per_year",
                "1/year",
                growth.as_ref().map(|found| found.values[1]),
                growth.as_ref().map(|found| found.errors[1]),
                "friction increases with time",
            ),
            Item::inside(
                "fig17/lubricated/share_of_the_gap_closed",
                "",
                closed,
                None,
                [0.5, 1.05],
                "approaches the unlubricated surface",
            ),
            Item::inside(
                "fig17/lubricated/late_rate_over_early_rate",
                "",
                slows,
                None,
                [0.0, 0.8],
                "slowly: the approach flattens",
            ),
        ],
    }
}

//! Figs. 4, 5 (linear against cubic), 8 (shares of the terms), 9 (another trajectory).

use ferntast_identification::experiments::damping::Sample;

use super::evidence::{Evidence, JointEvidence};
use super::item::{Chart, Curve, Item, Section};
use super::trajectory;
use crate::experiment::campaign::JointResult;
use crate::experiment::identify::Friction;

/// Points of a cloud that are drawn, at most.
const DRAWN: usize = 1500;

fn cloud(name: &str, samples: &[Sample]) -> Curve {
    let step = samples.len().div_ceil(DRAWN).max(1);
    Curve::dots(
        name,
        samples
            .iter()
            .step_by(step)
            .map(|s| (s.velocity.to_degrees(), s.damping)),
    )
}

/// Equation (3) or (4) at `samples`.
fn predicted(friction: &Friction, sample: &Sample) -> f64 {
    friction.torque(sample.velocity.abs(), sample.load) * sample.velocity.signum()
}

fn simulated(name: &str, friction: &Friction, samples: &[Sample]) -> Curve {
    let step = samples.len().div_ceil(DRAWN).max(1);
    let samples = samples.iter().step_by(step);
    Curve::dots(
        name,
        samples.map(|s| (s.velocity.to_degrees(), predicted(friction, s))),
    )
}

/// Figs. 4 and 5.
pub fn linear_and_cubic(evidence: &Evidence) -> Vec<Section> {
    let section = |number: usize, joint: usize, found: &JointEvidence| {
        let shape = |name: &str, friction: &Friction| {
            Curve::line(
                name,
                (0..=40).map(|degrees| {
                    let speed = f64::from(degrees).to_radians();
                    (f64::from(degrees), friction.viscous(speed).iter().sum())
                }),
            )
        };
        let clouds = |title: &str, friction: &Friction| Chart {
            title: title.to_owned(),
            x: "velocity [deg/s]".to_owned(),
            y: "damping torque [Nm]".to_owned(),
            curves: vec![
                cloud("measured", &found.samples),
                simulated("simulated", friction, &found.samples),
            ],
        };
        let ratio = found.cubic.rms / found.linear.rms.max(1e-12);
        Section {
            name: format!("Fig. {number}"),
            title: format!("Joint {joint}: linear against cubic model"),
            text: "On the ground with the space-qualified lubricant. The paper: \"a linear viscous damping term does not \
                   anymore represent the velocity dependent damping\"; the cubic model captures it \"much better\". It \
                   gives no error in numbers."
                .to_owned(),
            charts: vec![
                clouds("Linear model, equation (3)", &found.linear),
                clouds("Cubic model, equation (4)", &found.cubic),
                Chart {
                    title: "Viscous part of both".to_owned(),
                    x: "velocity [deg/s]".to_owned(),
                    y: "viscous torque [Nm]".to_owned(),
                    curves: vec![shape("linear", &found.linear), shape("cubic", &found.cubic)],
                },
            ],
            items: vec![Item::inside(
                &format!("fig{number}/error_of_cubic_over_linear"),
                "",
                Some(ratio),
                None,
                [0.0, 0.5],
                "the cubic model is much better: RMS of what it leaves over that of the linear one",
            )],
        }
    };
    vec![
        section(4, 1, &evidence.ground[0]),
        section(5, 2, &evidence.ground[1]),
    ]
}

/// The joints' results of the mission, in space.
pub(super) fn in_space(evidence: &Evidence, joint: usize) -> Vec<(f64, &JointResult)> {
    evidence
        .campaign
        .iter()
        .filter(|run| !run.ground)
        .filter_map(|run| run.joint.as_ref().map(|found| (run.day, found)))
        .filter(|(_, found)| found.joint == joint)
        .collect()
}

/// Fig. 8.
pub fn shares(evidence: &Evidence) -> Section {
    let (speed, load) = (40.0_f64.to_radians(), 13.0);
    let mut items = Vec::new();
    let mut charts = Vec::new();
    for joint in [1, 2] {
        let found = in_space(evidence, joint);
        let frictions: Vec<&Friction> = found.iter().map(|(_, one)| &one.friction).collect();
        let count = frictions.len().max(1) as f64;
        let shaped = frictions
            .iter()
            .filter(|f| f.value("b1") > 0.0 && f.value("b2") < 0.0 && f.value("b3") > 0.0);
        items.push(Item::inside(
            &format!("fig8/joint_{joint}/share_with_the_shape"),
            "",
            Some(shaped.count() as f64 / count),
            None,
            [1.0, 1.0],
            "all experiments show the same shape: b_1 > 0, b_2 < 0, b_3 > 0",
        ));
        let least = frictions
            .iter()
            .flat_map(|f| (0..=40).map(|k| f.torque(f64::from(k).to_radians(), 0.0)))
            .fold(f64::INFINITY, f64::min);
        items.push(Item::inside(
            &format!("fig8/joint_{joint}/least_damping_torque"),
            "Nm",
            Some(least),
            None,
            [0.0, f64::INFINITY],
            "no energy comes in though b_2 is negative: damping, unloaded, up to 40 deg/s",
        ));
        let terms = |f: &Friction| {
            let [linear, quadratic, cubic] = f.viscous(speed);
            [
                f.value("b0"),
                f.value("b0T") * load,
                linear,
                quadratic,
                cubic,
            ]
        };
        let mean = |term: usize| frictions.iter().map(|f| terms(f)[term]).sum::<f64>() / count;
        let total: f64 = (0..5).map(mean).sum();
        let spread = {
            let totals: Vec<f64> = frictions.iter().map(|f| terms(f).iter().sum()).collect();
            let variance = totals.iter().map(|t| (t - total).powi(2)).sum::<f64>() / count;
            variance.sqrt() / total.abs().max(1e-9)
        };
        charts.push(Chart {
            title: format!("Joint {joint}: damping by equation (4) on every date (13 Nm)"),
            x: "velocity [deg/s]".to_owned(),
            y: "damping torque [Nm]".to_owned(),
            curves: found
                .iter()
                .map(|(day, one)| {
                    Curve::line(
                        &format!("day {day:.0}"),
                        (1..=40).map(|k| {
                            let degrees = f64::from(k);
                            (degrees, one.friction.torque(degrees.to_radians(), load))
                        }),
                    )
                })
                .collect(),
        });
        let names = ["b_0", "b_0T τ", "b_1 q̇", "b_2 q̇|q̇|", "b_3 q̇³"];
        charts.push(Chart {
            title: format!(
                "Joint {joint}: contribution of each term at 40 deg/s, 13 Nm (mean total {total:.1} Nm, ± {:.0} %)",
                100.0 * spread
            ),
            x: "day of the mission [d]".to_owned(),
            y: "contribution [Nm]".to_owned(),
            curves: (0..5)
                .map(|term| {
                    Curve::dots(names[term], found.iter().map(|(day, one)| (*day, terms(&one.friction)[term])))
                })
                .collect(),
        });
    }
    Section {
        name: "Fig. 8".to_owned(),
        title: "Damping and the contribution of its terms over the mission".to_owned(),
        text: "The paper draws damping and contribution at 40 deg/s and 13 Nm without giving numbers in the text; it states \
               one characteristic shape for all experiments, and that the negative b_2 \"does not introduce energy\"."
            .to_owned(),
        charts,
        items,
    }
}

/// Fig. 9.
pub fn other_trajectory(evidence: &Evidence) -> Section {
    let samples = &evidence.may_sine.samples;
    let foreign = &evidence.may.cubic;
    let own = &evidence.may_sine.cubic;
    let rms = |error: &dyn Fn(&Sample) -> f64| {
        (samples.iter().map(|s| error(s).powi(2)).sum::<f64>() / samples.len().max(1) as f64).sqrt()
    };
    let size = rms(&|s| s.damping);
    let error = rms(&|s| s.damping - predicted(foreign, s)) / size.max(1e-12);
    // The sets of Table 1 differ though the damping does not: largest
    // difference at the speeds of the sinusoid.
    let differ = (1..=24)
        .map(|k| f64::from(k).to_radians())
        .map(|v| (own.torque(v, 0.0) / foreign.torque(v, 0.0) - 1.0).abs())
        .fold(0.0, f64::max);
    let damping = Chart {
        title: "Damping of the sinusoid".to_owned(),
        x: "velocity [deg/s]".to_owned(),
        y: "damping torque [Nm]".to_owned(),
        curves: vec![
            cloud("measured", samples),
            simulated("simulated with the spring's parameters", foreign, samples),
        ],
    };
    Section {
        name: "Fig. 9".to_owned(),
        title: "Parameters of one trajectory predict another".to_owned(),
        text: "The sinusoid is simulated with the parameters identified on the spring (2005-05-12). The paper: they \
               \"approximate the damping behavior of a differently shaped trajectory\"; it gives no error in numbers."
            .to_owned(),
        charts: std::iter::once(damping)
            .chain(trajectory::sinusoid(&evidence.may_sine.trajectory))
            .collect(),
        items: vec![
            Item::inside(
                "fig9/relative_error_of_prediction",
                "",
                Some(error),
                None,
                [0.0, 0.15],
                "RMS error over the RMS of the damping",
            ),
            Item::inside(
                "fig9/largest_difference_of_the_two_fits",
                "",
                Some(differ),
                None,
                [0.0, 0.15],
                "both trajectories' parameters give the same damping up to 24 deg/s",
            ),
        ],
    }
}

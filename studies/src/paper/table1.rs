//! Table 1: friction parameters of joint 2, put in and found.

use super::evidence::{self, Evidence, FrictionSet, JointEvidence};
use super::item::{Chart, Curve, Item, Section};

/// How near a parameter has to come, as a share of it.
const SHARE: f64 = 0.05;
const NAMES: [(&str, &str); 5] = [
    ("b0", "Nm"),
    ("b0T", ""),
    ("b1", "Nm·s/rad"),
    ("b2", "Nm·s²/rad²"),
    ("b3", "Nm·s³/rad³"),
];

fn rows(name: &str, set: &FrictionSet, found: &JointEvidence, is_loaded: bool) -> Vec<Item> {
    let rows = NAMES.iter().zip(set);
    rows.filter(|((key, _), _)| is_loaded || *key != "b0T")
        .map(|((key, unit), &paper)| {
            Item::near(
                &format!("table1/{name}/{key}"),
                unit,
                paper,
                Some(found.cubic.value(key)),
                found.cubic.error(key),
                SHARE * paper.abs(),
            )
        })
        .collect()
}

/// The section.
pub fn section(evidence: &Evidence) -> Section {
    let sets = [
        ("on_ground", &evidence::ON_GROUND, &evidence.ground[1], true),
        (
            "spring_2005_03_24",
            &evidence::MARCH,
            &evidence.march[1],
            true,
        ),
        ("spring_2005_05_12", &evidence::MAY, &evidence.may, true),
        (
            "sinusoidal_2005_12_22",
            &evidence::SINE,
            &evidence.sine,
            false,
        ),
    ];
    let mut items: Vec<Item> = sets
        .iter()
        .flat_map(|(name, set, found, is_loaded)| rows(name, set, found, *is_loaded))
        .collect();
    // Unloaded, b_0T says nothing: its standard error exceeds what it may be.
    let error = evidence.sine.loaded.error("b0T");
    let spring_error = evidence.march[1].cubic.error("b0T");
    let times = error
        .zip(spring_error)
        .map(|(sine, spring)| sine / spring.max(1e-12));
    items.push(Item::inside(
        "table1/sinusoidal_2005_12_22/b0T_error_over_that_of_the_spring",
        "",
        times,
        None,
        [3.0, f64::INFINITY],
        "the unloaded sinusoid does not excite b_0T properly",
    ));
    let curves = sets.iter().map(|(name, _, found, is_loaded)| {
        // The sinusoid's set is not to be used beyond the speeds it was fitted at.
        let last = if *is_loaded { 40 } else { 24 };
        Curve::line(
            name,
            (0..=last).map(|degrees| {
                let speed = f64::from(degrees);
                (speed, found.cubic.torque(speed.to_radians(), 0.0))
            }),
        )
    });
    Section {
        name: "Table 1".to_owned(),
        title: "Friction parameters identified for joint 2".to_owned(),
        text: "Each set of the paper is put into the simulated gear, the experiment is run, and the five parameters of \
               equation (4) are identified from the recording. For the unloaded sinusoid b_0T is left out, as in the paper. \
               The paper gives no uncertainty; standard errors here come from leaving out blocks of time in turn."
            .to_owned(),
        charts: vec![Chart {
            title: "Damping by equation (4), unloaded, with the parameters found".to_owned(),
            x: "velocity [deg/s]".to_owned(),
            y: "damping torque [Nm]".to_owned(),
            curves: curves.collect(),
        }],
        items,
    }
}

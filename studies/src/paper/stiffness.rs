//! Fig. 15: stiffness of joint 2 on the ground and in space.

use super::evidence::Evidence;
use super::item::{Chart, Curve, Item, Section};

/// The paper's stiffnesses \[Nm/rad\], each "around".
const PAPER: [(&str, f64); 2] = [("on_ground", 4400.0), ("in_space", 4900.0)];
const TOLERANCE: f64 = 0.03;

/// The section.
pub fn section(evidence: &Evidence) -> Section {
    let mut items = Vec::new();
    let mut charts = Vec::new();
    for ((name, paper), found) in PAPER.iter().zip(&evidence.stiffness) {
        items.push(Item::near(
            &format!("fig15/{name}/stiffness"),
            "Nm/rad",
            *paper,
            Some(found.stiffness),
            Some(found.std_error),
            TOLERANCE * paper,
        ));
        let milli = |delta: f64| 1e3 * delta;
        charts.push(Chart {
            title: format!("Joint 2, {}", name.replace('_', " ")),
            x: "deformation [mrad]".to_owned(),
            y: "joint torque [Nm]".to_owned(),
            curves: vec![
                Curve::dots(
                    "measured",
                    found.curve.iter().map(|[tau, delta]| (milli(*delta), *tau)),
                ),
                Curve::dots(
                    "identified",
                    found
                        .curve
                        .iter()
                        .map(|[tau, _]| (milli(tau / found.stiffness), *tau)),
                ),
            ],
        });
    }
    let [ground, space] = &evidence.stiffness;
    items.push(Item::inside(
        "fig15/relative_change",
        "",
        Some((space.stiffness / ground.stiffness - 1.0).abs()),
        None,
        [0.0, 0.15],
        "the observed change is below 15 %",
    ));
    Section {
        name: "Fig. 15".to_owned(),
        title: "Stiffness of joint 2".to_owned(),
        text: "Saw-teeth of torque against the fixed tip. The paper: \"around 4400 Nm/rad on-ground and 4900 Nm/rad in \
               space\". Unlike the paper, which neglects it, the compliance of what holds the tip is taken off (10⁶ N/m at \
               the tip, about a sixth of the deformation)."
            .to_owned(),
        charts,
        items,
    }
}

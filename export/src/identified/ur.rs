//! Friction compensation of Universal Robots: the request of the ROS 2 driver's service
//! `~/set_friction_model_parameters` (`ur_msgs/srv/SetFrictionModelParameters`;
//! UniversalRobots/Universal_Robots_ROS2_Driver#1704).
//!
//! The driver takes no torques: for each joint it takes the shares, 0 … 1, of the robot's own
//! model of viscous and Coulomb friction that are compensated. That model is not published.
//! What it says can be found from two recordings of one motion, without compensation and with
//! known shares s: of the friction b that the lab finds without, b − s B is left with it, and
//! the share that compensates all is b / B. One recording alone says the friction in Nm, and
//! no share.

use std::fmt::Write;
use std::path::Path;

use super::{IdentifiedError, Program, Request, model::Model, model::significant};

/// Joints of the robots.
const JOINTS: usize = 6;
/// The shares that the driver begins with: viscous, Coulomb.
const DEFAULTS: [[f64; JOINTS]; 2] = [
    [0.9, 0.9, 0.8, 0.9, 0.9, 0.9],
    [0.8, 0.8, 0.7, 0.8, 0.8, 0.8],
];
/// Names of the parameters, in that order.
const NAMES: [(&str, &str); 2] = [("viscous", "b1"), ("coulomb", "b0")];

pub fn text(
    model: &Model,
    request: &Request,
    notes: &mut Vec<String>,
) -> Result<String, IdentifiedError> {
    let joints = model.joints.len();
    if joints != JOINTS {
        return Err(IdentifiedError::NotSix {
            title: model.title.clone(),
            joints,
        });
    }
    let scales = match &request.compensated {
        Some(path) => shares(model, path, notes)?,
        None => {
            notes.push(
                "the shares are the driver's defaults, not identified: it takes shares (0 … 1) of the robot's own model of friction, which is not published; record the same motion once more under compensation with the default shares, and give that experiment: --compensated E.toml"
                    .to_owned(),
            );
            DEFAULTS
        }
    };
    let mut text = format!(
        "# {}.\n# Request of ~/set_friction_model_parameters (ur_msgs/srv/SetFrictionModelParameters), joints in the robot's order.\n",
        model.heading()
    );
    for joint in &model.joints {
        let _ = writeln!(text, "# {}: {}", joint.name, joint.friction_text());
    }
    if request.compensated.is_none() {
        text.push_str("# The shares are the driver's defaults: see ferntast lab export --help.\n");
    }
    text.push_str("parameters:\n");
    for ((name, _), scales) in NAMES.iter().zip(scales) {
        let scales = scales.map(|own| format!("{own:.3}")).join(", ");
        let _ = writeln!(text, "  {name}_scale: [{scales}]");
    }
    Ok(text)
}

/// The shares that compensate all, by what the driver's defaults leave at `path`.
fn shares(
    model: &Model,
    path: &Path,
    notes: &mut Vec<String>,
) -> Result<[[f64; JOINTS]; 2], IdentifiedError> {
    let other = Model::fitted(path, Program::Ur, model.approximate)?;
    let names = |own: &Model| {
        let names: Vec<&str> = own.joints.iter().map(|joint| joint.name.as_str()).collect();
        names.join(", ")
    };
    if names(&other) != names(model) {
        return Err(IdentifiedError::OtherJoints {
            found: names(&other),
            wanted: names(model),
            title: other.title,
        });
    }
    let mut scales = DEFAULTS;
    for (kind, (word, name)) in NAMES.iter().enumerate() {
        for (at, (joint, under)) in model.joints.iter().zip(&other.joints).enumerate() {
            let used = DEFAULTS[kind][at];
            let of =
                |own: &super::model::Joint| own.get(name).map(|own| (own.value, own.std_error));
            let (Some((whole, error)), Some((left, left_error))) = (of(joint), of(under)) else {
                notes.push(format!(
                    "{}: no {word} friction in the models; the default stays",
                    joint.name
                ));
                continue;
            };
            let own_model = (whole - left) / used;
            let noise = error.unwrap_or(0.0).hypot(left_error.unwrap_or(0.0));
            if own_model * used <= 2.0 * noise || own_model <= 0.0 {
                notes.push(format!(
                    "{}: the compensation takes nothing certain off the {word} friction ({} less {}); the default stays",
                    joint.name,
                    significant(whole),
                    significant(left)
                ));
                continue;
            }
            let share = whole / own_model;
            if !(0.0..=1.0).contains(&share) {
                notes.push(format!(
                    "{}: a {word} share of {} would compensate all; the driver takes 0 … 1",
                    joint.name,
                    significant(share)
                ));
            }
            scales[kind][at] = share.clamp(0.0, 1.0);
        }
    }
    Ok(scales)
}

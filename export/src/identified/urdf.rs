//! Friction and inertia in a URDF.

use std::fmt::Write;
use std::path::Path;

use ferntast_model::rigid_body::LinkInertia;
use ferntast_urdf::{
    Robot,
    edit::{self, Dynamics, Inertial, commented, escaped, number},
};

use super::{
    IdentifiedError,
    model::{ArmModel, Joint, Model, upright},
};

/// The experiment's URDF, or the one at `into`, with what was identified; of joints without
/// either one of their own.
pub fn text(
    model: &Model,
    into: Option<&Path>,
    notes: &mut Vec<String>,
) -> Result<String, IdentifiedError> {
    notes.extend(model.joints.iter().flat_map(Joint::impossible));
    if model.arm.is_some() || into.is_some() {
        notes.push(model.armatures_unsaid());
    }
    let source = into.or_else(|| model.arm.as_ref().map(|arm| arm.table.urdf.as_path()));
    match source {
        Some(path) => edited(model, path, notes),
        None => Ok(of_joints(model)),
    }
}

fn edited(model: &Model, path: &Path, notes: &mut Vec<String>) -> Result<String, IdentifiedError> {
    let file = |source| IdentifiedError::File {
        path: path.to_owned(),
        source,
    };
    let wrong = |source| IdentifiedError::Urdf {
        path: path.to_owned(),
        source,
    };
    let text = std::fs::read_to_string(path).map_err(file)?;
    let robot = Robot::read(text.as_bytes()).map_err(wrong)?;
    for joint in &model.joints {
        if robot.joints.iter().all(|own| own.name != joint.name) {
            let known = robot.joints.iter().map(|own| own.name.as_str());
            return Err(IdentifiedError::NoJoint {
                path: path.to_owned(),
                joint: joint.name.clone(),
                known: known.collect::<Vec<_>>().join(", "),
            });
        }
    }
    let dynamics: Vec<Dynamics> = (model.joints.iter())
        .map(|joint| Dynamics {
            joint: joint.name.clone(),
            damping: joint.viscous(),
            friction: joint.coulomb(),
            comment: format!(
                "{}: {}; armature {}",
                model.heading(),
                joint.friction_text(),
                joint.armature.text()
            ),
        })
        .collect();
    let mut inertials = Vec::new();
    if let Some(arm) = &model.arm {
        tell_tilt(arm, notes);
        for (at, name) in arm.table.arm.links.iter().enumerate() {
            let Some(change) = arm.change(at) else {
                continue;
            };
            let own = robot.links.iter().find(|link| link.name == *name);
            let own = own.and_then(|link| link.inertia);
            let inertia = own.unwrap_or_else(LinkInertia::zero) + change;
            if !inertia.is_physical() {
                notes.push(format!(
                    "link {name}: its own <inertial> with what was found is no body; only with what is fixed to it it is one"
                ));
            }
            inertials.push(Inertial {
                link: name.clone(),
                inertia,
                comment: format!("{}: {}", model.heading(), arm.effects_text().join("; ")),
            });
        }
    }
    edit::with(&text, &dynamics, &inertials).map_err(wrong)
}

/// URDF has no gravity: says how the base has to stand.
fn tell_tilt(arm: &ArmModel, notes: &mut Vec<String>) {
    if let Some(gravity) = arm.tilted() {
        let [roll, pitch] = upright(&gravity);
        notes.push(format!(
            "gravity in the frame of link {} is ({}, {}, {}) m/s², and URDF has none: let {} stand in an upright world with rpy=\"{} {} 0\"",
            arm.table.arm.base,
            number(gravity.x),
            number(gravity.y),
            number(gravity.z),
            arm.table.arm.base,
            number(roll),
            number(pitch),
        ));
    }
}

/// Each joint between the base and a body that has the inertia of its motor and gear.
fn of_joints(model: &Model) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {}.\n     Each joint moves a body of its motor's and gear's inertia; what it carries is not part of the experiment. -->\n\
         <robot name=\"{}\">\n  <link name=\"base\"/>\n",
        commented(&model.heading()),
        escaped(model.name())
    );
    for joint in &model.joints {
        let name = escaped(&joint.name);
        let inertia = joint.armature.value.max(1e-9);
        let (kind, mass) = match joint.kind {
            ferntast_identification::JointType::Revolute => ("continuous", 1.0),
            _ => ("prismatic", inertia),
        };
        let end = match kind {
            "prismatic" => {
                "    <limit lower=\"-1e3\" upper=\"1e3\" effort=\"1e9\" velocity=\"1e3\"/>\n"
            }
            _ => "",
        };
        let moment = number(inertia);
        let _ = write!(
            text,
            "  <joint name=\"{name}\" type=\"{kind}\">\n    <parent link=\"base\"/>\n    <child link=\"{name}_link\"/>\n    \
             <axis xyz=\"0 0 1\"/>\n{end}    <!-- {} -->\n    <dynamics damping=\"{}\" friction=\"{}\"/>\n  </joint>\n  \
             <link name=\"{name}_link\">\n    <!-- inertia {} -->\n    <inertial>\n      <mass value=\"{}\"/>\n      \
             <inertia ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" iyz=\"0\" izz=\"{moment}\"/>\n    </inertial>\n  </link>\n",
            commented(&joint.friction_text()),
            number(joint.viscous()),
            number(joint.coulomb()),
            commented(&joint.armature.text()),
            number(mass),
        );
    }
    text.push_str("</robot>\n");
    text
}

//! A model in SDFormat 1.9, as Gazebo reads it.

use std::fmt::Write;

use ferntast_identification::JointType;
use ferntast_model::rigid_body::{LinkInertia, Matrix3, Placement, Vector3};
use ferntast_urdf::edit::{commented, escaped, number};

use super::model::{Joint, Model, upright};
use super::mujoco::frames;

/// What SDFormat takes for no end.
const NO_END: f64 = 1e16;

pub fn text(model: &Model, notes: &mut Vec<String>) -> String {
    notes.extend(model.joints.iter().flat_map(Joint::impossible));
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {}. -->\n<sdf version=\"1.9\">\n  <model name=\"{}\" canonical_link=\"base\">\n",
        commented(&model.heading()),
        escaped(model.name())
    );
    if let Some(arm) = &model.arm {
        // The world's gravity is straight down; the base stands as it was found to.
        let tilt = arm
            .tilted()
            .map_or(Placement::identity(), |own| standing(&own));
        let _ = writeln!(text, "    {}", pose(&tilt, None));
        for own in arm.effects_text() {
            let _ = writeln!(text, "    <!-- {} -->", commented(&own));
        }
        notes.push(model.armatures_unsaid());
    }
    text.push_str("    <link name=\"base\"/>\n    <joint name=\"base_to_world\" type=\"fixed\"><parent>world</parent><child>base</child></joint>\n");
    let placements = model.arm.as_ref().map(frames);
    let mut before = "base".to_owned();
    for (at, joint) in model.joints.iter().enumerate() {
        let (link, inertia, placement, axis) = match (&model.arm, &placements) {
            (Some(arm), Some(placements)) => (
                arm.table.arm.links[at].clone(),
                arm.body.links[at],
                placements[at],
                arm.table.arm.chain.axes()[at],
            ),
            _ => {
                before = "base".to_owned();
                (
                    format!("{}_link", joint.name),
                    of_the_joint(joint),
                    Placement::identity(),
                    Vector3::z(),
                )
            }
        };
        joint_text(model, at, [&before, &link], &placement, &axis, &mut text);
        link_text(joint, &link, &inertia, &mut text);
        before = link;
    }
    text.push_str("  </model>\n</sdf>\n");
    text
}

/// A body with the inertia of motor and gear.
fn of_the_joint(joint: &Joint) -> LinkInertia {
    let inertia = joint.armature.value.max(1e-9);
    let mass = match joint.kind {
        JointType::Revolute => 1.0,
        _ => inertia,
    };
    let ball = Matrix3::identity() * inertia;
    LinkInertia::about_center_of_mass(mass, Vector3::zeros(), ball)
}

fn joint_text(
    model: &Model,
    at: usize,
    [parent, child]: [&str; 2],
    placement: &Placement,
    axis: &Vector3<f64>,
    text: &mut String,
) {
    let joint = &model.joints[at];
    let kind = match joint.kind {
        JointType::Revolute => "revolute",
        _ => "prismatic",
    };
    let arm = model.arm.as_ref().map(|arm| &arm.table.arm);
    let limits = arm.map(|arm| arm.chain.limits()[at]);
    let [lower, upper] = match limits {
        Some(own) if own.lower.is_finite() && own.upper.is_finite() => [own.lower, own.upper],
        _ => [-NO_END, NO_END],
    };
    let positive = |own: Option<Option<f64>>| own.flatten().filter(|own| *own > 0.0);
    let effort = positive(arm.map(|arm| arm.efforts[at]));
    let velocity = positive(arm.map(|arm| arm.velocities[at]));
    let tag = |name: &str, value: Option<f64>| {
        value.map_or_else(String::new, |own| {
            format!("          <{name}>{}</{name}>\n", number(own))
        })
    };
    let spring = joint.spring();
    let _ = write!(
        text,
        "    <joint name=\"{}\" type=\"{kind}\">\n      {}\n      <parent>{}</parent>\n      <child>{}</child>\n      \
         <axis>\n        <xyz>{} {} {}</xyz>\n        <limit>\n{}{}{}{}        </limit>\n        <!-- {}; armature {} -->\n        \
         <dynamics>\n{}{}{}{}        </dynamics>\n      </axis>\n    </joint>\n",
        escaped(&joint.name),
        pose(placement, Some(parent)),
        escaped(parent),
        escaped(child),
        number(axis.x),
        number(axis.y),
        number(axis.z),
        tag("lower", Some(lower)),
        tag("upper", Some(upper)),
        tag("effort", effort),
        tag("velocity", velocity),
        commented(&joint.friction_text()),
        commented(&joint.armature.text()),
        tag("damping", Some(joint.viscous())),
        tag("friction", Some(joint.coulomb())),
        tag("spring_reference", spring.map(|(_, rest)| rest)),
        tag("spring_stiffness", spring.map(|(stiffness, _)| stiffness)),
    );
}

fn link_text(joint: &Joint, name: &str, inertia: &LinkInertia, text: &mut String) {
    let (center, about) = inertia
        .at_center_of_mass()
        .unwrap_or((Vector3::zeros(), inertia.rotational));
    let _ = write!(
        text,
        "    <link name=\"{}\">\n      <pose relative_to=\"{}\">0 0 0 0 0 0</pose>\n      <inertial>\n        \
         <pose>{} {} {} 0 0 0</pose>\n        <mass>{}</mass>\n        <inertia>\n          \
         <ixx>{}</ixx><ixy>{}</ixy><ixz>{}</ixz><iyy>{}</iyy><iyz>{}</iyz><izz>{}</izz>\n        </inertia>\n      \
         </inertial>\n    </link>\n",
        escaped(name),
        escaped(&joint.name),
        number(center.x),
        number(center.y),
        number(center.z),
        number(inertia.mass),
        number(about.m11),
        number(about.m12),
        number(about.m13),
        number(about.m22),
        number(about.m23),
        number(about.m33),
    );
}

fn pose(placement: &Placement, relative_to: Option<&str>) -> String {
    let relative_to = relative_to.map_or_else(String::new, |own| {
        format!(" relative_to=\"{}\"", escaped(own))
    });
    let [x, y, z, w] = placement.quaternion();
    let place = placement.translation;
    let numbers: Vec<String> = [place.x, place.y, place.z, x, y, z, w]
        .into_iter()
        .map(number)
        .collect();
    format!(
        "<pose{relative_to} rotation_format=\"quat_xyzw\">{}</pose>",
        numbers.join(" ")
    )
}

/// Turned so that this gravity points straight down.
fn standing(gravity: &Vector3<f64>) -> Placement {
    let [roll, pitch] = upright(gravity);
    Placement::from_roll_pitch_yaw(Vector3::zeros(), [roll, pitch, 0.0])
}

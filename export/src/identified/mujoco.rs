//! A model in MuJoCo's XML.
//!
//! `frictionloss`, `damping` (a polynomial in |q̇| where friction has curvature), `armature`,
//! `stiffness`; links by the URDF's frames, each with all that is fixed to it; torque motors,
//! or servos of position. Shapes are left out but for rods that show where the links are.

use std::fmt::Write;

use ferntast_identification::JointType;
use ferntast_model::{
    Joints,
    rigid_body::{JointKind, LinkInertia, Placement, Vector3},
};
use ferntast_urdf::edit::{commented, escaped, number};

use super::model::{ArmModel, Joint, Model};

/// Frames that are nearer than this show no rod \[m\].
const ROD: f64 = 0.005;
/// A servo's gains are those of a critically damped joint.
const TAU: f64 = std::f64::consts::TAU;

pub fn text(model: &Model, servo_hz: Option<f64>, notes: &mut Vec<String>) -> String {
    notes.extend(model.joints.iter().flat_map(Joint::impossible));
    let gravity = match &model.arm {
        Some(arm) => arm.body.gravity,
        None => Vector3::zeros(),
    };
    let unphysical = model.arm.as_ref().is_some_and(|arm| {
        let mut links = arm.body.links.iter();
        links.any(|link| !link.is_physical())
    });
    let mut text = format!(
        "<!-- {}. -->\n<mujoco model=\"{}\">\n  <compiler angle=\"radian\" autolimits=\"true\"{}/>\n  \
         <option timestep=\"0.001\" integrator=\"implicitfast\" gravity=\"{}\"/>\n  <worldbody>\n",
        commented(&model.heading()),
        escaped(model.name()),
        if unphysical {
            " balanceinertia=\"true\""
        } else {
            ""
        },
        numbers(gravity.as_slice()),
    );
    match &model.arm {
        Some(arm) => bodies_of_arm(model, arm, &mut text),
        None => bodies_of_joints(model, &mut text),
    }
    text.push_str("  </worldbody>\n  <actuator>\n");
    let gains = servo_hz.map(|hertz| gains(model, hertz));
    for (at, joint) in model.joints.iter().enumerate() {
        let name = escaped(&joint.name);
        let effort = model
            .arm
            .as_ref()
            .and_then(|arm| arm.table.arm.efforts.get(at).copied());
        let effort = effort.flatten().filter(|own| *own > 0.0 && *own < 1e6);
        let range = |key: &str| {
            effort.map_or_else(String::new, |own| {
                format!(" {key}=\"{} {}\"", number(-own), number(own))
            })
        };
        let _ = match &gains {
            Some(gains) => writeln!(
                text,
                "    <position name=\"{name}\" joint=\"{name}\" kp=\"{}\" kv=\"{}\"{}/>",
                number(gains[at][0]),
                number(gains[at][1]),
                range("forcerange")
            ),
            None => writeln!(
                text,
                "    <motor name=\"{name}\" joint=\"{name}\" gear=\"1\"{}/>",
                range("ctrlrange")
            ),
        };
    }
    text.push_str("  </actuator>\n  <sensor>\n");
    for (kind, suffix) in [
        ("jointpos", "pos"),
        ("jointvel", "vel"),
        ("jointactuatorfrc", "torque"),
    ] {
        for joint in &model.joints {
            let name = escaped(&joint.name);
            let _ = writeln!(
                text,
                "    <{kind} name=\"{name}_{suffix}\" joint=\"{name}\"/>"
            );
        }
    }
    text.push_str("  </sensor>\n</mujoco>\n");
    if let Some(hertz) = servo_hz {
        notes.push(format!(
            "servos of {} Hz: kp = (2π f)² M, kv = 2 (2π f) M, M what each joint moves in the middle of the ranges, armature included",
            number(hertz)
        ));
    }
    text
}

/// Stiffness and damping of a servo on each joint.
fn gains(model: &Model, hertz: f64) -> Vec<[f64; 2]> {
    let rate = TAU * hertz;
    let moved = model.arm.as_ref().map(|arm| {
        let chain = &arm.table.arm.chain;
        let middle = chain.limits().map(|own| {
            let middle = 0.5 * (own.lower + own.upper);
            if middle.is_finite() { middle } else { 0.0 }
        });
        chain.mass_matrix(&middle)
    });
    let each = model.joints.iter().enumerate();
    each.map(|(at, joint)| {
        let links = moved.as_ref().map_or(0.0, |own| own[(at, at)]);
        let inertia = links + joint.armature.value.max(0.0);
        [rate * rate * inertia, 2.0 * rate * inertia]
    })
    .collect()
}

fn numbers(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().copied().map(number).collect();
    all.join(" ")
}

/// Attributes of a joint by what was identified, and what they are for people.
fn joint_text(joint: &Joint, kind: &str, axis: &Vector3<f64>, range: [f64; 2]) -> String {
    let value = |name| joint.get(name).map_or(0.0, |own| own.value);
    let (b2, b3) = (value("b2"), value("b3"));
    let damping = match b2 != 0.0 || b3 != 0.0 {
        true => numbers(&[joint.viscous(), b2, b3]),
        false => number(joint.viscous()),
    };
    let spring = joint
        .spring()
        .map_or_else(String::new, |(stiffness, rest)| {
            format!(
                " stiffness=\"{}\" springref=\"{}\"",
                number(stiffness),
                number(rest)
            )
        });
    let limited = match range.iter().all(|own| own.is_finite()) && range[0] < range[1] {
        true => format!(" range=\"{}\"", numbers(&range)),
        false => String::new(),
    };
    let mut comment = format!(
        "{}; armature {}",
        joint.friction_text(),
        joint.armature.text()
    );
    for name in ["b2", "b3", "kc", "k0"] {
        if let Some(own) = joint.get(name) {
            let _ = write!(comment, "; {name} {}", own.text());
        }
    }
    format!(
        "<!-- {} -->\n<joint name=\"{}\" type=\"{kind}\" axis=\"{}\"{limited} armature=\"{}\" damping=\"{damping}\" frictionloss=\"{}\"{spring}/>",
        commented(&comment),
        escaped(&joint.name),
        numbers(axis.as_slice()),
        number(joint.armature.value.max(0.0)),
        number(joint.coulomb()),
    )
}

fn inertial_text(inertia: &LinkInertia) -> String {
    let Some((center, about)) = inertia.at_center_of_mass() else {
        return String::new();
    };
    format!(
        "<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
        numbers(center.as_slice()),
        number(inertia.mass),
        numbers(&[
            about.m11, about.m22, about.m33, about.m12, about.m13, about.m23
        ]),
    )
}

fn placed(placement: &Placement) -> String {
    let [x, y, z, w] = placement.quaternion();
    format!(
        "pos=\"{}\" quat=\"{}\"",
        numbers(placement.translation.as_slice()),
        numbers(&[w, x, y, z])
    )
}

/// Frames of the links at position zero, each in the one before it, then the tip's.
pub fn frames(arm: &ArmModel) -> Vec<Placement> {
    let chain = &arm.table.arm.chain;
    let zero = Joints::filled(chain.count(), 0.0);
    let placements = chain.link_placements(&zero);
    let mut before = Placement::identity();
    let all = placements.iter().copied().chain([chain.forward(&zero)]);
    all.map(|own| {
        let within = before.inverse().then(&own);
        before = own;
        within
    })
    .collect()
}

fn bodies_of_arm(model: &Model, arm: &ArmModel, text: &mut String) {
    let frames = frames(arm);
    let chain = &arm.table.arm.chain;
    let (kinds, axes) = (chain.kinds(), chain.axes());
    let mut line = |depth: usize, own: &str| {
        for own in own.lines() {
            let _ = writeln!(text, "{:1$}{own}", "", 4 + 2 * depth);
        }
    };
    for own in arm.effects_text() {
        line(0, &format!("<!-- {} -->", commented(&own)));
    }
    for (at, joint) in model.joints.iter().enumerate() {
        let limits = chain.limits()[at];
        let kind = match kinds[at] {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        line(
            at,
            &format!(
                "<body name=\"{}\" {}>",
                escaped(&arm.table.arm.links[at]),
                placed(&frames[at])
            ),
        );
        line(at + 1, &inertial_text(&arm.body.links[at]));
        line(
            at + 1,
            &joint_text(joint, kind, &axes[at], [limits.lower, limits.upper]),
        );
        if let Some(next) = frames.get(at + 1).map(|own| own.translation)
            && next.norm() > ROD
        {
            line(
                at + 1,
                &format!(
                    "<geom type=\"capsule\" size=\"0.02\" fromto=\"0 0 0 {}\" mass=\"0\" contype=\"0\" conaffinity=\"0\"/>",
                    numbers(next.as_slice())
                ),
            );
        }
    }
    let count = model.joints.len();
    if let Some(tip) = frames.get(count) {
        line(
            count,
            &format!(
                "<site name=\"{}\" {}/>",
                escaped(&format!("{}_tip", arm.table.arm.tip)),
                placed(tip)
            ),
        );
    }
    for depth in (0..count).rev() {
        line(depth, "</body>");
    }
}

/// Each joint turns nothing but its motor and gear.
fn bodies_of_joints(model: &Model, text: &mut String) {
    for joint in &model.joints {
        let kind = match joint.kind {
            JointType::Revolute => "hinge",
            _ => "slide",
        };
        let own = joint_text(
            joint,
            kind,
            &Vector3::z(),
            [f64::NEG_INFINITY, f64::INFINITY],
        );
        let name = escaped(&joint.name);
        let _ = writeln!(text, "    <body name=\"{name}_link\">");
        text.push_str(
            "      <!-- what the joint carries is not part of the experiment: next to nothing -->\n      \
             <inertial pos=\"0 0 0\" mass=\"1e-6\" diaginertia=\"1e-9 1e-9 1e-9\"/>\n",
        );
        for line in own.lines() {
            let _ = writeln!(text, "      {line}");
        }
        text.push_str("    </body>\n");
    }
}

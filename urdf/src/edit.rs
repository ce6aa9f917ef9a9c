//! A file with other friction and other masses, all else as it was.

use std::fmt::Write;

use ferntast_model::rigid_body::LinkInertia;

use crate::{
    document::{self, Element},
    error::ReadError,
};

/// What is to be said of a joint's friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// Name of the joint.
    pub joint: String,
    /// Viscous \[Nm·s/rad\] or \[N·s/m\].
    pub damping: f64,
    /// Coulomb \[Nm\] or \[N\].
    pub friction: f64,
    /// For people.
    pub comment: String,
}

/// What is to be said of a link's masses.
#[derive(Clone, Debug, PartialEq)]
pub struct Inertial {
    /// Name of the link.
    pub link: String,
    /// In the link's frame.
    pub inertia: LinkInertia,
    /// For people.
    pub comment: String,
}

/// The text of the URDF `text` with these `<dynamics>` and `<inertial>` in place of its own;
/// joints and links that it has not are passed over.
///
/// # Errors
///
/// [`ReadError`]: it is no URDF.
pub fn with(
    text: &str,
    dynamics: &[Dynamics],
    inertials: &[Inertial],
) -> Result<String, ReadError> {
    let text = document::text(text.as_bytes())?;
    let document = document::parse(text)?;
    let line_ends = document::line_ends(text);
    let root = Element::root(&document, &line_ends);
    let mut edits: Vec<(std::ops::Range<usize>, String)> = Vec::new();
    for element in root.children() {
        let name = element.attribute("name").unwrap_or_default();
        let (child, new) = match element.name() {
            "joint" => match dynamics.iter().find(|own| own.joint == name) {
                Some(own) => ("dynamics", dynamics_text(own, element.child("dynamics"))),
                None => continue,
            },
            "link" => match inertials.iter().find(|own| own.link == name) {
                Some(own) => ("inertial", inertial_text(own)),
                None => continue,
            },
            _ => continue,
        };
        match (element.child(child), element.children().last()) {
            (Some(old), _) => edits.push((old.range(), new)),
            (None, Some(last)) => {
                let end = last.range().end;
                edits.push((end..end, format!("\n    {new}")));
            }
            // Without children: <link name="…"/>, or a start and an end.
            (None, None) => {
                let open = format!("<{} name=\"{}\">", element.name(), escaped(name));
                let close = format!("</{}>", element.name());
                edits.push((element.range(), format!("{open}\n    {new}\n  {close}")));
            }
        }
    }
    let mut text = text.to_owned();
    edits.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    for (range, new) in edits {
        text.replace_range(range, &new);
    }
    Ok(text)
}

fn dynamics_text(own: &Dynamics, before: Option<Element<'_>>) -> String {
    let mut text = format!("<!-- {} -->\n    <dynamics", commented(&own.comment));
    let _ = write!(
        text,
        " damping=\"{}\" friction=\"{}\"",
        number(own.damping),
        number(own.friction)
    );
    let others = before.into_iter().flat_map(|own| own.attributes());
    for (name, value) in others.filter(|(name, _)| !["damping", "friction"].contains(name)) {
        let _ = write!(text, " {name}=\"{}\"", escaped(value));
    }
    text.push_str("/>");
    text
}

fn inertial_text(own: &Inertial) -> String {
    let inertia = &own.inertia;
    let (center, about) = inertia
        .at_center_of_mass()
        .unwrap_or((inertia.first_moment, inertia.rotational));
    let numbers = |values: &[f64]| -> Vec<String> { values.iter().copied().map(number).collect() };
    format!(
        "<!-- {} -->\n    <inertial>\n      <origin xyz=\"{}\" rpy=\"0 0 0\"/>\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    </inertial>",
        commented(&own.comment),
        numbers(center.as_slice()).join(" "),
        number(inertia.mass),
        number(about.m11),
        number(about.m12),
        number(about.m13),
        number(about.m22),
        number(about.m23),
        number(about.m33),
    )
}

/// Nine digits: more than any of it is worth, fewer than noise.
#[must_use]
pub fn number(value: f64) -> String {
    /// What is left of zero after a few turns.
    const ZERO: f64 = 1e-15;
    if value.abs() < ZERO {
        return "0".to_owned();
    }
    let short: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    format!("{short}")
}

/// As it may stand within an attribute.
#[must_use]
pub fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('"', "&quot;")
}

/// As it may stand within a comment.
#[must_use]
pub fn commented(text: &str) -> String {
    let text = text.replace("--", "- -");
    match text.strip_suffix('-') {
        Some(rest) => format!("{rest}."),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Robot;
    use ferntast_model::rigid_body::{Matrix3, Vector3};

    const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm"> <!-- kept -->
  <link name="base"/>
  <link name="upper"><visual><geometry><mesh filename="package://arm/upper.dae"/></geometry></visual>
    <inertial><origin xyz="0.1 0 0" rpy="0.3 0 0"/><mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <dynamics damping="0.5" spring="7"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="hand"/><limit lower="-1" upper="1" effort="9" velocity="2"/></joint>
  <link name="hand"></link>
</robot>"#;

    fn dynamics(joint: &str) -> Dynamics {
        Dynamics {
            joint: joint.to_owned(),
            damping: 1.25,
            friction: 0.1 + 0.2,
            comment: "b0 -- 0.3 -".to_owned(),
        }
    }

    #[test]
    fn what_is_said_is_read_again_and_all_else_stays() {
        let about = Matrix3::new(0.03, 0.001, 0.0, 0.001, 0.04, 0.002, 0.0, 0.002, 0.05);
        let inertia = LinkInertia::about_center_of_mass(1.5, Vector3::new(0.2, -0.1, 0.3), about);
        let inertials = ["upper", "hand", "base", "tail"].map(|link| Inertial {
            link: link.to_owned(),
            inertia,
            comment: "found".to_owned(),
        });
        let joints = ["shoulder", "elbow", "wrist"].map(dynamics);
        let text = with(ARM, &joints, &inertials).expect("a URDF");
        let (before, after) = (Robot::read(ARM.as_bytes()), Robot::read(text.as_bytes()));
        let (before, after) = (before.expect("a URDF"), after.expect("a URDF"));
        for link in &after.links {
            let found = link.inertia.expect("masses");
            assert!(
                (found.rotational - inertia.rotational).norm() < 1e-9,
                "{text}"
            );
            assert!((found.first_moment - inertia.first_moment).norm() < 1e-9);
        }
        for (one, other) in before.joints.iter().zip(&after.joints) {
            assert_eq!(
                (&one.name, one.limit, one.axis),
                (&other.name, other.limit, other.axis)
            );
        }
        assert_eq!(
            text.matches("damping=\"1.25\" friction=\"0.3\"").count(),
            2,
            "{text}"
        );
        assert!(
            text.contains("spring=\"7\"") && text.contains("upper.dae"),
            "{text}"
        );
        assert!(
            text.contains("<!-- kept -->") && !text.contains("0.5"),
            "{text}"
        );
        // Once more changes nothing but the comments.
        let twice = with(&text, &joints, &inertials).expect("a URDF");
        assert_eq!(twice.matches("<inertial>").count(), 3);
        assert_eq!(twice.matches("<dynamics").count(), 2);
    }

    #[test]
    fn what_is_no_urdf_is_refused() {
        assert!(with("<robot", &[], &[]).is_err());
    }
}

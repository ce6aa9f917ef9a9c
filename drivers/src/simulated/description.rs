//! What the arm looks like, for those with tools of their own.

use std::fmt::Write;

use ferntast_model::{
    ArmModel,
    arm::LinkParameters,
    contour::{Feature, Surface},
};
use ferntast_msgs::{
    Text,
    sample::{ARM_FRAMES, LONGEST_DESCRIPTION, RobotDescriptionSample},
};

use ferntast_config::joint_names;

/// Radius of a link as drawn \[m\].
const LINK_RADIUS: f64 = 0.02;
/// Radius of the tip as drawn \[m\].
const TIP_RADIUS: f64 = 0.006;
/// Thickness of an edge or a spring's head as drawn \[m\].
const FRONT_THICKNESS: f64 = 0.004;
/// Height of the contour as drawn \[m\].
const CONTOUR_HEIGHT: f64 = 0.04;

/// The arm and its contour as URDF (<https://wiki.ros.org/urdf/XML>). Joints
/// are named as in `/follower/measured_js`, links as in `/tf`. A contour of
/// more fronts than the message has room for is left out.
pub fn describe(model: &ArmModel) -> RobotDescriptionSample {
    let mut xml = urdf(model, &model.contour.features());
    if xml.len() > LONGEST_DESCRIPTION {
        xml = urdf(model, &[]);
    }
    RobotDescriptionSample {
        urdf: Text::new(&xml),
    }
}

fn urdf(model: &ArmModel, fronts: &[Feature]) -> String {
    let mut xml = String::new();
    // Writing into a string does not fail.
    let _ = write(model, fronts, &mut xml);
    xml
}

fn write(model: &ArmModel, fronts: &[Feature], xml: &mut String) -> std::fmt::Result {
    let [(base, link_1), (_, link_2), (_, tip)] = ARM_FRAMES;
    writeln!(
        xml,
        "<?xml version=\"1.0\"?>\n<robot name=\"ferntast_follower\">"
    )?;
    writeln!(xml, "<link name=\"{base}\">")?;
    for feature in fronts {
        front(xml, feature)?;
    }
    writeln!(xml, "</link>")?;
    for (name, parameters) in [link_1, link_2].iter().zip(&model.arm.link) {
        link(xml, name, parameters)?;
    }
    writeln!(
        xml,
        "<link name=\"{tip}\"><visual><geometry><sphere radius=\"{TIP_RADIUS}\"/></geometry></visual></link>"
    )?;
    let joints = joint_names(model);
    let begins = [0.0, model.arm.link[0].length];
    let frames = ARM_FRAMES.iter().zip(&model.joint);
    for (index, ((parent, child), parameters)) in frames.enumerate() {
        writeln!(
            xml,
            "<joint name=\"{}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{} 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"{}\" upper=\"{}\" effort=\"{}\" velocity=\"{}\"/></joint>",
            joints.get(index).unwrap_or_default(),
            begins[index],
            parameters.position_lower,
            parameters.position_upper,
            parameters.motor_torque_limit,
            parameters.velocity_limit,
        )?;
    }
    writeln!(
        xml,
        "<joint name=\"tip\" type=\"fixed\"><parent link=\"{link_2}\"/><child link=\"{tip}\"/>\
         <origin xyz=\"{} 0 0\"/></joint>\n</robot>",
        model.arm.link[1].length
    )
}

/// A link along x: a rod, its inertia about z as identified; about y it is the
/// same, about x that of a rod.
fn link(xml: &mut String, name: &str, parameters: &LinkParameters) -> std::fmt::Result {
    let LinkParameters {
        length,
        mass,
        center_of_mass,
        inertia,
    } = parameters;
    let about_x = 0.5 * mass * LINK_RADIUS * LINK_RADIUS;
    writeln!(
        xml,
        "<link name=\"{name}\"><inertial><origin xyz=\"{center_of_mass} 0 0\"/><mass value=\"{mass}\"/>\
         <inertia ixx=\"{about_x}\" iyy=\"{inertia}\" izz=\"{inertia}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\
         <visual><origin xyz=\"{} 0 0\" rpy=\"0 {} 0\"/><geometry>\
         <cylinder radius=\"{LINK_RADIUS}\" length=\"{length}\"/></geometry></visual></link>",
        length / 2.0,
        std::f64::consts::FRAC_PI_2,
    )
}

/// A front of the contour: a board behind it.
fn front(xml: &mut String, feature: &Feature) -> std::fmt::Result {
    let center = feature.center - 0.5 * FRONT_THICKNESS * feature.normal;
    let tangent = feature.tangent();
    // Blue, orange and green of the colour-blind safe palette of Okabe and Ito.
    let (name, color) = match feature.surface {
        Surface::Lubricated => ("lubricated", "0 0.45 0.7 1"),
        Surface::Unlubricated => ("unlubricated", "0.9 0.62 0 1"),
        Surface::Spring => ("spring", "0 0.62 0.45 1"),
    };
    writeln!(
        xml,
        "<visual><origin xyz=\"{:.5} {:.5} 0\" rpy=\"0 0 {:.5}\"/><geometry><box size=\"{:.5} {FRONT_THICKNESS} {CONTOUR_HEIGHT}\"/></geometry>\
         <material name=\"{name}\"><color rgba=\"{color}\"/></material></visual>",
        center.x,
        center.y,
        tangent.y.atan2(tangent.x),
        2.0 * feature.half_length,
    )
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::Message;

    use super::super::load_config;
    use super::*;

    #[test]
    fn the_shipped_arm_is_described_whole() {
        let sample = describe(&load_config("rokviss").unwrap().model());
        assert_eq!(sample.check(), Ok(()));
        let text = sample.urdf.as_str();
        assert!(text.trim_end().ends_with("</robot>"), "cut: {text}");
        let (links, joints) = (
            text.matches("<link name").count(),
            text.matches("<joint name").count(),
        );
        assert_eq!((links, joints), (4, 3));
        assert_eq!(text.matches("<box").count(), 4);
    }

    #[test]
    fn a_contour_without_end_is_left_out() {
        let mut model = load_config("rokviss").unwrap().model();
        let edge = model.contour.edge[0];
        model.contour.edge = vec![edge; 200];
        let sample = describe(&model);
        let text = sample.urdf.as_str();
        assert!(text.trim_end().ends_with("</robot>"), "cut: {text}");
        assert!(!text.contains("<box"));
    }
}

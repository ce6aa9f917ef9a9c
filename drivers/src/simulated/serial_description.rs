//! What a serial arm looks like, for those with tools of their own.

use std::fmt::Write;

use ferntast_config::serial::{BASE_FRAME, Serial, TIP_FRAME};
use ferntast_model::{
    Joints,
    rigid_body::{JointKind, Placement, Vector3},
    serial_arm::Plane,
};
use ferntast_msgs::{
    Text,
    sample::{LONGEST_DESCRIPTION, RobotDescriptionSample},
};

/// Radius of a link as drawn \[m\].
const LINK_RADIUS: f64 = 0.03;
/// Radius of the tip as drawn \[m\].
const TIP_RADIUS: f64 = 0.008;
/// Size and thickness of a plane as drawn \[m\].
const PLANE: [f64; 2] = [0.4, 0.004];

/// The arm and its planes as URDF (<https://wiki.ros.org/urdf/XML>), with the joints of its
/// file and the links of `/tf`: rods in place of meshes, which need files that a listener may
/// not have. Planes that the message has no room for are left out.
pub fn describe_serial(serial: &Serial) -> RobotDescriptionSample {
    let mut xml = urdf(serial, serial.arm.surfaces());
    if xml.len() > LONGEST_DESCRIPTION {
        xml = urdf(serial, &[]);
    }
    RobotDescriptionSample {
        urdf: Text::new(&xml),
    }
}

fn urdf(serial: &Serial, planes: &[Plane]) -> String {
    let mut xml = String::new();
    // Writing into a string does not fail.
    let _ = write(serial, planes, &mut xml);
    xml
}

fn write(serial: &Serial, planes: &[Plane], xml: &mut String) -> std::fmt::Result {
    let chain = serial.arm.chain();
    let zero = Joints::filled(chain.count(), 0.0);
    let frames: Vec<(&str, &str, Placement)> = serial.frames(&zero).collect();
    writeln!(
        xml,
        "<?xml version=\"1.0\"?>\n<robot name=\"{}\">",
        escaped(&serial.name)
    )?;
    writeln!(xml, "<link name=\"{BASE_FRAME}\">")?;
    for plane in planes {
        board(xml, plane)?;
    }
    rod(xml, &frames[0].2)?;
    writeln!(xml, "</link>")?;
    let inertias = chain.inertias();
    for (joint, name) in serial.links.iter().enumerate() {
        let inertia = &inertias[joint];
        let center = match inertia.mass > 0.0 {
            true => inertia.first_moment / inertia.mass,
            false => Vector3::zeros(),
        };
        let away = center.cross_matrix();
        let about = inertia.rotational + away * away * inertia.mass;
        writeln!(
            xml,
            "<link name=\"{}\"><inertial><origin xyz=\"{:.6} {:.6} {:.6}\"/><mass value=\"{:.6}\"/>\
             <inertia ixx=\"{:.6e}\" iyy=\"{:.6e}\" izz=\"{:.6e}\" ixy=\"{:.6e}\" ixz=\"{:.6e}\" iyz=\"{:.6e}\"/></inertial>",
            escaped(name),
            center.x,
            center.y,
            center.z,
            inertia.mass,
            about.m11,
            about.m22,
            about.m33,
            about.m12,
            about.m13,
            about.m23,
        )?;
        rod(xml, &frames[joint + 1].2)?;
        writeln!(xml, "</link>")?;
    }
    writeln!(
        xml,
        "<link name=\"{TIP_FRAME}\"><visual><geometry><sphere radius=\"{TIP_RADIUS}\"/></geometry></visual></link>"
    )?;
    let kinds = chain.kinds();
    let axes = chain.axes();
    for (joint, own) in serial.arm.joints().iter().enumerate() {
        let (parent, child, place) = &frames[joint];
        let kind = match kinds[joint] {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        };
        let axis = axes[joint];
        writeln!(
            xml,
            "<joint name=\"{}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/>{}\
             <axis xyz=\"{:.6} {:.6} {:.6}\"/><limit lower=\"{:.4}\" upper=\"{:.4}\" effort=\"{}\" velocity=\"{}\"/></joint>",
            escaped(serial.joints.get(joint).unwrap_or_default()),
            escaped(parent),
            escaped(child),
            origin(place),
            axis.x,
            axis.y,
            axis.z,
            own.position_lower,
            own.position_upper,
            own.motor_torque_limit,
            own.velocity_limit,
        )?;
    }
    let (parent, child, place) = &frames[frames.len() - 1];
    writeln!(
        xml,
        "<joint name=\"tip\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{child}\"/>{}</joint>\n</robot>",
        escaped(parent),
        origin(place),
    )
}

/// A link as a rod to where the next one begins; nothing where that is at once.
fn rod(xml: &mut String, next: &Placement) -> std::fmt::Result {
    let way = next.translation;
    let length = way.norm();
    if length < LINK_RADIUS {
        return Ok(());
    }
    let middle = way * 0.5;
    // From z to the way: first about y, then about z.
    let (pitch, yaw) = ((way.x.hypot(way.y)).atan2(way.z), way.y.atan2(way.x));
    writeln!(
        xml,
        "<visual><origin xyz=\"{:.4} {:.4} {:.4}\" rpy=\"0 {pitch:.5} {yaw:.5}\"/><geometry>\
         <cylinder radius=\"{LINK_RADIUS}\" length=\"{length:.4}\"/></geometry></visual>",
        middle.x, middle.y, middle.z,
    )
}

/// A plane: a board behind it.
fn board(xml: &mut String, plane: &Plane) -> std::fmt::Result {
    let normal = plane.direction();
    let center = Vector3::from(plane.point) - normal * (0.5 * PLANE[1]);
    let (pitch, yaw) = (
        normal.x.hypot(normal.y).atan2(normal.z),
        normal.y.atan2(normal.x),
    );
    writeln!(
        xml,
        "<visual><origin xyz=\"{:.4} {:.4} {:.4}\" rpy=\"0 {pitch:.5} {yaw:.5}\"/><geometry>\
         <box size=\"{} {} {}\"/></geometry></visual>",
        center.x, center.y, center.z, PLANE[0], PLANE[0], PLANE[1],
    )
}

/// A frame in the one before it.
fn origin(place: &Placement) -> String {
    let rotation = &place.rotation;
    // R = R_z(yaw) R_y(pitch) R_x(roll).
    let pitch = (-rotation.m31).clamp(-1.0, 1.0).asin();
    let (roll, yaw) = match rotation.m31.abs() < 1.0 - 1e-9 {
        true => (
            rotation.m32.atan2(rotation.m33),
            rotation.m21.atan2(rotation.m11),
        ),
        // Looking along z only their sum, or difference, is told.
        false => (0.0, (-rotation.m12).atan2(rotation.m22)),
    };
    let at = place.translation;
    format!(
        "<origin xyz=\"{:.6} {:.6} {:.6}\" rpy=\"{roll:.6} {pitch:.6} {yaw:.6}\"/>",
        at.x, at.y, at.z
    )
}

/// A name as the value of an attribute.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::load_arm;
    use ferntast_msgs::Message;
    use ferntast_urdf::Robot;

    /// Read again it is the same arm.
    #[test]
    fn the_shipped_arm_is_described_as_it_is() {
        let file = load_arm("panda").unwrap();
        let serial = file.model.serial().unwrap();
        let sample = describe_serial(serial);
        assert_eq!(sample.check(), Ok(()));
        let robot = Robot::read(sample.urdf.as_str().as_bytes()).unwrap();
        let arm = robot.between(BASE_FRAME, TIP_FRAME).unwrap();
        let names: Vec<&str> = serial.joints.iter().collect();
        assert_eq!(arm.joints, names);
        let home = serial.arm.home();
        let (own, read) = (serial.arm.home_tip(), arm.chain.forward(home));
        assert!((own.translation - read.translation).norm() < 1e-4);
        assert!((own.rotation - read.rotation).norm() < 1e-4);
        let rest = home.map(|_| 0.0);
        let weight = arm
            .chain
            .inverse_dynamics(home, &rest, &rest, serial.arm.gravity());
        for (own, read) in serial.arm.weight(home).iter().zip(weight.iter()) {
            assert!((own - read).abs() < 1e-3, "{own} Nm, read {read} Nm");
        }
    }
}

//! Arms to test with.
#![allow(dead_code, reason = "each target uses some of them")]

use std::f64::consts::FRAC_PI_2;

use ferntast_model::{
    Joints,
    rigid_body::{
        Chain, ChainJoint, JointKind, LinkInertia, Matrix3, Placement, PositionLimits, Vector3,
    },
};

/// No limit of torque.
pub fn any_torque(chain: &Chain) -> Joints<f64> {
    Joints::filled(chain.count(), 1e6)
}

fn joint(kind: JointKind, placement: Placement, axis: Vector3<f64>, mass: f64) -> ChainJoint {
    let thick = 0.01 * mass;
    ChainJoint {
        kind,
        placement,
        axis,
        armature: 0.1,
        limits: PositionLimits {
            lower: -2.9,
            upper: 2.9,
        },
        link: LinkInertia::about_center_of_mass(
            mass,
            Vector3::new(0.01, -0.02, 0.06),
            Matrix3::from_diagonal(&Vector3::new(thick, 0.9 * thick, 0.4 * thick)),
        ),
    }
}

/// Seven turning joints with the lengths of a Panda and links that are lighter towards
/// the tip.
pub fn seven_joints() -> Chain {
    let turn = FRAC_PI_2;
    let places = [
        ([0.0, 0.0, 0.333], 0.0, 4.0),
        ([0.0, 0.0, 0.0], -turn, 4.0),
        ([0.0, -0.316, 0.0], turn, 3.0),
        ([0.0825, 0.0, 0.0], turn, 3.0),
        ([-0.0825, 0.384, 0.0], -turn, 2.0),
        ([0.0, 0.0, 0.0], turn, 1.5),
        ([0.088, 0.0, 0.0], turn, 1.0),
    ];
    let joints = places.map(|(at, roll, mass)| {
        let placement = Placement::from_roll_pitch_yaw(at.into(), [roll, 0.0, 0.0]);
        joint(JointKind::Revolute, placement, Vector3::z(), mass)
    });
    let tip = Placement::from_roll_pitch_yaw(Vector3::new(0.0, 0.0, 0.107), [0.0, 0.3, 0.0]);
    Chain::new(&joints, tip).expect("a chain")
}

/// A table that slides along x and, on it, a ram of 2 kg that goes up and down z: its tip is
/// at (x, 0, z).
pub fn slides() -> Chain {
    let slide = |axis, mass| {
        let placement = Placement::identity();
        let mut joint = joint(JointKind::Prismatic, placement, axis, mass);
        joint.armature = 0.0;
        joint
    };
    let joints = [slide(Vector3::x(), 1.0), slide(Vector3::z(), 2.0)];
    Chain::new(&joints, Placement::identity()).expect("a chain")
}

/// A planar arm of two links along x, as ROKVISS is one.
pub fn planar(links: &[ferntast_model::arm::LinkParameters; 2]) -> Chain {
    let along = |length: f64| Placement {
        translation: Vector3::new(length, 0.0, 0.0),
        ..Placement::identity()
    };
    let places = [Placement::identity(), along(links[0].length)];
    let joints = [0, 1].map(|at: usize| {
        let link = &links[at];
        ChainJoint {
            link: LinkInertia::about_center_of_mass(
                link.mass,
                Vector3::new(link.center_of_mass, 0.0, 0.0),
                Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, link.inertia)),
            ),
            ..joint(JointKind::Revolute, places[at], Vector3::z(), 1.0)
        }
    });
    Chain::new(&joints, along(links[1].length)).expect("a chain")
}

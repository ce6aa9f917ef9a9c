//! Arms to test with.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

use crate::Joints;
use crate::rigid_body::{Chain, ChainJoint, JointKind, LinkInertia, Placement, PositionLimits};

/// A link of a rod-like body.
pub fn joint(kind: JointKind, placement: Placement, axis: Vector3<f64>) -> ChainJoint {
    ChainJoint {
        kind,
        placement,
        axis,
        armature: 0.1,
        limits: PositionLimits::NONE,
        link: LinkInertia::about_center_of_mass(
            1.5,
            Vector3::new(0.02, -0.03, 0.12),
            Matrix3::new(
                0.02, 0.001, -0.002, 0.001, 0.018, 0.003, -0.002, 0.003, 0.005,
            ),
        ),
    }
}

/// Seven turning joints: shoulder, elbow and wrist with the lengths of a Panda.
pub fn seven_joints() -> Chain {
    let turn = FRAC_PI_2;
    let places = [
        ([0.0, 0.0, 0.333], 0.0),
        ([0.0, 0.0, 0.0], -turn),
        ([0.0, -0.316, 0.0], turn),
        ([0.0825, 0.0, 0.0], turn),
        ([-0.0825, 0.384, 0.0], -turn),
        ([0.0, 0.0, 0.0], turn),
        ([0.088, 0.0, 0.0], turn),
    ];
    let joints = places.map(|(at, roll)| {
        let placement = Placement::from_roll_pitch_yaw(at.into(), [roll, 0.0, 0.0]);
        let mut joint = joint(JointKind::Revolute, placement, Vector3::z());
        joint.limits = PositionLimits {
            lower: -2.9,
            upper: 2.9,
        };
        joint
    });
    let tip = Placement::from_roll_pitch_yaw(Vector3::new(0.0, 0.0, 0.107), [0.0, 0.3, 0.0]);
    Chain::new(&joints, tip).unwrap()
}

fn vector(scale: f64) -> impl Strategy<Value = Vector3<f64>> {
    let value = -scale..scale;
    (value.clone(), value.clone(), value).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

fn any_joint() -> impl Strategy<Value = ChainJoint> {
    let axis = vector(1.0).prop_filter("a direction", |axis| axis.norm() > 0.1);
    let kind = prop_oneof![3 => Just(JointKind::Revolute), 1 => Just(JointKind::Prismatic)];
    let inertia = (0.1..5.0f64, vector(0.2), vector(0.3), 0.0..0.1f64);
    (kind, vector(0.5), vector(3.0), axis, inertia, 0.0..0.5f64).prop_map(
        |(kind, shift, angles, axis, (mass, center, spread, size), armature)| ChainJoint {
            kind,
            placement: Placement::from_roll_pitch_yaw(shift, angles.into()),
            axis,
            armature,
            limits: PositionLimits::NONE,
            // A body of points along a rod, and a ball: one that there can be.
            link: LinkInertia::about_center_of_mass(
                mass,
                center,
                -spread.cross_matrix() * spread.cross_matrix() * mass + Matrix3::identity() * size,
            ),
        },
    )
}

/// Joint values q, q̇, q̈ and gravity.
pub type State = (Joints<f64>, Joints<f64>, Joints<f64>, Vector3<f64>);

/// A chain of one to eight joints, and a state of it.
pub fn any_chain_and_state() -> impl Strategy<Value = (Chain, State)> {
    proptest::collection::vec(any_joint(), 1..=8).prop_flat_map(|joints| {
        let values = |scale: f64| {
            proptest::collection::vec(-scale..scale, joints.len())
                .prop_map(|values| Joints::from_slice(&values).unwrap())
        };
        let tip = Placement::from_roll_pitch_yaw(Vector3::new(0.1, 0.2, 0.3), [0.1, 0.2, 0.3]);
        let chain = Chain::new(&joints, tip).unwrap();
        let state = (values(3.0), values(2.0), values(5.0), vector(10.0));
        (Just(chain), state)
    })
}

//! The arm that is written out in closed form is the oracle of the chain.

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

use crate::arm::{Arm, ArmParameters, LinkParameters};
use crate::rigid_body::{Chain, ChainJoint, JointKind, LinkInertia, Placement, PositionLimits};
use crate::{Joints, Vector2};

/// Lengths, masses, centres of mass and inertias of two links.
fn planar_arm(numbers: [f64; 8], gravity: [f64; 2]) -> (Arm, Chain) {
    let link = |at: usize| LinkParameters {
        length: numbers[at],
        mass: numbers[at + 1],
        center_of_mass: numbers[at + 2],
        inertia: numbers[at + 3],
    };
    let parameters = ArmParameters {
        gravity,
        link: [link(0), link(4)],
    };
    let along = |length: f64| Placement {
        translation: Vector3::new(length, 0.0, 0.0),
        ..Placement::identity()
    };
    let joint = |place: Placement, link: &LinkParameters| ChainJoint {
        kind: JointKind::Revolute,
        placement: place,
        axis: Vector3::z(),
        armature: 0.0,
        limits: PositionLimits::NONE,
        link: LinkInertia::about_center_of_mass(
            link.mass,
            Vector3::new(link.center_of_mass, 0.0, 0.0),
            Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, link.inertia)),
        ),
    };
    let [one, two] = &parameters.link;
    let joints = [
        joint(Placement::identity(), one),
        joint(along(one.length), two),
    ];
    let chain = Chain::new(&joints, along(two.length)).unwrap();
    (Arm::new(&parameters), chain)
}

fn planar(joints: &Joints<f64>) -> Vector2<f64> {
    crate::kinematics::planar(joints).unwrap()
}

proptest! {
    #[test]
    fn the_chain_has_the_closed_forms_torques_inertia_tip_and_jacobian(
        numbers in [0.1..0.5f64, 0.5..5.0, 0.0..0.3, 0.01..0.1, 0.1..0.5, 0.5..5.0, 0.0..0.3, 0.01..0.1],
        gravity in [-10.0..10.0f64, -10.0..10.0],
        q in [-3.0..3.0f64, -3.0..3.0],
        qd in [-3.0..3.0f64, -3.0..3.0],
        qdd in [-20.0..20.0f64, -20.0..20.0],
    ) {
        let (arm, chain) = planar_arm(numbers, gravity);
        let [x, y] = gravity;
        let (q, qd, qdd) = (Joints::from(q), Joints::from(qd), Joints::from(qdd));
        let torques = chain.inverse_dynamics(&q, &qd, &qdd, &Vector3::new(x, y, 0.0));
        let (flat, rate) = (planar(&q), planar(&qd));
        let closed = arm.inverse_dynamics(&flat, &rate, &planar(&qdd));
        prop_assert!((planar(&torques) - closed).norm() < 1e-12 * (1.0 + closed.norm()));

        let mass = chain.mass_matrix(&q).fixed_view::<2, 2>(0, 0).into_owned();
        prop_assert!((mass - arm.inertia(&flat)).norm() < 1e-13 * (1.0 + mass.norm()));
        let energy = arm.kinetic_energy(&flat, &rate);
        prop_assert!((chain.kinetic_energy(&q, &qd) - energy).abs() < 1e-13 * (1.0 + energy));

        let (tip, jacobian) = chain.forward_and_jacobian(&q);
        let (flat_tip, flat_jacobian) = arm.kinematics().forward_and_jacobian(&flat);
        prop_assert!((tip.translation.xy() - flat_tip).norm() < 1e-14);
        prop_assert!(tip.translation.z == 0.0);
        let upper = jacobian.fixed_view::<2, 2>(0, 0).into_owned();
        prop_assert!((upper - flat_jacobian).norm() < 1e-14);
        prop_assert_eq!((jacobian[(5, 0)], jacobian[(5, 1)]), (1.0, 1.0));
    }
}

//! What a control loop asks of an arm asks for no memory.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../../tests/shared/allocations.rs"]
mod allocations;

use allocations::allocations;
use ferntast_model::{
    Joints,
    rigid_body::{
        Chain, ChainJoint, JointKind, LinkInertia, Matrix3, Placement, PositionLimits, Vector3,
        Vector6, inverse_kinematics::Settings,
    },
};

/// Eight joints, each turned against the one before it, with narrow limits.
fn chain() -> Chain {
    let joint = |kind| ChainJoint {
        kind,
        placement: Placement::from_roll_pitch_yaw(Vector3::new(0.1, 0.0, 0.3), [1.2, 0.3, 0.1]),
        axis: Vector3::z(),
        armature: 0.1,
        limits: PositionLimits {
            lower: -0.51,
            upper: 0.51,
        },
        link: LinkInertia::about_center_of_mass(1.0, Vector3::x(), Matrix3::identity()),
    };
    let mut joints = [joint(JointKind::Revolute); 8];
    joints[3] = joint(JointKind::Prismatic);
    Chain::new(&joints, Placement::identity()).unwrap()
}

#[test]
fn functions_of_a_state_ask_for_no_memory() {
    let (chain, settings) = (chain(), Settings::default());
    let (q, qd) = (Joints::from([0.5; 8]), Joints::from([0.2; 8]));
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let work = || {
        let torques = chain.inverse_dynamics(&q, &qd, &qd, &gravity);
        let regressor = chain.torque_regressor(&q, &qd, &qd, &gravity);
        let (tip, jacobian) = chain.forward_and_jacobian(&q);
        let mass = chain.mass_matrix(&q);
        // Both ways: joints at their ends are held in one of them.
        let step = settings.step(&chain, &q, &Vector6::repeat(0.1), &qd);
        let back = settings.step(&chain, &step.q, &Vector6::repeat(-0.1), &qd);
        [
            torques[0],
            regressor[(0, 0)],
            tip.translation.x,
            jacobian[(0, 0)],
            mass[(0, 0)],
            back.q[0],
        ]
    };
    let (numbers, count) = allocations(work);
    assert_eq!(count, 0);
    assert!(
        numbers.iter().all(|number| number.is_finite()),
        "{numbers:?}"
    );
    // The counter counts.
    assert_eq!(allocations(|| vec![1.0; 3]).1, 1);
}

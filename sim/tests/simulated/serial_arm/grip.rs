//! A hand that holds the tip: a spring and a damper, which the motors push against.

use ferntast_model::{
    Joints,
    rigid_body::{Vector3, rotation},
};
use ferntast_sim::serial_arm::Grip;

use super::{TICK, arm, arms};

const SPREAD: &str = "gravity = [0.0, 0.0, 0.0]\nstart_position = [0.3, -0.6, 0.4, -1.9, 0.5, 1.6, 0.2]\n\
    [[joint]]\nmotor_inertia = 0.3\n";
const STIFFNESS: f64 = 1000.0;
const TURNING: f64 = 20.0;

/// What of a wrench acts on the joints, and where it moves a tip that is held: by force over stiffness, by moment
/// over that about its axes.
#[test]
fn pushed_against_it_gives_way_by_force_over_stiffness() {
    let chain = arms::seven_joints();
    let mut arm = arm(&chain, SPREAD);
    let begin = arm.truth().tip;
    arm.hold(Some(Grip {
        position: begin.translation + Vector3::new(0.01, -0.02, 0.015),
        velocity: Vector3::zeros(),
        rotation: rotation(&Vector3::z(), 0.1) * begin.rotation,
        stiffness: STIFFNESS,
        damping: 80.0,
        turning_stiffness: TURNING,
        turning_damping: 4.0,
    }));
    let (force, moment) = (Vector3::new(4.0, -2.0, 3.0), Vector3::new(0.3, 0.0, -0.4));
    for _ in 0..20_000 {
        let now = arm.truth();
        let jacobian = chain.jacobian(&now.position);
        // The seventh joint's worth of motion that the tip does not show is braked.
        let torque = Joints::from_fn(chain.count(), |joint| {
            let column = jacobian.column(joint);
            column.fixed_rows::<3>(0).dot(&force) + column.fixed_rows::<3>(3).dot(&moment)
                - 2.0 * now.velocity[joint]
        });
        arm.advance(&torque, TICK);
    }
    let end = arm.truth();
    let wanted = begin.translation + Vector3::new(0.01, -0.02, 0.015) + force / STIFFNESS;
    let off = (end.tip.translation - wanted).norm();
    let (against, turned) = (end.grip_force + force, end.grip_moment + moment);
    println!("{off:.1e} m off, {against:?} N, {turned:?} Nm");
    assert!(off < 1e-6, "{off} m");
    assert!(against.norm() < 1e-3, "{against:?}");
    assert!(turned.norm() < 1e-3, "{turned:?}");
    assert_eq!(end.force, Vector3::zeros());
}

/// However strongly it is damped: no step is too long for that.
#[test]
fn a_damper_never_makes_the_arm_swing() {
    let chain = arms::seven_joints();
    let mut arm = arm(&chain, SPREAD);
    let begin = arm.truth().tip;
    arm.hold(Some(Grip {
        position: begin.translation + Vector3::new(0.0, 0.0, 0.02),
        velocity: Vector3::zeros(),
        rotation: begin.rotation,
        stiffness: STIFFNESS,
        damping: 1e6,
        turning_stiffness: 0.0,
        turning_damping: 1e5,
    }));
    let none = Joints::filled(chain.count(), 0.0);
    for _ in 0..2000 {
        arm.advance(&none, TICK);
        // 20 N against 10⁶ N·s/m, twice at the end of a step.
        let speed = arm.truth().tip_velocity.norm();
        assert!(speed < 1e-4, "{speed} m/s");
    }
    arm.hold(None);
    arm.advance(&none, TICK);
    assert_eq!(arm.truth().grip_force, Vector3::zeros());
}

//! The tip gets where it is to go, singularities are not crossed, limits hold.

use nalgebra::{Vector3, Vector6};
use proptest::prelude::*;

use super::arms::{joint, seven_joints};
use crate::rigid_body::inverse_kinematics::{
    Distance, InverseKinematicsError, Settings, Task, motion_to,
};
use crate::rigid_body::{Chain, JointKind, Placement, PositionLimits};
use crate::{Joints, Vector2};

const TIGHT: Distance = Distance {
    position: 1e-9,
    orientation: 1e-9,
};
const BENT: [f64; 7] = [0.1, -0.5, 0.2, -2.0, 0.1, 1.7, 0.6];

/// Two links of 0.3 and 0.2 m in a plane.
fn planar() -> Chain {
    let place = |x: f64| Placement {
        translation: Vector3::new(x, 0.0, 0.0),
        ..Placement::identity()
    };
    let joints = [0.0, 0.3].map(|x| joint(JointKind::Revolute, place(x), Vector3::z()));
    Chain::new(&joints, place(0.2)).unwrap()
}

/// For a tip in a plane: two rows of position count, the third has no say.
fn in_plane() -> Settings {
    Settings {
        task: Task::Position,
        length: 0.3,
        homing: 0.0,
        ..Settings::default()
    }
}

proptest! {
    // Each case is thousands of steps.
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_pose_nearby_is_reached(turns in proptest::array::uniform7(-0.25..0.25f64)) {
        let (chain, start) = (seven_joints(), Joints::from(BENT));
        let goal = Joints::from_fn(start.count(), |joint| start[joint] + turns[joint]);
        let target = chain.forward(&goal);
        let settings = Settings::default();
        settings.validate().unwrap();
        let found = settings.solve(&chain, &target, &start, &start, TIGHT, 2000).unwrap();
        let left = motion_to(&chain.forward(&found), &target);
        prop_assert!(left.norm() < 2e-9, "{left}");
    }

    /// A pull beyond the reach stretches the arm and does not fold it to the other side.
    #[test]
    fn a_singularity_slows_and_is_not_crossed(
        q1 in -3.0..3.0f64, q2 in prop_oneof![0.3..2.8f64, -2.8..-0.3f64], x in -2.0..2.0f64, y in -2.0..2.0f64,
    ) {
        let (chain, settings) = (planar(), in_plane());
        let mut q = Joints::from([q1, q2]);
        let begin = chain.forward(&q).translation.xy();
        for _ in 0..3000 {
            let tip = chain.forward(&q).translation;
            let motion = Vector6::new(x - tip.x, y - tip.y, 0.0, 0.0, 0.0, 0.0);
            let next = settings.step(&chain, &q, &motion, &q);
            prop_assert!(next.q[1] * q2 > 0.0, "crossed from {:?} to {:?}", q, next.q);
            q = next.q;
        }
        let reached = chain.forward(&q).translation.xy();
        let goal = Vector2::new(x, y);
        // Where the straight way there is well within reach it has got there.
        let nearest = (0..=100).map(|part| begin.lerp(&goal, 0.01 * f64::from(part)).norm());
        let (least, most) = nearest.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
        if least > 0.15 && most < 0.49 {
            prop_assert!((reached - goal).norm() < 1e-6, "{reached} {goal}");
        }
        // Beyond the reach it points there, all but stretched.
        if least > 0.15 && goal.norm() > 0.6 {
            let stretched = goal.normalize() * 0.5;
            prop_assert!(reached.norm() > 0.49, "{reached}");
            prop_assert!((reached - stretched).norm() < 0.02, "{reached} {stretched}");
        }
    }

    #[test]
    fn no_joint_leaves_its_limits(
        shift in proptest::array::uniform3(-0.8..0.8f64), turn in proptest::array::uniform3(-2.0..2.0f64),
    ) {
        let (chain, settings) = (seven_joints(), Settings::default());
        let mut q = Joints::from(BENT);
        let here = chain.forward(&q);
        let target = here.then(&Placement::from_roll_pitch_yaw(shift.into(), turn));
        for _ in 0..1500 {
            let before = motion_to(&chain.forward(&q), &target);
            q = settings.step(&chain, &q, &before, &Joints::from(BENT)).q;
            for (value, limits) in q.iter().zip(chain.limits().iter()) {
                prop_assert!((limits.lower..=limits.upper).contains(value));
            }
        }
    }
}

#[test]
fn what_the_tip_leaves_free_goes_home() {
    let chain = seven_joints();
    let (mut q, home) = (
        Joints::from(BENT),
        Joints::from([0.4, -0.4, -0.1, -1.9, 0.3, 1.6, 0.5]),
    );
    let target = chain.forward(&q);
    let settings = Settings::default();
    let apart = |q: &Joints<f64>| {
        (0..7)
            .map(|joint| (q[joint] - home[joint]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let before = apart(&q);
    for _ in 0..3000 {
        let left = motion_to(&chain.forward(&q), &target);
        q = settings.step(&chain, &q, &left, &home).q;
    }
    assert!(apart(&q) < 0.9 * before, "{} of {before}", apart(&q));
    assert!(motion_to(&chain.forward(&q), &target).norm() < 1e-6);
}

#[test]
fn a_joint_at_its_end_leaves_its_part_to_the_others() {
    let place = |x: f64| Placement {
        translation: Vector3::new(x, 0.0, 0.0),
        ..Placement::identity()
    };
    let mut joints = [0.0, 0.3, 0.3].map(|x| joint(JointKind::Revolute, place(x), Vector3::z()));
    joints[1].limits = PositionLimits {
        lower: 0.0,
        upper: 0.9,
    };
    let chain = Chain::new(&joints, place(0.3)).unwrap();
    let (start, settings) = (Joints::from([0.0, 0.8, 0.8]), in_plane());
    // Nearer to the base than joint 2 at its end would allow if joint 3 stayed.
    let target = place(0.25);
    let tolerance = Distance {
        position: 1e-6,
        orientation: 0.0,
    };
    let found = settings
        .solve(&chain, &target, &start, &start, tolerance, 5000)
        .unwrap();
    assert!(found[1] <= 0.9 && found[1] > 0.89, "{found:?}");
    assert!((chain.forward(&found).translation - target.translation).norm() < 1e-6);
}

#[test]
fn a_target_out_of_reach_is_told_with_its_distance() {
    let (chain, start) = (seven_joints(), Joints::from(BENT));
    let mut target = chain.forward(&start);
    target.translation.x += 5.0;
    let solve = |target| Settings::default().solve(&chain, &target, &start, &start, TIGHT, 3000);
    let error = solve(target).unwrap_err();
    assert!(matches!(
        error,
        InverseKinematicsError::NotReached { distance, .. } if distance.position > 3.5
    ));
    assert!(
        error.to_string().contains("choose a target within reach"),
        "{error}"
    );
    target.translation.x = f64::NAN;
    assert_eq!(solve(target), Err(InverseKinematicsError::NotFinite));
}

#[test]
fn what_is_not_finite_moves_nothing() {
    let (chain, settings, good) = (seven_joints(), Settings::default(), Joints::from(BENT));
    let (motion, bad) = (Vector6::repeat(0.01), Joints::from([f64::NAN; 7]));
    for motion in [f64::NAN, f64::INFINITY] {
        let step = settings.step(&chain, &good, &Vector6::repeat(motion), &good);
        assert!(step.held && step.q == good, "{step:?}");
    }
    assert!(settings.step(&chain, &good, &motion, &bad).held);
    assert!(settings.step(&chain, &bad, &motion, &good).held);
    let far = settings.step(&chain, &good, &Vector6::repeat(1e300), &good);
    assert!(!far.held && far.q != good);
}

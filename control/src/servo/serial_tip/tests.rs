use super::super::{CartesianModel, Command, CommandCheck, ServoConfig, Target};
use super::*;
use crate::orientation::Orientation;
use ferntast_model::friction::FrictionParameters;
use ferntast_model::joint::JointParameters;
use ferntast_model::rigid_body::{
    ChainJoint, JointKind, LinkInertia, PositionLimits, rotation_vector,
};
use std::collections::BTreeMap;

fn joint() -> JointParameters {
    JointParameters {
        motor_inertia: 0.2,
        gear_ratio: 100.0,
        stiffness: 1e4,
        damping: 0.0,
        motor_constant: 10.0,
        motor_torque_limit: 50.0,
        torque_sensor_range: 60.0,
        position_lower: -2.5,
        position_upper: 2.5,
        velocity_limit: 2.0,
        friction: FrictionParameters {
            speed_range: [0.01, 2.0],
            effects: BTreeMap::new(),
        },
    }
}

/// An arm of so many joints that turn about z and y in turns, each link 0.2 m along z.
fn arm(joints: usize) -> SerialArm {
    let link = |number: usize| ChainJoint {
        kind: JointKind::Revolute,
        placement: Placement {
            rotation: Matrix3::identity(),
            translation: Vector3::new(0.0, 0.0, 0.2),
        },
        axis: match number % 2 {
            0 => Vector3::z(),
            _ => Vector3::y(),
        },
        armature: 0.0,
        limits: PositionLimits::NONE,
        link: LinkInertia {
            mass: 1.0,
            first_moment: Vector3::new(0.0, 0.0, 0.1),
            rotational: Matrix3::identity() * 0.02,
        },
    };
    let links: Vec<ChainJoint> = (0..joints).map(link).collect();
    let mut tip = Placement::identity();
    tip.translation.z = 0.1;
    let home = [0.2, 0.7, -0.1, 1.1, 0.3, 0.9, 0.1];
    let chain = Chain::new(&links, tip).unwrap();
    let joints = vec![joint(); joints];
    let gravity = [0.0, 0.0, -9.81];
    SerialArm::new(
        chain,
        joints.clone(),
        gravity,
        &home[..joints.len()],
        Vec::new(),
    )
    .unwrap()
}

/// The tip goes round a circle; gives the farthest that it was from it, and that it turned.
fn round(tip: &SerialTip, arm: &SerialArm, radius: f64) -> [f64; 2] {
    let middle = arm.home_tip().translation;
    let (mut led, mut worst) = (None, [0.0_f64; 2]);
    for step in 0..4000 {
        let angle = std::f64::consts::TAU * f64::from(step) / 2000.0;
        let at = middle + Vector3::new(angle.cos() - 1.0, angle.sin(), 0.5 * angle.sin()) * radius;
        let next = tip.joints(&at, None, arm.home(), led.as_ref()).unwrap();
        let place = arm.chain().forward(&next.joints);
        let turn = (place.rotation - tip.orientation).norm();
        worst[0] = worst[0].max((place.translation - at).norm());
        worst[1] = worst[1].max(turn);
        led = Some(next);
    }
    worst
}

#[test]
fn the_tip_follows_and_holds_its_orientation_where_it_can() {
    let seven = arm(7);
    let [apart, turned] = round(&SerialTip::new(&seven), &seven, 0.04);
    assert!(apart < 1e-5 && turned < 1e-5, "{apart} m, {turned}");
    let four = arm(4);
    let [apart, turned] = round(&SerialTip::new(&four), &four, 0.04);
    assert!(apart < 1e-5 && turned > 1e-2, "{apart} m, {turned}");
}

/// Where no singularity is near, the step is that of the model's inverse kinematics.
#[test]
fn a_plain_step_is_the_models_without_its_looking() {
    let arm = arm(7);
    let tip = SerialTip::new(&arm);
    let mut q = *arm.home();
    q[2] += 0.05;
    let left = Vector6::new(1e-4, -2e-4, 1e-4, 1e-4, 0.0, -1e-4);
    let jacobian = arm.chain().jacobian(&q);
    let (plain, way) = tip.plain_step(&q, &jacobian, &left).unwrap();
    let full = tip.settings.step(arm.chain(), &q, &left, arm.home());
    // The model's steps are shorter at most: compare directions.
    let direction = |to: &Joints<f64>| {
        let change = SVector::<f64, 7>::from_fn(|joint, _| to[joint] - q[joint]);
        change / change.norm()
    };
    assert!((direction(&plain) - direction(&full.q)).norm() < 1e-6);
    assert!(way <= LONGEST && full.mobility > tip.settings.slow_below);
}

/// Led towards a stretched arm it slows and stands, and is not led through.
#[test]
fn it_stands_before_a_singularity_and_is_refused_beyond_reach() {
    let arm = arm(7);
    let tip = SerialTip::new(&arm);
    let home = arm.home_tip().translation;
    let outwards = home.normalize();
    let (mut led, mut refused) = (None, 0);
    for step in 0..4000 {
        let at = home + outwards * (2e-4 * f64::from(step));
        match tip.joints(&at, None, arm.home(), led.as_ref()) {
            Ok(next) => led = Some(next),
            Err(refusal) => {
                let limit = Range::Reach;
                assert_eq!(refusal, CommandRefusal::OutOfRange { limit });
                refused += 1;
            }
        }
    }
    assert!(refused > 100, "{refused}");
    let q = led.unwrap().joints;
    let zero = Vector6::zeros();
    let mobility = tip.settings.step(arm.chain(), &q, &zero, &q).mobility;
    assert!(mobility >= 0.9 * tip.settings.stop_below, "{mobility}");
    assert!(q.iter().all(|own| own.abs() <= 2.5 && own.is_finite()));
    // And back it comes.
    let back = (0..2000).try_fold(led.unwrap(), |led, _| {
        tip.joints(&home, None, arm.home(), Some(&led))
    });
    let place = arm.chain().forward(&back.unwrap().joints);
    assert!((place.translation - home).norm() < 1e-4);
}

/// The tool is turned about `axis` by up to `angle`, in a time of so many commands, and the tip
/// stays: gives the farthest that the tip was from its place, and the angle that is left.
fn turn_about(arm: &SerialArm, axis: Vector3<f64>, angle: f64, commands: u32) -> ([f64; 2], Led) {
    let tip = SerialTip::new(arm);
    let home = arm.home_tip();
    let (mut led, mut apart): (Option<Led>, f64) = (None, 0.0);
    let axis = axis.normalize();
    let begin = tip.orientation(arm.home()).unwrap();
    let mut to = begin;
    for command in 1..=commands {
        let share = f64::from(command) / f64::from(commands);
        to = UnitQuaternion::from_scaled_axis(axis * (angle * share)) * begin;
        let turn = Turn { to, most: 2e-3 };
        let next = tip.joints(&home.translation, Some(&turn), arm.home(), led.as_ref());
        let next = next.unwrap();
        let place = arm.chain().forward(&next.joints);
        apart = apart.max((place.translation - home.translation).norm());
        led = Some(next);
    }
    let led = led.unwrap();
    let left = tip.orientation(&led.joints).unwrap().angle_to(&to);
    ([apart, left], led)
}

#[test]
fn the_tool_turns_about_a_tip_that_stays() {
    let arm = arm(7);
    for axis in [
        Vector3::x(),
        Vector3::y(),
        Vector3::z(),
        Vector3::new(1.0, -1.0, 0.5),
    ] {
        // 0.4 rad at 0.4 rad/s, and the same in a tenth of the time: as fast as it goes then.
        let ([apart, left], _) = turn_about(&arm, axis, 0.4, 1000);
        assert!(
            apart < 1e-5 && left < 1e-5,
            "{axis:?}: {apart} m, {left} rad"
        );
        let ([apart, left], _) = turn_about(&arm, axis, 0.4, 100);
        assert!(apart < 1e-4, "{axis:?}: {apart} m");
        assert!((0.19..0.21).contains(&left), "{left}");
    }
}

/// It is turned as far as it goes, half a turn and more about any axis: a tool that cannot follow
/// stays behind, and the tip stays where it is.
#[test]
fn a_tool_stays_behind_before_a_singularity() {
    let arm = arm(7);
    let mut behind = 0;
    for axis in [
        Vector3::x(),
        -Vector3::x(),
        Vector3::y(),
        -Vector3::y(),
        Vector3::z(),
    ] {
        let ([apart, left], led) = turn_about(&arm, axis, 3.0, 4000);
        let zero = Vector6::zeros();
        let settings = SerialTip::new(&arm).settings;
        let mobility = settings
            .step(arm.chain(), &led.joints, &zero, &led.joints)
            .mobility;
        println!("{axis:?}: {apart:.6} m, {left:.3} rad left, mobility {mobility:.3}");
        assert!(mobility >= 0.9 * settings.stop_below, "{mobility}");
        assert!(apart < FAR, "{axis:?}: {apart} m");
        assert!(led.joints.iter().all(|own| own.abs() <= 2.5));
        behind += u32::from(left > 0.1);
    }
    assert!(behind > 0, "none was turned too far");
}

#[test]
fn what_is_not_finite_or_of_other_joints_leads_nowhere() {
    let arm = arm(7);
    let tip = SerialTip::new(&arm);
    let far = Vector3::new(f64::NAN, 0.0, 0.0);
    if let Ok(led) = tip.joints(&far, None, arm.home(), None) {
        assert!(led.joints.iter().all(|own| own.is_finite()));
    }
    let home = arm.home_tip().translation;
    let refused = tip.joints(&home, None, &[0.0; 3].into(), None);
    assert!(matches!(refused, Err(CommandRefusal::NoTipModel)));
}

/// How far the tool is turned in the end \[rad\] whose hand turned by 0.1 rad, and by 0.15 rad while
/// the arm was paused; `arms` is what is done to go on.
fn turned_over_a_pause(arms: fn(&mut CommandCheck)) -> f64 {
    let arm = arm(7);
    let config = ServoConfig {
        workspace_lower: [-5.0; 2],
        workspace_upper: [5.0; 2],
        ..ServoConfig::default()
    };
    let limits = Joints::filled(arm.count(), [-2.5, 2.5]);
    let mut check = CommandCheck::new(CartesianModel::Serial(&arm), limits, &config).unwrap();
    let tip = arm.home_tip();
    let (mut joints, mut stamp_ns) = (*arm.home(), 1_000_000_000);
    let mut lead = |check: &mut CommandCheck, angle: f64| {
        let hand = UnitQuaternion::from_scaled_axis(Vector3::x() * (0.5 + angle));
        let hand = Orientation::given(hand.coords.into()).unwrap();
        for _ in 0..300 {
            stamp_ns += 1_000_000;
            let target = Target::Pose(tip.translation.into(), hand);
            let command = Command { stamp_ns, target };
            joints = check.check(&command, stamp_ns, &joints).unwrap();
        }
        let turned = arm.chain().forward(&joints).rotation * tip.rotation.transpose();
        rotation_vector(&turned).x
    };
    assert!(lead(&mut check, 0.0).abs() < 1e-5);
    assert!((lead(&mut check, 0.1) - 0.1).abs() < 1e-5);
    arms(&mut check);
    lead(&mut check, 0.25)
}

#[test]
fn a_tool_belongs_to_its_hand_over_a_pause_and_anew_where_the_arm_is_armed_anew() {
    let resumed = turned_over_a_pause(CommandCheck::rearm);
    assert!((resumed - 0.25).abs() < 1e-5, "{resumed} rad");
    let armed = turned_over_a_pause(CommandCheck::begin);
    assert!((armed - 0.1).abs() < 1e-5, "{armed} rad");
}

use super::*;
use crate::estimator::{Form, MotorCurrentParameters, Uncertainty};
use ferntast_model::friction::FrictionParameters;
use ferntast_model::joint::JointParameters;
use ferntast_model::rigid_body::{
    Chain, ChainJoint, JointKind, LinkInertia, Matrix3, Placement, PositionLimits,
};
use ferntast_model::serial_arm::Plane;
use std::collections::BTreeMap;

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

fn joint(range: f64) -> JointParameters {
    JointParameters {
        motor_inertia: 0.2,
        gear_ratio: 100.0,
        stiffness: 1e4,
        damping: 0.0,
        motor_constant: 10.0,
        motor_torque_limit: range,
        torque_sensor_range: range,
        position_lower: -3.0,
        position_upper: 3.0,
        velocity_limit: 2.0,
        friction: FrictionParameters {
            speed_range: [0.01, 2.0],
            effects: BTreeMap::new(),
        },
    }
}

/// An arm of seven joints that turn about z and y in turns, each link 0.2 m along z, with a
/// table below its tip and a wall beside it.
fn arm() -> SerialArm {
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
            mass: 2.0,
            first_moment: Vector3::new(0.01, 0.02, 0.2),
            rotational: Matrix3::from_diagonal(&Vector3::new(0.03, 0.035, 0.006)),
        },
    };
    let links: Vec<ChainJoint> = (0..7).map(link).collect();
    let mut tip = Placement::identity();
    tip.translation.z = 0.1;
    let joints = [90.0, 90.0, 90.0, 90.0, 15.0, 15.0, 15.0]
        .map(joint)
        .to_vec();
    let home = [0.2, 0.7, -0.1, 1.1, 0.3, 0.9, 0.1];
    let chain = Chain::new(&links, tip).unwrap();
    let free = SerialArm::new(chain.clone(), joints.clone(), GRAVITY, &home, Vec::new()).unwrap();
    let tip = free.home_tip().translation;
    let plane = |name: &str, normal: [f64; 3], apart: f64| Plane {
        name: name.to_owned(),
        point: (tip - Vector3::from(normal) * apart).into(),
        normal,
        stiffness: 2e4,
        damping: 100.0,
        friction: 0.3,
    };
    let planes = vec![
        plane("table", [0.0, 0.0, 1.0], 0.0),
        plane("wall", [-1.0, 0.0, 0.0], 0.05),
    ];
    SerialArm::new(chain, joints, GRAVITY, &home, planes).unwrap()
}

fn parameters(form: Form) -> EstimatorParameters {
    EstimatorParameters {
        form,
        cut_off: 40.0,
        contact_on: 1.0,
        contact_off: 0.5,
        contact_distance: 0.004,
        rest_speed: 0.001,
        rest_travel: 0.0005,
        singularity: 0.05,
        friction_memory: 10.0,
        longest_gap: 0.05,
        zeroing_time: 0.0,
        calibration_time: 0.0,
        uncertainty: Uncertainty::default(),
        motor_current: MotorCurrentParameters::default(),
    }
}

/// What the sensors give while the arm moves like that with `force` on its tip.
fn sensed(arm: &SerialArm, motion: &[Joints<f64>; 3], force: Vector3<f64>) -> JointMeasurement {
    pushed(arm, motion, [force, Vector3::zeros()])
}

/// The same with a force and a torque about the tip.
fn pushed(
    arm: &SerialArm,
    [q, qd, qdd]: &[Joints<f64>; 3],
    [force, turn]: [Vector3<f64>; 2],
) -> JointMeasurement {
    let needed = arm.inverse_dynamics(q, qd, qdd);
    let jacobian = arm.chain().jacobian(q);
    let carried = |joint: usize| {
        (0..3)
            .map(|row| jacobian[(row, joint)] * force[row] + jacobian[(row + 3, joint)] * turn[row])
            .sum::<f64>()
    };
    let torque = Joints::from_fn(q.count(), |joint| needed[joint] - carried(joint));
    JointMeasurement {
        motor_position: Joints::from_fn(q.count(), |joint| {
            arm.joints()[joint].motor_position(q[joint], torque[joint])
        }),
        joint_torque: torque,
    }
}

fn resting(q: Joints<f64>) -> [Joints<f64>; 3] {
    let none = q.map(|_| 0.0);
    [q, none, none]
}

#[test]
fn at_rest_the_force_is_that_on_the_tip_in_both_forms() {
    let arm = arm();
    let force = Vector3::new(3.0, -2.0, 15.0);
    let measured = sensed(&arm, &resting(*arm.home()), force);
    for form in [Form::Direct, Form::MomentumObserver] {
        let mut estimator = SpatialEstimator::new(&arm, &parameters(form)).unwrap();
        let mut estimate = SpatialEstimate::unknown(arm.count());
        for _ in 0..100 {
            estimate = estimator.step(1e-3, &measured);
        }
        let apart = (Vector3::from(estimate.force) - force).norm();
        assert!(apart < 1e-3, "{form:?}: {apart} N");
        assert!(estimate.state.valid && estimate.state.in_contact && estimate.state.near_rest);
        assert_eq!(estimate.surface, Some(0));
        assert!((estimate.state.normal_force - 15.0).abs() < 1e-3);
        let tangents = Vector3::from(estimate.contact_force).xy().norm();
        assert!((tangents - 13f64.sqrt()).abs() < 1e-3, "{tangents} N");
        let tip = Vector3::from(estimate.tip) - arm.home_tip().translation;
        assert!(tip.norm() < 1e-12, "{tip}");
    }
}

/// A force at the tip is told as one, without a torque; what turns the tool as well, with it.
#[test]
fn a_torque_is_told_where_a_force_at_the_tip_is_not_enough() {
    let arm = arm();
    let force = Vector3::new(3.0, -2.0, 15.0);
    let turn = Vector3::new(1.5, -0.8, 0.6);
    let told = |form: Form, turn: Vector3<f64>| {
        let measured = pushed(&arm, &resting(*arm.home()), [force, turn]);
        let mut estimator = SpatialEstimator::new(&arm, &parameters(form)).unwrap();
        let mut estimate = SpatialEstimate::unknown(arm.count());
        for _ in 0..1000 {
            estimate = estimator.step(1e-3, &measured);
        }
        estimate.wrench.map(Vector3::from)
    };
    for form in [Form::Direct, Form::MomentumObserver] {
        let [alone, none] = told(form, Vector3::zeros());
        assert!(
            (alone - force).norm() < 1e-3 && none.norm() < 1e-6,
            "{none}"
        );
        let [both, turned] = told(form, turn);
        assert!((both - force).norm() < 1e-3, "{form:?}: {both}");
        assert!((turned - turn).norm() < 1e-3, "{form:?}: {turned}");
    }
}

/// The joints swing by several rad/s: what the links' motion takes is not taken for a contact.
#[test]
fn what_moves_the_links_is_no_contact() {
    let arm = arm();
    for form in [Form::Direct, Form::MomentumObserver] {
        let mut estimator = SpatialEstimator::new(&arm, &parameters(form)).unwrap();
        let (mut largest, mut torque) = (0.0_f64, 0.0_f64);
        for step in 1..3000 {
            let time = 1e-3 * f64::from(step);
            let swing = |joint: usize, derivative: i32| {
                let (omega, size) = (2.0 + 0.5 * joint as f64, 0.3);
                let phase = omega * time + std::f64::consts::FRAC_PI_2 * f64::from(derivative);
                size * omega.powi(derivative) * phase.sin()
            };
            let state = [0, 1, 2].map(|derivative| {
                Joints::from_fn(arm.count(), |joint| {
                    let base = if derivative == 0 {
                        arm.home()[joint]
                    } else {
                        0.0
                    };
                    base + swing(joint, derivative)
                })
            });
            let estimate = estimator.step(1e-3, &sensed(&arm, &state, Vector3::zeros()));
            if step > 200 {
                largest = largest.max(Vector3::from(estimate.force).norm());
                let bias = arm.inverse_dynamics(&state[0], &state[1], &state[2]);
                let weight = arm.weight(&state[0]);
                let moving = (0..7).map(|joint| (bias[joint] - weight[joint]).abs());
                torque = torque.max(moving.fold(0.0, f64::max));
            }
        }
        // 9 Nm of motion; the filters see 40 rad/s³ of jerk late.
        assert!(torque > 5.0, "{torque} Nm");
        assert!(largest < 0.6, "{form:?}: {largest} N");
    }
}

#[test]
fn sliding_on_the_table_tells_its_friction() {
    let arm = arm();
    let mut estimator = SpatialEstimator::new(&arm, &parameters(Form::Direct)).unwrap();
    let settings = ferntast_model::rigid_body::inverse_kinematics::Settings::default();
    let (mut q, speed) = (*arm.home(), 0.02);
    let mut estimate = SpatialEstimate::unknown(arm.count());
    for _ in 0..600 {
        let way = nalgebra::Vector6::new(0.0, speed * 1e-3, 0.0, 0.0, 0.0, 0.0);
        q = settings.step(arm.chain(), &q, &way, arm.home()).q;
        // The table pushes by 10 N, friction by 3 N against the motion.
        let force = Vector3::new(0.0, -3.0, 10.0);
        estimate = estimator.step(1e-3, &sensed(&arm, &resting(q), force));
    }
    assert!(
        estimate.state.valid && !estimate.state.near_rest,
        "{estimate:?}"
    );
    assert!(
        (estimate.state.normal_force - 10.0).abs() < 0.1,
        "{estimate:?}"
    );
    assert!(
        (estimate.state.tangential_force - 3.0).abs() < 0.1,
        "{estimate:?}"
    );
    assert!(
        (estimate.state.friction.value - 0.3).abs() < 0.01,
        "{estimate:?}"
    );
}

#[test]
fn what_nobody_believes_in_is_felt_by_a_larger_force_that_lasts() {
    let arm = arm();
    let mut estimator = SpatialEstimator::new(&arm, &parameters(Form::Direct)).unwrap();
    let mut q = *arm.home();
    // Away from table and wall.
    q[1] -= 0.3;
    let mut after = |force: f64, steps: usize| {
        let mut estimate = SpatialEstimate::unknown(arm.count());
        for _ in 0..steps {
            let force = Vector3::new(0.0, force, 0.0);
            estimate = estimator.step(1e-3, &sensed(&arm, &resting(q), force));
        }
        estimate
    };
    assert!(!after(0.0, 100).state.touches);
    assert!(!after(2.0, 200).state.touches);
    let touched = after(8.0, 200);
    assert!(touched.state.touches && touched.state.in_contact && touched.state.near_rest);
    assert_eq!(touched.surface, None);
    assert!(
        (touched.state.normal_force - 8.0).abs() < 1e-3,
        "{touched:?}"
    );
    assert!(!after(0.0, 500).state.touches);
}

#[test]
fn a_stretched_arm_tells_no_force_and_a_zero_is_found_while_free() {
    let arm = arm();
    let mut estimator = SpatialEstimator::new(&arm, &parameters(Form::Direct)).unwrap();
    let stretched = [0.0; 7].into();
    let force = Vector3::new(5.0, 0.0, 0.0);
    let mut estimate = SpatialEstimate::unknown(arm.count());
    for _ in 0..100 {
        estimate = estimator.step(1e-3, &sensed(&arm, &resting(stretched), force));
    }
    assert!(estimate.state.singular && !estimate.state.valid);
    assert_eq!(estimate.force, [0.0; 3]);

    let mut own = parameters(Form::Direct);
    own.zeroing_time = 0.5;
    let mut estimator = SpatialEstimator::new(&arm, &own).unwrap();
    let mut q = *arm.home();
    q[1] -= 0.3;
    for _ in 0..1000 {
        let mut measured = sensed(&arm, &resting(q), Vector3::zeros());
        for joint in 0..7 {
            measured.joint_torque[joint] += 0.1;
            let turned = 0.1 / arm.joints()[joint].stiffness;
            measured.motor_position[joint] += turned;
        }
        estimate = estimator.step(1e-3, &measured);
    }
    let left = Vector3::from(estimate.force).norm();
    assert!(left < 0.02, "{left} N");
    // Without it: 0.1 Nm of seven joints are more than 0.2 N.
    assert!(estimate.state.valid);
}

#[test]
fn without_numbers_it_says_so_and_goes_on_after() {
    let arm = arm();
    let mut estimator = SpatialEstimator::new(&arm, &parameters(Form::Direct)).unwrap();
    let good = sensed(&arm, &resting(*arm.home()), Vector3::zeros());
    for _ in 0..50 {
        estimator.step(1e-3, &good);
    }
    let mut bad = good;
    bad.joint_torque[3] = f64::NAN;
    for measured in [
        bad,
        JointMeasurement {
            motor_position: [0.0; 2].into(),
            ..good
        },
    ] {
        let estimate = estimator.step(1e-3, &measured);
        assert!(estimate.state.input_invalid && !estimate.state.valid);
    }
    for _ in 0..50 {
        estimator.step(1e-3, &good);
    }
    assert!(estimator.step(1e-3, &good).state.valid);
}

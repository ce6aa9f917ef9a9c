use super::*;
use ferntast_model::arm::ArmParameters;
use ferntast_model::contour::{Contour, Surface};
use ferntast_model::joint::JointParameters;
use proptest::prelude::*;

/// The sections of the shipped arm that matter here.
#[derive(serde::Deserialize)]
struct Shipped {
    arm: ArmParameters,
    joint: Vec<JointParameters>,
    contour: Contour,
    estimator: EstimatorParameters,
}

fn shipped(gravity: [f64; 2]) -> (ArmModel, EstimatorParameters) {
    let text = include_str!("../../../config/arms/rokviss.toml");
    let mut shipped: Shipped = toml::from_str(text).unwrap();
    shipped.arm.gravity = gravity;
    let model = ArmModel {
        arm: shipped.arm,
        joint: shipped.joint,
        contour: shipped.contour,
    };
    (model, shipped.estimator)
}

/// What the sensors give when the arm rests at `q` with `force` on its tip.
fn at_rest(model: &ArmModel, q: Vector2<f64>, force: Vector2<f64>) -> JointMeasurement {
    let arm = Arm::new(&model.arm);
    let torque = arm.gravity(&q) - arm.kinematics().jacobian(&q).transpose() * force;
    JointMeasurement {
        motor_position: [0, 1]
            .map(|j: usize| model.joint[j].motor_position(q[j], torque[j]))
            .into(),
        joint_torque: torque.into(),
    }
}

#[test]
fn a_wrong_parameter_is_refused_by_name() {
    let (model, mut parameters) = shipped([0.0, 0.0]);
    parameters.contact_off = 2.0 * parameters.contact_on;
    let error = ContactEstimator::new(&model, &parameters).unwrap_err();
    assert_eq!(error.key(), "estimator.contact_off");
}

#[test]
fn a_sensor_beyond_its_range_leads_the_tip_no_further_astray() {
    let (model, parameters) = shipped([0.0, 0.0]);
    let range = model.joint[0].torque_sensor_range;
    let tip = |torque: f64| {
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        let measurement = JointMeasurement {
            motor_position: [-0.8, 1.6].into(),
            joint_torque: [torque, 0.0].into(),
        };
        let estimate = estimator.step(1e-3, &measurement);
        assert_eq!(estimate.state.saturated, torque.abs() >= range);
        estimate.tip
    };
    assert_eq!(tip(3.0 * range), tip(range));
    assert_ne!(tip(0.5 * range), tip(range));
}

#[test]
fn the_split_follows_the_surface() {
    let (model, parameters) = shipped([0.0, 0.0]);
    let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
    // Half a millimetre into the unlubricated edge, whose normal is −x.
    let tip = Vector2::from(model.contour.nominal_tip) + Vector2::new(0.0305, 0.01);
    let kinematics = model.arm.kinematics();
    let q = kinematics
        .inverse(&tip, model.contour.nominal_elbow)
        .unwrap();
    let measurement = at_rest(&model, q, Vector2::new(-20.0, 5.0));
    let mut estimate = ContactEstimate::unknown(estimator.joints());
    for _ in 0..100 {
        estimate = estimator.step(1e-3, &measurement);
    }
    assert!(
        estimate.state.in_contact
            && estimate.state.valid
            && estimate.state.near_rest
            && !estimate.state.corner
    );
    assert_eq!(estimate.surface, Some(Surface::Unlubricated));
    assert!((estimate.state.normal_force - 20.0).abs() < 1e-9);
    // The normal −x turned by −90° is +y.
    assert!((estimate.contact_force[0] - 5.0).abs() < 1e-9);
    assert_eq!(estimate.state.friction, Coefficient::UNKNOWN);

    // Less than the switching-on force keeps the contact, less than the other ends it.
    for (force, in_contact) in [(1.3, true), (0.7, true), (0.3, false), (0.7, false)] {
        let measurement = at_rest(&model, q, Vector2::new(-force, 0.0));
        for _ in 0..100 {
            estimate = estimator.step(1e-3, &measurement);
        }
        assert_eq!(estimate.state.in_contact, in_contact, "{force} N");
        assert_eq!(estimate.state.touches, in_contact, "{force} N");
    }
}

#[test]
fn what_is_not_in_the_contour_is_touched_by_a_larger_force_that_lasts() {
    let (model, parameters) = shipped([0.0, 0.0]);
    let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
    // 30 mm from the contour.
    let tip = Vector2::from(model.contour.nominal_tip);
    let kinematics = model.arm.kinematics();
    let elbow = model.contour.nominal_elbow;
    let q = kinematics.inverse(&tip, elbow).unwrap();
    let mut after = |force: f64, steps: usize| {
        let measurement = at_rest(&model, q, Vector2::new(-force, 0.0));
        let estimates = (0..steps).map(|_| estimator.step(1e-3, &measurement));
        let estimate = estimates.last().unwrap();
        assert!(!estimate.state.in_contact && estimate.surface.is_none());
        estimate.state.touches
    };
    let on = parameters.contact_on;
    // The sensors' zeros are found first.
    assert!(!after(0.0, 2500));
    assert!(!after(2.9 * on, 200), "as much as noise");
    assert!(!after(10.0 * on, 40), "as short as a jerk");
    assert!(!after(0.0, 100), "gone again");
    // The filters take less than 50 ms.
    assert!(after(3.1 * on, 150));
    assert!(after(1.5 * on, 200), "it goes on");
    assert!(after(0.9 * on, 150), "faint for a moment");
    assert!(!after(0.9 * on, 100), "and ends");
}

#[test]
fn in_the_corner_the_split_is_not_trusted() {
    let (model, parameters) = shipped([0.0, 0.0]);
    let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
    let tip = Vector2::from(model.contour.nominal_tip) + Vector2::new(0.0305, -0.0304);
    let kinematics = model.arm.kinematics();
    let q = kinematics
        .inverse(&tip, model.contour.nominal_elbow)
        .unwrap();
    let measurement = at_rest(&model, q, Vector2::new(-20.0, 16.0));
    let estimate = (0..100)
        .map(|_| estimator.step(1e-3, &measurement))
        .last()
        .unwrap();
    assert!(estimate.state.corner && estimate.state.in_contact);
    assert!((Vector2::from(estimate.force) - Vector2::new(-20.0, 16.0)).norm() < 1e-9);
}

#[test]
fn a_force_that_is_there_from_the_start_is_learned_within_the_largest_zero() {
    let (model, parameters) = shipped([0.0, 0.0]);
    assert!(parameters.zeroing_time > 0.0);
    let q = Vector2::new(-0.785, 1.571);
    let jacobian = model.arm.kinematics().jacobian(&q);
    for parameters in forms(&parameters) {
        for newtons in [2.0, 4.0, 30.0] {
            let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
            let force = Vector2::new(newtons, 0.0);
            let measurement = at_rest(&model, q, force);
            let estimate = (0..5000)
                .map(|_| estimator.step(1e-3, &measurement))
                .last()
                .unwrap();
            let learned = jacobian.transpose() * (force - Vector2::from(estimate.force));
            let most = zeroing::LARGEST_SHARE * model.joint[1].torque_sensor_range;
            let bears = (jacobian.transpose() * force).abs().max();
            // All of what is within it, nothing of what is not.
            let expected = if bears <= most { bears } else { 0.0 };
            assert!((learned.abs().max() - expected).abs() < 1e-6, "{learned}");
        }
    }
}

/// Both forms of equation (5), else as `parameters`.
fn forms(parameters: &EstimatorParameters) -> [EstimatorParameters; 2] {
    [Form::Direct, Form::MomentumObserver].map(|form| EstimatorParameters {
        form,
        ..*parameters
    })
}

#[test]
fn a_sensor_that_is_lost_for_long_leaves_no_contact() {
    let (model, parameters) = shipped([0.0, 0.0]);
    for parameters in forms(&parameters) {
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        let tip = Vector2::from(model.contour.nominal_tip) + Vector2::new(0.0305, 0.01);
        let kinematics = model.arm.kinematics();
        let elbow = model.contour.nominal_elbow;
        let q = kinematics.inverse(&tip, elbow).unwrap();
        let good = at_rest(&model, q, Vector2::new(-20.0, 5.0));
        let lost = JointMeasurement {
            joint_torque: [good.joint_torque[0], f64::NAN].into(),
            ..good
        };
        let mut run = |measurement, ticks| {
            (0..ticks)
                .map(|_| estimator.step(1e-3, measurement))
                .last()
                .unwrap()
        };
        let seen = run(&good, 100);
        assert!(seen.state.in_contact && seen.state.valid);
        let held = run(&lost, 10);
        assert!(held.state.in_contact && !held.state.valid && held.state.input_invalid);
        assert_eq!(held.force, seen.force);
        let gone = run(&lost, 100);
        assert!(!gone.state.in_contact && !gone.state.valid && gone.state.input_invalid);
        assert_eq!((gone.force, gone.tip), ([0.0, 0.0], seen.tip));
        let back = run(&good, 100);
        assert!(back.state.in_contact && back.state.valid && !back.state.input_invalid);
    }
}

#[test]
fn a_torque_sensor_that_is_stuck_is_told_from_one_at_rest() {
    let (model, parameters) = shipped([0.0, 0.0]);
    for parameters in forms(&parameters) {
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        let mut measurement = at_rest(&model, Vector2::new(-0.785, 1.571), Vector2::zeros());
        for _ in 0..1000 {
            assert!(
                !estimator
                    .step(1e-3, &measurement)
                    .state
                    .stuck
                    .contains(&true)
            );
        }
        // Joint 2 turns at 5 °/s; the torque of joint 1 changes, that of joint 2 does not.
        let mut estimate = ContactEstimate::unknown(estimator.joints());
        for tick in 0..200 {
            measurement.motor_position[1] += 8.7e-5;
            measurement.joint_torque[0] = 0.01 * f64::from(tick % 2);
            estimate = estimator.step(1e-3, &measurement);
        }
        assert_eq!(estimate.state.stuck, [false, true]);
        assert!(!estimate.state.valid && !estimate.state.input_invalid);
        for tick in 0..200 {
            measurement.joint_torque = [0.01 * f64::from(tick % 2); 2].into();
            estimate = estimator.step(1e-3, &measurement);
        }
        assert!(estimate.state.valid && estimate.state.stuck == [false, false]);
    }
}

#[test]
fn it_recovers_from_broken_time() {
    let (model, parameters) = shipped([0.0, 0.0]);
    let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
    let measurement = at_rest(&model, Vector2::new(-0.785, 1.571), Vector2::new(3.0, 4.0));
    for dt in [f64::INFINITY, f64::NAN, -1.0, 0.0, 1e300, 1e-300] {
        estimator.step(dt, &measurement);
    }
    let estimate = (0..100)
        .map(|_| estimator.step(1e-3, &measurement))
        .last()
        .unwrap();
    assert!(estimate.state.valid && !estimate.state.input_invalid);
    assert!((Vector2::from(estimate.force) - Vector2::new(3.0, 4.0)).norm() < 1e-9);
}

proptest! {
    /// Equation (5) at rest: the torque sensors bear the tip's force and the links' weight.
    #[test]
    fn a_force_at_rest_is_found(
        q1 in -1.5..1.0f64, q2 in 0.3..2.4f64, x in -30.0..30.0f64, y in -30.0..30.0f64, ground: bool, observer: bool,
    ) {
        let (model, parameters) = shipped([0.0, if ground { -9.80665 } else { 0.0 }]);
        // A force that is there from the start, in the middle of nowhere, is a zero's like.
        let parameters = EstimatorParameters { zeroing_time: 0.0, ..forms(&parameters)[usize::from(observer)] };
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        let (q, force) = (Vector2::new(q1, q2), Vector2::new(x, y));
        let measurement = at_rest(&model, q, force);
        let estimate = (0..100).map(|_| estimator.step(1e-3, &measurement)).last().unwrap();
        prop_assert!((Vector2::from(estimate.force) - force).norm() < 1e-9);
        prop_assert!((planar(&estimate.position).unwrap() - q).norm() < 1e-12);
        let tip = model.arm.kinematics().forward(&q);
        prop_assert!((Vector2::from(estimate.tip) - tip).norm() < 1e-12);
    }

    /// Whatever numbers come, the estimate stays finite, and what cannot be used is not called valid.
    #[test]
    fn it_stays_finite(
        inputs in prop::collection::vec((prop_oneof![any::<f64>(), Just(1e-3)], number(), number(), number(), number()), 1..50),
        observer: bool,
    ) {
        let (model, parameters) = shipped([0.0, 0.0]);
        let parameters = forms(&parameters)[usize::from(observer)];
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        for (dt, a, b, c, d) in inputs {
            let measurement = JointMeasurement { motor_position: [a, b].into(), joint_torque: [c, d].into() };
            let e = estimator.step(dt, &measurement);
            let numbers = [e.position, e.velocity].map(|own| own.into_places(0.0));
            prop_assert!(numbers.iter().flatten().all(|x| x.is_finite()));
            let numbers = [e.tip, e.tip_velocity, e.force, e.contact_force];
            prop_assert!(numbers.iter().flatten().all(|x| x.is_finite()));
            prop_assert!(e.state.normal_force >= 0.0 && e.state.tangential_force.is_finite() && e.state.friction.value.is_finite());
            prop_assert!(!e.state.friction.error.is_nan());
            let broken = [a, b, c, d].iter().any(|x| !x.is_finite()) || !dt.is_finite() || dt <= 0.0;
            prop_assert!(!broken || (e.state.input_invalid && !e.state.valid));
            prop_assert!(!(e.state.valid && (e.state.singular || e.state.saturated || e.state.stuck.contains(&true))));
        }
    }
}

/// Any number, or one that an arm may give.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), -50.0..50.0f64, -1.0..1.0f64]
}

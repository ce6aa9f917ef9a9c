use super::*;
use ferntast_model::arm::ArmParameters;
use ferntast_model::contour::Contour;
use proptest::prelude::*;

/// The sections of the shipped arm that matter here.
#[derive(serde::Deserialize)]
struct Shipped {
    arm: ArmParameters,
    joint: [JointParameters; JOINTS],
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
        motor_position: [0, 1].map(|j: usize| model.joint[j].motor_position(q[j], torque[j])),
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
    let mut estimate = ContactEstimate::UNKNOWN;
    for _ in 0..100 {
        estimate = estimator.step(1e-3, &measurement);
    }
    assert!(estimate.in_contact && estimate.valid && estimate.near_rest && !estimate.corner);
    assert_eq!(estimate.surface, Some(Surface::Unlubricated));
    assert!((estimate.normal_force - 20.0).abs() < 1e-9);
    // The normal −x turned by −90° is +y.
    assert!((estimate.contact_force[0] - 5.0).abs() < 1e-9);
    assert_eq!(estimate.friction, Coefficient::UNKNOWN);

    // Less than the switching-on force keeps the contact, less than the other ends it.
    for (force, in_contact) in [(1.3, true), (0.7, true), (0.3, false), (0.7, false)] {
        let measurement = at_rest(&model, q, Vector2::new(-force, 0.0));
        for _ in 0..100 {
            estimate = estimator.step(1e-3, &measurement);
        }
        assert_eq!(estimate.in_contact, in_contact, "{force} N");
    }
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
    assert!(estimate.corner && estimate.in_contact);
    assert!((Vector2::from(estimate.force) - Vector2::new(-20.0, 16.0)).norm() < 1e-9);
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
    assert!(estimate.valid && !estimate.input_invalid);
    assert!((Vector2::from(estimate.force) - Vector2::new(3.0, 4.0)).norm() < 1e-9);
}

proptest! {
    /// Equation (5) at rest: the torque sensors bear the tip's force and the links' weight.
    #[test]
    fn a_force_at_rest_is_found(
        q1 in -1.5..1.0f64, q2 in 0.3..2.4f64, x in -30.0..30.0f64, y in -30.0..30.0f64, ground: bool,
    ) {
        let (model, parameters) = shipped([0.0, if ground { -9.80665 } else { 0.0 }]);
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        let (q, force) = (Vector2::new(q1, q2), Vector2::new(x, y));
        let measurement = at_rest(&model, q, force);
        let estimate = (0..100).map(|_| estimator.step(1e-3, &measurement)).last().unwrap();
        prop_assert!((Vector2::from(estimate.force) - force).norm() < 1e-9);
        prop_assert!((Vector2::from(estimate.position) - q).norm() < 1e-12);
        let tip = model.arm.kinematics().forward(&q);
        prop_assert!((Vector2::from(estimate.tip) - tip).norm() < 1e-12);
    }

    /// Whatever numbers come, the estimate stays finite.
    #[test]
    fn it_stays_finite(inputs in prop::collection::vec((any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>()), 1..50)) {
        let (model, parameters) = shipped([0.0, 0.0]);
        let mut estimator = ContactEstimator::new(&model, &parameters).unwrap();
        for (dt, a, b, c, d) in inputs {
            let measurement = JointMeasurement { motor_position: [a, b], joint_torque: [c, d] };
            let e = estimator.step(dt, &measurement);
            let numbers = [e.position, e.velocity, e.tip, e.tip_velocity, e.force, e.contact_force];
            prop_assert!(numbers.iter().flatten().all(|x| x.is_finite()));
            prop_assert!(e.normal_force >= 0.0 && e.tangential_force.is_finite() && e.friction.value.is_finite());
        }
    }
}

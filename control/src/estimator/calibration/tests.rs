//! What is found of sensors and contours that are known.

use super::*;
use ferntast_model::contact::ContactParameters;
use ferntast_model::contour::{EdgeParameters, Surface};
use ferntast_model::kinematics::Kinematics;

const UNCERTAINTY: Uncertainty = Uncertainty {
    torque_zero: 0.0,
    torque_gain: 0.03,
    torque_hysteresis: 0.0,
    spring_stiffness: 0.01,
    contour_turn: 0.035,
};
const STIFFNESS: f64 = 4e4;

fn edge(from: [f64; 2], to: [f64; 2]) -> Feature {
    EdgeParameters {
        surface: Surface::Lubricated,
        from,
        to,
        contact: ContactParameters {
            stiffness: STIFFNESS,
            damping: 0.0,
            friction: 0.0,
        },
    }
    .feature()
}

/// Slides to and fro along `believed`, which truly is turned by `turn`, with sensors of these
/// `gains`; friction `friction`, in one direction only where `once`.
fn slide(
    own: &mut SelfCalibration,
    at: usize,
    believed: &Feature,
    (gains, turn, friction): ([f64; 2], f64, f64),
    once: bool,
) {
    let truth = believed.turned(turn);
    let kinematics = Kinematics::new([0.25, 0.25]);
    for k in 0..8000 {
        let phase = f64::from(k) * std::f64::consts::TAU / 2000.0;
        let direction = if once { 1.0 } else { phase.cos().signum() };
        let pushes = 20.0 + (3.0 * phase).sin();
        let along = 0.02 * phase.sin();
        let tip = truth.center + truth.tangent() * along - truth.normal * (pushes / STIFFNESS);
        let force = truth.normal * pushes - truth.tangent() * (direction * friction * pushes);
        let q = kinematics
            .inverse(&tip, ferntast_model::kinematics::Elbow::Positive)
            .unwrap();
        let jacobian = kinematics.jacobian(&q);
        let mut torque = jacobian.tr_mul(&force);
        torque.x *= gains[0];
        torque.y *= gains[1];
        let measured = |torque: &Vector2<f64>| kinematics.tip_force(&q, torque, 0.1).unwrap();
        own.slide(
            at,
            1e3,
            &Push {
                feature: believed,
                tip,
                force: measured(&torque),
                by_ratio: measured(&Vector2::new(-0.5 * torque.x, 0.5 * torque.y)),
                direction,
                dt: 1e-3,
                alike: 0.01,
            },
        );
    }
}

fn edges() -> [Feature; 2] {
    [
        edge([0.38355, -0.050], [0.38355, 0.120]),
        edge([0.23355, -0.030], [0.40355, -0.030]),
    ]
}

#[test]
fn the_ratio_of_gains_and_the_turns_are_found_and_a_common_gain_is_not() {
    for (gains, turn) in [
        ([1.03, 0.97], 0.0),
        ([1.02, 1.03], -0.035),
        ([1.0, 1.0], 0.035),
    ] {
        let mut own = SelfCalibration::new(UNCERTAINTY, 2);
        for (at, (edge, friction)) in edges().iter().zip([0.45, 0.16]).enumerate() {
            slide(&mut own, at, edge, (gains, turn, friction), false);
            let found = own.turn(at).unwrap();
            assert!((found.value - turn).abs() < 1e-3, "{found:?} for {turn}");
            assert!(found.error < 2e-3, "{found:?}");
        }
        let found = own.calibration();
        let ratio = gains[0] - gains[1];
        assert!(
            (found.ratio.value - ratio).abs() < 3e-3,
            "{found:?} for {ratio}"
        );
        assert!(found.ratio.error < 8e-3, "{found:?}");
        assert_eq!(found.common.value, 0.0);
        assert!((found.common.error - 0.03 / 2.0_f64.sqrt()).abs() < 1e-12);
    }
}

/// In one direction friction and gains cannot be told apart; the way tells the turn even so.
#[test]
fn one_direction_tells_the_turn_only() {
    let mut own = SelfCalibration::new(UNCERTAINTY, 2);
    let [edge, _] = edges();
    slide(&mut own, 0, &edge, ([1.03, 0.97], 0.02, 0.45), true);
    assert!((own.turn(0).unwrap().value - 0.02).abs() < 2e-3);
    assert!(
        own.calibration().ratio.error > 0.01,
        "{:?}",
        own.calibration()
    );
}

#[test]
fn where_nothing_is_stated_nothing_is_moved() {
    let mut own = SelfCalibration::new(Uncertainty::default(), 2);
    let [edge, _] = edges();
    slide(&mut own, 0, &edge, ([1.03, 0.97], 0.02, 0.45), false);
    let found = own.calibration();
    let none = Calibrated {
        value: 0.0,
        error: 0.0,
    };
    assert_eq!(
        (found.ratio, found.common, own.turn(0)),
        (none, none, Some(none))
    );
    assert_eq!(own.turn(7), None);
}

#[test]
fn a_spring_of_known_stiffness_tells_the_common_gain() {
    let mut own = SelfCalibration::new(UNCERTAINTY, 1);
    let head = edge([-0.02, 0.0], [0.02, 0.0]);
    for k in 0..2000 {
        let depth = 0.01
            * (f64::from(k) * std::f64::consts::TAU / 1000.0)
                .sin()
                .powi(2);
        own.press(
            1e3,
            &Push {
                feature: &head,
                tip: head.center - head.normal * depth,
                force: head.normal * (1.025 * STIFFNESS * depth),
                by_ratio: Vector2::zeros(),
                direction: 1.0,
                dt: 1e-3,
                alike: 0.01,
            },
        );
    }
    let [first, second] = own.calibration().gains();
    // Drawn to 1 by what is stated of it: 0.01² against 0.03²/2.
    assert!(
        (first.value - 1.0205).abs() < 1e-3 && first.value == second.value,
        "{first:?}"
    );
    assert!(first.error > 0.009 && first.error < 0.03, "{first:?}");
}

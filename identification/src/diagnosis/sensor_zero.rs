//! The torque sensor's own zero: a friction that differs by direction and a
//! sensor with an offset leave the same constant in equation (2), but only one
//! of them shows in the sensor while the joint is free of load.

use nalgebra::DVector;

use super::candidates::Candidate;
use crate::design::PreparedModel;
use crate::effects::ConstantOf;
use crate::numerics::gram::Gram;
use crate::numerics::statistics::mean_error;

/// Smallest offset by the fit, in standard errors of the sensor's zero, that can
/// be compared with it.
const MIN_OFFSET: f64 = 4.0;

/// Reading of the sensor \[Nm\] with the joint at rest and free of load, and its
/// standard error over sessions \[Nm\]; `None` for fewer than two such sessions.
///
/// In each session the reading is fitted by a constant, the link's inertia
/// (q̈) and its damping (q̇).
#[must_use]
pub fn reading(prepared: &PreparedModel) -> Option<(f64, f64)> {
    if prepared.facts.no_torque_sensor().is_some() {
        return None;
    }
    let zeros: Vec<f64> = prepared
        .sessions
        .iter()
        .filter(|signals| signals.unloaded)
        .filter_map(|signals| {
            let column = |of: fn(&crate::effects::Point) -> f64| -> Vec<f64> {
                let rows = signals.all_rows.iter();
                rows.map(|at| of(&signals.points[*at])).collect()
            };
            let ones = vec![1.0; signals.all_rows.len()];
            let (velocity, acceleration) = (column(|p| p.velocity), column(|p| p.acceleration));
            let load = column(|p| p.load);
            let gram = Gram::from_columns(&[&ones, &velocity, &acceleration], &load, 0, ones.len());
            let fitted: DVector<f64> = gram.solve();
            fitted.get(0).copied().filter(|zero| zero.is_finite())
        })
        .collect();
    (zeros.len() >= 2).then(|| mean_error(&zeros))
}

/// Where both are among `passing` and the sensor's zero is known, leaves out the
/// one that contradicts it.
pub fn decide(prepared: &PreparedModel, passing: &mut Vec<Candidate>) {
    let Some((zero, error)) = reading(prepared) else {
        return;
    };
    let constant = |c: &Candidate| c.effect.row().constant;
    let wanted = |of: ConstantOf| {
        let candidate = passing.iter().find(|c| constant(c) == Some(of))?;
        candidate.score.coefficients.first().copied()
    };
    let (Some(offset), Some(_)) = (wanted(ConstantOf::Sensor), wanted(ConstantOf::Friction)) else {
        return;
    };
    // y = τ_m − J q̈ − τ: a reading that is too large leaves a constant below zero.
    let expected = -offset;
    if expected.abs() < MIN_OFFSET * error {
        return;
    }
    let wrong = match (zero - expected).abs() < zero.abs() {
        true => ConstantOf::Friction,
        false => ConstantOf::Sensor,
    };
    passing.retain(|c| constant(c) != Some(wrong));
}

//! The flexible joint of the second paper, off line and on line.
//!
//! Three regressions of two parameters each, which is the model simplified:
//! every side of the gear by itself, the joint torque sensor between them.
//!
//! ```text
//! stiffness   τ_s                    = k_1 Δ   + k_2 Δ³,  Δ = θ − q
//! input       τ_m − J_m θ̈ − τ_s     = b_in θ̇  + b_inD sign θ̇
//! output      τ_s − J_l q̈ − τ_b sign q̇ = b_out q̇ + b_outC sign q̇
//! ```
//!
//! Only the paper's last page is at hand: it names the six parameters and the
//! method, recursive least squares with a variable forgetting factor, and states
//! that the values on line settle at those found off line, with some
//! fluctuation, since they vary with position, the brake fluctuates and the
//! gear is weak in places. The equations are read as above.

mod off_line;
mod on_line;

pub use off_line::{Estimate, off_line};
pub use on_line::{OnLine, Track, on_line};

use crate::numerics::filter::Kernel;
use ferntast_model::friction::sign;

/// Width of the filter on every channel \[s\].
const FILTER: f64 = 0.010;
/// Time between rows of the regressions \[s\].
const ROW_PERIOD: f64 = 0.010;
/// Below this speed a side of the joint is near rest \[rad/s\].
const NEAR_REST: f64 = 0.05;
/// Time by which the rows left out near rest are extended on either side \[s\].
const MARGIN: f64 = 0.05;

/// The six parameters: symbol of the paper, unit.
pub const PARAMETERS: [(&str, &str); 6] = [
    ("k1", "Nm/rad"),
    ("k2", "Nm/rad^3"),
    ("b_in", "Nm s/rad"),
    ("b_inD", "Nm"),
    ("b_out", "Nm s/rad"),
    ("b_outC", "Nm"),
];

/// Recorded channels, all of one length; joint side.
#[derive(Clone, Copy, Debug)]
pub struct FlexibleJointSignals<'a> {
    /// Sampling period \[s\].
    pub period: f64,
    /// θ \[rad\].
    pub motor_position: &'a [f64],
    /// q \[rad\].
    pub position: &'a [f64],
    /// τ_m \[Nm\].
    pub motor_torque: &'a [f64],
    /// τ_s \[Nm\].
    pub joint_torque: &'a [f64],
    /// Commanded torque of the brake, without sign \[Nm\].
    pub brake_torque: &'a [f64],
}

/// Known inertias of the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertias {
    /// J_m \[kg m²\].
    pub motor: f64,
    /// J_l \[kg m²\].
    pub load: f64,
}

/// One row y = φᵀθ of one of the three regressions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time since the start \[s\].
    pub time: f64,
    /// φ.
    pub phi: [f64; 2],
    /// y \[Nm\].
    pub measured: f64,
}

/// Rows of stiffness, input and output, in order of time. One filter without
/// phase on every channel; rows of input and output leave out what is near rest.
#[must_use]
pub fn rows(signals: &FlexibleJointSignals<'_>, inertias: Inertias) -> [Vec<Row>; 3] {
    let sigma = FILTER / signals.period;
    let kernel = |order| Kernel::gaussian(sigma, order, signals.period);
    let (smooth, slope, curvature) = (kernel(0), kernel(1), kernel(2));
    let stride = (ROW_PERIOD / signals.period).round().max(1.0) as usize;
    let reach = Kernel::reach(sigma);
    let length = [
        signals.motor_position,
        signals.position,
        signals.motor_torque,
        signals.joint_torque,
        signals.brake_torque,
    ]
    .iter()
    .map(|channel| channel.len())
    .min()
    .unwrap_or(0);
    let mut rows: [Vec<Row>; 3] = Default::default();
    let margin = (MARGIN / signals.period).round() as usize;
    let slides = |signal: &[f64], at: usize, speed: f64| {
        let before = slope.at(signal, at.saturating_sub(margin));
        let after = slope.at(signal, (at + margin).min(length.saturating_sub(1)));
        [before, speed, after]
            .iter()
            .all(|v| v.abs() > NEAR_REST && sign(*v) == sign(speed))
    };
    for at in (reach..length.saturating_sub(reach)).step_by(stride) {
        let time = at as f64 * signals.period;
        let joint_torque = smooth.at(signals.joint_torque, at);
        let twist = smooth.at(signals.motor_position, at) - smooth.at(signals.position, at);
        rows[0].push(Row {
            time,
            phi: [twist, twist.powi(3)],
            measured: joint_torque,
        });
        let speed = slope.at(signals.motor_position, at);
        if slides(signals.motor_position, at, speed) {
            rows[1].push(Row {
                time,
                phi: [speed, sign(speed)],
                measured: smooth.at(signals.motor_torque, at)
                    - inertias.motor * curvature.at(signals.motor_position, at)
                    - joint_torque,
            });
        }
        let speed = slope.at(signals.position, at);
        if slides(signals.position, at, speed) {
            rows[2].push(Row {
                time,
                phi: [speed, sign(speed)],
                measured: joint_torque
                    - inertias.load * curvature.at(signals.position, at)
                    - smooth.at(signals.brake_torque, at) * sign(speed),
            });
        }
    }
    rows
}

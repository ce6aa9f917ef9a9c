//! What is wrong with a force all the time, and so does not average out: zero and
//! gain of each torque sensor, and the contour's turn.
//!
//! Each is a standard uncertainty times the force's derivative with respect to it;
//! they are independent and add up in squares (GUM, JCGM 100:2008, equation (10)).

use ferntast_model::kinematics::Kinematics;
use ferntast_model::{Vector2, parameters};

parameters! {
    /// How well the parameters behind a force are known: standard uncertainties.
    /// None is taken into account where nothing is said.
    #[derive(Copy)]
    pub struct Uncertainty {
        /// Zero of a torque sensor, before it was zeroed on line \[Nm\].
        pub torque_zero: f64 [0.0..=10.0, "Nm"] = 0.0,
        /// Gain of a torque sensor, as a share of it \[-\].
        pub torque_gain: f64 [0.0..=0.5, "-"] = 0.0,
        /// Half of the width of a torque sensor's loop of hysteresis \[Nm\]; off line only.
        pub torque_hysteresis: f64 [0.0..=10.0, "Nm"] = 0.0,
        /// Stiffness of the contour's springs, as a share of it \[-\]; 0: nothing is known of it.
        pub spring_stiffness: f64 [0.0..=0.5, "-"] = 0.0,
        /// Direction of an edge of the contour \[rad\].
        pub contour_turn: f64 [0.0..=0.5, "rad"] = 0.0,
    }
}

/// How many errors there are: two zeros, two gains, one turn.
pub const ERRORS: usize = 5;

/// Errors of F_N and of F_T \[N\], one standard uncertainty each.
pub type SplitErrors = [[f64; 2]; ERRORS];

/// Errors of the force on the tip \[N\] by the torque sensors: both zeros, both gains.
pub type SensorErrors = [Vector2<f64>; ERRORS - 1];

/// What standard uncertainties `zeros` \[Nm\] of the torque sensors and `gains` of them \[Nm\] make
/// of the force at the posture `q` \[rad\]: J⁻ᵀ of each error alone. The `gains` are two
/// independent errors of the joints' torques, see [`independent_gains`].
pub fn sensor_errors(
    kinematics: &Kinematics,
    q: &Vector2<f64>,
    zeros: &Vector2<f64>,
    gains: &[Vector2<f64>; 2],
    singularity: f64,
) -> SensorErrors {
    let of = |torque: &Vector2<f64>| {
        let force = kinematics.tip_force(q, torque, singularity);
        force.unwrap_or_else(Vector2::zeros)
    };
    [
        of(&Vector2::new(zeros.x, 0.0)),
        of(&Vector2::new(0.0, zeros.y)),
        of(&gains[0]),
        of(&gains[1]),
    ]
}

/// Errors of the joints' torques \[Nm\] by gains that are known to `gain` \[-\], each by itself,
/// where the contact makes `torque` \[Nm\]. Slowly sliding in weightlessness the
/// sensors feel the contact and nothing else, so that its torque stands for theirs.
pub fn independent_gains(torque: &Vector2<f64>, gain: f64) -> [Vector2<f64>; 2] {
    [
        Vector2::new(gain * torque.x, 0.0),
        Vector2::new(0.0, gain * torque.y),
    ]
}

/// The same of F_N and F_T, for a tip that slides in `direction` (±1) along
/// `tangent`; `split` has the force along tangent and normal \[N\]. A contour
/// turned by δ has F_t + δ F_n along its tangent, and F_n − δ F_t along its normal.
pub fn split_errors(
    sensors: &SensorErrors,
    normal: &Vector2<f64>,
    tangent: &Vector2<f64>,
    split: [f64; 2],
    direction: f64,
    turn: f64,
) -> SplitErrors {
    let of = |error: &Vector2<f64>| [error.dot(normal), -direction * error.dot(tangent)];
    let [zero_1, zero_2, gain_1, gain_2] = sensors;
    let turned = [-turn * split[0], -direction * turn * split[1]];
    [of(zero_1), of(zero_2), of(gain_1), of(gain_2), turned]
}

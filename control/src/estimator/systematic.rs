//! What is wrong with a force all the time, and so does not average out: zero and
//! gain of each torque sensor, and the contour's turn.
//!
//! Each is a standard uncertainty times the force's derivative with respect to it;
//! they are independent and add up in squares (GUM, JCGM 100:2008, equation (10)).

use ferntast_model::kinematics::Kinematics;
use ferntast_model::{MAX_JOINTS, Vector2, parameters};

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

/// How many errors there are at most: a zero and a gain of each joint's sensor, one turn.
pub const ERRORS: usize = 2 * MAX_JOINTS + 1;

/// Errors of F_N and of F_T \[N\], one standard uncertainty each.
pub type SplitErrors = [[f64; 2]; ERRORS];

/// Errors of a force on the tip \[N\] by the torque sensors.
#[derive(Clone, Copy, Debug)]
pub struct SensorErrors<V> {
    errors: [V; ERRORS - 1],
    count: usize,
}

impl<V: Copy> SensorErrors<V> {
    /// What standard uncertainties `zeros` \[Nm\] and `gain` \[-\] of the torque sensors
    /// make of the force, where the contact makes `torque` \[Nm\]; `force` is what an error of
    /// one joint's torque alone makes. Slowly sliding in weightlessness the sensors feel the
    /// contact and nothing else, so that its torque stands for theirs.
    pub(super) fn new(
        torque: &[f64],
        zeros: &[f64],
        gain: f64,
        none: V,
        force: impl Fn(usize, f64) -> V,
    ) -> Self {
        let joints = torque.len().min(zeros.len());
        let zeros = (0..joints).map(|joint| force(joint, zeros[joint]));
        let gains = (0..joints).map(|joint| force(joint, gain * torque[joint]));
        Self::of(none, zeros.chain(gains))
    }

    /// Errors that are independent of each other; `none` is no error.
    fn of(none: V, each: impl Iterator<Item = V>) -> Self {
        let mut errors = [none; ERRORS - 1];
        let mut count = 0;
        for (place, error) in errors.iter_mut().zip(each) {
            *place = error;
            count += 1;
        }
        Self { errors, count }
    }

    /// The same of F_N and F_T: what `split` makes of an error of the force. `turned` is what
    /// a surface that is turned adds.
    pub(super) fn split(&self, split: impl Fn(&V) -> [f64; 2], turned: [f64; 2]) -> SplitErrors {
        let mut errors = [[0.0; 2]; ERRORS];
        let each = self.errors.iter().take(self.count).map(split);
        for (place, error) in errors.iter_mut().zip(each.chain([turned])) {
            *place = error;
        }
        errors
    }
}

/// What standard uncertainties `zeros` \[Nm\] of the torque sensors of a planar arm and `gains` of
/// them \[Nm\] make of the force at the posture `q` \[rad\]: J⁻ᵀ of each error alone. The `gains`
/// are two independent errors of the joints' torques, see [`independent_gains`].
pub fn sensor_errors(
    kinematics: &Kinematics,
    q: &Vector2<f64>,
    zeros: &Vector2<f64>,
    gains: &[Vector2<f64>; 2],
    singularity: f64,
) -> SensorErrors<Vector2<f64>> {
    let torques = [
        Vector2::new(zeros.x, 0.0),
        Vector2::new(0.0, zeros.y),
        gains[0],
        gains[1],
    ];
    let forces = torques.iter().map(|torque| {
        let force = kinematics.tip_force(q, torque, singularity);
        force.unwrap_or_else(Vector2::zeros)
    });
    SensorErrors::of(Vector2::zeros(), forces)
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
    sensors: &SensorErrors<Vector2<f64>>,
    normal: &Vector2<f64>,
    tangent: &Vector2<f64>,
    split: [f64; 2],
    direction: f64,
    turn: f64,
) -> SplitErrors {
    let of = |error: &Vector2<f64>| [error.dot(normal), -direction * error.dot(tangent)];
    let turned = [-turn * split[0], -direction * turn * split[1]];
    sensors.split(of, turned)
}

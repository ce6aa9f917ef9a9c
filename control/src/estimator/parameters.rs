//! Parameters of the contact-force estimator.

use super::{Form, MotorCurrentParameters, Uncertainty};
use ferntast_model::parameters;

parameters! {
    /// Tuning of the contact-force estimator: section `[estimator]`.
    #[derive(Copy)]
    pub struct EstimatorParameters {
        /// How the contact's torque is found.
        #[serde(default)]
        pub form: Form,
        /// Cut-off of the filter on all channels \[Hz\]; its delay is 1/(π cut_off).
        pub cut_off: f64 [0.5..=400.0, "Hz"],
        /// Normal force from which on there is contact \[N\].
        pub contact_on: f64 [1e-3..=1e4, "N"],
        /// Normal force below which contact ends \[N\].
        pub contact_off: f64 [0.0..=*contact_on, "N"],
        /// How near a surface the tip must be to be in contact \[m\].
        pub contact_distance: f64 [1e-5..=1.0, "m"],
        /// Sliding slower than this counts as rest \[m/s\].
        pub rest_speed: f64 [1e-6..=1.0, "m/s"],
        /// After a turn or a rest, sliding less than this still counts as rest
        /// \[m\]: surfaces and arm bend before the tip slides.
        pub rest_travel: f64 [0.0..=1.0, "m"],
        /// Least |sin q₂| at which forces are told \[-\].
        pub singularity: f64 [1e-3..=0.99, "-"],
        /// Memory of the coefficient of equation (6) \[s of sliding\].
        pub friction_memory: f64 [0.01..=1e5, "s"],
        /// Longest time between measurements; after a longer one it starts over \[s\].
        pub longest_gap: f64 [1e-3..=10.0, "s"],
        /// Memory of the torque sensors' zeros, which are found while the tip is free
        /// \[s of that\]; 0 takes the sensors as they are. By motor currents there is none:
        /// friction that is not known is no zero.
        #[serde(default)]
        pub zeroing_time: f64 [0.0..=1e4, "s"],
        /// Memory of the torque sensors' gains and the contour's turn, which are found while the
        /// tip slides \[s of that\], within what `uncertainty` states of them; 0 takes both as they
        /// are. By motor currents there is none.
        #[serde(default)]
        pub calibration_time: f64 [0.0..=1e5, "s"],
        /// What the standard error of the coefficient has to take into account.
        #[serde(default)]
        pub uncertainty: Uncertainty [section],
        /// How joint torques are found from motor currents, where the form asks for it.
        #[serde(default)]
        pub motor_current: MotorCurrentParameters [section],
    }
}

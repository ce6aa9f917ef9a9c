//! What can be tuned about the haptic master.

use ferntast_model::parameters;

parameters! {
    /// Tuning of the haptic master. Every key may be left out.
    pub struct MasterConfig {
        /// The hand is refused beyond ± this, x, y, z, leader base frame \[m\].
        pub workspace: [f64; 3] [0.001..=10.0, "m"] = [0.12, 0.12, 0.12],
        /// Speed from one pose to the next that counts as a jump \[m/s\]. Recorded
        /// bursts of real hands reach 3 m/s.
        pub jump_speed: f64 [0.01..=100.0, "m/s"] = 4.0,
        /// Step between poses that is never a jump, however short the time \[m\].
        pub jump_slack: f64 [0.0..=0.1, "m"] = 0.005,
        /// Oldest pose that is acted on, by its stamp \[s\].
        pub hand_age: f64 [0.002..=10.0, "s"] = 0.1,
        /// Silence after which the hand is not passed on and gets no force \[s\].
        pub silence: f64 [0.002..=0.030, "s"] = 0.025,
        /// Silence after which its source loses the authority \[s\].
        pub release_after: f64 [*silence..=60.0, "s"] = 1.0,
        /// Largest force on the hand, magnitude \[N\].
        pub force_limit: f64 [0.0..=100.0, "N"] = 10.0,
        /// Largest change of the force \[N/s\].
        pub force_rate_limit: f64 [1.0..=1e6, "N/s"] = 1000.0,
        /// Time constant of the hand's velocity \[s\].
        pub velocity_filter: f64 [1e-4..=1.0, "s"] = 0.01,
    }
}

//! What can be tuned about the two layers.

use super::inside::InnerLaw;
use crate::delay::mapping::law_parameters;

law_parameters! {
    /// Parameters of the law. Every key may be left out. The inner law has the scales that are
    /// given here.
    pub struct TwoLayer {
        /// The layer of transparency.
        pub inside: InnerLaw [section] = InnerLaw::default(),
        /// Share of what comes in through the hand, beyond what came in there before, that the
        /// hand's end gives to the tip's at once \[-\]. The tip's end gives all of what comes in.
        pub promised_share: f64 [0.0..=1.0, "-"] = 0.6,
        /// Time constant with which the tip's end gives what it does not need to the hand's \[s\].
        pub transfer_time: f64 [0.01..=100.0, "s"] = 0.05,
        /// Time constant with which the hand's end gives what it does not need to the tip's, of
        /// which comes back what that does not need either \[s\].
        pub refill_time: f64 [0.01..=1000.0, "s"] = 5.0,
        /// Energy that the hand's end needs for itself \[J\].
        pub kept_at_hand: f64 [0.0..=100.0, "J"] = 0.02,
        /// Energy that the tip's end needs for itself, at the hand's scale \[J\].
        pub kept_at_tip: f64 [0.0..=100.0, "J"] = 0.005,
        /// Energy with which the tip's end begins, at the hand's scale: it lets the arm set out
        /// before the hand has paid for that \[J\].
        pub credit: f64 [0.0..=1.0, "J"] = 0.006,
        /// Energy that an end may hold, at the hand's scale; what is beyond counts as
        /// dissipated \[J\].
        pub reserve: f64 [0.0..=1000.0, "J"] = 0.4,
        /// Below this energy the hand is damped \[J\].
        pub level: f64 [0.0..=100.0, "J"] = 0.3,
        /// Largest damping at a hand in contact that fills the tank \[N·s/m\].
        pub largest_damping: f64 [0.0..=1000.0, "N·s/m"] = 4.0,
        /// The same where there is nothing to touch \[N·s/m\].
        pub largest_free_damping: f64 [0.0..=1000.0, "N·s/m"] = 14.0,
        /// Largest change of the force on the hand \[N/s\].
        pub force_rate: f64 [1.0..=1e6, "N/s"] = 490.0,
        /// m_h: lightest mass of hand and handle \[kg\].
        pub hand_mass: f64 [0.01..=20.0, "kg"] = 0.2,
        /// m: mass of arm and motors at the tip \[kg\].
        pub tip_mass: f64 [0.01..=1000.0, "kg"] = 4.0,
        /// Speed that the tip's command may always have, at the hand's scale \[m/s\].
        pub least_speed: f64 [0.0..=1.0, "m/s"] = 0.01,
        /// Largest speed at which the tip gives way, at the hand's scale \[m/s\].
        pub yield_speed: f64 [0.001..=10.0, "m/s"] = 0.2,
        /// Largest lead of the command over the tip, at the tip \[m\].
        pub largest_lead: f64 [1e-4..=1.0, "m"] = 0.003,
        /// How late the contact's force is beside the tip, by the filters and the threshold of
        /// its estimate \[s\].
        pub force_lag: f64 [0.0..=0.1, "s"] = 0.016,
        /// k: stiffness of the arm's servo at the tip; a session takes the arm's own
        /// where that is larger \[N/m\].
        pub servo_stiffness: f64 [1.0..=1000000.0, "N/m"] = 7000.0,
    }
}

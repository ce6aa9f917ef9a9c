//! What can be tuned about the haptic master.

use ferntast_model::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Tuning of the haptic master. Every key may be left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MasterConfig {
    /// The hand is refused beyond ± this, x, y, z, leader base frame \[m\].
    pub workspace: [f64; 3],
    /// Speed from one pose to the next that counts as a jump \[m/s\]. Recorded
    /// bursts of real hands reach 3 m/s.
    pub jump_speed: f64,
    /// Step between poses that is never a jump, however short the time \[m\].
    pub jump_slack: f64,
    /// Oldest pose that is acted on, by its stamp \[s\].
    pub hand_age: f64,
    /// Silence after which the hand is not passed on and gets no force \[s\].
    pub silence: f64,
    /// Silence after which its source loses the authority \[s\].
    pub release_after: f64,
    /// Largest force on the hand, magnitude \[N\].
    pub force_limit: f64,
    /// Largest change of the force \[N/s\].
    pub force_rate_limit: f64,
    /// Time constant of the hand's velocity \[s\].
    pub velocity_filter: f64,
}

impl Default for MasterConfig {
    fn default() -> Self {
        MasterConfig {
            workspace: [0.12, 0.12, 0.12],
            jump_speed: 4.0,
            jump_slack: 0.005,
            hand_age: 0.1,
            silence: 0.025,
            release_after: 1.0,
            force_limit: 10.0,
            force_rate_limit: 1000.0,
            velocity_filter: 0.01,
        }
    }
}

impl MasterConfig {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        for (axis, value) in self.workspace.iter().enumerate() {
            check(&format!("workspace[{axis}]"), *value, 0.001, 10.0, "m")?;
        }
        check("jump_speed", self.jump_speed, 0.01, 100.0, "m/s")?;
        check("jump_slack", self.jump_slack, 0.0, 0.1, "m")?;
        check("hand_age", self.hand_age, 0.002, 10.0, "s")?;
        check("silence", self.silence, 0.002, 0.030, "s")?;
        check("release_after", self.release_after, self.silence, 60.0, "s")?;
        check("force_limit", self.force_limit, 0.0, 100.0, "N")?;
        check("force_rate_limit", self.force_rate_limit, 1.0, 1e6, "N/s")?;
        check("velocity_filter", self.velocity_filter, 1e-4, 1.0, "s")
    }
}

//! Parameters of the contact-force estimator.

use super::Form;
use ferntast_model::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Tuning of the contact-force estimator: section `[estimator]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EstimatorParameters {
    /// How the contact's torque is found.
    #[serde(default)]
    pub form: Form,
    /// Cut-off of the filter on all channels \[Hz\]; its delay is 1/(π cut_off).
    pub cut_off: f64,
    /// Normal force from which on there is contact \[N\].
    pub contact_on: f64,
    /// Normal force below which contact ends \[N\].
    pub contact_off: f64,
    /// How near a surface the tip must be to be in contact \[m\].
    pub contact_distance: f64,
    /// Sliding slower than this counts as rest \[m/s\].
    pub rest_speed: f64,
    /// After a turn or a rest, sliding less than this still counts as rest
    /// \[m\]: surfaces and arm bend before the tip slides.
    pub rest_travel: f64,
    /// Least |sin q₂| at which forces are told \[-\].
    pub singularity: f64,
    /// Memory of the coefficient of equation (6) \[s of sliding\].
    pub friction_memory: f64,
    /// Longest time between measurements; after a longer one it starts anew \[s\].
    pub longest_gap: f64,
}

impl EstimatorParameters {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("cut_off", self.cut_off, 0.5, 400.0, "Hz")?;
        check("contact_on", self.contact_on, 1e-3, 1e4, "N")?;
        check("contact_off", self.contact_off, 0.0, self.contact_on, "N")?;
        check("contact_distance", self.contact_distance, 1e-5, 1.0, "m")?;
        check("rest_speed", self.rest_speed, 1e-6, 1.0, "m/s")?;
        check("rest_travel", self.rest_travel, 0.0, 1.0, "m")?;
        check("singularity", self.singularity, 1e-3, 0.99, "-")?;
        check("friction_memory", self.friction_memory, 0.01, 1e5, "s")?;
        check("longest_gap", self.longest_gap, 1e-3, 10.0, "s")
    }
}

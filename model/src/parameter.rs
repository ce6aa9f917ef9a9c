//! Bounds of parameters, and the error when one is not within.

/// What is wrong with a parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// The value is outside its bounds, or not a finite number.
    #[error(
        "{key} = {value}{unit} is outside {lower} … {upper}{unit}; set it within these bounds", unit = behind(unit)
    )]
    OutOfBounds {
        /// Path of the key in the configuration.
        key: String,
        /// The value found.
        value: f64,
        /// Smallest value allowed.
        lower: f64,
        /// Largest value allowed.
        upper: f64,
        /// Unit of all three.
        unit: &'static str,
    },
    /// Values that are each within their bounds do not fit together.
    #[error("{key}: {reason}")]
    Inconsistent {
        /// Path of the key in the configuration.
        key: String,
        /// What does not fit, with the values, and how to correct it.
        reason: String,
    },
    /// A name that nothing goes by.
    #[error("{key} is not known; known here: {known}")]
    Unknown {
        /// Path of the key in the configuration.
        key: String,
        /// The names that would be.
        known: String,
    },
    /// A parameter was not given.
    #[error("{key} [{unit}] is missing; add it")]
    Missing {
        /// Path of the key in the configuration.
        key: String,
        /// Unit of the parameter.
        unit: &'static str,
    },
    /// A list is of the wrong length.
    #[error("{key} has {found} entries where {wanted} are needed: one for each {each}")]
    WrongCount {
        /// Path of the key in the configuration.
        key: String,
        /// Entries found.
        found: usize,
        /// Entries needed.
        wanted: usize,
        /// What there has to be one for each of.
        each: &'static str,
    },
}

/// A unit as it stands behind a number: nothing where there is none.
fn behind(unit: &str) -> String {
    match unit {
        "-" => String::new(),
        unit => format!(" {unit}"),
    }
}

impl ParameterError {
    /// The same error with `section` put before the key.
    #[must_use]
    pub fn within(mut self, section: &str) -> Self {
        let (Self::OutOfBounds { key, .. }
        | Self::Inconsistent { key, .. }
        | Self::Unknown { key, .. }
        | Self::Missing { key, .. }
        | Self::WrongCount { key, .. }) = &mut self;
        *key = format!("{section}.{key}");
        self
    }

    /// Path of the key that is wrong.
    pub fn key(&self) -> &str {
        match self {
            Self::OutOfBounds { key, .. }
            | Self::Inconsistent { key, .. }
            | Self::Unknown { key, .. }
            | Self::Missing { key, .. }
            | Self::WrongCount { key, .. } => key,
        }
    }
}

/// Checks that `value` is finite and within `lower` … `upper`.
///
/// # Errors
///
/// [`ParameterError::OutOfBounds`] naming `key`, value, bounds and `unit`.
pub fn check(
    key: &str,
    value: f64,
    lower: f64,
    upper: f64,
    unit: &'static str,
) -> Result<(), ParameterError> {
    if value.is_finite() && value >= lower && value <= upper {
        return Ok(());
    }
    Err(ParameterError::OutOfBounds {
        key: key.to_owned(),
        value,
        lower,
        upper,
        unit,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_key_value_bounds_and_unit() {
        let error = check("stiffness", -3.0, 1.0, 1e6, "Nm/rad")
            .unwrap_err()
            .within("joint[1]");
        assert_eq!(
            error.to_string(),
            "joint[1].stiffness = -3 Nm/rad is outside 1 … 1000000 Nm/rad; \
             set it within these bounds"
        );
        assert_eq!(error.key(), "joint[1].stiffness");
    }

    #[test]
    fn what_is_not_finite_is_out_of_bounds() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(check("x", value, f64::NEG_INFINITY, f64::INFINITY, "-").is_err());
        }
        let bare = check("domain_id", 300.0, 0.0, 232.0, "-").unwrap_err();
        assert!(
            bare.to_string()
                .starts_with("domain_id = 300 is outside 0 … 232;"),
            "{bare}"
        );
        assert!(check("x", 1.0, 1.0, 1.0, "-").is_ok());
    }
}

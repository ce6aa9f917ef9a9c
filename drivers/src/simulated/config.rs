//! The simulated arm's file: what is believed of it, and what is true.

use ferntast_config::{ARM, ArmFile, ConfigError, load, serial::load_serial};
use ferntast_sim::arm::ArmConfig;

/// Loads the arm `name`, shipped or a file.
///
/// # Errors
///
/// What is wrong, in which file, and how to correct it.
pub fn load_config(name: &str) -> Result<ArmConfig, ConfigError> {
    load(ARM, name, ArmConfig::validate)
}

/// The same, as the nodes have it.
///
/// # Errors
///
/// As [`load_config`].
pub fn load_arm(name: &str) -> Result<ArmFile, ConfigError> {
    match load_serial(name)? {
        Some(serial) => Ok(serial),
        None => arm_file(&load_config(name)?),
    }
}

/// An arm as the nodes have it.
///
/// # Errors
///
/// A number that JSON cannot hold.
pub fn arm_file(config: &ArmConfig) -> Result<ArmFile, ConfigError> {
    ArmFile::new(config.model(), config.estimator, config)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_keep_all_of_the_file() {
        let config = load_config("rokviss").unwrap();
        let file = load_arm("rokviss").unwrap();
        assert_eq!(file.model.planar(), Some(&config.model()));
        assert_eq!(file.whole::<ArmConfig>().unwrap(), config);
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::to_string(&file).unwrap(), text);
    }
}

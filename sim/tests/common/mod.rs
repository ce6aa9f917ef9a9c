//! What the tests of the simulated arm share.

use ferntast_sim::arm::ArmConfig;

/// One tick \[s\].
pub const TICK: f64 = 1e-3;

/// The arm that is shipped.
pub fn rokviss() -> ArmConfig {
    toml::from_str(include_str!("../../../config/arms/rokviss.toml")).expect("config/arms")
}

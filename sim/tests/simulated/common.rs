//! What the tests of the simulated arm share.

use ferntast_control::servo::ServoConfig;
use ferntast_sim::arm::ArmConfig;
use ferntast_sim::teleoperation::ArmUnderTrial;

/// One tick \[s\].
pub const TICK: f64 = 1e-3;

/// The arm that is shipped.
pub fn rokviss() -> ArmConfig {
    toml::from_str(include_str!("../../../config/arms/rokviss.toml")).expect("config/arms")
}

/// The same with its servo, for trials.
pub fn under_trial() -> ArmUnderTrial {
    ArmUnderTrial {
        arm: rokviss(),
        servo: ServoConfig::default(),
    }
}

/// The same, whose servo stands where it runs into something, as in the sweep that ships.
pub fn stopping() -> ArmUnderTrial {
    let mut own = under_trial();
    own.servo.contact_stop.torque = 0.55;
    own
}

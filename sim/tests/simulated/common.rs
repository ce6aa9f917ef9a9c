//! What the tests of the simulated arm share.

use ferntast_control::delay::Law;
use ferntast_control::servo::{self, ServoConfig};
use ferntast_emulation::channel::{ChannelConfig, LinkConfig};
use ferntast_sim::arm::ArmConfig;
use ferntast_sim::teleoperation::ArmUnderTrial;

/// One tick \[s\].
pub const TICK: f64 = 1e-3;
/// One tick \[ns\].
pub const TICK_NS: i64 = 1_000_000;

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

/// How stiff its servo is at most \[N/m\].
pub fn stiffest(arm: &ArmUnderTrial) -> f64 {
    servo::stiffest(&arm.arm.model(), &arm.servo).expect("a stiffness")
}

/// The law of that name, with further `keys`, as a configuration would set it.
pub fn configured(name: &str, force_scale: f64, keys: &str) -> Law {
    let text = format!("kind = \"{name}\"\nforce_scale = {force_scale}\n{keys}");
    let law: Law = toml::from_str(&text).expect("keys of the law");
    assert_eq!(law.validate(), Ok(()));
    law
}

/// A link with a constant delay, by its round trip \[s\].
pub fn constant(round_trip: f64) -> LinkConfig {
    LinkConfig {
        up: ChannelConfig::with_delay(0.5 * round_trip),
        down: ChannelConfig::with_delay(0.5 * round_trip),
        ..LinkConfig::default()
    }
}

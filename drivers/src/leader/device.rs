//! What the leader arm is.

use super::held::HeldArm;
use crate::driver::Driver;

/// An arm behind a driver that a person moves, or a simulated one with a simulated hand.
pub enum Device {
    /// Somebody or something else moves it.
    Driven(Box<dyn Driver>),
    /// A scripted hand does.
    Held(Box<HeldArm>),
}

impl Device {
    pub(super) fn driver(&mut self) -> &mut dyn Driver {
        match self {
            Device::Driven(driver) => driver.as_mut(),
            Device::Held(held) => held.as_mut(),
        }
    }

    pub(super) fn gives_torque(&self) -> bool {
        match self {
            Device::Driven(driver) => driver.gives_torque(),
            Device::Held(held) => held.gives_torque(),
        }
    }

    pub(super) fn failure(&self) -> Option<String> {
        match self {
            Device::Driven(driver) => driver.failure(),
            Device::Held(held) => held.failure(),
        }
    }

    /// The scripted hand's time passes only while the master is enabled, as that of a script
    /// without a leader arm does.
    pub(super) fn set_running(&mut self, running: bool) {
        if let Device::Held(held) = self {
            held.set_running(running);
        }
    }
}

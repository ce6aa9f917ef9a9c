//! What a truth can hide, one effect a file.
//!
//! Nothing here is shared with the models that the lab fits: an effect that is
//! wrong in one place must not be wrong in the same way in the other.
//!
//! To add one: a file beside these with a `draw` function that turns seed and
//! strength into parameters, a variant in [`super::HiddenEffect`], and a line
//! in [`draw`]. What it changes in the joint itself has to be known in
//! `without_hidden.rs`, whose test runs over all of them.

mod asymmetric_coulomb;
mod backlash;
mod cable_spring;
mod channel_delay;
mod current_saturation;
mod elasticity;
mod equation_4;
mod gravity;
mod inertia;
mod local_friction;
mod motor_constant;
mod presliding_hysteresis;
mod ripple;
mod stribeck;
mod temperature_coulomb;
mod temperature_viscous;
mod torque_sensor_gain;
mod torque_sensor_offset;
mod unknown_acceleration;
mod unknown_oscillation;
mod unknown_position_step;
mod unknown_temperature_position;
mod unknown_torque_rate;
mod unknown_velocity_load;
mod unknown_work_heating;
mod wear_drift;

use ferntast_emulation::random::Random;

use super::HiddenEffect;
use super::parameters::JointParameters;
use crate::bench::{about, either_sign};

/// The joint where friction acts, at one instant, joint side.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// Since the session's start \[s\].
    pub(super) time: f64,
    /// Since the first session's start \[days\].
    pub(super) date: f64,
    /// \[degC\]
    pub(super) temperature: f64,
    /// q \[rad\].
    pub(super) position: f64,
    /// q̇ \[rad/s\].
    pub(super) velocity: f64,
    /// q̈ \[rad/s²\], smoothed over 5 ms.
    pub(super) acceleration: f64,
    /// Bend of the bristles, −1 … 1; ±1 is sliding in that direction.
    pub(super) bristle: f64,
    /// τ \[Nm\].
    pub(super) load: f64,
    /// τ̇ \[Nm/s\], smoothed over 20 ms.
    pub(super) load_rate: f64,
}

/// Friction torque τ_F = `level` · bristle + `torque` \[Nm\].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Friction {
    /// What bristles carry when they are fully bent \[Nm\].
    pub(super) level: f64,
    /// The rest \[Nm\].
    pub(super) torque: f64,
}

/// What sensors say before noise.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reading {
    /// \[rad\]
    pub(super) position: f64,
    /// τ_m \[Nm\].
    pub(super) motor_torque: f64,
    /// τ \[Nm\].
    pub(super) joint_torque: f64,
}

/// A hidden effect with its parameters.
pub(super) trait Effect: Send + Sync {
    /// Parameters: name, value, unit.
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)>;

    /// Changes the joint itself, before anything moves.
    fn prepare(&self, _joint: &mut JointParameters) {}

    /// Adds its friction at `state`.
    fn friction(&self, _state: &State, _friction: &mut Friction) {}

    /// What the motor can really give when `command` \[Nm\] is asked for.
    fn motor_torque(&self, command: f64) -> f64 {
        command
    }

    /// Forgets what it remembers: a new session begins.
    fn reset(&mut self) {}

    /// Follows the joint through a millisecond in which friction did `work` \[J\].
    fn tick(&mut self, _work: f64) {}

    /// Changes what sensors say; called once a millisecond.
    fn read(&mut self, _command: f64, _reading: &mut Reading) {}

    /// A copy with its memory.
    fn boxed(&self) -> Box<dyn Effect>;
}

/// Draws the parameters of `effect` for `joint` at `strength` (1: full).
pub(super) fn draw(
    effect: HiddenEffect,
    joint: &JointParameters,
    strength: f64,
    random: &mut Random,
) -> Box<dyn Effect> {
    use HiddenEffect as Hidden;
    match effect {
        Hidden::Coulomb
        | Hidden::LoadCoulomb
        | Hidden::Viscous
        | Hidden::QuadraticViscous
        | Hidden::CubicViscous
        | Hidden::NonlinearViscous => equation_4::draw(effect, strength, joint),
        Hidden::Stribeck => stribeck::draw(strength, random),
        Hidden::AsymmetricCoulomb => asymmetric_coulomb::draw(strength, random),
        Hidden::TemperatureCoulomb => temperature_coulomb::draw(strength, random),
        Hidden::TemperatureViscous => temperature_viscous::draw(strength, random),
        Hidden::WearDrift => wear_drift::draw(strength, random),
        Hidden::Ripple => ripple::draw(strength, joint.gear_ratio, random),
        Hidden::PreslidingHysteresis => presliding_hysteresis::draw(strength, random),
        Hidden::LocalFriction => local_friction::draw(strength, random),
        Hidden::Inertia => inertia::draw(strength, random),
        Hidden::Gravity => gravity::draw(strength, random),
        Hidden::CableSpring => cable_spring::draw(strength, random),
        Hidden::Elasticity => elasticity::draw(strength, random),
        Hidden::Backlash => backlash::draw(strength, random),
        Hidden::MotorConstant => motor_constant::draw(strength, random),
        Hidden::TorqueSensorGain => torque_sensor_gain::draw(strength, random),
        Hidden::TorqueSensorOffset => torque_sensor_offset::draw(strength, random),
        Hidden::ChannelDelay => channel_delay::draw(strength, random),
        Hidden::CurrentSaturation => current_saturation::draw(strength, joint, random),
        Hidden::UnknownTemperaturePosition => unknown_temperature_position::draw(strength, random),
        Hidden::UnknownTorqueRate => unknown_torque_rate::draw(strength, random),
        Hidden::UnknownAcceleration => unknown_acceleration::draw(strength, random),
        Hidden::UnknownVelocityLoad => unknown_velocity_load::draw(strength, random),
        Hidden::UnknownPositionStep => unknown_position_step::draw(strength, random),
        Hidden::UnknownOscillation => unknown_oscillation::draw(strength, random),
        Hidden::UnknownWorkHeating => unknown_work_heating::draw(strength, random),
    }
}

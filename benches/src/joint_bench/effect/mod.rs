//! What a truth can hide, one effect a file.
//!
//! Nothing here is shared with the models that the lab fits: an effect that is
//! wrong in one place must not be wrong in the same way in the other.
//!
//! To add one: a file beside these with a `draw` function that turns seed and
//! strength into parameters and a test of its signature, and its lines here: the
//! module, and the variant with its draw. What it changes in the joint itself has to be known in
//! `without_hidden.rs`, whose test runs over all of them.

mod asymmetric_coulomb;
mod asymmetric_viscous;
mod backlash;
mod cable_spring;
mod channel;
mod channel_delay;
mod clock_drift;
pub(super) mod cold_start;
mod current_saturation;
mod elasticity;
mod equation_4;
mod gravity;
mod inertia;
mod load_ripple;
mod load_stribeck;
mod local_friction;
mod motor_constant;
mod presliding_hysteresis;
mod ripple;
mod stribeck;
mod temperature_coulomb;
mod temperature_viscous;
mod torque_sensor_calibration;
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

use super::parameters::JointParameters;
use crate::bench::{about, either_sign, named};

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

/// Makes the enum of what can be hidden, and `draw`: a line an effect, with how it is
/// drawn for a joint at a strength (1: full).
macro_rules! truths {
    ($joint:ident, $strength:ident, $random:ident;
     $(#[$doc:meta])* pub enum $name:ident or $unknown:ident {
        $($(#[$each:meta])* $variant:ident = $id:literal => $drawn:expr,)*
    }) => {
        named! {
            $(#[$doc])*
            pub enum $name or $unknown {
                $($(#[$each])* $variant = $id,)*
            }
        }

        /// Draws the parameters of `effect`.
        pub(super) fn draw(
            effect: $name,
            $joint: &JointParameters,
            $strength: f64,
            $random: &mut Random,
        ) -> Box<dyn Effect> {
            match effect {
                $($name::$variant => $drawn,)*
            }
        }
    };
}

truths! {
    joint, strength, random;
    /// An effect that is in the truth of a joint's recording and not in the
    /// model that the experimenter believes in.
    ///
    /// Those whose id begins with `unknown_` are in no catalogue, the others are
    /// the lab's effects of a joint. A new one goes last: the blind test
    /// counts seeds in this order.
    pub enum HiddenEffect or UnknownEffect {
        /// b_0 sign(q̇).
        Coulomb = "coulomb" => equation_4::draw(HiddenEffect::Coulomb, strength, joint),
        /// b_0T |τ| sign(q̇).
        LoadCoulomb = "load_coulomb" => equation_4::draw(HiddenEffect::LoadCoulomb, strength, joint),
        /// b_1 q̇.
        Viscous = "viscous" => equation_4::draw(HiddenEffect::Viscous, strength, joint),
        /// b_2 q̇|q̇|.
        QuadraticViscous = "quadratic_viscous" => equation_4::draw(HiddenEffect::QuadraticViscous, strength, joint),
        /// b_3 q̇³.
        CubicViscous = "cubic_viscous" => equation_4::draw(HiddenEffect::CubicViscous, strength, joint),
        /// b_2 q̇|q̇| + b_3 q̇³: the step from equation (3) to (4).
        NonlinearViscous = "nonlinear_viscous" => equation_4::draw(HiddenEffect::NonlinearViscous, strength, joint),
        /// More Coulomb friction near rest.
        Stribeck = "stribeck" => stribeck::draw(strength, random),
        /// Coulomb friction that differs by direction.
        AsymmetricCoulomb = "asymmetric_coulomb" => asymmetric_coulomb::draw(strength, random),
        /// Coulomb friction that changes with temperature.
        TemperatureCoulomb = "temperature_coulomb" => temperature_coulomb::draw(strength, random),
        /// Viscous friction that changes with temperature.
        TemperatureViscous = "temperature_viscous" => temperature_viscous::draw(strength, random),
        /// Coulomb friction that grows with the days.
        WearDrift = "wear_drift" => wear_drift::draw(strength, random),
        /// Torque periodic in the wave generator's turn.
        Ripple = "ripple" => ripple::draw(strength, joint.gear_ratio, random),
        /// Bristles that bend before the joint slides.
        PreslidingHysteresis = "presliding_hysteresis" => presliding_hysteresis::draw(strength, random),
        /// More Coulomb friction at one position.
        LocalFriction = "local_friction" => local_friction::draw(strength, random),
        /// Inertia that the believed model does not have.
        Inertia = "inertia" => inertia::draw(strength, random),
        /// Weight that the torque sensor does not feel.
        Gravity = "gravity" => gravity::draw(strength, random),
        /// A cable along the joint that pulls back.
        CableSpring = "cable_spring" => cable_spring::draw(strength, random),
        /// Compliance between motor and the measured position.
        Elasticity = "elasticity" => elasticity::draw(strength, random),
        /// Dead zone between motor and gear.
        Backlash = "backlash" => backlash::draw(strength, random),
        /// Wrong motor constant.
        MotorConstant = "motor_constant" => motor_constant::draw(strength, random),
        /// Wrong gain of the torque sensor.
        TorqueSensorGain = "torque_sensor_gain" => torque_sensor_gain::draw(strength, random),
        /// Wrong zero of the torque sensor.
        TorqueSensorOffset = "torque_sensor_offset" => torque_sensor_offset::draw(strength, random),
        /// One channel stamped late.
        ChannelDelay = "channel_delay" => channel_delay::draw(strength, random),
        /// Motor torque clipped.
        CurrentSaturation = "current_saturation" => current_saturation::draw(strength, joint, random),
        /// Outside the catalogue: a pull that turns with temperature and position.
        UnknownTemperaturePosition = "unknown_temperature_position" => unknown_temperature_position::draw(strength, random),
        /// Outside the catalogue: friction that differs while load builds up or falls.
        UnknownTorqueRate = "unknown_torque_rate" => unknown_torque_rate::draw(strength, random),
        /// Outside the catalogue: friction that grows while the speed changes.
        UnknownAcceleration = "unknown_acceleration" => unknown_acceleration::draw(strength, random),
        /// Outside the catalogue: viscous friction that grows with the square of the load.
        UnknownVelocityLoad = "unknown_velocity_load" => unknown_velocity_load::draw(strength, random),
        /// Outside the catalogue: a step of torque at one position, whatever the direction.
        UnknownPositionStep = "unknown_position_step" => unknown_position_step::draw(strength, random),
        /// Outside the catalogue: a slow oscillation in time, as from a supply.
        UnknownOscillation = "unknown_oscillation" => unknown_oscillation::draw(strength, random),
        /// Outside the catalogue: friction that falls as the joint's own work warms it.
        UnknownWorkHeating = "unknown_work_heating" => unknown_work_heating::draw(strength, random),
        /// Viscous friction that differs by direction.
        AsymmetricViscous = "asymmetric_viscous" => asymmetric_viscous::draw(strength, random),
        /// More Coulomb friction near rest, by load.
        LoadStribeck = "load_stribeck" => load_stribeck::draw(strength, random),
        /// Wrong gain and zero of the torque sensor at once.
        TorqueSensorCalibration = "torque_sensor_calibration" => torque_sensor_calibration::draw(strength, random),
        /// A gain that is periodic in the wave generator's turn.
        LoadRipple = "load_ripple" => load_ripple::draw(strength, joint.gear_ratio, random),
        /// One channel by a clock that runs fast.
        ClockDrift = "clock_drift" => clock_drift::draw(strength, random),
    }
}

//! What a truth can hide, one effect a file.
//!
//! Nothing here is shared with the models that the lab fits: an effect that is
//! wrong in one place must not be wrong in the same way in the other.
//!
//! To add one: a file beside these with a `draw` function that turns seed and
//! strength into parameters, a variant in [`super::HiddenEffect`], and a line
//! in [`draw`].

mod contact_compliance;
mod contact_spot;
mod contact_stribeck;
mod contact_wear;
mod equation_6;
mod unknown_adhesion;
mod unknown_direction;
mod unknown_hertz;
mod unknown_speed_force;
mod unknown_temperature;
mod unknown_waviness;

use ferntast_emulation::random::Random;

use super::HiddenEffect;
use super::parameters::EdgeParameters;
use crate::bench::{about, either_sign};

/// The tip on its edge, at one instant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// Where the tip is along the edge \[m\].
    pub(super) place: f64,
    /// Where it is pulled: 1 towards larger places, −1 towards smaller ones.
    pub(super) direction: f64,
    /// How fast it slides, ≥ 0 \[m/s\].
    pub(super) speed: f64,
    /// F_N \[N\].
    pub(super) normal_force: f64,
    /// Since the first session's start \[days\].
    pub(super) date: f64,
    /// \[degC\]
    pub(super) temperature: f64,
}

/// A hidden effect with its parameters.
pub(super) trait Effect: Send + Sync {
    /// Parameters: name, value, unit.
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)>;

    /// Changes the edge itself, before anything moves.
    fn prepare(&self, _edge: &mut EdgeParameters) {}

    /// What it adds to the force that friction holds against sliding \[N\].
    fn holds(&self, _state: &State) -> f64 {
        0.0
    }

    /// What it adds to viscous friction \[N·s/m\].
    fn damping(&self, _state: &State) -> f64 {
        0.0
    }

    /// Force along the edge that does not ask for the direction of motion \[N\].
    fn along(&self, _state: &State) -> f64 {
        0.0
    }
}

/// Draws the parameters of `effect` for `edge` at `strength` (1: full).
pub(super) fn draw(
    effect: HiddenEffect,
    edge: &EdgeParameters,
    strength: f64,
    random: &mut Random,
) -> Box<dyn Effect> {
    use HiddenEffect as Hidden;
    match effect {
        Hidden::ContactCoulomb | Hidden::ContactViscous => equation_6::draw(effect, strength, edge),
        Hidden::ContactStribeck => contact_stribeck::draw(strength, random),
        Hidden::ContactCompliance => contact_compliance::draw(strength, edge, random),
        Hidden::ContactSpot => contact_spot::draw(strength, edge, random),
        Hidden::ContactWear => contact_wear::draw(strength, edge, random),
        Hidden::UnknownHertz => unknown_hertz::draw(strength),
        Hidden::UnknownAdhesion => unknown_adhesion::draw(strength, random),
        Hidden::UnknownDirection => unknown_direction::draw(strength, edge, random),
        Hidden::UnknownTemperature => unknown_temperature::draw(strength, edge, random),
        Hidden::UnknownWaviness => unknown_waviness::draw(strength, random),
        Hidden::UnknownSpeedForce => unknown_speed_force::draw(strength, random),
    }
}

//! Joint friction, one effect a file.
//!
//! The friction torque τ_F of equation (2) is a sum of effects:
//!
//! τ_F = Σ regressor(state) · parameters.
//!
//! **To add an effect**: copy a neighbour's file (the equation, its source,
//! its parameters with unit and bounds) and add its line to [`EFFECTS`].
//! Configuration, presets and fitters find it by its name.
//!
//! An effect may have a memory (presliding, hysteresis): it says its
//! [`length`](Effect::memory_length) and moves it on in
//! [`advance`](Effect::advance). Effects without one leave both alone.

mod coulomb;
mod cubic_viscous;
mod load_coulomb;
mod preset;
mod quadratic_viscous;
mod sum;
mod viscous;

pub use coulomb::Coulomb;
pub use cubic_viscous::CubicViscous;
pub use load_coulomb::LoadCoulomb;
pub use preset::{PRESETS, Preset};
pub use quadratic_viscous::QuadraticViscous;
pub use sum::{Friction, FrictionParameters, FrictionTorque};
pub use viscous::Viscous;

use crate::Parameter;

/// Every effect there is, in the order of the columns of a regressor.
pub static EFFECTS: &[&dyn Effect] = &[
    &Coulomb,
    &LoadCoulomb,
    &Viscous,
    &QuadraticViscous,
    &CubicViscous,
];

/// Largest number of parameters of one effect.
pub const MAX_PARAMETERS: usize = 8;

/// What friction may depend on, of one joint, on the joint side of the gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionState {
    /// Motor position q \[rad\].
    pub position: f64,
    /// Motor velocity q̇ \[rad/s\].
    pub velocity: f64,
    /// Load: joint torque τ at the torque sensor \[Nm\].
    pub load: f64,
    /// Temperature of the joint \[degC\].
    pub temperature: f64,
}

/// One effect in words: name, equation, where it comes from, parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Name in configuration files.
    pub name: &'static str,
    /// The equation, in the symbols of the source.
    pub equation: &'static str,
    /// Where the equation stands.
    pub source: &'static str,
    /// Its parameters, in the order of the regressor.
    pub parameters: &'static [Parameter],
}

/// One physical effect that contributes to τ_F, linear in its parameters.
///
/// Slices have the lengths that the effect itself states: `values` and `row`
/// as many as [`Description::parameters`], `memory`
/// [`memory_length`](Self::memory_length). Shorter ones are used as far as
/// they go; nothing panics.
pub trait Effect: Sync {
    /// Name, equation, source and parameters.
    fn description(&self) -> &'static Description;

    /// Writes ∂τ_F/∂parameter for each parameter into `row`.
    /// Unit of an entry: \[Nm\] by the parameter's unit.
    fn regressor(&self, state: &FrictionState, memory: &[f64], row: &mut [f64]);

    /// Its friction torque \[Nm\], positive against positive velocity.
    fn torque(&self, values: &[f64], state: &FrictionState, memory: &[f64]) -> f64 {
        let mut row = [0.0; MAX_PARAMETERS];
        let used = values.len().min(MAX_PARAMETERS);
        self.regressor(state, memory, &mut row[..used]);
        values.iter().zip(&row).map(|(value, x)| value * x).sum()
    }

    /// How many numbers it remembers.
    fn memory_length(&self) -> usize {
        0
    }

    /// Moves its memory on by `dt` \[s\].
    fn advance(&self, _values: &[f64], _state: &FrictionState, _dt: f64, _memory: &mut [f64]) {}
}

/// The effect called `name`.
pub fn effect(name: &str) -> Option<&'static dyn Effect> {
    EFFECTS
        .iter()
        .copied()
        .find(|effect| effect.description().name == name)
}

/// sign(x) with sign(0) = 0: at rest, friction takes no side.
pub(crate) fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn names_are_unique_and_parameters_fit() {
        for (index, effect) in EFFECTS.iter().enumerate() {
            let own = effect.description();
            assert!(own.parameters.len() <= MAX_PARAMETERS, "{}", own.name);
            assert!(!own.parameters.is_empty() && !own.source.is_empty());
            for other in &EFFECTS[index + 1..] {
                assert_ne!(own.name, other.description().name);
            }
            for parameter in own.parameters {
                assert!(parameter.lower < parameter.upper, "{}", parameter.name);
            }
        }
        assert!(effect("magic").is_none());
    }

    proptest! {
        /// Every effect here is odd in velocity: friction knows no direction.
        #[test]
        fn friction_turns_with_the_velocity(velocity in -0.7..0.7f64, load in -40.0..40.0f64) {
            for effect in EFFECTS {
                let length = effect.description().parameters.len();
                let (mut forth, mut back) = ([0.0; MAX_PARAMETERS], [0.0; MAX_PARAMETERS]);
                let state = FrictionState { velocity, load, ..Default::default() };
                let turned = FrictionState { velocity: -velocity, ..state };
                effect.regressor(&state, &[], &mut forth[..length]);
                effect.regressor(&turned, &[], &mut back[..length]);
                for (a, b) in forth.iter().zip(back) {
                    prop_assert_eq!(*a, -b);
                }
            }
        }
    }
}

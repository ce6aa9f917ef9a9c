//! Friction, and the catalogue of its static effects.
//!
//! The friction torque τ_F of equation (2) is a sum of effects:
//!
//! τ_F = Σ columns(state; shape) · coefficients.
//!
//! An effect is a row of data ([`Row`]) with its law ([`StaticEffect`]). Fits,
//! the twin and the servo's feed-forward take it from here; effects that are no
//! function of what the joint is doing now (backlash, a delay) have their rows
//! in `identification`, where alone they count.
//!
//! **To add one**: a row in the file of what it goes with, and nothing else:
//! [`all`] has it, and so has whatever goes through the catalogue.

mod conditions;
mod contact;
mod facts;
mod place;
mod preset;
mod proposal;
mod row;
mod speed;
mod static_effect;
mod sum;

pub use facts::{Facts, JointType, Subject};
pub use preset::{PRESETS, Preset};
pub use proposal::{Contrast, Proposal};
pub use row::{
    ANGLE, AtReversal, ConstantOf, DAY, Direction, EffectParameter, Exact, ONE, OwnSignals, Part,
    Row, SPEED, STIFFNESS, TORQUE, Unit, Unmeasured,
};
pub use static_effect::{FrictionState, Signal, StaticEffect, logarithmic, sign};
pub use sum::{Friction, FrictionParameters, FrictionTerm, FrictionTorque};

/// Largest number of coefficients of one effect, and of shape parameters.
pub const MAX_PARAMETERS: usize = 4;
/// Name under which a twin tells T₀ \[degC\] of effects that read the temperature.
pub const REFERENCE_TEMPERATURE: &str = "T0";
/// Name under which a twin tells the fastest speed \[rad/s\] that its estimates rest on:
/// beyond it they are extrapolated.
pub const FASTEST_SEEN: &str = "v_seen";

/// Every static effect, of joints and of contacts. Columns of a
/// [`Friction`] are in this order.
pub fn all() -> impl Iterator<Item = &'static StaticEffect> {
    speed::EFFECTS
        .iter()
        .chain(place::EFFECTS)
        .chain(conditions::EFFECTS)
        .chain(contact::EFFECTS)
}

/// The static effects of a joint.
pub fn of_joint() -> impl Iterator<Item = &'static StaticEffect> {
    all().filter(|effect| effect.row.of == Subject::Joint)
}

/// The static effect of a joint called `id`.
pub fn effect(id: &str) -> Option<&'static StaticEffect> {
    of_joint().find(|effect| effect.row.id == id)
}

/// The static effect of a joint that has a coefficient called `name`, and the
/// place of that among its coefficients.
pub fn effect_with(name: &str) -> Option<(&'static StaticEffect, usize)> {
    of_joint().find_map(|effect| {
        let mut own = effect.row.coefficients.iter();
        Some((effect, own.position(|each| each.name == name)?))
    })
}

/// Name in results of the parameter, coefficient or shape, that an arm's file calls `key`.
pub fn name_of_key(key: &str) -> Option<&'static str> {
    of_joint().find_map(|effect| {
        let row = &effect.row;
        let mut all = row.coefficients.iter().chain(row.shape);
        all.find(|own| own.key == key).map(|own| own.name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rows_are_complete_and_bounds_make_sense() {
        for effect in all() {
            let row = &effect.row;
            assert!(
                (1..=MAX_PARAMETERS).contains(&row.coefficients.len()),
                "{}",
                row.id
            );
            assert!(row.shape.len() <= MAX_PARAMETERS, "{}", row.id);
            for text in [row.equation, row.source, row.shows_as, row.excited_by] {
                assert!(!text.is_empty(), "{}", row.id);
            }
            for own in row.coefficients.iter().chain(row.shape) {
                assert!(own.lower < own.upper, "{}: {}", row.id, own.name);
            }
            assert_eq!(all().filter(|other| other.row.id == row.id).count(), 1);
        }
        assert!(effect("magic").is_none() && effect("contact_coulomb").is_none());
    }

    /// A name means one column, whichever effect it is found by.
    #[test]
    fn parameters_of_a_joint_are_told_apart_by_their_names() {
        let names = |own: &StaticEffect| -> Vec<&str> {
            let all = own.row.coefficients.iter().chain(own.row.shape);
            all.flat_map(|each| [each.name, each.key]).collect()
        };
        for (at, own) in of_joint().enumerate() {
            for other in of_joint().skip(at + 1).filter(|other| !other.row.is_sum) {
                let (a, b) = (names(own), names(other));
                let same: Vec<_> = a.iter().filter(|name| b.contains(name)).collect();
                assert!(
                    own.row.is_sum || same.is_empty(),
                    "{}, {}: {same:?}",
                    own.row.id,
                    other.row.id
                );
            }
        }
    }

    proptest! {
        /// What reads no position and no constant knows no direction but that of motion,
        /// unless its row says otherwise; whatever it is, it is finite.
        #[test]
        fn friction_turns_with_the_velocity(
            velocity in -0.7..0.7f64,
            load in -40.0..40.0f64,
            position in -1.5..1.5f64,
            temperature in -30.0..30.0f64,
        ) {
            for effect in all() {
                let (count, shapes) = (effect.row.coefficients.len(), effect.row.shape.len());
                let shape = [0.3, 0.2, 2.0, 1.0];
                let (mut forth, mut back) = ([0.0; MAX_PARAMETERS], [0.0; MAX_PARAMETERS]);
                let state = FrictionState { velocity, load, position, temperature, days: 3.0 };
                let turned = FrictionState { velocity: -velocity, ..state };
                (effect.columns)(&state, &shape[..shapes], &mut forth[..count]);
                (effect.columns)(&turned, &shape[..shapes], &mut back[..count]);
                for (a, b) in forth.iter().zip(back) {
                    prop_assert!(a.is_finite());
                    match effect.row.own_signals.direction {
                        Direction::Opposite => prop_assert_eq!(*a, -b),
                        Direction::Same => prop_assert_eq!(*a, b),
                        Direction::Either => {}
                    }
                    prop_assert!(!effect.acts_at_rest() || *a == b);
                }
            }
        }
    }
}

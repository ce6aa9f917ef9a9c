//! The friction of one joint: a sum of effects with their values.

use super::{FrictionState, JointType, MAX_PARAMETERS, Signal, StaticEffect};
use crate::{ParameterError, Section, check};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The friction of one joint in a configuration file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionParameters {
    /// Smallest and largest speed |q̇| that the values were identified at
    /// \[rad/s\]. Below the first they are used as they are (Coulomb friction
    /// reaches down to rest); above the last is extrapolation.
    pub speed_range: [f64; 2],
    /// Effect by id, and in it coefficients and shape by key.
    pub effects: BTreeMap<String, BTreeMap<String, f64>>,
}

impl FrictionParameters {
    /// Checks names and values.
    ///
    /// # Errors
    ///
    /// An effect or parameter that is not known, missing, or out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        Friction::new(self).map(|_| ())
    }
}

impl Section for FrictionParameters {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        self.validate().map_err(|error| error.within(key))
    }
}

/// A friction torque, and whether to trust it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionTorque {
    /// τ_F \[Nm\], positive against positive velocity.
    pub torque: f64,
    /// The speed is above the range that the parameters were identified in.
    pub extrapolated: bool,
}

/// An effect with its values. Allocates nothing.
#[derive(Clone, Copy, Debug)]
pub struct FrictionTerm {
    /// The effect.
    pub effect: &'static StaticEffect,
    /// Its shape, as many as its row has.
    pub shape: [f64; MAX_PARAMETERS],
    /// Its coefficients, as many as its row has.
    pub values: [f64; MAX_PARAMETERS],
}

impl FrictionTerm {
    /// Number of coefficients.
    pub fn count(&self) -> usize {
        self.effect.row.coefficients.len().min(MAX_PARAMETERS)
    }

    /// Writes ∂τ_F/∂coefficient at `state`.
    pub fn columns(&self, state: &FrictionState) -> [f64; MAX_PARAMETERS] {
        let mut columns = [0.0; MAX_PARAMETERS];
        let shapes = self.effect.row.shape.len().min(MAX_PARAMETERS);
        (self.effect.columns)(state, &self.shape[..shapes], &mut columns[..self.count()]);
        columns
    }

    /// Its torque \[Nm\], positive against positive velocity.
    pub fn torque(&self, state: &FrictionState) -> f64 {
        let columns = self.columns(state);
        let both = self.values.iter().zip(&columns).take(self.count());
        both.map(|(value, x)| value * x).sum()
    }

    /// As a file has it: every parameter by its key.
    fn read(
        effect: &'static StaticEffect,
        given: &BTreeMap<String, f64>,
    ) -> Result<FrictionTerm, ParameterError> {
        let row = &effect.row;
        let known = || row.coefficients.iter().chain(row.shape);
        if let Some(key) = given.keys().find(|key| known().all(|own| own.key != *key)) {
            return Err(ParameterError::Unknown {
                key: key.clone(),
                known: known().map(|own| own.key).collect::<Vec<_>>().join(", "),
            });
        }
        let read = |parameters: &[super::EffectParameter]| {
            let mut values = [0.0; MAX_PARAMETERS];
            for (value, own) in values.iter_mut().zip(parameters) {
                let unit = own.unit.of(JointType::Revolute);
                *value = *given.get(own.key).ok_or_else(|| ParameterError::Missing {
                    key: own.key.to_owned(),
                    unit,
                })?;
                check(own.key, *value, own.lower, own.upper, unit)?;
            }
            Ok(values)
        };
        Ok(FrictionTerm {
            effect,
            shape: read(row.shape)?,
            values: read(row.coefficients)?,
        })
    }
}

/// The friction model of one joint: equations (3), (4) and whatever effects
/// are added to them. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct Friction {
    terms: Vec<FrictionTerm>,
    speed_range: [f64; 2],
}

impl Friction {
    /// Friction with the effects and values of `parameters`.
    ///
    /// # Errors
    ///
    /// An effect or parameter that is not known, missing, or out of bounds,
    /// or a speed range that is empty.
    pub fn new(parameters: &FrictionParameters) -> Result<Friction, ParameterError> {
        let [lower, upper] = parameters.speed_range;
        check("speed_range[1]", upper, 0.0, 100.0, "rad/s")?;
        check("speed_range[0]", lower, 0.0, upper, "rad/s")?;
        let given = &parameters.effects;
        if let Some(id) = given
            .keys()
            .find(|id| configurable().all(|own| own.row.id != *id))
        {
            let known: Vec<_> = configurable().map(|own| own.row.id).collect();
            return Err(ParameterError::Unknown {
                key: format!("effects.{id}"),
                known: known.join(", "),
            });
        }
        // In the order of the catalogue, so that columns do not depend on names.
        let terms = configurable().filter_map(|effect| {
            let id = effect.row.id;
            let term = FrictionTerm::read(effect, given.get(id)?);
            Some(term.map_err(|error| error.within(&format!("effects.{id}"))))
        });
        Ok(Friction {
            terms: terms.collect::<Result<_, _>>()?,
            speed_range: parameters.speed_range,
        })
    }

    /// Its effects.
    pub fn terms(&self) -> &[FrictionTerm] {
        &self.terms
    }

    /// Smallest and largest speed |q̇| that the values were identified at \[rad/s\].
    pub fn speed_range(&self) -> [f64; 2] {
        self.speed_range
    }

    /// τ_F at `state`, by the equations also where they were never identified;
    /// then marked as extrapolated.
    pub fn torque(&self, state: &FrictionState) -> FrictionTorque {
        FrictionTorque {
            torque: self.terms.iter().map(|term| term.torque(state)).sum(),
            // NaN counts as outside.
            extrapolated: !self.is_within_range(state.velocity),
        }
    }

    /// τ_F with the velocity held at the end of the identified range: what a
    /// law that compensates friction may safely use. Still marked.
    pub fn torque_within_range(&self, state: &FrictionState) -> FrictionTorque {
        let [_, upper] = self.speed_range;
        let held = FrictionState {
            velocity: state.velocity.clamp(-upper, upper),
            ..*state
        };
        FrictionTorque {
            extrapolated: !self.is_within_range(state.velocity),
            ..self.torque(&held)
        }
    }

    /// Whether the parameters were identified at speeds as high as |`velocity`| \[rad/s\].
    pub fn is_within_range(&self, velocity: f64) -> bool {
        velocity.abs() <= self.speed_range[1]
    }
}

/// Effects that an arm's file may have: such as need no reference of a recording,
/// no temperature or date to count from.
fn configurable() -> impl Iterator<Item = &'static StaticEffect> {
    super::of_joint()
        .filter(|own| !own.reads(Signal::Temperature) && !own.reads(Signal::Date))
        .filter(|own| !own.row.is_sum)
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::*;

    fn preset(name: &str) -> Friction {
        Preset::named(name).unwrap().friction().unwrap()
    }

    fn unloaded(friction: &Friction, degrees_per_second: f64) -> FrictionTorque {
        friction.torque(&FrictionState {
            velocity: degrees_per_second.to_radians(),
            ..Default::default()
        })
    }

    /// Fig. 6: at 1 °/s, about 50 % more in space than on the ground.
    #[test]
    fn friction_at_low_velocity_is_that_of_table_1() {
        let ground = unloaded(&preset("on_ground"), 1.0).torque;
        let space = unloaded(&preset("spring_2005_03_24"), 1.0).torque;
        assert!((ground - 10.35).abs() < 0.005, "{ground}");
        assert!((space - 15.05).abs() < 0.005, "{space}");
    }

    #[test]
    fn the_slope_is_negative_between_about_11_and_29_degrees_per_second() {
        for (name, rises, falls) in [
            ("on_ground", [1.0, 11.0], [13.5, 26.0]),
            ("spring_2005_03_24", [1.0, 10.0], [11.5, 28.5]),
        ] {
            let friction = preset(name);
            let slope = |v: f64| {
                unloaded(&friction, v + 0.01).torque - unloaded(&friction, v - 0.01).torque
            };
            for v in rises {
                assert!(slope(v) > 0.0, "{name} at {v}");
            }
            for v in falls {
                assert!(slope(v) < 0.0, "{name} at {v}");
            }
            assert!(slope(31.0) > 0.0, "{name}");
        }
    }

    #[test]
    fn extrapolation_is_flagged() {
        let sinusoidal = preset("sinusoidal_2005_12_22");
        let beyond = unloaded(&sinusoidal, 40.0);
        assert!((beyond.torque - 199.0).abs() < 0.5, "{beyond:?}");
        assert!(beyond.extrapolated);
        assert!(!unloaded(&sinusoidal, 19.0).extrapolated);
        assert!(!unloaded(&preset("spring_2005_03_24"), 40.0).extrapolated);
        assert!(unloaded(&sinusoidal, f64::NAN).extrapolated);
        let fast = FrictionState {
            velocity: 3.0,
            ..Default::default()
        };
        let held = sinusoidal.torque_within_range(&fast);
        assert!(held.extrapolated);
        assert_eq!(held.torque, unloaded(&sinusoidal, 20.0).torque);
    }

    #[test]
    fn every_set_of_table_1_dissipates() {
        for preset in super::super::PRESETS {
            let friction = preset.friction().unwrap();
            for step in 1..=4000 {
                let v = f64::from(step) * 0.01;
                assert!(
                    unloaded(&friction, v).torque > 0.0,
                    "{} at {v}",
                    preset.name
                );
                assert!(
                    unloaded(&friction, -v).torque < 0.0,
                    "{} at -{v}",
                    preset.name
                );
            }
        }
    }

    #[test]
    fn load_adds_its_share() {
        let friction = preset("spring_2005_03_24");
        let state = FrictionState {
            velocity: -0.1,
            load: 13.0,
            ..Default::default()
        };
        let free = FrictionState { load: 0.0, ..state };
        let share = friction.torque(&state).torque - friction.torque(&free).torque;
        assert!((share + 0.146 * 13.0).abs() < 1e-12);
    }

    #[test]
    fn torque_is_columns_times_values() {
        let friction = preset("on_ground");
        let state = FrictionState {
            velocity: 0.3,
            load: -7.0,
            ..Default::default()
        };
        let values: Vec<f64> = friction.terms().iter().map(|term| term.values[0]).collect();
        assert_eq!(values, [7.573, 0.127, 168.388, -544.193, 516.421]);
        let columns = friction.terms().iter().map(|term| term.columns(&state)[0]);
        let sum: f64 = columns.zip(values).map(|(a, b)| a * b).sum();
        assert!((sum - friction.torque(&state).torque).abs() < 1e-12);
    }

    #[test]
    fn an_effect_with_a_shape_is_read_by_its_keys() {
        let mut parameters = Preset::named("on_ground").unwrap().parameters();
        let bump = [("bs", 5.0), ("vs", 0.03)].map(|(key, value)| (key.to_owned(), value));
        parameters.effects.insert("stribeck".into(), bump.into());
        let at = |parameters: &FrictionParameters| {
            unloaded(&Friction::new(parameters).unwrap(), 0.03_f64.to_degrees()).torque
        };
        let without = unloaded(&preset("on_ground"), 0.03_f64.to_degrees()).torque;
        assert!((at(&parameters) - without - 5.0 * (-1.0_f64).exp()).abs() < 1e-12);
        let warmth = BTreeMap::from([("kT".to_owned(), 0.1)]);
        parameters
            .effects
            .insert("temperature_coulomb".into(), warmth);
        let key = parameters.validate().unwrap_err().key().to_owned();
        assert_eq!(key, "effects.temperature_coulomb");
    }

    #[test]
    fn wrong_names_and_values_are_refused_by_key() {
        let good = Preset::named("on_ground").unwrap().parameters();
        let mut unknown = good.clone();
        unknown.effects.insert("magic".into(), BTreeMap::new());
        assert_eq!(unknown.validate().unwrap_err().key(), "effects.magic");

        let mut missing = good.clone();
        missing.effects.insert("viscous".into(), BTreeMap::new());
        assert!(
            matches!(missing.validate(), Err(ParameterError::Missing { key, .. }) if key == "effects.viscous.b_1")
        );

        let mut wrong = good.clone();
        wrong
            .effects
            .insert("viscous".into(), BTreeMap::from([("b_1".into(), f64::NAN)]));
        assert!(
            matches!(wrong.validate(), Err(ParameterError::OutOfBounds { key, .. }) if key == "effects.viscous.b_1")
        );

        let mut empty = good;
        empty.speed_range = [1.0, 0.5];
        assert_eq!(empty.validate().unwrap_err().key(), "speed_range[0]");
    }
}

//! The friction of one joint: a sum of effects with their values.

use super::{EFFECTS, Effect, FrictionState, MAX_PARAMETERS};
use crate::{ParameterError, check};
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
    /// Effect by name, and in it the parameters by name.
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

/// A friction torque, and whether to trust it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionTorque {
    /// τ_F \[Nm\], positive against positive velocity.
    pub torque: f64,
    /// The speed is above the range that the parameters were identified in.
    pub extrapolated: bool,
}

#[derive(Clone)]
struct Term {
    effect: &'static dyn Effect,
    values: [f64; MAX_PARAMETERS],
    count: usize,
    memory: Vec<f64>,
}

impl Term {
    fn values(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// The friction model of one joint: equations (3), (4) and whatever effects
/// are added to them. Allocates when made, never afterwards.
#[derive(Clone)]
pub struct Friction {
    terms: Vec<Term>,
    speed_range: [f64; 2],
}

impl std::fmt::Debug for Friction {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let terms = self
            .terms
            .iter()
            .map(|term| (term.effect.description().name, term.values()));
        formatter.debug_map().entries(terms).finish()
    }
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
        for name in parameters.effects.keys() {
            if super::effect(name).is_none() {
                let known: Vec<_> = EFFECTS.iter().map(|e| e.description().name).collect();
                return Err(ParameterError::Unknown {
                    key: format!("effects.{name}"),
                    known: known.join(", "),
                });
            }
        }
        let mut terms = Vec::new();
        // In the order of EFFECTS, so that regressor columns do not depend on names.
        for effect in EFFECTS.iter().copied() {
            let name = effect.description().name;
            if let Some(values) = parameters.effects.get(name) {
                let term = term(effect, values)
                    .map_err(|error| error.within(&format!("effects.{name}")))?;
                terms.push(term);
            }
        }
        Ok(Friction {
            terms,
            speed_range: parameters.speed_range,
        })
    }

    /// Smallest and largest speed |q̇| that the values were identified at \[rad/s\].
    pub fn speed_range(&self) -> [f64; 2] {
        self.speed_range
    }

    /// τ_F at `state`, by the equations also where they were never identified;
    /// then marked as extrapolated.
    pub fn torque(&self, state: &FrictionState) -> FrictionTorque {
        FrictionTorque {
            torque: self
                .terms
                .iter()
                .map(|term| term.effect.torque(term.values(), state, &term.memory))
                .sum(),
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

    /// Number of parameters: columns of the regressor.
    pub fn parameter_count(&self) -> usize {
        self.terms.iter().map(|term| term.count).sum()
    }

    /// Writes the regressor: `row[k]` = ∂τ_F/∂(k-th parameter), as many as
    /// [`parameter_count`](Self::parameter_count). A shorter `row` is filled
    /// as far as it goes.
    pub fn regressor(&self, state: &FrictionState, row: &mut [f64]) {
        let mut rest = row;
        for term in &self.terms {
            let (own, after) = rest.split_at_mut(term.count.min(rest.len()));
            term.effect.regressor(state, &term.memory, own);
            rest = after;
        }
    }

    /// Writes the values in the order of the regressor's columns.
    pub fn values(&self, values: &mut [f64]) {
        let own = self.terms.iter().flat_map(|term| term.values());
        for (to, from) in values.iter_mut().zip(own) {
            *to = *from;
        }
    }

    /// Names of the parameters in the order of the regressor's columns.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.terms.iter().flat_map(|term| {
            let parameters = term.effect.description().parameters;
            parameters.iter().take(term.count).map(|own| own.name)
        })
    }

    /// Takes other values, in the order of the regressor's columns; fewer are
    /// taken as far as they go. Allocates nothing, checks nothing.
    pub fn set_values(&mut self, values: &[f64]) {
        let own = self
            .terms
            .iter_mut()
            .flat_map(|term| term.values.iter_mut().take(term.count));
        for (to, from) in own.zip(values) {
            *to = *from;
        }
    }

    /// Moves the memory of effects that have one on by `dt` \[s\].
    pub fn advance(&mut self, state: &FrictionState, dt: f64) {
        for term in &mut self.terms {
            let values = &term.values[..term.count];
            term.effect.advance(values, state, dt, &mut term.memory);
        }
    }
}

fn term(
    effect: &'static dyn Effect,
    given: &BTreeMap<String, f64>,
) -> Result<Term, ParameterError> {
    let parameters = effect.description().parameters;
    if let Some(name) = given
        .keys()
        .find(|name| parameters.iter().all(|p| p.name != name.as_str()))
    {
        let known: Vec<_> = parameters.iter().map(|p| p.name).collect();
        return Err(ParameterError::Unknown {
            key: name.clone(),
            known: known.join(", "),
        });
    }
    let mut values = [0.0; MAX_PARAMETERS];
    for (value, parameter) in values.iter_mut().zip(parameters) {
        *value = *given
            .get(parameter.name)
            .ok_or_else(|| ParameterError::Missing {
                key: parameter.name.to_owned(),
                unit: parameter.unit,
            })?;
        parameter.check(*value)?;
    }
    Ok(Term {
        effect,
        values,
        count: parameters.len().min(MAX_PARAMETERS),
        memory: vec![0.0; effect.memory_length()],
    })
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
    fn torque_is_regressor_times_values() {
        let friction = preset("on_ground");
        let state = FrictionState {
            velocity: 0.3,
            load: -7.0,
            ..Default::default()
        };
        let (mut row, mut values) = ([0.0; 5], [0.0; 5]);
        assert_eq!(friction.parameter_count(), 5);
        friction.regressor(&state, &mut row);
        friction.values(&mut values);
        let sum: f64 = row.iter().zip(values).map(|(a, b)| a * b).sum();
        assert!((sum - friction.torque(&state).torque).abs() < 1e-12);
        assert_eq!(values, [7.573, 0.127, 168.388, -544.193, 516.421]);
        let names: Vec<_> = friction.names().collect();
        assert_eq!(names, ["b_0", "b_0T", "b_1", "b_2", "b_3"]);
        let mut other = preset("on_ground");
        other.set_values(&values.map(|value| 2.0 * value));
        let doubled = other.torque(&state).torque;
        assert!((doubled - 2.0 * friction.torque(&state).torque).abs() < 1e-12);
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

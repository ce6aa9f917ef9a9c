//! Friction fed forward, and friction found elsewhere taken over into it.
//!
//! What is fed forward is a sum of static effects of the catalogue, linear in
//! their coefficients θ, so that a straight way from one set of them to another,
//!
//! θ(t) = θ_from + s(t) (θ_to − θ_from), s from 0 to 1 within
//! [`TakeOverConfig::time`],
//!
//! leads the torque over without a jump. A shape parameter does not enter
//! linearly: an effect with another shape is another term, which comes up from
//! zero while the old one goes down to it. Coefficients are taken over where
//! they are certain, the others stay as configured; all of it is refused when one
//! of them, or the torque that they give together, is too far from what is
//! configured. What was found is known up to the fastest speed that it was found at
//! ([`FASTEST_SEEN`]), v_s: beyond, the difference to what is configured stays as it is there,
//!
//! τ_F(θ, v) = τ_F(θ_configured, v) + τ_F(θ − θ_configured, v_s sign v) for |v| > v_s,
//!
//! since a polynomial of the speed runs away where nothing holds it.

mod fed;

pub use fed::FedForward;

use ferntast_model::ParameterError;
use ferntast_model::friction::{
    EffectParameter, FASTEST_SEEN, Friction, FrictionState, JointType, MAX_PARAMETERS,
    REFERENCE_TEMPERATURE, Signal, StaticEffect, effect_with,
};
use ferntast_model::joint::JointParameters;

use fed::{Fed, Values};

use super::take_over::{
    Declined, FoundParameter, LeftOut, TakeOverConfig, TakeOverRefusal, TakenOver, unknown_signal,
    value_of,
};

/// Effects that are fed forward at most, those on their way out included.
pub const MAX_TERMS: usize = 16;
/// Speeds at which the torque is held against the configured one, …
const SPEEDS: u32 = 40;
/// … and positions, where an effect goes with position.
const POSITIONS: u32 = 40;
/// How far \[K\] from where it was taken over the temperature counts: beyond, friction
/// stays as it is there.
const TEMPERATURE_REACH: f64 = 10.0;

/// What is fed forward at one moment \[Nm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FedTorque {
    /// What goes with the motion, and is none at rest.
    pub sliding: f64,
    /// What a joint at rest feels as well: a spring, a weight, a ripple.
    pub standing: f64,
}

/// Friction of one joint as it is fed forward. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct FeedForward {
    terms: [Option<Fed>; MAX_TERMS],
    speed_range: [f64; 2],
    position_range: [f64; 2],
    config: TakeOverConfig,
    /// T \[degC\], where it is measured.
    temperature: Option<f64>,
    /// T₀ \[degC\].
    reference_temperature: f64,
    /// Temperatures \[degC\] within which friction follows.
    temperature_range: [f64; 2],
    /// v_s \[rad/s\], and what it was before it is led over.
    seen: f64,
    seen_before: f64,
    /// s \[1\].
    share: f64,
    taken_over: bool,
}

impl FeedForward {
    /// Friction as configured.
    ///
    /// # Errors
    ///
    /// Friction that the model does not know, a value out of bounds.
    pub fn new(
        joint: &JointParameters,
        config: TakeOverConfig,
    ) -> Result<FeedForward, ParameterError> {
        config
            .validate()
            .map_err(|error| error.within("take_over"))?;
        let friction = Friction::new(&joint.friction).map_err(|error| error.within("friction"))?;
        let mut terms = [None; MAX_TERMS];
        for (place, term) in terms.iter_mut().zip(friction.terms()) {
            *place = Some(Fed::configured(*term));
        }
        Ok(FeedForward {
            terms,
            speed_range: friction.speed_range(),
            position_range: [joint.position_lower, joint.position_upper],
            config,
            temperature: None,
            reference_temperature: 0.0,
            temperature_range: [0.0; 2],
            seen: f64::INFINITY,
            seen_before: f64::INFINITY,
            share: 1.0,
            taken_over: false,
        })
    }

    /// What the joint's temperature is now \[degC\].
    pub fn set_temperature(&mut self, temperature: f64) {
        self.temperature = Some(temperature);
    }

    /// τ_F at `position` \[rad\] and `velocity` \[rad/s\] under the load `load`
    /// \[Nm\], the velocity held at the end of the range that friction is known in.
    pub fn torque(&self, position: f64, velocity: f64, load: f64) -> FedTorque {
        let [_, fastest] = self.speed_range;
        let [coldest, warmest] = self.temperature_range;
        let temperature = self.temperature.unwrap_or(coldest);
        let state = FrictionState {
            position,
            velocity: velocity.clamp(-fastest, fastest),
            load,
            temperature: temperature.clamp(coldest, warmest) - self.reference_temperature,
            days: 0.0,
        };
        let known = self.known(&state, self.seen_now());
        let all_known = known == state;
        let mut fed = FedTorque {
            sliding: -0.0,
            standing: -0.0,
        };
        for own in self.terms.iter().flatten() {
            let part = match own.term.effect.acts_at_rest() {
                true => &mut fed.standing,
                false => &mut fed.sliding,
            };
            *part += match all_known {
                true => own.term.torque(&state),
                false => own.torque_as_known(own.term.values, &state, &known),
            };
        }
        fed
    }

    /// v_s while it is led over \[rad/s\].
    fn seen_now(&self) -> f64 {
        match self.is_on_the_way() && self.seen_before != self.seen {
            true => self.seen_before + self.share * (self.seen - self.seen_before),
            false => self.seen,
        }
    }

    /// The nearest state to `state` in which no speed is beyond `seen` \[rad/s\].
    fn known(&self, state: &FrictionState, seen: f64) -> FrictionState {
        FrictionState {
            velocity: state.velocity.clamp(-seen, seen),
            ..*state
        }
    }

    /// Sets out for what was `found`; gives what of it is taken over. Other
    /// coefficients go back to what is configured.
    ///
    /// # Errors
    ///
    /// [`TakeOverRefusal`]; nothing changes then.
    pub fn take_over<'a>(
        &mut self,
        found: &[FoundParameter<'a>],
    ) -> Result<TakenOver<'a>, TakeOverRefusal> {
        let mut next = self.clone_for(found);
        let mut taken = TakenOver {
            count: next.take_configured(found)?,
            left_out: None,
        };
        for own in found.iter().filter(|own| own.value.is_finite()) {
            match next.take_new(own.name, found) {
                Ok(count) => taken.count += count,
                Err(Declined::LeftOut(why)) => {
                    taken.left_out = taken.left_out.or(Some((own.name, why)));
                }
                Err(Declined::Refused(refusal)) => return Err(refusal),
            }
        }
        match (taken.count, taken.left_out) {
            (0, Some((_, why))) => return Err(TakeOverRefusal::NothingStatic(why)),
            (0, None) => return Err(TakeOverRefusal::NothingCertain),
            _ => {}
        }
        next.check_torque()?;
        *self = next;
        self.share = 0.0;
        self.taken_over = true;
        Ok(taken)
    }

    /// Sets out for what is configured.
    pub fn give_back(&mut self) {
        self.seen = self.seen_now();
        self.seen_before = self.seen;
        self.head_for_configured();
        self.share = 0.0;
        self.taken_over = false;
    }

    /// One step of `dt` \[s\] on the way.
    pub fn step(&mut self, dt: f64) {
        if self.share >= 1.0 {
            return;
        }
        self.share = (self.share + dt.max(0.0) / self.config.time).min(1.0);
        let share = self.share;
        for fed in self.terms.iter_mut().flatten() {
            fed.term.values = fed.target;
            if share < 1.0 {
                for (value, from) in fed.term.values.iter_mut().zip(fed.from) {
                    *value = from + share * (*value - from);
                }
            }
        }
        if share >= 1.0 {
            self.drop_idle();
            if !self.taken_over {
                self.seen = f64::INFINITY;
            }
        }
    }

    /// Whether what was found elsewhere is in use, or on its way.
    pub fn is_taken_over(&self) -> bool {
        self.taken_over
    }

    /// Whether the values are on their way.
    pub fn is_on_the_way(&self) -> bool {
        self.share < 1.0
    }

    /// The parameters, effect by effect: coefficients, then shape; and at last T₀, where
    /// one was taken over.
    pub fn parameters(&self) -> impl Iterator<Item = FedForward> + '_ {
        let [coldest, warmest] = self.temperature_range;
        let reference = (self.taken_over && coldest < warmest).then_some(FedForward {
            name: REFERENCE_TEMPERATURE,
            configured: 0.0,
            value: self.reference_temperature,
            target: self.reference_temperature,
        });
        let seen = (self.taken_over && self.seen < self.speed_range[1]).then_some(FedForward {
            name: FASTEST_SEEN,
            configured: 0.0,
            value: self.seen,
            target: self.seen,
        });
        let effects = self.terms.iter().flatten().flat_map(Fed::parameters);
        effects.chain(reference).chain(seen)
    }

    /// A copy that heads for what is configured, with T₀ and v_s as found.
    fn clone_for(&self, found: &[FoundParameter<'_>]) -> Self {
        // Arrays only: nothing is allocated.
        let mut next = self.clone();
        next.head_for_configured();
        // What is fed forward as configured is known at all speeds: there is nothing to lead over.
        let led = self.taken_over || self.is_on_the_way();
        let [_, fastest] = self.speed_range;
        next.seen = value_of(found, FASTEST_SEEN).map_or(fastest, |own| own.clamp(0.0, fastest));
        next.seen_before = if led {
            self.seen_now().min(fastest)
        } else {
            next.seen
        };
        let reference = value_of(found, REFERENCE_TEMPERATURE);
        if let (Some(reference), Some(now)) = (reference, self.temperature) {
            next.reference_temperature = reference;
            next.temperature_range = [now - TEMPERATURE_REACH, now + TEMPERATURE_REACH];
        }
        next
    }

    fn head_for_configured(&mut self) {
        for fed in self.terms.iter_mut().flatten() {
            fed.from = fed.term.values;
            fed.target = fed.configured;
        }
    }

    /// Lets go of effects that are not configured and have faded out.
    fn drop_idle(&mut self) {
        for place in &mut self.terms {
            let idle = |fed: &mut Fed| !fed.is_configured && fed.target == [0.0; MAX_PARAMETERS];
            if place.as_mut().is_some_and(idle) {
                *place = None;
            }
        }
    }

    /// Heads for what was found of the configured effects, coefficient by
    /// coefficient; gives their number.
    fn take_configured(&mut self, found: &[FoundParameter<'_>]) -> Result<usize, TakeOverRefusal> {
        let config = self.config;
        let mut taken = 0;
        for fed in self
            .terms
            .iter_mut()
            .flatten()
            .filter(|fed| fed.is_configured)
        {
            let coefficients = fed.term.effect.row.coefficients.iter();
            for (place, parameter) in fed.target.iter_mut().zip(coefficients) {
                let configured = *place;
                let certain = found
                    .iter()
                    .find(|own| own.name == parameter.name && config.is_certain(own, configured));
                let Some(own) = certain else {
                    continue;
                };
                let reach = config.parameter_share * configured.abs();
                let (lower, upper) = (configured - reach, configured + reach);
                check_bounds(parameter, own.value, [lower, upper], OF_CONFIGURED)?;
                *place = own.value;
                taken += 1;
            }
        }
        Ok(taken)
    }

    /// Heads for the effect that is not configured and whose first coefficient is
    /// `name`: all of it, or nothing; gives the number of its coefficients.
    fn take_new(&mut self, name: &str, found: &[FoundParameter<'_>]) -> Result<usize, Declined> {
        let Some((effect, index)) = effect_with(name) else {
            let is_shape = ferntast_model::friction::of_joint()
                .any(|effect| effect.row.shape.iter().any(|own| own.name == name));
            let comes_along = [REFERENCE_TEMPERATURE, FASTEST_SEEN].contains(&name);
            return match is_shape || comes_along {
                true => Ok(0),
                false => Err(LeftOut::NotStatic.into()),
            };
        };
        let mut terms = self.terms.iter().flatten();
        let configured = terms.any(|fed| fed.is_configured && same(fed.term.effect, effect));
        if index > 0 || configured {
            return Ok(0);
        }
        let has_temperature = self.temperature.is_some();
        if let Some(signal) = unknown_signal(effect, has_temperature) {
            return Err(LeftOut::Unknown(signal).into());
        }
        let no_reference = value_of(found, REFERENCE_TEMPERATURE).is_none();
        if effect.reads(Signal::Temperature) && no_reference {
            return Err(LeftOut::NoShape.into());
        }
        let Some(values) = self.certain(effect, found) else {
            return Ok(0);
        };
        let mut shape = [0.0; MAX_PARAMETERS];
        for (place, own) in shape.iter_mut().zip(effect.row.shape) {
            *place = value_of(found, own.name).ok_or(LeftOut::NoShape)?;
        }
        let own = effect.row.coefficients.iter().chain(effect.row.shape);
        let count = effect.row.coefficients.len();
        for (own, value) in own.zip(values[..count].iter().chain(&shape)) {
            check_bounds(own, *value, [own.lower, own.upper], OF_EFFECT)?;
        }
        self.place_for(effect, shape)?.target = values;
        Ok(count)
    }

    /// The coefficients of `effect` as found, where all of them are certain.
    fn certain(
        &self,
        effect: &'static StaticEffect,
        found: &[FoundParameter<'_>],
    ) -> Option<Values> {
        let mut values = [0.0; MAX_PARAMETERS];
        let own = |name: &str| found.iter().find(|own| own.name == name);
        for (place, parameter) in values.iter_mut().zip(effect.row.coefficients) {
            *place = own(parameter.name)?.value;
        }
        let size = values
            .iter()
            .fold(0.0, |size: f64, value| size.max(value.abs()));
        let mut all = effect.row.coefficients.iter();
        let certain =
            all.all(|each| own(each.name).is_some_and(|own| self.config.is_certain(own, size)));
        certain.then_some(values)
    }

    /// The term of `effect` with this shape, a new one where there is none.
    fn place_for(
        &mut self,
        effect: &'static StaticEffect,
        shape: Values,
    ) -> Result<&mut Fed, TakeOverRefusal> {
        let is_own = |fed: &Fed| {
            !fed.is_configured && same(fed.term.effect, effect) && fed.term.shape == shape
        };
        let mut places = self.terms.iter();
        let at = places
            .position(|place| place.as_ref().is_some_and(is_own))
            .or_else(|| self.terms.iter().position(Option::is_none));
        let place = at.and_then(|at| self.terms.get_mut(at));
        let id = effect.row.id;
        let place = place.ok_or(TakeOverRefusal::TooMany { effect: id })?;
        Ok(place.get_or_insert_with(|| Fed::new(effect, shape)))
    }

    /// Holds the unloaded torque of the target against the configured one.
    fn check_torque(&self) -> Result<(), TakeOverRefusal> {
        let reads = |signal| {
            let mut terms = self.terms.iter().flatten();
            terms.any(|fed| fed.term.effect.reads(signal))
        };
        let positions = if reads(Signal::Position) {
            POSITIONS
        } else {
            0
        };
        let [lower, upper] = self.speed_range;
        for step in 0..=SPEEDS {
            let speed = between(lower, upper, step, SPEEDS);
            if speed <= 0.0 {
                continue;
            }
            for place in 0..=positions {
                let [low, high] = self.position_range;
                for temperature in self.temperature_range {
                    for velocity in [speed, -speed] {
                        self.check_torque_at(&FrictionState {
                            position: between(low, high, place, POSITIONS),
                            velocity,
                            temperature: temperature - self.reference_temperature,
                            ..FrictionState::default()
                        })?;
                    }
                }
            }
        }
        Ok(())
    }

    fn check_torque_at(&self, state: &FrictionState) -> Result<(), TakeOverRefusal> {
        let terms = || self.terms.iter().flatten();
        let configured: f64 = terms().map(|fed| fed.torque(fed.configured, state)).sum();
        let known = self.known(state, self.seen);
        let torque: f64 = terms()
            .map(|fed| fed.torque_as_known(fed.target, state, &known))
            .sum();
        let reach = self.config.torque_share * configured.abs();
        if (torque - configured).abs() <= reach {
            return Ok(());
        }
        Err(TakeOverRefusal::Torque {
            speed: state.velocity,
            torque,
            lower: configured - reach,
            upper: configured + reach,
        })
    }
}

fn same(one: &StaticEffect, other: &StaticEffect) -> bool {
    one.row.id == other.row.id
}

/// Value number `step` of `steps` from `lower` to `upper`.
fn between(lower: f64, upper: f64, step: u32, steps: u32) -> f64 {
    lower + f64::from(step) / f64::from(steps) * (upper - lower)
}

/// What allows a configured parameter no more.
const OF_CONFIGURED: &str = "[servo.take_over] parameter_share";
/// What allows a parameter of another effect no more.
const OF_EFFECT: &str = "no servo takes more";

fn check_bounds(
    parameter: &EffectParameter,
    value: f64,
    [lower, upper]: [f64; 2],
    rule: &'static str,
) -> Result<(), TakeOverRefusal> {
    match (lower..=upper).contains(&value) {
        true => Ok(()),
        false => Err(TakeOverRefusal::Parameter {
            name: parameter.key,
            value,
            lower,
            upper,
            unit: parameter.unit.of(JointType::Revolute),
            rule,
        }),
    }
}

#[cfg(test)]
mod tests;

//! Friction fed forward, and friction found elsewhere taken over into it.
//!
//! What is fed forward is linear in the parameters θ of equations (3) and (4),
//! so that a straight way from one set of them to another,
//!
//! θ(t) = θ_from + s(t) (θ_to − θ_from), s from 0 to 1 within
//! [`TakeOverConfig::time`],
//!
//! leads the torque over without a jump. Parameters are taken over where they
//! are certain, the others stay as configured; all of it is refused when one
//! of them, or the torque that they give together, is too far from what is
//! configured.

use ferntast_model::friction::{Friction, FrictionParameters, FrictionState};
use ferntast_model::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Parameters that can be taken over; what a model has beyond stays as configured.
pub const MOST_PARAMETERS: usize = 16;
/// Speeds at which the torque is held against the configured one.
const SPEEDS: u32 = 40;

type Values = [f64; MOST_PARAMETERS];

/// How far the servo lets itself be told other friction. Every key may be left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TakeOverConfig {
    /// Largest change of a parameter, as a share of what is configured \[-\].
    pub parameter_share: f64,
    /// Largest change of the unloaded friction torque at any speed of its
    /// range, as a share of the configured one \[-\]. Below 1, so that friction
    /// stays friction.
    pub torque_share: f64,
    /// Largest standard error of a parameter that is taken over, as a share of
    /// what is configured \[-\].
    pub std_error_share: f64,
    /// Least excitation of a parameter that is taken over, 0 … 1 \[-\].
    pub least_excitation: f64,
    /// Time from one set of parameters to the other \[s\].
    pub time: f64,
}

impl Default for TakeOverConfig {
    fn default() -> Self {
        TakeOverConfig {
            parameter_share: 0.5,
            torque_share: 0.5,
            std_error_share: 0.05,
            least_excitation: 0.9,
            time: 2.0,
        }
    }
}

impl TakeOverConfig {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("parameter_share", self.parameter_share, 0.0, 10.0, "-")?;
        check("torque_share", self.torque_share, 0.0, 0.95, "-")?;
        check("std_error_share", self.std_error_share, 0.0, 1.0, "-")?;
        check("least_excitation", self.least_excitation, 0.0, 1.0, "-")?;
        check("time", self.time, 0.1, 600.0, "s")
    }
}

/// A parameter as it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundParameter<'a> {
    /// Its name; underscores do not count (`b0` is `b_0`).
    pub name: &'a str,
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// 0 where the motion told nothing of it, towards 1 where it told all \[1\].
    pub excitation: f64,
}

/// Why nothing is taken over.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TakeOverRefusal {
    /// No parameter of the servo's model is certain.
    #[error("no friction parameter is excited with a small standard error; move the joint longer")]
    NothingCertain,
    /// A parameter is too far from the configured one.
    #[error("{name} = {value:.4} is outside {lower:.4} … {upper:.4}")]
    Parameter {
        /// Which.
        name: &'static str,
        /// As found.
        value: f64,
        /// Least value allowed.
        lower: f64,
        /// Largest value allowed.
        upper: f64,
    },
    /// The torque is too far from the configured one.
    #[error("{torque:.2} Nm at {speed:.3} rad/s is outside {lower:.2} … {upper:.2} Nm")]
    Torque {
        /// At this speed \[rad/s\].
        speed: f64,
        /// With what was found \[Nm\].
        torque: f64,
        /// Least torque allowed \[Nm\].
        lower: f64,
        /// Largest torque allowed \[Nm\].
        upper: f64,
    },
}

/// One parameter of the friction that is fed forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FedForward {
    /// Its name in the arm's file.
    pub name: &'static str,
    /// By the arm's file.
    pub configured: f64,
    /// In use now.
    pub value: f64,
    /// What the value is, or is on its way to.
    pub target: f64,
}

/// Friction of one joint as it is fed forward. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct FeedForward {
    friction: Friction,
    config: TakeOverConfig,
    names: [&'static str; MOST_PARAMETERS],
    count: usize,
    configured: Values,
    from: Values,
    target: Values,
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
        parameters: &FrictionParameters,
        config: TakeOverConfig,
    ) -> Result<FeedForward, ParameterError> {
        config
            .validate()
            .map_err(|error| error.within("take_over"))?;
        let friction = Friction::new(parameters).map_err(|error| error.within("friction"))?;
        let mut configured = [0.0; MOST_PARAMETERS];
        friction.values(&mut configured);
        let mut names = [""; MOST_PARAMETERS];
        for (place, name) in names.iter_mut().zip(friction.names()) {
            *place = name;
        }
        Ok(FeedForward {
            count: friction.parameter_count().min(MOST_PARAMETERS),
            friction,
            config,
            names,
            configured,
            from: configured,
            target: configured,
            share: 1.0,
            taken_over: false,
        })
    }

    /// τ_F at `velocity` \[rad/s\] under the load `load` \[Nm\], the velocity
    /// held at the end of the range that friction is known in \[Nm\].
    pub fn torque(&self, velocity: f64, load: f64) -> f64 {
        let state = FrictionState {
            velocity,
            load,
            ..FrictionState::default()
        };
        self.friction.torque_within_range(&state).torque
    }

    /// Sets out for what was `found`; gives the number of parameters that are
    /// taken over. The others go back to what is configured.
    ///
    /// # Errors
    ///
    /// [`TakeOverRefusal`]; nothing changes then.
    pub fn take_over(&mut self, found: &[FoundParameter<'_>]) -> Result<usize, TakeOverRefusal> {
        let mut target = self.configured;
        let mut taken = 0;
        for (place, name) in target.iter_mut().zip(self.names).take(self.count) {
            let configured = *place;
            let certain = found
                .iter()
                .find(|own| is_same(own.name, name) && self.is_certain(own, configured));
            let Some(own) = certain else {
                continue;
            };
            let reach = self.config.parameter_share * configured.abs();
            let (lower, upper) = (configured - reach, configured + reach);
            if !(lower..=upper).contains(&own.value) {
                return Err(TakeOverRefusal::Parameter {
                    name,
                    value: own.value,
                    lower,
                    upper,
                });
            }
            *place = own.value;
            taken += 1;
        }
        if taken == 0 {
            return Err(TakeOverRefusal::NothingCertain);
        }
        self.check_torque(&target)?;
        self.set_out(target);
        self.taken_over = true;
        Ok(taken)
    }

    /// Sets out for what is configured.
    pub fn give_back(&mut self) {
        self.set_out(self.configured);
        self.taken_over = false;
    }

    /// One step of `dt` \[s\] on the way.
    pub fn step(&mut self, dt: f64) {
        if self.share >= 1.0 {
            return;
        }
        self.share = (self.share + dt.max(0.0) / self.config.time).min(1.0);
        let values = self.values();
        self.friction.set_values(&values[..self.count]);
    }

    /// Whether what was found elsewhere is in use, or on its way.
    pub fn is_taken_over(&self) -> bool {
        self.taken_over
    }

    /// Whether the values are on their way.
    pub fn is_on_the_way(&self) -> bool {
        self.share < 1.0
    }

    /// The parameters.
    pub fn parameters(&self) -> impl Iterator<Item = FedForward> + '_ {
        let values = self.values();
        (0..self.count).map(move |i| FedForward {
            name: self.names[i],
            configured: self.configured[i],
            value: values[i],
            target: self.target[i],
        })
    }

    fn is_certain(&self, own: &FoundParameter<'_>, configured: f64) -> bool {
        let most = self.config.std_error_share * configured.abs();
        // A number that is none fails every comparison.
        own.value.is_finite()
            && (0.0..=most).contains(&own.std_error)
            && own.excitation >= self.config.least_excitation
    }

    fn check_torque(&self, target: &Values) -> Result<(), TakeOverRefusal> {
        let [lower, upper] = self.friction.speed_range();
        for step in 0..=SPEEDS {
            let share = f64::from(step) / f64::from(SPEEDS);
            let speed = lower + share * (upper - lower);
            if speed <= 0.0 {
                continue;
            }
            let (configured, torque) = (
                self.unloaded(&self.configured, speed),
                self.unloaded(target, speed),
            );
            let reach = self.config.torque_share * configured.abs();
            if (torque - configured).abs() > reach {
                return Err(TakeOverRefusal::Torque {
                    speed,
                    torque,
                    lower: configured - reach,
                    upper: configured + reach,
                });
            }
        }
        Ok(())
    }

    /// τ_F of other `values` without load \[Nm\].
    fn unloaded(&self, values: &Values, speed: f64) -> f64 {
        let state = FrictionState {
            velocity: speed,
            ..FrictionState::default()
        };
        let mut row = [0.0; MOST_PARAMETERS];
        self.friction.regressor(&state, &mut row);
        let terms = row.iter().zip(values).take(self.count);
        terms.map(|(x, value)| x * value).sum()
    }

    fn values(&self) -> Values {
        let mut values = self.target;
        if self.share < 1.0 {
            for (value, from) in values.iter_mut().zip(&self.from) {
                *value = from + self.share * (*value - from);
            }
        }
        values
    }

    fn set_out(&mut self, target: Values) {
        self.from = self.values();
        self.target = target;
        self.share = 0.0;
    }
}

/// Whether two names are the same but for underscores.
fn is_same(a: &str, b: &str) -> bool {
    let letters = |text: &'_ str| -> [u8; 24] {
        let mut letters = [0; 24];
        let bytes = text.bytes().filter(|byte| *byte != b'_');
        for (place, byte) in letters.iter_mut().zip(bytes) {
            *place = byte;
        }
        letters
    };
    letters(a) == letters(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CONFIGURED: [(&str, &str, f64); 5] = [
        ("coulomb", "b_0", 12.372),
        ("load_coulomb", "b_0T", 0.146),
        ("viscous", "b_1", 163.301),
        ("quadratic_viscous", "b_2", -578.954),
        ("cubic_viscous", "b_3", 547.449),
    ];
    const NAMES: [&str; 5] = ["b0", "b0T", "b1", "b2", "b3"];

    fn feed_forward() -> FeedForward {
        let effects = CONFIGURED
            .iter()
            .map(|(effect, name, value)| {
                ((*effect).to_owned(), [((*name).to_owned(), *value)].into())
            })
            .collect();
        let parameters = FrictionParameters {
            speed_range: [0.0175, 0.698],
            effects,
        };
        FeedForward::new(&parameters, TakeOverConfig::default()).unwrap()
    }

    fn found(factor: f64) -> [FoundParameter<'static>; 5] {
        std::array::from_fn(|i| FoundParameter {
            name: NAMES[i],
            value: factor * CONFIGURED[i].2,
            std_error: 0.01 * CONFIGURED[i].2.abs(),
            excitation: 0.99,
        })
    }

    fn settle(own: &mut FeedForward) {
        for _ in 0..2_010 {
            own.step(1e-3);
        }
    }

    #[test]
    fn what_was_found_is_used_and_given_back_without_a_jump() {
        let mut own = feed_forward();
        let torque = |own: &FeedForward| own.torque(0.3, 5.0);
        let configured = torque(&own);
        assert_eq!(own.take_over(&found(1.3)), Ok(5));
        assert!(own.is_taken_over() && own.is_on_the_way());
        let mut last = torque(&own);
        assert_eq!(last, configured);
        for step in 0..4_000 {
            if step == 900 {
                // Back before it is there.
                own.give_back();
            }
            own.step(1e-3);
            let now = torque(&own);
            // 30 % of some 16 Nm in two seconds.
            assert!((now - last).abs() < 0.01, "{now} after {last}");
            last = now;
        }
        assert_eq!(last, configured);
        own.take_over(&found(1.3)).unwrap();
        settle(&mut own);
        assert!((torque(&own) / configured - 1.3).abs() < 1e-12);
        assert!(!own.is_on_the_way());
        own.give_back();
        settle(&mut own);
        assert_eq!(torque(&own), configured);
        assert!(own.parameters().all(|one| one.value == one.configured));
    }

    #[test]
    fn only_what_is_certain_is_taken_over() {
        let mut own = feed_forward();
        let mut some = found(1.2);
        some[1].excitation = 0.5;
        some[2].std_error = 0.2 * some[2].value;
        some[3].std_error = f64::NAN;
        some[4].value = f64::INFINITY;
        assert_eq!(own.take_over(&some), Ok(1));
        let targets: Vec<f64> = own.parameters().map(|one| one.target).collect();
        assert_eq!(targets[0], 1.2 * CONFIGURED[0].2);
        for i in 1..5 {
            assert_eq!(targets[i], CONFIGURED[i].2);
        }
        let before = own.clone();
        for all in [&mut some[..], &mut []] {
            for one in all.iter_mut() {
                one.excitation = 0.0;
            }
            assert_eq!(own.take_over(all), Err(TakeOverRefusal::NothingCertain));
        }
        assert_eq!(own.target, before.target);
    }

    #[test]
    fn what_is_too_far_away_is_refused_as_a_whole_and_by_name() {
        let mut own = feed_forward();
        let mut far = found(1.2);
        far[2].value = 1.6 * CONFIGURED[2].2;
        far[2].std_error = 0.0;
        match own.take_over(&far) {
            Err(TakeOverRefusal::Parameter { name: "b_1", .. }) => {}
            other => panic!("{other:?}"),
        }
        // Each within its bounds, together too much: less of what slows down.
        let mut together = found(1.0);
        together[2].value = 1.45 * CONFIGURED[2].2;
        together[3].value = 0.55 * CONFIGURED[3].2;
        let error = own.take_over(&together).unwrap_err();
        assert!(matches!(error, TakeOverRefusal::Torque { .. }), "{error}");
        assert!(error.to_string().contains("rad/s"));
        assert!(!own.is_taken_over() && !own.is_on_the_way());
    }

    proptest! {
        /// Whatever is found, what is fed forward is finite and against the motion.
        #[test]
        fn friction_stays_friction(
            values in prop::array::uniform5(0.4..1.6_f64),
            errors in prop::array::uniform5(0.0..0.1_f64),
            steps in 0..3_000,
        ) {
            let mut own = feed_forward();
            let all: [FoundParameter<'_>; 5] = std::array::from_fn(|i| FoundParameter {
                value: values[i] * CONFIGURED[i].2,
                std_error: errors[i] * CONFIGURED[i].2.abs(),
                ..found(1.0)[i]
            });
            let _ = own.take_over(&all);
            for _ in 0..steps {
                own.step(1e-3);
            }
            for step in 1..40 {
                let speed = 0.02 * f64::from(step);
                prop_assert!(own.torque(speed, 0.0) > 0.0);
                prop_assert!(own.torque(-speed, 0.0) < 0.0);
            }
        }
    }
}

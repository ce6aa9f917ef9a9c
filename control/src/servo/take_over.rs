//! How far the servo lets itself be told other friction, and why it does not.

use std::fmt;

use ferntast_model::friction::{Signal, StaticEffect};
use ferntast_model::parameters;

parameters! {
    /// How far the servo lets itself be told other friction. Every key may be left out.
    #[derive(Copy)]
    pub struct TakeOverConfig {
        /// Largest change of a parameter, as a share of what is configured \[-\].
        pub parameter_share: f64 [0.0..=10.0, "-"] = 0.5,
        /// Largest change of the unloaded friction torque at any speed of its
        /// range, as a share of the configured one \[-\]. Below 1, so that friction
        /// stays friction.
        pub torque_share: f64 [0.0..=0.95, "-"] = 0.5,
        /// Largest standard error of a parameter that is taken over, as a share of
        /// what is configured; of an effect that is not configured, as a share of its
        /// largest coefficient \[-\].
        pub std_error_share: f64 [0.0..=1.0, "-"] = 0.05,
        /// Least excitation of a parameter that is taken over, 0 … 1 \[-\].
        pub least_excitation: f64 [0.0..=1.0, "-"] = 0.9,
        /// Time from one set of parameters to the other \[s\].
        pub time: f64 [0.1..=600.0, "s"] = 2.0,
    }
}

impl TakeOverConfig {
    /// Whether what was found is certain, for a parameter of this `size`.
    pub(super) fn is_certain(&self, own: &FoundParameter<'_>, size: f64) -> bool {
        let most = self.std_error_share * size.abs();
        // A number that is none fails every comparison.
        own.value.is_finite()
            && (0.0..=most).contains(&own.std_error)
            && own.excitation >= self.least_excitation
    }
}

/// A parameter as it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundParameter<'a> {
    /// Its name in the catalogue: a coefficient or a shape parameter of an
    /// effect, or [`REFERENCE_TEMPERATURE`](ferntast_model::friction::REFERENCE_TEMPERATURE).
    pub name: &'a str,
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// 0 where the motion told nothing of it, towards 1 where it told all \[1\].
    pub excitation: f64,
}

/// Finds the value called `name`.
pub(super) fn value_of(found: &[FoundParameter<'_>], name: &str) -> Option<f64> {
    let own = found.iter().find(|own| own.name == name)?;
    own.value.is_finite().then_some(own.value)
}

/// What is taken over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TakenOver<'a> {
    /// Number of coefficients.
    pub count: usize,
    /// The first coefficient that cannot be fed forward, and why.
    pub left_out: Option<(&'a str, LeftOut)>,
}

/// Why a coefficient cannot be fed forward, however certain it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LeftOut {
    /// No function of what the joint is doing now (backlash, elasticity, a
    /// delay), or no friction (an inertia, the gain of a sensor).
    #[error("no static friction")]
    NotStatic,
    /// The servo does not know a signal that the effect reads.
    #[error("the servo does not know the {}", .0.name())]
    Unknown(Signal),
    /// A shape parameter, or T₀, was not told.
    #[error("its shape is not told")]
    NoShape,
}

/// Why nothing is taken over.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TakeOverRefusal {
    /// No parameter of the servo's model is certain.
    #[error("no friction parameter is excited with a small standard error; move the joint longer")]
    NothingCertain,
    /// Nothing of what was found can be fed forward; the reason of the first.
    #[error("nothing to feed forward: {0}")]
    NothingStatic(LeftOut),
    /// There are more effects than the servo holds.
    #[error("{effect} is one effect too many to feed forward")]
    TooMany {
        /// The effect.
        effect: &'static str,
    },
    /// A parameter is too far from the configured one.
    #[error(
        "{name} = {} {unit} is outside {} … {}: {rule}",
        Brief(*value), Brief(*lower), Brief(*upper)
    )]
    Parameter {
        /// Which.
        name: &'static str,
        /// As found.
        value: f64,
        /// Least value allowed.
        lower: f64,
        /// Largest value allowed.
        upper: f64,
        /// Unit of all three.
        unit: &'static str,
        /// What allows no more.
        rule: &'static str,
    },
    /// The torque is too far from the configured one.
    #[error(
        "{torque:.2} Nm at {speed:.3} rad/s is outside {lower:.2} … {upper:.2} Nm: [servo.take_over] torque_share"
    )]
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

/// A number in few letters, since what is refused is told in 96.
struct Brief(f64);

impl fmt::Display for Brief {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = if self.0.abs() < 10.0 { 4 } else { 2 };
        write!(f, "{:.digits$}", self.0)
    }
}

/// Why an effect is not among what is taken over.
pub(super) enum Declined {
    /// It alone is left out.
    LeftOut(LeftOut),
    /// All is refused for it.
    Refused(TakeOverRefusal),
}

impl From<LeftOut> for Declined {
    fn from(why: LeftOut) -> Self {
        Self::LeftOut(why)
    }
}

impl From<TakeOverRefusal> for Declined {
    fn from(refusal: TakeOverRefusal) -> Self {
        Self::Refused(refusal)
    }
}

/// The signal that `effect` reads and the servo has not: the date of the twin's
/// first recording, the temperature where nobody measures it.
pub(super) fn unknown_signal(effect: &StaticEffect, has_temperature: bool) -> Option<Signal> {
    if effect.reads(Signal::Date) {
        return Some(Signal::Date);
    }
    (effect.reads(Signal::Temperature) && !has_temperature).then_some(Signal::Temperature)
}

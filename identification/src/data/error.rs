//! Faults of recordings and models.

use thiserror::Error;

use super::{JointType, Subject};

/// Why a model cannot be bound to recordings.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PrepareError {
    /// No session at all.
    #[error("no session to fit; name at least one recording")]
    NoSession,
    /// A session is too short.
    #[error(
        "{session}: {samples} samples are too few, at least {needed} are needed; record longer or drop this session"
    )]
    TooFewSamples {
        /// Name of the session.
        session: String,
        /// Number of its samples.
        samples: usize,
        /// Smallest number of samples.
        needed: usize,
    },
    /// Channels of one session differ in length.
    #[error(
        "{session}: channel {channel} has {samples} samples, position has {expected}; sample all channels together"
    )]
    Length {
        /// Name of the session.
        session: String,
        /// Name of the channel.
        channel: String,
        /// Number of samples of the channel.
        samples: usize,
        /// Number of samples of the position.
        expected: usize,
    },
    /// A sampling period that is not a positive number.
    #[error("{session}: sampling period {period} s; it must be a positive number")]
    Period {
        /// Name of the session.
        session: String,
        /// The period \[s\].
        period: f64,
    },
    /// Sampling rates too different for a filter that counts in samples.
    #[error(
        "{slowest} has {slow:.1} Hz, {fastest} {fast:.1} Hz: the decimation of a stated [filter] is a number of samples, which is not the same time in both; leave [filter] out, or resample the faster recording"
    )]
    RatesWithFilter {
        /// Name of the session that is sampled slowest.
        slowest: String,
        /// Its rate \[Hz\].
        slow: f64,
        /// Name of the session that is sampled fastest.
        fastest: String,
        /// Its rate \[Hz\].
        fast: f64,
    },
    /// NaN or infinity in a channel.
    #[error(
        "{session}: channel {channel} is not a number at sample {sample}; cut it out or repair it"
    )]
    NotFinite {
        /// Name of the session.
        session: String,
        /// Name of the channel.
        channel: String,
        /// Index of the first such sample.
        sample: usize,
    },
    /// The joint, or the tip, never moved.
    #[error(
        "the {} is constant in every session: nothing can be learned from what is at rest; record motion",
        .0.signal("position")
    )]
    ConstantPosition(JointType),
    /// The motor torque, or the tangential force, is constant.
    #[error("the {} is constant in every session; is the right signal named?", .0.signal("motor_torque"))]
    ConstantForce(JointType),
    /// A contact without its normal force.
    #[error("a contact has a normal force; name it as signal normal_force")]
    NoNormalForce,
    /// The normal force is never positive.
    #[error(
        "the normal force is never above zero: the tip does not touch, or the sign is wrong (positive pushes the tip out)"
    )]
    NeverTouched,
    /// An inertia in the model of a contact.
    #[error("a contact has no inertia; leave it out of the model")]
    InertiaOfContact,
    /// Some sessions have a channel, others do not.
    #[error("channel {channel} is in {with} of {all} sessions; it must be in all or in none")]
    Mixed {
        /// Name of the channel.
        channel: String,
        /// Number of sessions that have it.
        with: usize,
        /// Number of sessions.
        all: usize,
    },
    /// The joint moved, yet hardly ever away from rest and reversals.
    #[error(
        "only {rows} moments of steady motion for {parameters} parameters: at {rate_hz:.0} Hz the filter that leaves \
         the acceleration quiet (cut-off {cut_off_hz:.1} Hz) looks {reach_s:.2} s to either side, and so long no stroke \
         begins, turns or ends; record longer strokes, or oftener, or with a finer encoder; or state another filter in \
         [filter] (butterworth_hz, decimation)"
    )]
    NothingExcited {
        /// Number of rows of the regression.
        rows: usize,
        /// Number of parameters of the model.
        parameters: usize,
        /// Samples in a second that are worked with \[Hz\].
        rate_hz: f64,
        /// Cut-off of the filter \[Hz\].
        cut_off_hz: f64,
        /// How far it looks to either side \[s\].
        reach_s: f64,
    },
    /// A given inertia that is not a positive number.
    #[error("inertia {0} kg m²; it must be zero or more, or fitted")]
    Inertia(f64),
    /// A gear ratio that is not a positive number.
    #[error("gear ratio {0}; it must be a positive number")]
    GearRatio(f64),
    /// No effect has this id.
    #[error("unknown effect {id:?}; the catalogue has {known}")]
    UnknownEffect {
        /// Id in the model.
        id: String,
        /// Ids of the catalogue, separated by commas.
        known: String,
    },
    /// An effect of a contact in the model of a joint, or the other way round.
    #[error(
        "effect {id:?} is one of {}, but what is recorded is {}; `ferntast lab effects` lists both",
        .of.name(), .recorded.name()
    )]
    OtherSubject {
        /// Id in the model.
        id: String,
        /// Subject of the effect.
        of: Subject,
        /// Subject of the recordings.
        recorded: Subject,
    },
    /// The same effect twice.
    #[error("effect {0:?} is in the model twice; name it once")]
    Twice(String),
    /// An effect that cannot be identified from these recordings.
    #[error("effect {id:?} cannot be fitted to these recordings: {why}")]
    Unavailable {
        /// Id of the effect.
        id: String,
        /// Property of the recordings that is missing, in words.
        why: String,
    },
    /// A formula that cannot be used.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}

/// Why a formula cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExpressionError {
    /// It does not parse.
    #[error("effect {effect:?}: cannot read the expression {expression:?}: {why}")]
    Syntax {
        /// Name of the effect.
        effect: String,
        /// The expression.
        expression: String,
        /// The fault and its place.
        why: String,
    },
    /// Parameters neither enter linearly nor have bounds.
    #[error(
        "effect {effect:?}: {} not enter linearly. A name that is no signal is a parameter; the recordings have the signals {signals}: is one misspelt? If not, give bounds, like {} = [0.005, 0.2]",
        listed(.parameters), .parameters.last().map_or("vs", String::as_str)
    )]
    NotLinear {
        /// Name of the effect.
        effect: String,
        /// The parameter, or those that enter linearly each, but not together.
        parameters: Vec<String>,
        /// Names of the recorded signals, separated by commas.
        signals: String,
    },
    /// No parameter enters linearly, so that there is nothing to fit.
    #[error(
        "effect {effect:?}: the expression {expression:?} has no parameter that enters linearly; write a*({expression})"
    )]
    NoParameter {
        /// Name of the effect.
        effect: String,
        /// The expression.
        expression: String,
    },
    /// More parameters of one kind than are supported.
    #[error("effect {effect:?}: {count} parameters of one kind, at most {most} are possible")]
    TooMany {
        /// Name of the effect.
        effect: String,
        /// Number of parameters.
        count: usize,
        /// Largest number of parameters.
        most: usize,
    },
    /// Bounds that leave no value.
    #[error(
        "effect {effect:?}: bounds [{lower}, {upper}] of {parameter:?} exclude every value; the lower must be below the upper"
    )]
    Bounds {
        /// Name of the effect.
        effect: String,
        /// The parameter.
        parameter: String,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Bounds for a name that the expression does not have.
    #[error("effect {effect:?}: bounds for {parameter:?}, which the expression does not have")]
    UnusedBounds {
        /// Name of the effect.
        effect: String,
        /// The parameter.
        parameter: String,
    },
    /// A signal that the recordings lack.
    #[error(
        "effect {effect:?} needs {signal:?}, which the recordings do not have; they have {known}"
    )]
    MissingSignal {
        /// Name of the effect.
        effect: String,
        /// The signal.
        signal: String,
        /// Names of the recorded signals, separated by commas.
        known: String,
    },
    /// The expression is not a number somewhere on these recordings.
    #[error(
        "effect {effect:?}: the expression is not a number at {session}, {time:.3} s; keep roots, logarithms and quotients defined"
    )]
    NotFinite {
        /// Name of the effect.
        effect: String,
        /// The session.
        session: String,
        /// Time in it \[s\].
        time: f64,
    },
}

/// The names with their verb.
fn listed(names: &[String]) -> String {
    match names {
        [one] => format!("the parameter {one:?} does"),
        many => format!("the parameters {} together do", many.join(", ")),
    }
}

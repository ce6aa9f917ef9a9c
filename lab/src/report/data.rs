//! What a report shows.

use serde::Serialize;

/// Everything on the page. Sections without content are left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// The answer.
    pub verdict: Option<Verdict>,
    /// Numbers to see first, such as the error on data held out.
    pub figures: Vec<Figure>,
    /// What becomes of the samples.
    pub used: Vec<Share>,
    /// What has to be known before anything here is believed.
    pub warnings: Vec<String>,
    /// The model's equation, version and data.
    pub about: Vec<About>,
    /// Measured against model, one a session.
    pub traces: Vec<Trace>,
    /// The residual over one signal each.
    pub maps: Vec<ResidualMap>,
    /// Effects that may be missing, the best first.
    pub candidates: Vec<Candidate>,
    /// Where nothing explains the rest: effects that take a part of it.
    pub helps_in_part: Vec<Candidate>,
    /// Effects that were tried and are not named.
    pub rivals: Vec<Rival>,
    /// What the residual depends on though no effect explains it.
    pub dependences: Vec<Dependence>,
    /// How the error fell, the first experiment first.
    pub history: Vec<HistoryPoint>,
    /// The fitted parameters.
    pub parameters: Vec<Parameter>,
    /// Where the model fails most.
    pub worst: Vec<Window>,
    /// What should be known besides.
    pub notes: Vec<String>,
}

/// The answer of a diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// `missing`, `complete` or `unexplained`.
    pub kind: String,
    /// The same as a sentence.
    pub text: String,
}

/// Samples of one fate.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Share {
    /// What becomes of them.
    pub what: String,
    /// How many they are.
    pub samples: usize,
    /// Part of all samples \[0 … 1\].
    pub share: f64,
    /// Whether the verdict rests on them.
    pub used: bool,
}

/// Something to know of the model or its origin.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct About {
    /// What.
    pub name: String,
    /// Its formula, number or text.
    pub value: String,
}

/// An effect that was tried and is not named.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Rival {
    /// Its id.
    pub effect: String,
    /// Part of the residual's mean square that it explains \[0 … 1\].
    pub share: f64,
    /// Probability of such a gain by chance.
    pub p_value: f64,
    /// Why it is not named.
    pub why: String,
}

/// A stretch of time that is shaded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shade {
    /// Its begin \[s\].
    pub from: f64,
    /// Its end \[s\].
    pub to: f64,
    /// `not used` or `validates`.
    pub what: &'static str,
}

/// One number with its name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// What it is.
    pub label: String,
    /// The number as it should be read.
    pub value: String,
    /// A line below it; may be empty.
    pub note: String,
}

/// Curves over time of one session.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trace {
    /// The session.
    pub title: String,
    /// Unit of the values.
    pub unit: String,
    /// Time of the first sample \[s\].
    pub start: f64,
    /// Sampling period \[s\].
    pub period: f64,
    /// The curves; one name has one colour on the whole page. Values that are
    /// not finite leave a hole.
    pub curves: Vec<Curve>,
    /// What is not used, and what validates.
    pub shades: Vec<Shade>,
}

/// A curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Curve {
    /// Its name: measured, model, residual.
    pub name: String,
    /// Its values, one a sample.
    pub values: Vec<f64>,
}

/// The residual over one signal, in bins.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ResidualMap {
    /// The signal.
    pub signal: String,
    /// Its unit.
    pub signal_unit: String,
    /// Unit of the residual.
    pub unit: String,
    /// The bins, in ascending order.
    pub bins: Vec<Bin>,
}

/// One bin of a residual map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Bin {
    /// The signal in the middle of the bin.
    pub center: f64,
    /// Mean of the residual.
    pub mean: f64,
    /// Standard deviation of the residual.
    pub spread: f64,
    /// Samples.
    pub count: u64,
}

/// An effect that may be missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Candidate {
    /// Its id.
    pub effect: String,
    /// Error on data held out, without it.
    pub held_out_before: f64,
    /// The same with it.
    pub held_out_after: f64,
    /// Unit of both.
    pub unit: String,
    /// Probability of such a gain by chance.
    pub p_value: f64,
    /// What it cannot be distinguished from.
    pub indistinguishable_from: Vec<String>,
    /// What would separate them; may be empty.
    pub separate_by: String,
}

/// What the residual depends on.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Dependence {
    /// One signal or a pair.
    pub signals: Vec<String>,
    /// Of what swings with time: its period \[s\].
    pub period_s: Option<f64>,
    /// Part of the residual's mean square that they explain \[0 … 1\].
    pub strength: f64,
}

/// One experiment of a chain.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HistoryPoint {
    /// The effect that was added, or how it began.
    pub label: String,
    /// Error on data held out.
    pub held_out: f64,
    /// Its unit.
    pub unit: String,
}

/// A fitted parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard error; `None` where it could not be determined.
    pub std_error: Option<f64>,
    /// Interval that holds the true value with a probability of 95 %.
    pub interval_95: Option<[f64; 2]>,
    /// The effect that it belongs to.
    pub effect: String,
    /// Unit of both.
    pub unit: String,
    /// Whether the data say anything about it.
    pub excited: bool,
}

/// A stretch of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Window {
    /// The session.
    pub session: String,
    /// Its begin \[s\].
    pub start: f64,
    /// Its end \[s\].
    pub end: f64,
    /// Error in it.
    pub rms: f64,
    /// Its unit.
    pub unit: String,
}

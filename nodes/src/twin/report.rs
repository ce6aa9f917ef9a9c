//! What the twin says of itself: on its topic, in words, and in a summary.

use std::fmt;

use ferntast_identification::twin::{Change, ChangeKind, Twin, TwinParameter};
use ferntast_msgs::{
    Text, Time,
    sample::{MAX_TWIN_PARAMETERS, TwinParametersSample, TwinVerdict},
};
use serde::Serialize;

use super::assess::Assessment;

/// The message on `/twin/parameters`, and the words on `/diagnostics`: empty
/// while all is well. `goes_with` is the signal that the residual goes with now,
/// for where the lab has not told it.
pub(super) fn of(
    twin: &Twin,
    joint: &str,
    stamp: Time,
    assessment: &Assessment,
    goes_with: Option<&str>,
) -> (TwinParametersSample, Text<96>) {
    let mut sample = TwinParametersSample {
        residual_rms: twin.residual_rms(),
        band: twin.band(),
        out_of_band: u8::from(twin.out_of_band()),
        verdict: assessment.code(),
        assessed_at: assessment.at,
        candidate: assessment.candidate,
        goes_with: match assessment.goes_with.is_empty() && twin.out_of_band() {
            true => Text::new(goes_with.unwrap_or_default()),
            false => assessment.goes_with,
        },
        joint: Text::new(joint),
        ..TwinParametersSample::initial(stamp)
    };
    let parameters = twin.parameters();
    sample.count = parameters.len().min(MAX_TWIN_PARAMETERS) as u32;
    for (i, parameter) in parameters.iter().take(MAX_TWIN_PARAMETERS).enumerate() {
        sample.names[i] = Text::new(&parameter.name);
        sample.values[i] = parameter.value;
        sample.off_line[i] = parameter.off_line;
        sample.std_errors[i] = parameter.std_error;
        sample.excitation[i] = parameter.excitation;
    }
    let change = twin.change();
    let mut unit = "";
    if let Some(change) = &change {
        sample.changed = Text::new(&change.parameter);
        sample.change_kind = Text::new(match change.kind {
            ChangeKind::Step => "step",
            ChangeKind::Drift => "drift",
        });
        sample.change_before = change.before;
        sample.change_after = change.now;
        sample.change_time = change.time;
        let own = parameters.iter().find(|own| own.name == change.parameter);
        unit = own.map_or("", |own| own.unit.as_str());
    }
    let words = Description {
        sample: &sample,
        change: change.as_ref(),
        unit,
        at_bound: parameters.iter().find(|own| own.at_bound),
    };
    let words = Text::display(&words);
    (sample, words)
}

struct Description<'a> {
    sample: &'a TwinParametersSample,
    change: Option<&'a Change>,
    unit: &'a str,
    at_bound: Option<&'a TwinParameter>,
}

impl fmt::Display for Description<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sample = self.sample;
        if let Some(own) = self.at_bound {
            write!(f, "{} is held at {:.3}; ", own.name, own.value)?;
        }
        let missing = sample.verdict == TwinVerdict::MISSING;
        let unexplained = sample.verdict == TwinVerdict::UNEXPLAINED;
        if sample.out_of_band == 1 || missing || unexplained {
            let (rms, band) = (sample.residual_rms, sample.band);
            write!(f, "residual {rms:.2} Nm, band {band:.2}")?;
            if !sample.goes_with.is_empty() {
                write!(f, ", with {}", sample.goes_with)?;
            }
        }
        if missing {
            write!(f, "; missing {}", sample.candidate)?;
        }
        if unexplained {
            write!(f, "; no known effect")?;
        }
        if let Some(change) = self.change {
            let kind = match change.kind {
                ChangeKind::Step => "stepped",
                ChangeKind::Drift => "drifted",
            };
            if sample.out_of_band == 1 || missing || unexplained {
                write!(f, "; ")?;
            }
            write!(
                f,
                "{} {kind} from {:.3} to {:.3} {} at {:.0} s",
                change.parameter, change.before, change.now, self.unit, change.time
            )?;
        }
        Ok(())
    }
}

/// The twin in the result of a command.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TwinSummary {
    /// The joint that it follows.
    pub joint: String,
    /// Latest residuals, root mean square \[Nm\].
    #[serde(rename = "residual_rms_Nm")]
    pub residual_rms: f64,
    /// Standard deviation of the residual off line \[Nm\].
    #[serde(rename = "band_Nm")]
    pub band: f64,
    /// Whether the residual has left its band.
    pub out_of_band: bool,
    /// The parameters.
    pub parameters: Vec<ParameterSummary>,
    /// The parameter that moved; `null` where none did.
    pub change: Option<ChangeSummary>,
    /// `pending`, `complete`, `missing` or `unexplained`.
    pub verdict: String,
    /// When the lab gave it, after the first sample \[s\]; `null` before.
    pub assessed_at_s: Option<f64>,
    /// The missing effect.
    pub candidate: Option<String>,
    /// Signals that the residual depends on most.
    pub goes_with: Option<String>,
}

/// A parameter in the summary.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterSummary {
    /// Name as in the lab.
    pub name: String,
    /// Value now.
    pub value: f64,
    /// Value off line.
    pub off_line: f64,
    /// Standard error of the value.
    pub std_error: f64,
    /// 0 where the motion told nothing of it, towards 1 where it told all \[1\].
    pub excitation: f64,
}

/// A change in the summary.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeSummary {
    /// The parameter.
    pub parameter: String,
    /// `step` or `drift`.
    pub kind: String,
    /// Value before.
    pub before: f64,
    /// Value after.
    pub after: f64,
    /// When half of the way was done, after the first sample \[s\].
    pub time_s: f64,
}

impl TwinSummary {
    /// Of the last message on `/twin/parameters`.
    pub fn of(sample: &TwinParametersSample) -> Self {
        let text = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        let parameters = (0..sample.len()).map(|i| ParameterSummary {
            name: sample.names[i].to_string(),
            value: sample.values[i],
            off_line: sample.off_line[i],
            std_error: sample.std_errors[i],
            excitation: sample.excitation[i],
        });
        Self {
            joint: sample.joint.to_string(),
            residual_rms: sample.residual_rms,
            band: sample.band,
            out_of_band: sample.out_of_band == 1,
            parameters: parameters.collect(),
            change: text(sample.changed.as_str()).map(|parameter| ChangeSummary {
                parameter,
                kind: sample.change_kind.to_string(),
                before: sample.change_before,
                after: sample.change_after,
                time_s: sample.change_time,
            }),
            verdict: sample.verdict.name().unwrap_or_default().to_owned(),
            assessed_at_s: (sample.verdict != TwinVerdict::PENDING).then_some(sample.assessed_at),
            candidate: text(sample.candidate.as_str()),
            goes_with: text(sample.goes_with.as_str()),
        }
    }
}

impl fmt::Display for TwinSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "twin      {}: residual {:.2} Nm, band {:.2} Nm, {}",
            self.joint, self.residual_rms, self.band, self.verdict
        )?;
        if let Some(candidate) = &self.candidate {
            write!(f, " {candidate}")?;
        }
        if let Some(signals) = &self.goes_with {
            write!(f, ", goes with {signals}")?;
        }
        if let Some(change) = &self.change {
            write!(
                f,
                "; {} {} from {:.3} to {:.3} at {:.0} s",
                change.parameter, change.kind, change.before, change.after, change.time_s
            )?;
        }
        Ok(())
    }
}

//! Work that may take long: answers come line by line.

use std::{convert::Infallible, sync::Arc};

use axum::{
    Json,
    body::Body,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use ferntast_identification::{
    Comparison, Diagnosis,
    arm::ArmTerm,
    comparison::VariesTogether,
    fit::{Implausible, Pair},
};
use ferntast_lab::{
    report,
    work::{self, Opened},
};
use futures_util::stream;
use serde::{Deserialize, Serialize};
use serde_json::json;
use tokio::sync::mpsc;

use super::{
    Joint, Lab, LabError,
    drawing::{Drawing, MAX_POINTS},
    step_back,
};

/// Says how much is done.
pub(super) type Progress<'a> = &'a mut dyn FnMut(f64);

/// Does `work` when it is its turn, and answers in lines of JSON. If nobody
/// reads any more, it goes on to its end: what it writes is whole.
pub(super) fn in_lines<T: Serialize>(
    lab: &Arc<Lab>,
    work: impl FnOnce(&Lab, Progress<'_>) -> Result<T, LabError> + Send + 'static,
) -> Response {
    let (lines, reader) = mpsc::unbounded_channel::<String>();
    let lab = lab.clone();
    tokio::spawn(async move {
        let turn = lab.turn.clone();
        let Ok(_permit) = turn.acquire().await else {
            return;
        };
        let broken = lines.clone();
        let done = tokio::task::spawn_blocking(move || {
            step_back();
            let mut told = 0.0;
            let result = work(&lab, &mut |share: f64| {
                if share - told >= 0.01 {
                    told = share;
                    say(&lines, &json!({ "progress": share }));
                }
            });
            match result {
                Ok(result) => say(&lines, &Done { result }),
                Err(error) => say(&lines, &json!({ "error": error.to_string() })),
            }
        });
        if done.await.is_err() {
            say(&broken, &json!({ "error": LabError::Broken.to_string() }));
        }
    });
    let body = stream::unfold(reader, |mut reader| async move {
        let line = reader.recv().await?;
        Some((Ok::<_, Infallible>(line), reader))
    });
    let kind = [(header::CONTENT_TYPE, "application/x-ndjson")];
    (kind, Body::from_stream(body)).into_response()
}

/// The last line.
#[derive(Serialize)]
struct Done<T> {
    result: T,
}

fn say(lines: &mpsc::UnboundedSender<String>, value: &impl Serialize) {
    let Ok(line) = serde_json::to_string(value) else {
        return;
    };
    // Nobody reads any more: then nobody has to be told.
    let _ = lines.send(line + "\n");
}

/// The experiment on one joint, and what to do with it.
fn with_joint<T>(
    lab: &Lab,
    joint: &Joint,
    work: impl FnOnce(&Opened) -> Result<T, LabError>,
) -> Result<T, LabError> {
    let opened = lab.open(&joint.path)?;
    let one = opened.joints.get(joint.joint);
    let one = one.ok_or_else(|| joint.missing())?;
    work(one)
}

/// The model against the recordings, and curves to draw.
#[derive(Serialize)]
struct Compared {
    comparison: Comparison,
    /// What of the samples is left out: reason in words, share.
    left_out: Vec<(&'static str, f64)>,
    /// What has to be known of signals and parameters, as sentences.
    warnings: Vec<String>,
    drawings: Vec<Drawing>,
}

/// Holds the model against the recordings, with curves to draw.
pub async fn compare(State(lab): State<Arc<Lab>>, Json(joint): Json<Joint>) -> Response {
    in_lines(&lab, move |lab, progress| {
        progress(0.05);
        with_joint(lab, &joint, |opened| {
            progress(0.3);
            let sessions = opened.dataset.sessions.len() + opened.dataset.held_out.len();
            let comparison = opened.compare_drawing(MAX_POINTS / sessions.max(1))?;
            let drawings: Vec<Drawing> = comparison.series.iter().map(Drawing::of).collect();
            let used = &comparison.used;
            let share = |samples: usize| samples as f64 / used.samples.max(1) as f64;
            let left_out = used.left_out().into_iter();
            let soundness = &comparison.soundness;
            let implausible = soundness.implausible.iter().map(Implausible::text);
            let pairs = soundness.inseparable.iter().map(Pair::text);
            let together = comparison.varies_together.iter().map(VariesTogether::text);
            Ok(Compared {
                left_out: left_out
                    .map(|(reason, samples)| (reason.text(), share(samples)))
                    .collect(),
                warnings: together.chain(implausible).chain(pairs).collect(),
                comparison,
                drawings,
            })
        })
    })
}

/// Tells which effect is missing, with the claim and warnings in words.
pub async fn diagnose(State(lab): State<Arc<Lab>>, Json(joint): Json<Joint>) -> Response {
    in_lines(&lab, move |lab, progress| {
        with_joint(lab, &joint, |opened| {
            let diagnosis = opened.diagnose_at_cutoffs(progress)?;
            Ok(Diagnosed {
                claim: diagnosis.claim(),
                warning: diagnosis.cutoff_warning(),
                together: diagnosis
                    .varies_together
                    .iter()
                    .map(VariesTogether::text)
                    .collect(),
                diagnosis,
            })
        })
    })
}

/// A diagnosis, and what it claims.
#[derive(Serialize)]
struct Diagnosed {
    #[serde(flatten)]
    diagnosis: Diagnosis,
    claim: String,
    /// Where the verdict depends on the filter.
    warning: Option<String>,
    /// What varies together from session to session, as sentences.
    together: Vec<String>,
}

/// Decides what chance is taken to be when formulas are searched, as for the
/// command line unless another is asked for.
const SEED: u64 = 1;

/// Proposes formulas for what no effect of the catalogue explains.
pub async fn discover(State(lab): State<Arc<Lab>>, Json(joint): Json<Joint>) -> Response {
    in_lines(&lab, move |lab, progress| {
        with_joint(lab, &joint, |opened| Ok(opened.discover(SEED, progress)?))
    })
}

/// What is to be added to which experiment.
#[derive(Debug, Deserialize)]
pub struct Addition {
    #[serde(flatten)]
    joint: Joint,
    /// An id, or `NAME=EXPRESSION`.
    effect: String,
    /// `NAME=LOW,HIGH` of parameters that are searched.
    #[serde(default)]
    bounds: Vec<String>,
    /// It is called as in an arm's file: `payload`, `stribeck@elbow`.
    #[serde(default)]
    of_arm: bool,
    /// The new file; else beside the old one.
    #[serde(default)]
    output: Option<String>,
}

/// Adds an effect, in an arm's file to one joint unless it is said to be the arm's, and writes the
/// new experiment file.
pub async fn add(State(lab): State<Arc<Lab>>, Json(addition): Json<Addition>) -> Response {
    in_lines(&lab, move |lab, progress| {
        let effect = work::own_effect(&addition.effect, &addition.bounds)?;
        let parent = lab.there(&addition.joint.path)?;
        let output = |name: &str| match &addition.output {
            Some(output) => lab.new_file(output),
            None => Ok(work::beside(&parent, name)),
        };
        progress(0.1);
        let opened = lab.open(&addition.joint.path)?;
        let (output, added) = match &opened.arm {
            Some(arm) => {
                let term = match addition.of_arm {
                    true => ArmTerm::of(&effect),
                    false => arm
                        .of_joint(effect, addition.joint.joint)
                        .ok_or_else(|| addition.joint.missing())?,
                };
                let output = output(&term.to_string())?;
                let added = json!(arm.add(&term, &output)?);
                (output, added)
            }
            None => {
                let output = output(effect.name())?;
                let add = |opened: &Opened| Ok(opened.add(&effect, &output)?);
                let added = json!(with_joint(lab, &addition.joint, add)?);
                (output, added)
            }
        };
        Ok(json!({ "path": lab.name(&output), "added": added }))
    })
}

/// Makes the report's page; the browser saves it.
pub async fn report(State(lab): State<Arc<Lab>>, Json(joint): Json<Joint>) -> Response {
    in_lines(&lab, move |lab, progress| {
        with_joint(lab, &joint, |opened| {
            let comparison = opened.compare()?;
            let diagnosis: Diagnosis = opened.diagnose_at_cutoffs(progress)?;
            let report = report::assemble(opened, &comparison, &diagnosis)?;
            Ok(json!({ "html": report::render(&report)? }))
        })
    })
}

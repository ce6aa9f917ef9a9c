//! What changed of a whole arm: of the arm, and of each of its joints.

use std::collections::BTreeMap;

use ferntast_identification::{
    Verdict,
    arm::{self, ArmComparison, ArmDiagnosis, ArmSpec},
    fit::Parameter,
};

use super::{
    super::{OpenedArm, WorkError},
    BY_BLOCKS, Point, Trend, TrendError,
    changes::{courses, turns},
    or_by_its_own,
    parts::{Part, days, parts},
    same_units,
};

/// What was found of one part.
struct Found {
    comparison: ArmComparison,
    diagnosis: Option<ArmDiagnosis>,
}

/// The trend of the arm, whose effects no joint alone has, and of each joint, over `files`.
/// The same model is fitted to all of each part, which is diagnosed, too, if `diagnoses`; `progress`
/// is called with the share done, 0 … 1.
///
/// # Errors
///
/// [`TrendError`].
pub fn trends_of_arm(
    files: &[OpenedArm],
    diagnoses: bool,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Trend>, TrendError> {
    let all: Vec<&OpenedArm> = files.iter().collect();
    let Some(first) = files.first() else {
        return Err(TrendError::One(String::new()));
    };
    let joints = &first.dataset.joints;
    if let Some(other) = files.iter().find(|own| own.dataset.joints != *joints) {
        let others = &other.dataset.joints;
        return Err(TrendError::Arms(joints.join(", "), others.join(", ")));
    }
    same_units::of_experiments(&all)?;
    let parts = parts(&all)?;
    let spec = spec_of_all(files, &first.spec);
    let mut notes = Vec::new();
    let mut found = Vec::new();
    let share = 1.0 / parts.len() as f64;
    for (number, part) in parts.iter().enumerate() {
        let comparison = fitted(part, &spec, &mut notes)?;
        let mut step = |done: f64| progress(share * (number as f64 + done));
        let diagnosis = match diagnoses.then(|| arm::diagnose(&part.data, &spec, &mut step)) {
            Some(Err(why)) => {
                notes.push(format!("{}: not diagnosed: {why}", part.name));
                None
            }
            told => told.and_then(Result::ok),
        };
        found.push(Found {
            comparison,
            diagnosis,
        });
        step(1.0);
    }
    if parts.iter().any(|part| part.data.sessions.len() < 3) {
        notes.push(BY_BLOCKS.to_owned());
    }
    let subjects = std::iter::once(None).chain(joints.iter().map(|own| Some(own.as_str())));
    let each = subjects.map(|joint| {
        let points = parts.iter().zip(&found).map(|(part, found)| Point {
            name: part.name.clone(),
            days: days(&parts, part),
            sessions: part.data.sessions.len(),
            temperature: None,
            held_out: found.held_out(joint),
            parameters: found.parameters(joint),
            verdict: found.verdict(joint),
            missing: found.missing(joint),
        });
        let points: Vec<Point> = points.collect();
        same_units::of_parameters(&parts, &points)?;
        Ok(Trend {
            title: joint.map_or_else(|| first.experiment.title.clone(), str::to_owned),
            unit: first.unit_of(joint),
            effects: effects(&spec, joint, &found),
            parameters: courses(&points),
            came_or_went: turns(&points),
            points,
            notes: match joint {
                None => notes.clone(),
                Some(_) => Vec::new(),
            },
        })
    });
    each.collect()
}

impl Found {
    /// Error on rows left out, of a joint or of all.
    fn held_out(&self, joint: Option<&str>) -> f64 {
        let own = joint.and_then(|joint| self.comparison.joints.get(joint));
        own.map_or(self.comparison.rms.held_out, |own| own.rms.held_out)
    }

    /// Parameters of a joint, or of the effects of the arm: `payload.mass`.
    fn parameters(&self, joint: Option<&str>) -> BTreeMap<String, Parameter> {
        let Some(joint) = joint else {
            let each = self.comparison.arm.iter().flat_map(|(effect, own)| {
                own.iter()
                    .map(move |(name, value)| (format!("{effect}.{name}"), value.clone()))
            });
            return each.collect();
        };
        let own = self.comparison.joints.get(joint);
        own.map_or_else(Default::default, |own| own.parameters.clone())
    }

    fn verdict(&self, joint: Option<&str>) -> Option<Verdict> {
        let found = self.diagnosis.as_ref()?;
        match joint {
            Some(joint) => found.joints.get(joint).map(|own| own.verdict),
            None => Some(found.verdict),
        }
    }

    /// The first effect that is named, of a joint or of the arm.
    fn missing(&self, joint: Option<&str>) -> Option<String> {
        let mut all = self.diagnosis.as_ref()?.candidates.iter();
        let own = all.find(|own| own.joint.as_deref() == joint)?;
        Some(own.named.effect.clone())
    }
}

/// Names of the effects of the model that are a joint's, or the arm's.
fn effects(spec: &ArmSpec, joint: Option<&str>, found: &[Found]) -> Vec<String> {
    let is_of_arm = |name: &String| {
        let mut parts = found.iter();
        parts.any(|own| own.comparison.arm.contains_key(name))
    };
    let terms = spec.effects.iter().filter_map(|own| {
        let name = own.to_string();
        match (joint, is_of_arm(&name)) {
            (None, true) => Some(name),
            (Some(joint), false) => {
                let is_own = own.joint.as_ref().is_none_or(|other| other == joint);
                is_own.then(|| own.effect.name().to_owned())
            }
            _ => None,
        }
    });
    terms.collect()
}

/// All effects that any of the experiments has; the rest as the first one has it.
fn spec_of_all(files: &[OpenedArm], first: &ArmSpec) -> ArmSpec {
    let mut spec = first.clone();
    for term in files.iter().flat_map(|own| &own.spec.effects) {
        if !(spec.effects.iter()).any(|own| own.to_string() == term.to_string()) {
            spec.effects.push(term.clone());
        }
    }
    spec
}

/// The model fitted to a part; where that cannot be, the experiment's own.
fn fitted(
    part: &Part<'_, OpenedArm>,
    spec: &ArmSpec,
    notes: &mut Vec<String>,
) -> Result<ArmComparison, WorkError> {
    let own = || {
        let own = arm::compare(&part.data, &part.opened.spec);
        own.map_err(|error| part.opened.refuse(error))
    };
    let of_all = arm::compare(&part.data, spec);
    let found = or_by_its_own(&part.name, of_all, own, notes)?;
    let told = part.opened.tell_misread(&found.misread);
    notes.extend(
        told.into_iter()
            .map(|line| format!("{}: {line}", part.name)),
    );
    Ok(found)
}

//! Equivalents: effects that these data cannot distinguish.

use ferntast_model::friction::Proposal;

use super::candidates::{Candidate, SUSPECT_MAX_P_VALUE};
use crate::design::{Design, PreparedModel, columns};
use crate::numerics::statistics::mean_error;

/// Two gains are equal if they differ by fewer standard errors than this.
const MAX_GAIN_DIFFERENCE: f64 = 2.0;
/// Smallest ratio of an equivalent's gain to that of the best …
const MIN_GAIN_RATIO: f64 = 0.85;
/// … and largest ratio of the mean squares that they leave.
pub(super) const MAX_REMAINDER_RATIO: f64 = 1.05;
/// Smallest share of the mean square that a suspect explains.
const SUSPECT_MIN_SHARE: f64 = 0.2;
/// A suspect is equivalent to the best if the ratio of their gains is above this …
const SUSPECT_MIN_GAIN_RATIO: f64 = 0.5;
/// … and the gains differ by fewer standard errors than this: 5 % with the five
/// degrees of freedom of six sessions.
const SUSPECT_MAX_GAIN_DIFFERENCE: f64 = 2.571;

/// Number of free parameters.
fn freedom(candidate: &Candidate) -> usize {
    candidate.effect.freedom()
}

/// Difference of two gains in standard errors, paired fold by fold.
fn difference(design: &Design, a: &Candidate, b: &Candidate) -> f64 {
    let (a, b) = (
        by_fold(design, &a.score.gains),
        by_fold(design, &b.score.gains),
    );
    let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
    let (mean, error) = mean_error(&differences);
    if mean == 0.0 {
        0.0
    } else {
        mean / error.max(1e-300)
    }
}

/// Gains summed over each fold; they come block by block within folds, or one a fold.
fn by_fold(design: &Design, gains: &[f64]) -> Vec<f64> {
    if gains.len() == design.folds.len() {
        return gains.to_vec();
    }
    let mut at = 0;
    design
        .folds
        .iter()
        .map(|fold| {
            let sum = gains.iter().skip(at).take(fold.len()).sum();
            at += fold.len();
            sum
        })
        .collect()
}

/// Whether `other` explains the data as well as `best` does: the mean squares that
/// they leave are nearly equal, or the difference is within its own error.
pub fn as_good(design: &Design, best: &Candidate, other: &Candidate) -> bool {
    let left = |c: &Candidate| (c.score.before - c.score.gain).max(1e-300);
    let ratio = other.score.gain / best.score.gain.max(1e-300);
    let (less, more) = if ratio < 1.0 {
        (best, other)
    } else {
        (other, best)
    };
    ratio > MIN_GAIN_RATIO
        && ratio < MIN_GAIN_RATIO.recip()
        && (left(more) < MAX_REMAINDER_RATIO * left(less)
            || difference(design, best, other).abs() < MAX_GAIN_DIFFERENCE)
}

/// Sorts by gain, then puts the simplest of those that are as good as the best first.
pub fn order(design: &Design, passing: &mut Vec<Candidate>) {
    passing.sort_by(|a, b| b.score.gain.total_cmp(&a.score.gain));
    let Some(best) = passing.first().cloned() else {
        return;
    };
    let simplest = passing
        .iter()
        .enumerate()
        .filter(|(_, c)| freedom(c) < freedom(&best) && as_good(design, &best, c))
        .min_by_key(|(at, c)| (freedom(c), *at))
        .map(|(at, _)| at);
    if let Some(at) = simplest {
        let first = passing.remove(at);
        passing.insert(0, first);
    }
}

/// Effects that show between sessions and explain much without being significant:
/// a handful of sessions has little power.
pub fn suspects(tried: &[Candidate]) -> impl Iterator<Item = &Candidate> {
    tried.iter().filter(|c| {
        c.effect.row().is_between_sessions()
            && c.plausible
            && c.score.share() > SUSPECT_MIN_SHARE
            && c.score.p_value < SUSPECT_MAX_P_VALUE
    })
}

/// Whether the random variation between sessions may have put `other` behind `best`.
fn may_be(design: &Design, best: &Candidate, other: &Candidate) -> bool {
    best.effect.row().is_between_sessions()
        && other.score.gain > SUSPECT_MIN_GAIN_RATIO * best.score.gain
        && difference(design, best, other).abs() < SUSPECT_MAX_GAIN_DIFFERENCE
}

/// The candidates that explain these data as well as `candidate` does.
#[must_use]
pub fn find<'a>(
    design: &Design,
    candidate: &Candidate,
    passing: &'a [Candidate],
    tried: &'a [Candidate],
) -> Vec<&'a Candidate> {
    let row = candidate.effect.row();
    let parts: Vec<&str> = match row.is_sum {
        true => row.parts().collect(),
        false => Vec::new(),
    };
    let mut equivalents: Vec<&Candidate> = passing
        .iter()
        .filter(|other| {
            other.id() != candidate.id()
                && !parts.contains(&other.id())
                && as_good(design, candidate, other)
        })
        .chain(tried.iter().filter(|other| parts.contains(&other.id())))
        .collect();
    for other in suspects(tried) {
        let new = other.id() != candidate.id() && !equivalents.iter().any(|c| c.id() == other.id());
        if new && may_be(design, candidate, other) {
            equivalents.push(other);
        }
    }
    equivalents
}

/// The recording that best distinguishes a candidate from its `equivalents`.
#[must_use]
pub fn proposal(candidate: &Candidate, equivalents: &[&Candidate]) -> Proposal {
    let contrasts = |c: &Candidate| c.effect.row().contrasts;
    let rivals: Vec<_> = equivalents.iter().map(|c| contrasts(c)).collect();
    let alone = candidate.effect.description().shown_by;
    Proposal::between(contrasts(candidate), &rivals, alone)
}

/// The same in words, with the state at which the predictions differ most.
#[must_use]
pub fn separate_by(
    prepared: &PreparedModel,
    candidate: &Candidate,
    equivalents: &[&Candidate],
) -> String {
    let proposal = proposal(candidate, equivalents);
    let what = format!("{}: {}", proposal.id(), proposal.instruction());
    let Some(other) = equivalents.first() else {
        return format!("{what}; {}", candidate.effect.description().excited_by);
    };
    let place = farthest_apart(prepared, candidate, other);
    format!(
        "{what}. On these data {} and {} differ most at {place}",
        candidate.id(),
        other.id()
    )
}

/// State at which two candidates' predictions differ most.
fn farthest_apart(prepared: &PreparedModel, a: &Candidate, b: &Candidate) -> String {
    let predict = |signals: &crate::signals::Signals, c: &Candidate| -> Vec<f64> {
        let mut sum = vec![0.0; signals.points.len()];
        for (column, coefficient) in columns::working(signals, &c.effect, &c.shape)
            .iter()
            .zip(&c.score.coefficients)
        {
            sum.iter_mut()
                .zip(column)
                .for_each(|(s, x)| *s += coefficient * x);
        }
        sum
    };
    let mut best = (0.0, crate::effects::Point::default());
    for signals in &prepared.sessions {
        let (pa, pb) = (predict(signals, a), predict(signals, b));
        for at in &signals.rows {
            let gap = (pa[*at] - pb[*at]).abs();
            if gap > best.0 {
                best = (gap, signals.points[*at]);
            }
        }
    }
    let joint = prepared.facts.joint;
    let (angle, force) = (crate::effects::ANGLE.of(joint), joint.force_unit());
    let named = |signal: &str| joint.signal(signal).replace('_', " ");
    format!(
        "{} {:.3} {angle}, {} {:.3} {angle}/s, {} {:.2} {force}",
        named("position"),
        best.1.position,
        named("velocity"),
        best.1.velocity,
        named("load"),
        best.1.load
    )
}

#[cfg(test)]
mod tests {
    use super::Proposal::{
        Accelerations, FastUnloaded, LoadSteps, SlowReversals, TemperatureSweep, WidePosition,
        WideSpeedRange,
    };
    use super::*;
    use crate::effects;

    #[test]
    fn the_proposed_motion_distinguishes_most_of_the_equivalents() {
        let contrasts = |id: &str| effects::find(id).map_or(&[][..], |own| own.row().contrasts);
        let between = |own: &str, rivals: &[&str]| {
            let rivals: Vec<_> = rivals.iter().map(|id| contrasts(id)).collect();
            Proposal::between(contrasts(own), &rivals, LoadSteps)
        };
        assert_eq!(
            between("wear_drift", &["temperature_coulomb"]),
            TemperatureSweep
        );
        assert_eq!(between("gravity", &["cable_spring"]), WidePosition);
        assert_eq!(
            between("quadratic_viscous", &["cubic_viscous", "nonlinear_viscous"]),
            WideSpeedRange
        );
        assert_eq!(
            between("backlash", &["presliding_hysteresis"]),
            SlowReversals
        );
        assert_eq!(between("inertia", &["channel_delay"]), Accelerations);
        assert_eq!(
            between(
                "torque_sensor_gain",
                &["cable_spring", "gravity", "motor_constant"]
            ),
            FastUnloaded
        );
        // One rival each way: the first.
        assert_eq!(
            between("load_coulomb", &["motor_constant", "cable_spring"]),
            FastUnloaded
        );
        assert_eq!(between("ripple", &[]), LoadSteps);
        assert_eq!(
            between("ripple", &["an effect of the user's own"]),
            LoadSteps
        );
    }
}

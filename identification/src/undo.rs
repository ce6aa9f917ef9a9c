//! Effects that act on what is measured, taken out of the channels: a channel
//! stamped late, a position measured behind a spring.
//!
//! A column says what such an effect does to the torque balance to first order.
//! Where it is large, the channels are made what they are without it, and what the
//! coefficients do beyond is linear again (Gauss and Newton's method).

use std::iter::repeat;

use nalgebra::DVector;

use crate::design::Design;
use crate::effects::with_columns;
use crate::prediction::working;
use crate::refine;
use crate::setup::{BoundTerm, Setup};
use crate::signals::{Channels, Signals};

/// Steps, whole or halved, at most, …
const MAX_STEPS: usize = 10;
/// … and none after one that is shorter than this share of a standard error, …
const SETTLED: f64 = 0.2;
/// … or than this share of the whole one.
const SHORTEST: f64 = 0.2;
/// Share of the rows that a step leaves at least: what comes too late is lost at
/// the end.
const LEAST_KEPT: f64 = 0.9;
/// Share of a coefficient over which the columns are differences.
const NUDGE: f64 = 1e-3;

impl Setup {
    /// Takes the model's effects that act on channels out of these, if that leaves
    /// less than their columns do.
    pub(crate) fn undo(&mut self) {
        if !self.terms.iter().any(|t| t.effect.row().acts_on_channels) {
            return;
        }
        let mut design = Design::new(self);
        let (mut error, rows) = left(&design);
        let mut share = 1.0;
        for _ in 0..MAX_STEPS {
            if share < SHORTEST || self.is_settled(&design) {
                return;
            }
            let Some(next) = self.next(&design.shared, share) else {
                return;
            };
            let mut tried = self.clone();
            tried.take_out(&next);
            let then = Design::new(&tried);
            let (after, kept) = left(&then);
            if after < error && kept as f64 > LEAST_KEPT * rows as f64 {
                (*self, design, error, share) = (tried, then, after, 1.0);
            } else {
                share *= 0.5;
            }
        }
    }

    /// Coefficients of each effect that acts on channels, `share` of the way to the
    /// fitted ones; none for other effects. `None` where they make no sense.
    fn next(&self, fitted: &DVector<f64>, share: f64) -> Option<Vec<Vec<f64>>> {
        let each = with_columns(&self.terms).map(|(term, columns)| {
            if !term.effect.row().acts_on_channels {
                return Some(Vec::new());
            }
            let before = term.undone.iter().copied().chain(repeat(0.0));
            let next: Vec<f64> = columns
                .zip(before)
                .map(|(k, before)| before + share * (fitted[k] - before))
                .collect();
            term.effect.plausible(&term.shape, &next).then_some(next)
        });
        each.collect()
    }

    fn is_settled(&self, design: &Design) -> bool {
        with_columns(&self.terms).all(|(term, mut columns)| {
            let settled = columns.by_ref().zip(&term.undone).all(|(k, before)| {
                let error = design.covariance[(k, k)].max(0.0).sqrt();
                (design.shared[k] - before).abs() <= SETTLED * error
            });
            settled && (!term.effect.row().acts_on_channels || !term.undone.is_empty())
        })
    }

    /// Makes the channels what they are without the effects that act on them.
    fn take_out(&mut self, coefficients: &[Vec<f64>]) {
        for (term, own) in self.terms.iter_mut().zip(coefficients) {
            term.undone.clone_from(own);
        }
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let (channels, lost) = undone(&self.terms, signals);
            signals.jacobians.clear();
            signals.take(channels, lost, &self.filters);
        }
        if self.reversals {
            self.keep_reversals();
        }
        self.model_load();
        self.predict();
        self.differentiate();
    }

    /// Columns of the effects that are taken out: how the torque balance changes
    /// with their coefficients.
    fn differentiate(&mut self) {
        let mut own = self.terms.clone();
        own.retain(|t| !t.effect.row().needs_prediction);
        let (facts, predicted) = (&self.facts, &self.predicted);
        let inertia = facts.inertia.unwrap_or(0.0);
        // τ + J q̈ + τ_F − τ_m.
        let balance = |signals: &Signals| -> Vec<f64> {
            let friction = working(signals, &own, predicted, |_| true);
            let points = signals.points.iter().zip(friction);
            points
                .map(|(point, friction)| {
                    let load = if facts.joint_torque { point.load } else { 0.0 };
                    load + inertia * point.acceleration + friction - point.motor_torque
                })
                .collect()
        };
        let nudged = |signals: &Signals, terms: &[BoundTerm]| {
            let (channels, lost) = undone(terms, signals);
            let mut nudged = signals.clone();
            nudged.take(channels, lost, &self.filters);
            if !facts.joint_torque {
                for (point, known) in nudged.points.iter_mut().zip(&signals.points) {
                    point.load = known.load;
                }
            }
            balance(&nudged)
        };
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let before = balance(signals);
            for (at, term) in self.terms.iter().enumerate() {
                let mut columns = Vec::new();
                for (k, coefficient) in term.undone.iter().enumerate() {
                    let nudge = NUDGE * coefficient.abs().max(1e-9);
                    let mut terms = self.terms.clone();
                    terms[at].undone[k] += nudge;
                    let after = nudged(signals, &terms);
                    let both = after.iter().zip(&before);
                    columns.push(
                        both.map(|(after, before)| (after - before) / nudge)
                            .collect(),
                    );
                }
                if !columns.is_empty() {
                    let id = term.effect.description().id.clone();
                    signals.jacobians.insert(id, columns);
                }
            }
        }
    }
}

/// The channels of a session without what `terms` do to them, and how many
/// samples at the end say nothing then.
fn undone(terms: &[BoundTerm], signals: &Signals) -> (Channels, usize) {
    let mut channels = Channels::clone(&signals.recorded);
    let mut lost = 0;
    for term in terms.iter().filter(|t| !t.undone.is_empty()) {
        let period = signals.period;
        lost += (term.effect).undo(&term.shape, &term.undone, &mut channels, period);
    }
    (channels, lost)
}

/// Mean square that the model leaves, each session with its own parameters, and
/// of how many rows.
fn left(design: &Design) -> (f64, usize) {
    let left = refine::within(design, &design.own());
    (left.square() / left.rows.max(1) as f64, left.rows)
}

#[cfg(test)]
mod tests {
    use crate::bench::{State, model, plain, recording};
    use crate::{Addition, Dataset, Term, add, compare};

    const BELIEVED: [&str; 2] = ["coulomb", "viscous"];

    fn added(data: &Dataset, effect: &str) -> Addition {
        add(data, &model(&BELIEVED), &Term::Catalogue(effect.into())).unwrap()
    }

    /// How much more is left on rows held out than where nothing is missing.
    fn over_plain(addition: &Addition, plain: &Dataset) -> f64 {
        let reached = compare(plain, &model(&BELIEVED)).unwrap().rms.held_out;
        addition.held_out_after / reached
    }

    /// Every other channel begins `late` samples after the position does.
    fn with_late_position(mut data: Dataset, late: usize) -> Dataset {
        for session in &mut data.sessions {
            session.position.truncate(session.position.len() - late);
            session.motor_torque.drain(..late);
            for channel in [&mut session.joint_torque, &mut session.temperature] {
                channel.as_mut().unwrap().drain(..late);
            }
        }
        data
    }

    #[test]
    fn a_channel_that_is_far_too_late_is_taken_back_as_a_whole() {
        let data = recording(4, plain);
        let found = added(&with_late_position(data.clone(), 9), "channel_delay");
        let delay = &found.parameters["delay"];
        assert!((0.0897..0.0903).contains(&delay.value), "{delay:?}");
        assert!(found.held_out_before > 3.0 * found.held_out_after);
        let over = over_plain(&found, &data);
        assert!((0.98..1.02).contains(&over), "{over}");
    }

    /// δ \[rad\] of K δ + K₃ δ³ = τ, halved into.
    fn twist(torque: f64, stiffness: f64, cubic: f64) -> f64 {
        let (mut low, mut high) = (-0.2, 0.2);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match stiffness * middle + cubic * f64::powi(middle, 3) < torque {
                true => low = middle,
                false => high = middle,
            }
        }
        low
    }

    #[test]
    fn a_joint_that_winds_up_and_stiffens_gives_its_stiffness() {
        let friction = |s: &State| 5.0 * s.qd.signum() + 60.0 * s.qd;
        let rigid = recording(6, friction);
        let mut data = rigid.clone();
        for session in &mut data.sessions {
            for (at, position) in session.position.iter_mut().enumerate() {
                let load = 25.0 * f64::max(*position - 0.1, 0.0) + 3.0 * (0.009 * at as f64).sin();
                *position -= twist(load, 150.0, 4e4);
            }
        }
        let found = added(&data, "elasticity");
        let inverse = found.parameters["inverse_K"].value;
        assert!((0.9..1.1).contains(&(inverse * 150.0)), "{inverse}");
        let stiff = found.parameters["tau_s"].value;
        let expected = 150.0 * f64::sqrt(150.0 / 4e4);
        assert!((0.7..1.4).contains(&(stiff / expected)), "{stiff}");
        // The torque sensor's noise comes in with the twist.
        let over = over_plain(&found, &rigid);
        assert!((0.98..1.10).contains(&over), "{over}");
        let before = found.held_out_before / found.held_out_after;
        assert!(before > 1.5, "{before}");
    }
}

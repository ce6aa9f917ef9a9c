//! Shapes of the model's own effects.

use crate::design::{Design, PreparedModel};
use crate::effects::BoundTerm;
use crate::shape_search;
use crate::signals::Signals;

/// Rounds over the shapes of a model's effects, at most, …
const MAX_ROUNDS: usize = 8;
/// … and none after one that changes no shape parameter by this share.
const MIN_RELATIVE_CHANGE: f64 = 0.002;

impl PreparedModel {
    /// Finds the shapes of the model's own effects, one after the other, since each
    /// depends on those of the others and on what these predict: first over the
    /// whole grid, then around the last value, until no shape changes. That of the effect
    /// `known` is found already.
    pub(super) fn find_shapes(&mut self, known: Option<&str>) {
        let is_searched = |term: &BoundTerm| {
            !term.shape.is_empty() && known.is_none_or(|id| term.effect.description().id != id)
        };
        let searched: Vec<usize> = (0..self.terms.len())
            .filter(|i| is_searched(&self.terms[*i]))
            .collect();
        let predicts = self.terms.iter().any(|t| t.effect.row().needs_prediction);
        let max_rounds = match (predicts, searched.len()) {
            (true, _) => MAX_ROUNDS,
            (false, 0 | 1) => 1,
            (false, _) => 2,
        };
        for round in 0..max_rounds {
            let mut moved = 0.0;
            for &at in &searched {
                if self.terms[at].effect.row().needs_prediction {
                    self.predict();
                }
                let mut term = self.terms.remove(at);
                let design = Design::new(self);
                let shape = match round {
                    0 | 1 => shape_search::search(self, &design, &term.effect),
                    _ => Some(shape_search::polish(
                        self,
                        &design,
                        &term.effect,
                        &term.shape,
                    )),
                };
                let shape = shape.unwrap_or_else(|| term.shape.clone());
                moved = f64::max(moved, largest_change(&term.shape, &shape));
                term.shape = shape;
                self.terms.insert(at, term);
            }
            if round > 0 && moved < MIN_RELATIVE_CHANGE {
                break;
            }
        }
    }

    /// Leaves undetermined rows out, and refines the shapes of the effects that
    /// cause them on the rest: these rows hold little information about the shapes
    /// and bias them strongly.
    pub(super) fn refine_shapes_on_determined_rows(&mut self) {
        let all: Vec<Vec<usize>> = self.rows().map(<[usize]>::to_vec).collect();
        self.leave_out_undetermined_rows();
        if self.rows().eq(all.iter().map(Vec::as_slice)) {
            return;
        }
        for at in 0..self.terms.len() {
            let mut term = self.terms.remove(at);
            let undetermined =
                |s: &Signals| (term.effect).undetermined_samples(&term.shape, &s.points);
            if self.sessions.iter().any(|s| !undetermined(s).is_empty()) {
                let design = Design::new(self);
                term.shape = shape_search::polish(self, &design, &term.effect, &term.shape);
            }
            self.terms.insert(at, term);
        }
        let sessions = self.sessions.iter_mut().chain(&mut self.held_out);
        for (signals, rows) in sessions.zip(all) {
            signals.rows = rows;
        }
        self.predict();
        self.leave_out_undetermined_rows();
    }
}

/// Largest relative change of a shape parameter.
fn largest_change(before: &[f64], after: &[f64]) -> f64 {
    let both = before.iter().zip(after);
    both.map(|(before, after)| (after - before).abs() / before.abs().max(1e-300))
        .fold(0.0, f64::max)
}

//! What differs from session to session: by how much the parts of friction are
//! larger or smaller than on the whole, and whether that goes with temperature
//! or date.
//!
//! A handful of sessions leaves few degrees of freedom. Two things make up for
//! that. A session scales each part of friction as a whole: left free, b_1, b_2
//! and b_3 of one session make up for each other, and the noise of that hides
//! what temperature does to b_1. And the parts scatter by like shares, so that
//! the scatter of the others says something of the one (a moderated t-test:
//! Smyth, Statistical Applications in Genetics and Molecular Biology 3, 2004).

use nalgebra::DMatrix;

use crate::design::{BlockGrams, Design};
use crate::effects::{Part, with_columns};
use crate::gram::{Gram, pseudo_inverse};
use crate::setup::Setup;
use crate::statistics::{f_tail, mean_error};

/// A part whose scale a session says no better than this counts for nothing there.
const MAX_ERROR: f64 = 0.1;
/// Degrees of freedom that the scatter of the other parts is worth: they
/// scatter alike, not equally.
const WORTH: f64 = 4.0;
/// Where a part scatters more than the others by chance this small, theirs says
/// nothing of its own.
const ALIKE: f64 = 0.05;
/// Sessions that it takes.
const FEWEST: usize = 4;

/// Scale of each part in each session, less 1; `None` where a session does not
/// say it.
struct Scales {
    /// What scales together.
    parts: Vec<Part>,
    /// One row a session.
    sessions: Vec<Vec<Option<f64>>>,
}

impl Scales {
    fn of(setup: &Setup, design: &Design) -> Self {
        let mut members: Vec<(Part, Vec<usize>)> = Vec::new();
        for (term, own) in with_columns(&setup.terms) {
            let Some(part) = term.effect.row().part else {
                continue;
            };
            match members.iter_mut().find(|(p, _)| *p == part) {
                Some((_, all)) => all.extend(own),
                None => members.push((part, own.collect())),
            }
        }
        let mut shapes = DMatrix::zeros(design.base, members.len());
        for (at, (_, columns)) in members.iter().enumerate() {
            for &column in columns {
                shapes[(column, at)] = design.shared[column];
            }
        }
        Self {
            parts: members.into_iter().map(|(part, _)| part).collect(),
            sessions: design
                .sessions
                .iter()
                .map(|session| scales(&Gram::sum(&session.grams, design.base), design, &shapes))
                .collect(),
        }
    }

    /// Variance of part number `at` over the sessions around their mean.
    fn variance(&self, at: usize) -> Option<f64> {
        let scales: Vec<f64> = self.sessions.iter().filter_map(|s| s[at]).collect();
        let (_, error) = mean_error(&scales);
        (scales.len() >= FEWEST).then_some(error * error * scales.len() as f64)
    }
}

/// Scales of one session, by least squares of what the shared parameters leave
/// over the parts that these make up, which are the columns of `shapes`.
fn scales(own: &Gram, design: &Design, shapes: &DMatrix<f64>) -> Vec<Option<f64>> {
    let base = design.base;
    let products = own.products.view((0, 0), (base, base));
    let measured = own.products.view((0, base), (base, 1));
    let left = measured - products * &design.shared;
    let between = shapes.transpose() * products * shapes;
    let (inverse, _) = pseudo_inverse(&between);
    let scales = &inverse * (shapes.transpose() * left);
    let error = own.squared_error(&design.shared) / own.rows.max(1) as f64;
    (0..shapes.ncols())
        .map(|at| {
            let variance = error * inverse[(at, at)];
            (variance > 0.0 && variance < MAX_ERROR * MAX_ERROR).then(|| scales[at])
        })
        .collect()
}

/// Chance that scatter alone makes the effect `varied` of the model go with
/// what the (single) extra column multiplies it with, session by session;
/// `None` where sessions are too few, or it is no part that scales.
#[must_use]
pub fn trend(setup: &Setup, design: &Design, grams: &BlockGrams, varied: &str) -> Option<f64> {
    let scales = Scales::of(setup, design);
    let (varied, column) = setup.first_column(varied)?;
    let part = varied.effect.row().part?;
    let at = scales.parts.iter().position(|own| *own == part)?;
    let points: Vec<(f64, f64)> = grams
        .iter()
        .zip(&scales.sessions)
        .filter_map(|(session, scales)| {
            let total = Gram::sum(session, session.first()?.columns());
            let own = total.products[(column, column)];
            let factor = total.products[(column, design.base)] / own;
            (own > 0.0 && factor.is_finite()).then_some((factor, scales[at]?))
        })
        .collect();
    let others: Vec<f64> = (0..scales.parts.len())
        .filter(|other| *other != at)
        .filter_map(|other| scales.variance(other))
        .collect();
    chance(&points, &others)
}

/// Chance that `points`, a factor and a scale each, lie on a line like this by
/// scatter alone, where the scales of other parts have the variances `others`.
fn chance(points: &[(f64, f64)], others: &[f64]) -> Option<f64> {
    if points.len() < FEWEST {
        return None;
    }
    let line = Line::through(points)?;
    let alone = line.chance(line.rest, line.freedom);
    let prior = others.iter().sum::<f64>() / others.len().max(1) as f64;
    let known = others.len() as f64 * (points.len() as f64 - 1.0);
    if prior <= 0.0 || f_tail(line.rest / prior, line.freedom, known) < ALIKE {
        return Some(alone);
    }
    let freedom = line.freedom + WORTH;
    let both = (line.freedom * line.rest + WORTH * prior) / freedom;
    // Two looks at the same question.
    Some((2.0 * alone.min(line.chance(both, freedom))).min(1.0))
}

/// A straight line through scales.
struct Line {
    /// Square that it explains.
    explained: f64,
    /// Mean square around it.
    rest: f64,
    /// Points less two.
    freedom: f64,
}

impl Line {
    fn through(points: &[(f64, f64)]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = |side: fn(&(f64, f64)) -> f64| points.iter().map(side).sum::<f64>() / count;
        let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
        let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|(x, y)| term(x - mx, y - my)).sum()
        };
        let (across, along) = (sum(&|x, _| x * x), sum(&|x, y| x * y));
        if across <= 0.0 {
            return None;
        }
        let explained = along * along / across;
        Some(Self {
            explained,
            rest: ((sum(&|_, y| y * y) - explained) / (count - 2.0)).max(1e-300),
            freedom: count - 2.0,
        })
    }

    /// Chance that scatter of this `variance`, known with `freedom` degrees of
    /// freedom, explains as much.
    fn chance(&self, variance: f64, freedom: f64) -> f64 {
        f_tail(self.explained / variance, 1.0, freedom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Anscombe's first set (The American Statistician 27, 1973): slope 0.500 with
    /// a standard error of 0.118, t = 4.24, p = 0.00217 with nine degrees of freedom.
    const ANSCOMBE: [(f64, f64); 11] = [
        (10.0, 8.04),
        (8.0, 6.95),
        (13.0, 7.58),
        (9.0, 8.81),
        (11.0, 8.33),
        (14.0, 9.96),
        (6.0, 7.24),
        (4.0, 4.26),
        (12.0, 10.84),
        (7.0, 4.82),
        (5.0, 5.68),
    ];

    #[test]
    fn a_line_alone_is_judged_by_its_own_scatter() {
        let found = chance(&ANSCOMBE, &[]).unwrap();
        assert!((found - 0.00217).abs() < 1e-5, "{found}");
    }

    #[test]
    fn parts_that_scatter_alike_make_a_line_surer() {
        let few = &ANSCOMBE[..6];
        let line = Line::through(few).unwrap();
        let alone = chance(few, &[]).unwrap();
        let with_others = chance(few, &[line.rest, line.rest]).unwrap();
        // Eight degrees of freedom instead of four, paid for twice.
        let expected = 2.0 * f_tail(line.explained / line.rest, 1.0, 8.0);
        assert!((with_others - expected.min(2.0 * alone)).abs() < 1e-12);
    }

    #[test]
    fn parts_that_scatter_far_less_say_nothing() {
        let rest = Line::through(&ANSCOMBE).unwrap().rest;
        let alone = chance(&ANSCOMBE, &[]);
        assert_eq!(chance(&ANSCOMBE, &[0.01 * rest, 0.02 * rest]), alone);
    }

    #[test]
    fn a_handful_of_sessions_is_needed() {
        assert_eq!(chance(&ANSCOMBE[..3], &[]), None);
        assert_eq!(chance(&[(1.0, 2.0); 5], &[]), None);
    }
}

//! Variation of friction from session to session: the ratio of each part to its
//! mean over the sessions, and whether it depends on temperature or date.
//!
//! A handful of sessions leaves few degrees of freedom, for which two constraints
//! compensate. Each part of friction scales as a whole: with free coefficients,
//! the estimates of b_1, b_2 and b_3 of one session are correlated, and their noise
//! masks the influence of temperature on b_1. And the relative variances of the
//! parts are similar, so that those of the others are prior information about the
//! one (a moderated t-test: Smyth, Statistical Applications in Genetics and
//! Molecular Biology 3, 2004).

use nalgebra::DMatrix;

use crate::design::{BlockGrams, Design, PreparedModel};
use crate::effects::{Part, with_columns};
use crate::numerics::gram::{Gram, pseudo_inverse};
use crate::numerics::statistics::{f_tail, mean_error};

/// Largest standard error of a scale; a scale that a session determines less well
/// is left out there.
const MAX_RELATIVE_ERROR: f64 = 0.1;
/// Degrees of freedom of the prior from the other parts: their variances are
/// similar, not equal.
const PRIOR_FREEDOM: f64 = 4.0;
/// p-value below which the variance of a part is larger than that of the others,
/// so that these are no prior for it.
const MIN_P_VALUE_OF_PRIOR: f64 = 0.05;
/// Smallest number of sessions for a test: a line through three leaves one degree of freedom,
/// to which the prior adds.
pub const MIN_SESSIONS: usize = 3;

/// Scale of each part in each session, less 1; `None` where a session does not
/// determine it.
struct Scales {
    /// Parts of friction in the model, in the order of its terms.
    parts: Vec<Part>,
    /// One row a session.
    sessions: Vec<Vec<Option<f64>>>,
}

impl Scales {
    fn estimate(prepared: &PreparedModel, design: &Design) -> Self {
        let mut members: Vec<(Part, Vec<usize>)> = Vec::new();
        for (term, own) in with_columns(&prepared.terms) {
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
        (scales.len() >= MIN_SESSIONS).then_some(error * error * scales.len() as f64)
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
            (variance > 0.0 && variance < MAX_RELATIVE_ERROR * MAX_RELATIVE_ERROR)
                .then(|| scales[at])
        })
        .collect()
}

/// p-value of a trend of the model's effect `varied` over the factor that the
/// (single) extra column multiplies it with, session by session; `None` where
/// sessions are too few, or it is no part that scales.
#[must_use]
pub fn trend(
    prepared: &PreparedModel,
    design: &Design,
    grams: &BlockGrams,
    varied: &str,
) -> Option<f64> {
    let scales = Scales::estimate(prepared, design);
    let (varied, column) = prepared.first_column(varied)?;
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
    p_value_of_line(&points, &others)
}

/// p-value of a line through `points`, a factor and a scale each, where the scales
/// of other parts have the variances `others`.
fn p_value_of_line(points: &[(f64, f64)], others: &[f64]) -> Option<f64> {
    if points.len() < MIN_SESSIONS {
        return None;
    }
    let line = Line::through(points)?;
    let alone = line.p_value(line.rest, line.freedom);
    let prior = others.iter().sum::<f64>() / others.len().max(1) as f64;
    let known = others.len() as f64 * (points.len() as f64 - 1.0);
    if prior <= 0.0 || f_tail(line.rest / prior, line.freedom, known) < MIN_P_VALUE_OF_PRIOR {
        return Some(alone);
    }
    let freedom = line.freedom + PRIOR_FREEDOM;
    let both = (line.freedom * line.rest + PRIOR_FREEDOM * prior) / freedom;
    // Two tests of the same hypothesis (Bonferroni).
    Some((2.0 * alone.min(line.p_value(both, freedom))).min(1.0))
}

/// A straight line through scales.
struct Line {
    /// Sum of squares that it explains.
    explained: f64,
    /// Mean square around it.
    rest: f64,
    /// Degrees of freedom: points less two.
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

    /// p-value of the line for a residual `variance` known with `freedom` degrees of
    /// freedom.
    fn p_value(&self, variance: f64, freedom: f64) -> f64 {
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
    fn a_line_alone_is_tested_against_its_own_variance() {
        let found = p_value_of_line(&ANSCOMBE, &[]).unwrap();
        assert!((found - 0.00217).abs() < 1e-5, "{found}");
    }

    #[test]
    fn parts_of_similar_variance_make_a_line_more_significant() {
        let few = &ANSCOMBE[..6];
        let line = Line::through(few).unwrap();
        let alone = p_value_of_line(few, &[]).unwrap();
        let with_others = p_value_of_line(few, &[line.rest, line.rest]).unwrap();
        // Eight degrees of freedom instead of four, paid for twice.
        let expected = 2.0 * f_tail(line.explained / line.rest, 1.0, 8.0);
        assert!((with_others - expected.min(2.0 * alone)).abs() < 1e-12);
    }

    #[test]
    fn parts_of_far_smaller_variance_are_no_prior() {
        let rest = Line::through(&ANSCOMBE).unwrap().rest;
        let alone = p_value_of_line(&ANSCOMBE, &[]);
        assert_eq!(
            p_value_of_line(&ANSCOMBE, &[0.01 * rest, 0.02 * rest]),
            alone
        );
    }

    #[test]
    fn a_handful_of_sessions_is_needed() {
        assert_eq!(p_value_of_line(&ANSCOMBE[..2], &[]), None);
        assert_eq!(p_value_of_line(&[(1.0, 2.0); 5], &[]), None);
    }
}

//! Which differences exceed what both ends are uncertain by.

use ferntast_identification::{fit::Parameter, numerics::statistics::f_tail};

use super::{Change, Course, Point, Turn};

/// A change counts where chance alone makes one as large less often than this.
const SIGNIFICANCE: f64 = 0.05;

/// Every parameter over the points.
pub(super) fn courses(points: &[Point]) -> Vec<Course> {
    let mut names: Vec<&String> = points
        .iter()
        .flat_map(|own| own.parameters.keys())
        .collect();
    names.sort();
    names.dedup();
    let course = |name: &String| {
        let there: Vec<(&str, &Parameter)> = points
            .iter()
            .filter_map(|own| Some((own.name.as_str(), own.parameters.get(name)?)))
            .collect();
        let (_, first) = there.first()?;
        let steps = there.windows(2).filter_map(|pair| match pair {
            [from, to] => difference(*from, *to),
            _ => None,
        });
        let p_value = spread(&there);
        Some(Course {
            name: name.clone(),
            effect: first.effect.clone(),
            unit: first.unit.clone(),
            change: match there.as_slice() {
                [first, .., last] => difference(*first, *last),
                _ => None,
            },
            steps: steps.collect(),
            p_value,
            changes: p_value.is_some_and(|p| p < SIGNIFICANCE),
        })
    };
    names.into_iter().filter_map(course).collect()
}

/// What is known of a difference: both errors together, with the degrees of freedom of
/// Welch and Satterthwaite.
fn difference(from: (&str, &Parameter), to: (&str, &Parameter)) -> Option<Change> {
    let (a, b) = (from.1.std_error?.powi(2), to.1.std_error?.powi(2));
    let both = (a + b).max(1e-300);
    let freedom = both.powi(2) / (a * a / from.1.freedom? + b * b / to.1.freedom?).max(1e-300);
    let change = to.1.value - from.1.value;
    let p_value = f_tail(change * change / both, 1.0, freedom);
    Some(Change {
        from: from.0.to_owned(),
        to: to.0.to_owned(),
        change,
        std_error: both.sqrt(),
        p_value,
        exceeds_errors: p_value < SIGNIFICANCE,
    })
}

/// Probability that values around their weighted mean lie as far apart by chance.
fn spread(there: &[(&str, &Parameter)]) -> Option<f64> {
    let weighted = there.iter().map(|(_, own)| {
        let error = own.std_error.filter(|error| *error > 0.0)?;
        Some((own.value, error.powi(-2), own.freedom?))
    });
    let weighted: Vec<(f64, f64, f64)> = weighted.collect::<Option<_>>()?;
    let freedom = weighted.len().checked_sub(1).filter(|own| *own > 0)? as f64;
    let weights: f64 = weighted.iter().map(|own| own.1).sum();
    let mean = weighted.iter().map(|own| own.0 * own.1).sum::<f64>() / weights;
    let square: f64 = weighted
        .iter()
        .map(|own| own.1 * (own.0 - mean).powi(2))
        .sum();
    let of_errors = weighted.iter().map(|own| own.2).sum();
    Some(f_tail(square / freedom, freedom, of_errors))
}

/// Effects that came or went: named as missing since, or not any more; in the model,
/// away from zero since, or not any more, by a change that exceeds its errors.
pub(super) fn turns(points: &[Point]) -> Vec<Turn> {
    let mut turns = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = pair else { continue };
        let mut turn = |effect: &str, came: bool, by_diagnosis: bool| {
            turns.push(Turn {
                effect: effect.to_owned(),
                from: from.name.clone(),
                to: to.name.clone(),
                came,
                by_diagnosis,
            });
        };
        let asked = from.verdict.is_some() && to.verdict.is_some();
        if asked && from.missing != to.missing {
            from.missing
                .iter()
                .for_each(|effect| turn(effect, false, true));
            to.missing
                .iter()
                .for_each(|effect| turn(effect, true, true));
        }
        let mut effects: Vec<&str> = from
            .parameters
            .values()
            .map(|own| own.effect.as_str())
            .collect();
        effects.sort_unstable();
        effects.dedup();
        for effect in effects {
            let own = from
                .parameters
                .iter()
                .filter(|(_, own)| own.effect == effect);
            let both: Vec<(&Parameter, &Parameter)> = own
                .filter_map(|(name, own)| Some((own, to.parameters.get(name)?)))
                .collect();
            let is_there = |of: &dyn Fn(&(&Parameter, &Parameter)) -> bool| both.iter().any(of);
            let (before, after) = (
                is_there(&|pair| is_away_from_zero(pair.0)),
                is_there(&|pair| is_away_from_zero(pair.1)),
            );
            let changed = both
                .iter()
                .any(|(a, b)| difference(("", a), ("", b)).is_some_and(|own| own.exceeds_errors));
            if before != after && changed {
                turn(effect, after, false);
            }
        }
    }
    turns
}

fn is_away_from_zero(parameter: &Parameter) -> bool {
    parameter
        .interval_95
        .is_some_and(|[low, high]| low > 0.0 || high < 0.0)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn point(name: &str, b0: f64, bs: f64) -> Point {
        let parameter =
            |value: f64, effect: &str| Parameter::measured(value, (0.1, 5.0), "Nm", effect);
        Point {
            name: name.to_owned(),
            days: None,
            sessions: 3,
            temperature: None,
            held_out: 1.0,
            parameters: BTreeMap::from([
                ("b0".to_owned(), parameter(b0, "coulomb")),
                ("bs".to_owned(), parameter(bs, "stribeck")),
            ]),
            verdict: None,
            missing: None,
        }
    }

    #[test]
    fn what_exceeds_the_errors_changed_and_nothing_else() {
        let points = [
            point("a", 5.0, 0.05),
            point("b", 5.1, 0.10),
            point("c", 6.0, 2.0),
        ];
        let courses = courses(&points);
        assert!(courses[0].changes && courses[0].name == "b0");
        let [first, second] = courses[0].steps.as_slice() else {
            panic!("{courses:?}")
        };
        assert!(!first.exceeds_errors && second.exceeds_errors);
        assert!((second.std_error - 0.02_f64.sqrt()).abs() < 1e-12);
        let whole = courses[0].change.as_ref().unwrap();
        assert_eq!((whole.from.as_str(), whole.to.as_str()), ("a", "c"));
        let turns = turns(&points);
        assert_eq!(turns.len(), 1, "{turns:?}");
        assert!(turns[0].came && turns[0].effect == "stribeck" && turns[0].to == "c");
    }

    #[test]
    fn a_parameter_that_stays_within_its_errors_does_not_change() {
        let points: Vec<Point> = [5.0, 5.1, 4.95, 5.05]
            .iter()
            .map(|b0| point("x", *b0, 1.0))
            .collect();
        assert!(courses(&points).iter().all(|own| !own.changes));
        assert!(turns(&points).is_empty());
    }
}

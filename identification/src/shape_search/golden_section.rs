//! The least error between two values, by golden sections.

/// Steps after the first two values.
const STEPS: usize = 9;
/// Of these, the first that a part of the rows is enough for: they compare values far apart.
const STEPS_ON_PART: usize = 5;
/// Share of a section that is left after a step.
const RATIO: f64 = 0.618_034;

/// A section with two values inside.
#[derive(Clone, Copy, Debug)]
struct Section {
    a: f64,
    c: f64,
    d: f64,
    b: f64,
}

impl Section {
    const fn new([a, b]: [f64; 2]) -> Self {
        let (c, d) = (b - RATIO * (b - a), a + RATIO * (b - a));
        Self { a, c, d, b }
    }

    /// Errors at the two values inside.
    fn inside(&self, mut error: impl FnMut(f64) -> f64) -> [f64; 2] {
        [error(self.c), error(self.d)]
    }

    /// `steps` on from the errors at the two values inside with those that `error` tells.
    fn narrowed(
        mut self,
        steps: usize,
        [mut at_c, mut at_d]: [f64; 2],
        mut error: impl FnMut(f64) -> f64,
    ) -> Self {
        for _ in 0..steps {
            let Self { a, c, d, b } = &mut self;
            if at_c < at_d {
                (*b, *d, at_d) = (*d, *c, at_c);
                *c = *b - RATIO * (*b - *a);
                at_c = error(*c);
            } else {
                (*a, *c, at_c) = (*c, *d, at_d);
                *d = *a + RATIO * (*b - *a);
                at_d = error(*d);
            }
        }
        self
    }
}

/// Values of one parameter of a shape, and the best of them.
struct Along<'a, E> {
    shape: &'a mut [f64],
    at: usize,
    error_of: E,
    best: f64,
    error: f64,
}

impl<'a, E: FnMut(&[f64]) -> f64> Along<'a, E> {
    /// The value at place `at` of `shape`, which leaves `error`.
    fn new(shape: &'a mut [f64], at: usize, error: f64, error_of: E) -> Self {
        let best = shape[at];
        Self {
            shape,
            at,
            error_of,
            best,
            error,
        }
    }

    fn try_value(&mut self, value: f64) -> f64 {
        self.shape[self.at] = value;
        let error = (self.error_of)(self.shape);
        if error < self.error {
            (self.best, self.error) = (value, error);
        }
        error
    }

    /// Leaves the best value in the shape, and returns its error.
    fn end(self) -> f64 {
        self.shape[self.at] = self.best;
        self.error
    }
}

/// Puts the best value between `low` and `high` at place `at` of `shape`, which
/// leaves `error` as it is; the error that is left then.
pub(crate) fn golden_section(
    shape: &mut [f64],
    at: usize,
    range: [f64; 2],
    error: f64,
    error_of: impl FnMut(&[f64]) -> f64,
) -> f64 {
    let mut along = Along::new(shape, at, error, error_of);
    let section = Section::new(range);
    let inside = section.inside(|value| along.try_value(value));
    section.narrowed(STEPS, inside, |value| along.try_value(value));
    along.end()
}

/// The same where `of_part` tells the error on a part of the rows, which is less to compute:
/// it decides the first steps, `error_of` the last. Where the best value is not in the section
/// that the part ends with, all steps are done again without the part.
pub(super) fn in_two_stages(
    shape: &mut [f64],
    at: usize,
    range: [f64; 2],
    error: f64,
    mut of_part: impl FnMut(&[f64]) -> f64,
    mut error_of: impl FnMut(&[f64]) -> f64,
) -> f64 {
    let start = shape[at];
    let [low, high] = range;
    let first = {
        let mut try_value = |value: f64| {
            shape[at] = value;
            of_part(shape)
        };
        let section = Section::new(range);
        let inside = section.inside(&mut try_value);
        section.narrowed(STEPS_ON_PART, inside, try_value)
    };
    shape[at] = start;
    let mut along = Along::new(shape, at, error, &mut error_of);
    let inside = first.inside(|value| along.try_value(value));
    let mut least = inside[0].min(inside[1]);
    let is_beyond = |least: f64| error <= least && !(first.a..=first.b).contains(&start);
    // Nearer to the start it may be better still.
    if !is_beyond(least) {
        let last = first.narrowed(STEPS - STEPS_ON_PART, inside, |value| {
            let error = along.try_value(value);
            least = least.min(error);
            error
        });
        let below = last.a == first.a && first.a > low && along.try_value(first.a) < least;
        let above = last.b == first.b && first.b < high && along.try_value(first.b) < least;
        if !below && !above && !is_beyond(least) {
            return along.end();
        }
    }
    along.end();
    shape[at] = start;
    golden_section(shape, at, range, error, error_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bowl(at: f64) -> impl Fn(&[f64]) -> f64 + Copy {
        move |shape: &[f64]| 1.0 + (shape[1] - at).powi(2)
    }

    #[test]
    fn the_least_error_is_found_between_two_values() {
        let mut shape = [7.0, 2.0];
        let error = golden_section(&mut shape, 1, [0.0, 4.0], 1.0e3, bowl(1.234));
        // 4 · 0.618⁹ of the section are left.
        assert!((shape[1] - 1.234).abs() < 0.06 && shape[0] == 7.0);
        assert_eq!(error, bowl(1.234)(&shape));
    }

    #[test]
    fn a_value_known_to_be_better_than_all_between_stays() {
        let mut shape = [7.0, 9.0];
        let error = golden_section(&mut shape, 1, [0.0, 4.0], 0.5, bowl(1.234));
        assert_eq!((shape, error), ([7.0, 9.0], 0.5));
    }

    /// With a part that has its least error nearby, far away, or at an end, the same value is
    /// found as without it (the values of golden sections lie on one grid, to the digits of the
    /// ratio), by fewer questions where it is nearby.
    #[test]
    fn a_part_of_the_rows_changes_nothing_but_the_time() {
        for least in [0.02, 0.7, 1.234, 2.5, 3.99] {
            let mut alone = [7.0, 2.0];
            let without = golden_section(&mut alone, 1, [0.0, 4.0], 1e3, bowl(least));
            for (away, most) in [(0.0, 8), (0.01, 8), (-0.4, 20), (1.5, 20), (-9.0, 20)] {
                let mut asked = 0;
                let counted = |shape: &[f64]| {
                    asked += 1;
                    bowl(least)(shape)
                };
                let mut shape = [7.0, 2.0];
                let part = bowl(least + away);
                let with = in_two_stages(&mut shape, 1, [0.0, 4.0], 1e3, part, counted);
                let same = (shape[1] - alone[1]).abs() < 1e-7 && (with - without).abs() < 1e-9;
                assert!(same, "{shape:?} {alone:?} of {least} {away}");
                assert!((6..=most).contains(&asked), "{asked} of {least} {away}");
            }
        }
    }
}

//! Effects whose law the model has, as the servo feeds it forward.

use ferntast_model::friction::{self, FrictionState, Row, Signal, StaticEffect};

use super::{Effect, EffectDescription, Facts, Memory, Point};

/// A static effect of the catalogue.
pub(super) struct StaticLaw {
    law: &'static StaticEffect,
    description: EffectDescription,
}

/// All static effects of the catalogue.
pub(super) fn all() -> impl Iterator<Item = StaticLaw> {
    friction::all().map(|law| StaticLaw {
        description: EffectDescription::from_row(&law.row),
        law,
    })
}

impl Effect for StaticLaw {
    fn description(&self) -> &EffectDescription {
        &self.description
    }

    fn row(&self) -> &'static Row {
        &self.law.row
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (self.law.unavailable)(facts)
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        (self.law.shapes)(facts)
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        (self.law.bounds)(facts)
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        (self.law.columns)(&point.friction_state(), shape, columns);
    }

    fn of_states(&self, shape: &[f64], states: &[FrictionState]) -> Option<Vec<Vec<f64>>> {
        let mut columns = vec![vec![0.0; states.len()]; self.columns()];
        match columns.as_mut_slice() {
            [only] => {
                for (value, state) in only.iter_mut().zip(states) {
                    (self.law.columns)(state, shape, std::slice::from_mut(value));
                }
            }
            several => {
                let mut values = vec![0.0; several.len()];
                for (at, state) in states.iter().enumerate() {
                    values.fill(0.0);
                    (self.law.columns)(state, shape, &mut values);
                    for (column, value) in several.iter_mut().zip(&values) {
                        column[at] = *value;
                    }
                }
            }
        }
        Some(columns)
    }

    fn is_of_motion(&self) -> bool {
        !self.law.reads(Signal::Load)
    }

    fn reads_velocity(&self) -> bool {
        self.law.reads(Signal::Velocity)
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        (self.law.is_plausible)(coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::MAX_COLUMNS;

    /// Columns that are kept while the load is modelled anew, or taken over at another
    /// velocity, must not depend on it.
    #[test]
    fn no_law_reads_what_it_does_not_say() {
        let at = |load: f64, velocity: f64| Point {
            position: 0.31,
            velocity,
            load,
            temperature: 3.0,
            days: 2.5,
            ..Point::default()
        };
        for law in all() {
            let columns = |point: Point| {
                let mut columns = [0.0; MAX_COLUMNS];
                let shape = vec![0.2; law.description.shape.len()];
                law.evaluate(&shape, &point, &mut [0.0; 4], &mut columns[..law.columns()]);
                columns
            };
            let here = columns(at(4.0, 0.1));
            if law.is_of_motion() {
                assert_eq!(columns(at(-7.0, 0.1)), here, "{}", law.description.id);
            }
            if !law.reads_velocity() {
                assert_eq!(columns(at(4.0, -0.3)), here, "{}", law.description.id);
            }
        }
    }
}

//! Effects whose law the model has, as the servo feeds it forward.

use ferntast_model::friction::{self, FrictionState, Row, StaticEffect};

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
        let state = FrictionState {
            position: point.position,
            velocity: point.velocity,
            load: point.load,
            temperature: point.temperature,
            days: point.days,
        };
        (self.law.columns)(&state, shape, columns);
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        (self.law.is_plausible)(coefficients)
    }
}

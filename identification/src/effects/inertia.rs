//! The inertia: a correction to the one given, or itself a parameter.

use ferntast_model::friction::{
    Contrast, Direction, Exact, OwnSignals, Proposal, Row, Subject, Unit,
};

use super::{Effect, EffectDescription, Facts, Memory, Point, free};

const KILOGRAMS: Unit = Unit::new("kg m²", "kg");

const COMMON: Row = Row {
    id: "inertia",
    of: Subject::Joint,
    source: "rigid body",
    shows_as: "slope over q̈",
    excited_by: "fast accelerations at low speed",
    shown_by: Proposal::FastUnloaded,
    contrasts: &[Contrast::FastByLoad, Contrast::Accelerations],
    confusable_with: &["channel_delay"],
    exact: &[Exact::Acceleration],
    ..Row::NONE
};

static CORRECTION: Row = Row {
    equation: "τ_m = … + ΔJ · q̈",
    coefficients: &[free("dJ", KILOGRAMS)],
    corrects_inertia: true,
    own_signals: OwnSignals::new(&["acceleration"], Direction::Same),
    ..COMMON
};

static FITTED: Row = Row {
    equation: "τ_m = J · q̈ + …",
    coefficients: &[free("inertia", KILOGRAMS)],
    is_inertia: true,
    ..COMMON
};

/// A torque proportional to q̈.
pub struct Inertia {
    row: &'static Row,
    description: EffectDescription,
}

impl Inertia {
    fn new(row: &'static Row) -> Self {
        Self {
            row,
            description: EffectDescription::from_row(row),
        }
    }

    /// An inertia other than the one given: the effect of the catalogue.
    #[must_use]
    pub fn correction() -> Self {
        Self::new(&CORRECTION)
    }

    /// J itself, in a model where it is a parameter.
    #[must_use]
    pub fn fitted() -> Self {
        Self::new(&FITTED)
    }
}

impl Effect for Inertia {
    fn description(&self) -> &EffectDescription {
        &self.description
    }

    fn row(&self) -> &'static Row {
        self.row
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        columns.fill(point.acceleration);
    }

    fn is_of_motion(&self) -> bool {
        true
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.inertia.is_none()).then(|| "the inertia is fitted already".to_owned())
    }
}

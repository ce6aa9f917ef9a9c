//! How an effect describes itself.

use ferntast_model::friction::{EffectParameter, Proposal, Row, Subject, Unit};
use serde::Serialize;

/// A parameter's name and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Name as in results.
    pub name: String,
    /// Unit.
    pub unit: Unit,
}

/// What an effect is and how it shows: its row in the catalogue in words, or
/// that of an effect of the user's own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectDescription {
    /// Name in files, on the command line and in results.
    pub id: String,
    /// What it is an effect of.
    pub of: Subject,
    /// Its part of τ_F, of a contact of F_T.
    pub equation: String,
    /// Where the equation is from.
    pub source: String,
    /// Parameters that are fitted.
    pub coefficients: Vec<Quantity>,
    /// Parameters that are searched.
    pub shape: Vec<Quantity>,
    /// What it looks like in the residual.
    pub shows_as: String,
    /// Motion or condition that makes it visible.
    pub excited_by: String,
    /// The recording that shows it best.
    pub shown_by: Proposal,
    /// Effects that look alike.
    pub taken_for: Vec<String>,
}

impl EffectDescription {
    /// Of an effect of the catalogue.
    #[must_use]
    pub fn of(row: &Row) -> Self {
        let quantities = |parameters: &[EffectParameter]| {
            let quantity = |own: &EffectParameter| Quantity {
                name: own.name.to_owned(),
                unit: own.unit,
            };
            parameters.iter().map(quantity).collect()
        };
        Self {
            id: row.id.to_owned(),
            of: row.of,
            equation: row.equation.to_owned(),
            source: row.source.to_owned(),
            coefficients: quantities(row.coefficients),
            shape: quantities(row.shape),
            shows_as: row.shows_as.to_owned(),
            excited_by: row.excited_by.to_owned(),
            shown_by: row.shown_by,
            taken_for: row.taken_for.iter().map(|id| (*id).to_owned()).collect(),
        }
    }
}

/// Makes the struct of an effect that is no static law, out of its row; within
/// its `impl Effect`, `row!(methods)` gives the two methods that say what it is.
macro_rules! row {
    (methods) => {
        fn description(&self) -> &$crate::effects::EffectDescription {
            &self.0
        }

        fn row(&self) -> &'static ferntast_model::friction::Row {
            &ROW
        }
    };
    ($name:ident, $($field:ident: $value:expr),* $(,)?) => {
        static ROW: ferntast_model::friction::Row = ferntast_model::friction::Row {
            $($field: $value,)*
            ..ferntast_model::friction::Row::NONE
        };

        #[doc = concat!("The effect of this row: ", stringify!($name), ".")]
        pub struct $name($crate::effects::EffectDescription);

        impl Default for $name {
            fn default() -> Self {
                Self($crate::effects::EffectDescription::of(&ROW))
            }
        }
    };
}
pub(crate) use row;

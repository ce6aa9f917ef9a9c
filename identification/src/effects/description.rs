//! How an effect describes itself.

use ferntast_model::friction::{EffectParameter, Proposal, Row, Subject, Unit, Unmeasured};
use serde::Serialize;

/// Name and unit of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Name as in results.
    pub name: String,
    /// Unit, of a revolute and of a prismatic joint.
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
    /// What it is about, where nobody measures that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_unmeasured: Option<Unmeasured>,
    /// Id of the effect that it is another one of the same kind as: it counts beside that alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub another: Option<String>,
    /// Ids of effects that are easily mistaken for it: their signatures in the
    /// residual are similar.
    #[serde(rename = "taken_for")]
    pub confusable_with: Vec<String>,
}

impl EffectDescription {
    /// The description of an effect of the catalogue.
    #[must_use]
    pub fn from_row(row: &Row) -> Self {
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
            of_unmeasured: row.of_unmeasured,
            another: row.another.map(str::to_owned),
            confusable_with: row
                .confusable_with
                .iter()
                .map(|id| (*id).to_owned())
                .collect(),
        }
    }
}

/// Declares the struct of an effect that is no static law from its row; within
/// its `impl Effect`, `row!(methods)` writes the methods `description` and `row`.
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
                Self($crate::effects::EffectDescription::from_row(&ROW))
            }
        }
    };
}
pub(crate) use row;

//! The model with one more effect.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Parameter, fit};
use crate::data::error::PrepareError;
use crate::data::{Dataset, Inertia, ModelSpec, Term};
use crate::design::Design;
use crate::effects;
use crate::preparation::prepare;

/// Errors and parameters without and with one more effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Addition {
    /// Id or name of the effect.
    pub effect: String,
    /// RMS on rows left out, before \[Nm\].
    pub held_out_before: f64,
    /// RMS on rows left out, after \[Nm\].
    pub held_out_after: f64,
    /// RMS on the rows fitted, before \[Nm\].
    pub train_before: f64,
    /// RMS on the rows fitted, after \[Nm\].
    pub train_after: f64,
    /// All parameters of the new model.
    pub parameters: BTreeMap<String, Parameter>,
    /// Parameters that the data do not excite.
    pub not_excited: Vec<String>,
    /// The new model.
    pub model: ModelSpec,
}

/// Fits the model without and with one more effect.
///
/// `inertia` turns a given inertia into a fitted one: a correction to it is
/// the same thing.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn add(dataset: &Dataset, spec: &ModelSpec, effect: &Term) -> Result<Addition, PrepareError> {
    let mut model = spec.clone();
    match effect {
        Term::Catalogue(id) if effects::find(id).is_some_and(|own| own.row().corrects_inertia) => {
            if spec.inertia == Inertia::Fit {
                return Err(PrepareError::Twice(id.clone()));
            }
            // A correction to a given inertia is an inertia that is fitted.
            model.inertia = Inertia::Fit;
        }
        _ => model.effects.push(effect.clone()),
    }
    let prepared = prepare(dataset, &model)?;
    // Both on the rows that the new model is fitted to.
    let before = prepare(dataset, spec)?.on_rows_of(&prepared);
    let before = fit(&before, &Design::new(&before));
    let after = fit(&prepared, &Design::new(&prepared));
    Ok(Addition {
        effect: effect.name().to_owned(),
        held_out_before: before.held_out,
        held_out_after: after.held_out,
        train_before: before.train,
        train_after: after.train,
        parameters: after.parameters,
        not_excited: after.not_excited,
        model,
    })
}

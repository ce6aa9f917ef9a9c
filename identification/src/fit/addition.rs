//! The model with one more effect.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Fit, Parameter, Soundness, fit};
use crate::data::check::check;
use crate::data::error::PrepareError;
use crate::data::{Dataset, Inertia, ModelSpec, Term};
use crate::design::{Design, PreparedModel};
use crate::effects;
use crate::preparation::{Filtered, KnownShape};
use crate::validation::left_out::{Decrease, LeftOut};

/// Errors and parameters without and with one more effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Addition {
    /// Id or name of the effect.
    pub effect: String,
    /// RMS on rows left out, before \[Nm\].
    pub held_out_before: f64,
    /// RMS on rows left out, after \[Nm\].
    pub held_out_after: f64,
    /// The same as mean squares, with the uncertainty of their difference.
    pub decrease: Decrease,
    /// Residuals on rows left out, after.
    #[serde(skip)]
    pub left_out: LeftOut,
    /// Whether the error on rows left out falls by more than its own uncertainty.
    pub lowers_error: bool,
    /// Share of the rows fitted that count for errors: torque beyond a limit of the
    /// drive or its sensor does not.
    pub judged_share: f64,
    /// RMS on the rows fitted, before \[Nm\].
    pub train_before: f64,
    /// RMS on the rows fitted, after \[Nm\].
    pub train_after: f64,
    /// All parameters of the new model.
    pub parameters: BTreeMap<String, Parameter>,
    /// Parameters that the data do not excite.
    pub not_excited: Vec<String>,
    /// Whether they can be told apart, and are possible.
    pub soundness: Soundness,
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
    check(dataset, spec)?;
    let filtered = Filtered::new(dataset);
    let before = filtered.bind(spec)?;
    let base = fit(&before, &Design::new(&before));
    let (addition, _) = add_to(&filtered, spec, (&before, &base), effect, None)?;
    Ok(addition)
}

/// The same of recordings that are filtered, to which `spec` is bound and fitted;
/// and the model with the effect, at `shape` where that is known.
pub(crate) fn add_to(
    filtered: &Filtered<'_>,
    spec: &ModelSpec,
    (prepared, base): (&PreparedModel, &Fit),
    effect: &Term,
    shape: Option<&[f64]>,
) -> Result<(Addition, PreparedModel), PrepareError> {
    let model = with(spec, effect)?;
    let name = effect.name();
    let known = shape.map(|shape| KnownShape {
        effect: name,
        shape,
    });
    let extended = filtered.bind_to_fit(&model, known)?;
    // Both on the rows that the new model is fitted to.
    let same = |of: fn(&PreparedModel) -> Vec<&[usize]>| of(prepared) == of(&extended);
    let refitted = match same(rows) && same(unjudged_rows) {
        true => None,
        false => {
            let before = prepared.clone().on_rows_of(&extended);
            Some(fit(&before, &Design::new(&before)))
        }
    };
    let before = refitted.as_ref().unwrap_or(base);
    let after = fit(&extended, &Design::new(&extended));
    let decrease = after.left_out.decrease_from(&before.left_out);
    let count = |rows: Vec<&[usize]>| rows.iter().map(|own| own.len()).sum::<usize>() as f64;
    let addition = Addition {
        effect: effect.name().to_owned(),
        held_out_before: before.held_out,
        held_out_after: after.held_out,
        lowers_error: decrease.is_certain(),
        decrease,
        judged_share: 1.0 - count(unjudged_rows(&extended)) / count(rows(&extended)).max(1.0),
        train_before: before.train,
        train_after: after.train,
        left_out: after.left_out,
        parameters: after.parameters,
        not_excited: after.not_excited,
        soundness: after.soundness,
        model,
    };
    Ok((addition, extended))
}

/// The model `spec` with one more effect.
fn with(spec: &ModelSpec, effect: &Term) -> Result<ModelSpec, PrepareError> {
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
    Ok(model)
}

fn rows(prepared: &PreparedModel) -> Vec<&[usize]> {
    prepared.rows().collect()
}

fn unjudged_rows(prepared: &PreparedModel) -> Vec<&[usize]> {
    let all = prepared.sessions.iter().chain(&prepared.held_out);
    all.map(|signals| signals.unjudged_rows.as_slice())
        .collect()
}

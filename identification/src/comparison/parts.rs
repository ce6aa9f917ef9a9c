//! A fitted model taken apart: what each of its effects amounts to, and what is lost by
//! who can say only some of them.

use std::collections::BTreeMap;

use nalgebra::DVector;
use serde::Serialize;

use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec};
use crate::design::{Design, PreparedModel};
use crate::effects::{Facts, with_columns};
use crate::fit::{Parameter, Rms, fit};
use crate::preparation::prepare;

/// Which effects, by id or name, a program that the model goes to can say.
pub type Says<'a> = &'a dyn Fn(&str) -> bool;

/// A fitted model taken apart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parts {
    /// Errors \[Nm\].
    pub rms: Rms,
    /// Parameters by name.
    pub parameters: BTreeMap<String, Parameter>,
    /// Those that the data do not excite.
    pub not_excited: Vec<String>,
    /// What each effect amounts to, in the order of the model.
    pub effects: Vec<EffectPart>,
    /// RMS on the rows fitted of the model with only what can be said, its coefficients
    /// left as they are \[Nm\].
    pub without: f64,
    /// That model fitted anew; `None` where everything can be said.
    pub refitted: Option<Refitted>,
    /// What is known of the recordings.
    pub facts: Facts,
}

/// What one effect amounts to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectPart {
    /// Its id, or the name of one of the user's own.
    pub effect: String,
    /// RMS of its torque on the rows fitted \[Nm\].
    pub rms: f64,
    /// Whether it can be said.
    pub said: bool,
}

/// A model with only what can be said, fitted anew to the rows of the whole one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refitted {
    /// Errors \[Nm\].
    pub rms: Rms,
    /// Parameters by name.
    pub parameters: BTreeMap<String, Parameter>,
}

/// Fits the model `spec`, takes it apart, and fits it again with what can be said.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn take_apart(
    dataset: &Dataset,
    spec: &ModelSpec,
    says: Says<'_>,
) -> Result<Parts, PrepareError> {
    let prepared = prepare(dataset, spec)?;
    let mut parts = Parts::new(&prepared, &Design::new(&prepared), says);
    let mut fewer = spec.clone();
    fewer.effects.retain(|term| says(term.name()));
    if fewer.effects.len() < spec.effects.len() {
        let fewer = prepare(dataset, &fewer)?.on_rows_of(&prepared);
        parts.refitted = Some(Refitted::new(&fewer, &Design::new(&fewer)));
    }
    Ok(parts)
}

impl Parts {
    /// Of a model bound to recordings, without the second fit.
    pub(crate) fn new(prepared: &PreparedModel, design: &Design, says: Says<'_>) -> Self {
        let fitted = fit(prepared, design);
        let mut kept = fitted.coefficients.clone();
        let mut effects = Vec::new();
        for (term, columns) in with_columns(&prepared.terms) {
            let row = term.effect.row();
            let effect = term.effect.description().id.clone();
            // The inertia is the joint's own, whatever is said of friction.
            let said = row.is_inertia || row.corrects_inertia || says(&effect);
            let mut own = DVector::zeros(kept.len());
            let first = columns.start;
            let count = columns.count();
            own.rows_mut(first, count)
                .copy_from(&fitted.coefficients.rows(first, count));
            if !said {
                kept.rows_mut(first, count).fill(0.0);
            }
            let rms = rms_of(design, |session| {
                let whole = session.residual(&DVector::zeros(own.len()));
                let less = session.residual(&own);
                whole.iter().zip(less).map(|(a, b)| a - b).collect()
            });
            effects.push(EffectPart { effect, rms, said });
        }
        Self {
            rms: Rms {
                train: fitted.train,
                held_out: fitted.held_out,
            },
            without: rms_of(design, |session| session.residual(&kept)),
            parameters: fitted.parameters,
            not_excited: fitted.not_excited,
            effects,
            refitted: None,
            facts: prepared.facts.clone(),
        }
    }

    /// Parameters as they go on: those fitted anew where `approximate`.
    #[must_use]
    pub fn chosen(&self, approximate: bool) -> &BTreeMap<String, Parameter> {
        match &self.refitted {
            Some(refitted) if approximate => &refitted.parameters,
            _ => &self.parameters,
        }
    }
}

impl Refitted {
    pub(crate) fn new(prepared: &PreparedModel, design: &Design) -> Self {
        let fitted = fit(prepared, design);
        Self {
            rms: Rms {
                train: fitted.train,
                held_out: fitted.held_out,
            },
            parameters: fitted.parameters,
        }
    }
}

/// RMS over the rows that count of what `of` gives for each session.
fn rms_of(design: &Design, of: impl Fn(&crate::design::SessionDesign) -> Vec<f64>) -> f64 {
    let (mut square, mut rows) = (0.0, 0_usize);
    for session in &design.sessions {
        let values = of(session);
        for (value, _) in values.iter().zip(&session.judged).filter(|(_, own)| **own) {
            square += value * value;
            rows += 1;
        }
    }
    (square / rows.max(1) as f64).sqrt()
}

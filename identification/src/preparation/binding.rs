//! The terms of a model, as given, bound to effects of the catalogue or of the user's own.

use std::sync::Arc;

use crate::data::error::PrepareError;
use crate::data::{Inertia, ModelSpec, Term};
use crate::design::PreparedModel;
use crate::effects::expression::Compiled;
use crate::effects::{self, BoundTerm, EffectHandle};

impl PreparedModel {
    /// The effects of `spec`, each with a shape from which a search can start.
    pub(super) fn bind(&self, spec: &ModelSpec) -> Result<Vec<BoundTerm>, PrepareError> {
        let mut terms: Vec<BoundTerm> = Vec::new();
        if spec.inertia == Inertia::Fit {
            let inertia = Arc::new(effects::Inertia::fitted());
            terms.push(BoundTerm::new(inertia, Vec::new()));
        }
        for term in &spec.effects {
            let effect = self.resolve(term)?;
            let id = &effect.description().id;
            if let Some(why) = effect.unavailable(&self.facts) {
                return Err(PrepareError::Unavailable {
                    id: id.clone(),
                    why,
                });
            }
            if terms.iter().any(|t| &t.effect.description().id == id) {
                return Err(PrepareError::Twice(id.clone()));
            }
            // The middle of the grid, else of the bounds.
            let shapes = effect.shapes(&self.facts);
            let bounds = effect.bounds(&self.facts);
            let shape = match shapes.get(shapes.len() / 2) {
                Some(shape) if !shape.is_empty() || bounds.is_empty() => shape.clone(),
                _ => bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect(),
            };
            terms.push(BoundTerm::new(effect, shape));
        }
        Ok(terms)
    }

    /// The effect that a term names.
    fn resolve(&self, term: &Term) -> Result<EffectHandle, PrepareError> {
        match term {
            Term::Catalogue(id) => self.in_catalogue(id),
            Term::Custom(custom) => Ok(Arc::new(Compiled::new(
                custom,
                &self.facts,
                &self.sessions,
            )?)),
        }
    }

    fn in_catalogue(&self, id: &str) -> Result<EffectHandle, PrepareError> {
        let subject = self.facts.joint.subject();
        let coupling = self.coupling();
        let coupling = coupling.filter(|effect| effect.description().id == id);
        match effects::find(id).or(coupling) {
            Some(effect) if effect.description().of == subject => Ok(effect),
            Some(effect) => Err(PrepareError::OtherSubject {
                id: id.to_owned(),
                of: effect.description().of,
                recorded: subject,
            }),
            None => Err(PrepareError::UnknownEffect {
                id: id.to_owned(),
                known: effects::for_subject(subject)
                    .iter()
                    .map(|e| e.description().id.clone())
                    .collect::<Vec<_>>()
                    .join(", "),
            }),
        }
    }
}

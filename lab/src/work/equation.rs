//! The model's equation.

use ferntast_identification::{Inertia, JointType, Term, catalogue};
use serde::Serialize;

use crate::experiment::Experiment;

/// One part of the model's equation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Formula {
    /// Id or name of the effect.
    pub effect: String,
    /// What it is, with the names that its parameters have in results.
    pub formula: String,
}

/// The equation that holds for the subject, then what each effect of the model is in it.
pub(super) fn of(experiment: &Experiment) -> Vec<Formula> {
    let sensor = match experiment.signals.joint_torque {
        Some(_) => "J q̈ + τ + τ_F, τ measured",
        None => "J q̈ + τ + τ_F",
    };
    let (name, whole) = match experiment.joint {
        JointType::Contact => ("contact", "F_T = the sum of these".to_owned()),
        _ => ("joint", format!("τ_m = {sensor}")),
    };
    let mut formulas = vec![Formula {
        effect: name.to_owned(),
        formula: whole,
    }];
    if experiment.joint != JointType::Contact {
        formulas.push(Formula {
            effect: "inertia".to_owned(),
            formula: match experiment.model.inertia {
                Inertia::Given(inertia) => format!("J = {inertia}, given"),
                Inertia::Fit => "J = inertia, fitted".to_owned(),
            },
        });
    }
    let catalogue = catalogue();
    formulas.extend(experiment.model.effects.iter().map(|term| {
        Formula {
            effect: term.name().to_owned(),
            formula: match term {
                Term::Catalogue(id) => catalogue
                    .iter()
                    .find(|own| own.id == *id)
                    .map_or_else(String::new, |own| own.equation.clone()),
                Term::Custom(own) => own.expression.clone(),
            },
        }
    }));
    formulas
}

//! What a form has no words for, and what it amounts to.

use ferntast_identification::catalogue;
use serde::Serialize;

use super::model::{Joint, Model, significant};

/// An effect that could not be said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unsaid {
    /// Its joint.
    pub joint: String,
    /// The effect.
    pub effect: String,
    /// What it is; empty for one of the user's own.
    pub equation: String,
    /// RMS of its torque in the recordings.
    pub rms: f64,
    /// Unit of that.
    pub unit: String,
    /// As a sentence.
    pub text: String,
}

/// All of them.
pub fn all(model: &Model) -> Vec<Unsaid> {
    let catalogue = catalogue();
    let of = |joint: &Joint| -> Vec<Unsaid> {
        let unit = joint.kind.force_unit();
        let lost = joint.parts.effects.iter().filter(|own| !own.said);
        lost.map(|own| {
            let row = catalogue.iter().find(|row| row.id == own.effect);
            let equation = row.map_or_else(String::new, |row| row.equation.clone());
            let words = match equation.as_str() {
                "" => String::new(),
                equation => format!(" ({equation})"),
            };
            Unsaid {
                text: format!(
                    "{}: {}{words} cannot be said in {}: {} {unit} RMS in these recordings; {}",
                    joint.name,
                    own.effect,
                    model.to.title(),
                    significant(own.rms),
                    consequence(model, joint, unit),
                ),
                joint: joint.name.clone(),
                effect: own.effect.clone(),
                equation,
                rms: own.rms,
                unit: unit.to_owned(),
            }
        })
        .collect()
    };
    model.joints.iter().flat_map(of).collect()
}

/// What the joint's model errs by with what is written.
fn consequence(model: &Model, joint: &Joint, unit: &str) -> String {
    let parts = &joint.parts;
    let whole = significant(parts.rms.train);
    let refitted = parts.refitted.as_ref();
    let refitted = significant(refitted.map_or(f64::NAN, |own| own.rms.train));
    match model.approximate {
        true => format!(
            "the rest is fitted without it and errs by {refitted} {unit} on these, the whole model by {whole}"
        ),
        false => format!(
            "without it the rest errs by {} {unit} on these, the whole model by {whole}; fitted anew (--approximate) by {refitted}",
            significant(parts.without),
        ),
    }
}

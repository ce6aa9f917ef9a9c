//! An arm's file of this project: what servo and estimator believe. The twin takes the
//! experiment itself.

use std::{
    collections::BTreeMap,
    fmt::Write,
    path::{Path, PathBuf},
};

use ferntast_model::friction::{self, FrictionParameters};
use ferntast_urdf::edit::number;

use super::{
    IdentifiedError,
    model::{Joint, Model},
    urdf,
};

/// The arm's file, and the URDF that it names beside it; of joints without an arm the
/// sections `[[joint]]` alone.
pub fn files(
    model: &Model,
    output: &Path,
    notes: &mut Vec<String>,
) -> Result<Vec<(PathBuf, String)>, IdentifiedError> {
    let mut text = format!("# {}.\n", model.heading());
    let mut files = Vec::new();
    match &model.arm {
        Some(arm) => {
            let file = output.with_extension("urdf");
            let mut of_urdf = Vec::new();
            files.push((file.clone(), urdf::text(model, None, &mut of_urdf)?));
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let _ = write!(
                text,
                "# ferntast session --arm {} --twin {}\n\n[arm]\nurdf = {:?}\nbase = {:?}\ntip = {:?}\n",
                output.display(),
                model.title,
                name,
                arm.table.arm.base,
                arm.table.arm.tip,
            );
            for own in arm.effects_text() {
                let _ = writeln!(text, "# {own}");
            }
            let gravity = arm.body.gravity;
            let _ = writeln!(
                text,
                "gravity = [{}, {}, {}] # m/s²",
                float(gravity.x),
                float(gravity.y),
                float(gravity.z)
            );
        }
        None => text
            .push_str("# Sections of an arm's file: put each in the place of the joint's own.\n"),
    }
    for joint in &model.joints {
        section(joint, model.arm.is_some(), &mut text, notes);
    }
    files.insert(0, (output.to_owned(), text));
    Ok(files)
}

fn section(joint: &Joint, named: bool, text: &mut String, notes: &mut Vec<String>) {
    text.push_str("\n[[joint]]");
    match named {
        true => {
            let _ = write!(text, "\nname = {:?}\n", joint.name);
        }
        false => {
            let _ = writeln!(text, "                   # {}", joint.name);
        }
    }
    let _ = writeln!(
        text,
        "motor_inertia = {} # {}",
        float(joint.armature.value.max(1e-4)),
        joint.armature.text()
    );
    if let Some(ratio) = joint.gear_ratio {
        let _ = writeln!(text, "gear_ratio = {}", float(ratio));
    }
    let [slow, fast] = joint.parts.facts.speed;
    let _ = write!(
        text,
        "\n[joint.friction]\nspeed_range = [{}, {}] # rad/s or m/s, of the recordings\n\n[joint.friction.effects]\n",
        float(round(slow)),
        float(round(fast))
    );
    for (id, values) in effects(joint) {
        let one = FrictionParameters {
            speed_range: [0.0, 1.0],
            effects: BTreeMap::from([(
                id.to_owned(),
                values
                    .iter()
                    .map(|own| (own.key.to_owned(), own.value))
                    .collect(),
            )]),
        };
        let pairs: Vec<String> = (values.iter())
            .map(|own| format!("{} = {}", own.key, float(own.value)))
            .collect();
        let line = format!("{id} = {{ {} }}", pairs.join(", "));
        let words: Vec<String> = values.iter().map(|own| own.text.clone()).collect();
        match one.validate() {
            Ok(()) => {
                let _ = writeln!(text, "{line} # {}", words.join(", "));
            }
            Err(error) => {
                notes.push(format!("{}: {id} is left out: {error}", joint.name));
                let _ = writeln!(text, "# {line} # {error}");
            }
        }
    }
}

/// A parameter as an arm's file has it.
struct Own {
    key: &'static str,
    value: f64,
    text: String,
}

/// Friction by effect, as the servo has it: of a sum its parts.
fn effects(joint: &Joint) -> Vec<(&'static str, Vec<Own>)> {
    let own = friction::of_joint().filter(|own| !own.row.is_sum);
    let all = own.filter_map(|effect| {
        let row = &effect.row;
        let values: Option<Vec<Own>> = (row.coefficients.iter().chain(row.shape))
            .map(|parameter| {
                let own = joint.get(parameter.name)?;
                Some(Own {
                    key: parameter.key,
                    value: own.value,
                    text: own.text(),
                })
            })
            .collect();
        Some((row.id, values?))
    });
    all.filter(|(id, _)| super::Program::Ferntast.says(id))
        .collect()
}

fn round(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// A number that TOML takes for a float.
fn float(value: f64) -> String {
    let text = number(value);
    match text.contains(['.', 'e', 'n', 'f']) {
        true => text,
        false => format!("{text}.0"),
    }
}

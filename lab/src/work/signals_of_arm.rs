//! Which columns are position and motor torque of each joint of an arm.

use ferntast_identification::JointType;

use super::{
    NewError,
    chain::{ArmChain, ArmJoint},
    error::in_runs,
    new_signal::{Guessed, NewSignal, TakenFor, signal_of, signal_said, unsure},
    request::{Request, Said},
    sources::Sources,
};
use crate::guess::{Role, angle_unit, array_by_name, by_joint};

pub(super) fn guess(request: &Request, sources: &Sources, chain: &ArmChain, guessed: &mut Guessed) {
    for role in [Role::Position, Role::MotorTorque] {
        let names: Vec<&str> = sources
            .columns
            .iter()
            .map(|own| own.name.as_str())
            .collect();
        let by_name = by_joint(role, &chain.names(), &names);
        let mut without_unit = Vec::new();
        for (at, (joint, found)) in chain.joints.iter().zip(by_name).enumerate() {
            let mut signal = match said(request, role, joint, at, chain.joints.len()) {
                Some(Ok(said)) if sources.tables && sources.of(&said.column).is_none() => {
                    let why = format!("there is no column {:?}", said.column);
                    guessed
                        .questions
                        .push(of(joint, unsure(role, why, Vec::new(), sources)));
                    continue;
                }
                Some(Ok(said)) => signal_said(role, &said, sources),
                Some(Err(why)) => {
                    guessed
                        .questions
                        .push(unsure(role, why, Vec::new(), sources));
                    break;
                }
                None => match one(role, joint, &found, sources) {
                    Ok(signal) => signal,
                    Err(question) => {
                        guessed.questions.push(question);
                        continue;
                    }
                },
            };
            if signal.unit.is_empty() {
                without_unit.push(signal.column.clone());
                unit(role, joint, &mut signal, sources, guessed);
            }
            signal.signal = format!("{}@{}", role.key(), joint.name);
            guessed.signals.push(signal);
        }
        if role == Role::MotorTorque && sources.tables && !without_unit.is_empty() {
            guessed.taken.push(TakenFor {
                text: format!(
                    "signals.motor_torque: nothing says the unit of {}, taken for Nm (N of a joint along a line)",
                    without_unit.join(", ")
                ),
                option: "say it by --motor-torque COLUMN:UNIT".to_owned(),
            });
        }
    }
}

/// What was said of this joint's signal: of it alone, or of all joints; why that cannot be.
fn said(
    request: &Request,
    role: Role,
    joint: &ArmJoint,
    at: usize,
    count: usize,
) -> Option<Result<Said, String>> {
    let mut of_joint = request.of_joint.iter().rev();
    let own = of_joint.find(|(other, name, _)| *other == role && *name == joint.name);
    if let Some((_, _, said)) = own {
        return Some(Ok(said.clone()));
    }
    let all = request.said(role)?;
    let with = |column: String| {
        Some(Ok(Said {
            column,
            unit: all.unit.clone(),
        }))
    };
    if all.column.contains("{joint}") {
        return with(all.column.replace("{joint}", &joint.name));
    }
    if all.column.starts_with('/') && !all.column.contains(['[', ',']) {
        return with(array_by_name(&all.column, &joint.name));
    }
    let list: Vec<&str> = all.column.split(',').map(str::trim).collect();
    match list.get(at) {
        // A unit at the end is that of all which have none of their own.
        Some(text) if list.len() == count => {
            let mut own = Said::parse(text);
            own.unit = own.unit.or_else(|| all.unit.clone());
            Some(Ok(own))
        }
        _ => Some(Err(format!(
            "{:?} is {} for {count} joints: say a name with {{joint}} in it, or one column for each with commas between",
            all.column,
            match list.len() {
                1 => "one column".to_owned(),
                several => format!("{several} columns"),
            },
        ))),
    }
}

/// The one column that is called like this joint's signal.
fn one(
    role: Role,
    joint: &ArmJoint,
    found: &[(&str, Option<&'static str>)],
    sources: &Sources,
) -> Result<NewSignal, NewError> {
    let ask = |why: String, choices: Vec<String>| of(joint, unsure(role, why, choices, sources));
    match found {
        [(name, unit)] => {
            let column = sources.column(name);
            let signal = column.map(|own| signal_of(role, own, None, true));
            let mut signal = signal.ok_or_else(|| ask(String::new(), Vec::new()))?;
            if signal.unit.is_empty() {
                signal.unit = unit.unwrap_or_default().to_owned();
            }
            Ok(signal)
        }
        [] => {
            let why = format!("nothing is called like a {} of {}", role.key(), joint.name);
            Err(ask(why, Vec::new()))
        }
        several => {
            let names: Vec<String> = several.iter().map(|(name, _)| (*name).to_owned()).collect();
            Err(ask(
                format!("it can be {}", in_runs(&names).join(" or ")),
                names,
            ))
        }
    }
}

/// The unit of a signal of which nothing says it; asked for where an angle goes over many turns.
fn unit(
    role: Role,
    joint: &ArmJoint,
    signal: &mut NewSignal,
    sources: &Sources,
    guessed: &mut Guessed,
) {
    let linear = joint.joint == JointType::Prismatic;
    let usual = match (role, linear) {
        (Role::Position, false) => "rad",
        (Role::Position, true) => "m",
        (_, false) => "Nm",
        (_, true) => "N",
    };
    let range = signal
        .range
        .map_or(0.0, |[least, greatest]| greatest - least);
    match angle_unit(range).filter(|_| usual == "rad") {
        Some(unit) => {
            let column = &signal.column;
            let why = format!(
                "{column:?} goes over {range:.0}, which is many turns in rad: it may be in {unit}"
            );
            let choices = [unit, "rad"]
                .map(|unit| format!("{column}:{unit}"))
                .to_vec();
            let question = unsure(role, why, choices, sources);
            guessed.questions.push(of(joint, question));
        }
        None => signal.unit = usual.to_owned(),
    }
}

/// A question about this joint.
fn of(named: &ArmJoint, question: NewError) -> NewError {
    match question {
        NewError::Unsure {
            role,
            why,
            choices,
            columns,
            ..
        } => NewError::Unsure {
            role,
            joint: Some(named.name.clone()),
            why,
            choices,
            columns,
        },
        other => other,
    }
}

//! Which columns are the signals of one joint.

use ferntast_identification::JointType;

use super::{
    new_signal::{Guessed, NewSignal, TakenFor, must, unsure},
    request::Request,
    sources::Sources,
};
use crate::{
    guess::{Role, angle_unit},
    unit::{Quantity, Unit},
};

/// A joint that moves along a line, where a unit says so.
pub(super) fn joint_of(signals: &[NewSignal]) -> JointType {
    let is_linear = |signal: &NewSignal| {
        let quantity = Unit::parse(&signal.unit).map(|unit| unit.quantity());
        matches!(quantity, Some(Quantity::Length | Quantity::Force))
    };
    match signals.iter().any(is_linear) {
        true => JointType::Prismatic,
        false => JointType::Revolute,
    }
}

pub(super) fn guess(request: &Request, sources: &Sources, guessed: &mut Guessed) {
    let torque = must(request, sources, Role::MotorTorque);
    let position = must(request, sources, Role::Position);
    let mut torque = guessed.or_ask(torque);
    let mut position = guessed.or_ask(position);
    if let Some(torque) = torque.as_mut().filter(|own| own.unit.is_empty()) {
        let linear = request.joint == Some(JointType::Prismatic);
        torque.unit = if linear { "N" } else { "Nm" }.to_owned();
        if sources.tables {
            guessed.taken.push(TakenFor {
                text: format!(
                    "signals.motor_torque: nothing says the unit of {:?}, taken for {}",
                    torque.column, torque.unit
                ),
                option: format!(
                    "a current or voltage is told by --motor-torque {}:A, or :V",
                    torque.column
                ),
            });
        }
    }
    if let Some(position) = position.as_mut().filter(|own| own.unit.is_empty()) {
        let force = torque.as_ref().and_then(|own| Unit::parse(&own.unit));
        let linear = force.map(|unit| unit.quantity()) == Some(Quantity::Force)
            || request.joint == Some(JointType::Prismatic);
        let range = position
            .range
            .map_or(0.0, |[least, greatest]| greatest - least);
        match angle_unit(range).filter(|_| !linear) {
            Some(unit) => guessed.questions.push(unsure(
                Role::Position,
                format!(
                    "{:?} goes over {range:.0}, which is many turns in rad: it may be in {unit}",
                    position.column
                ),
                vec![
                    format!("{}:{unit}", position.column),
                    format!("{}:rad", position.column),
                ],
                sources,
            )),
            None => position.unit = if linear { "m" } else { "rad" }.to_owned(),
        }
    }
    let position_unit = position.as_ref().and_then(|own| Unit::parse(&own.unit));
    let linear = position_unit.map(|unit| unit.quantity()) == Some(Quantity::Length);
    guessed.signals.extend(position);
    guessed.signals.extend(torque);
    let torque_unit = if linear { "N" } else { "Nm" };
    guessed.maybe(request, sources, Role::JointTorque, torque_unit);
    guessed.maybe(request, sources, Role::Temperature, "degC");
}

//! Which columns are the signals of a contact.

use super::{
    new_signal::{Guessed, must},
    request::Request,
    sources::Sources,
};
use crate::guess::{Role, opposes};

pub(super) fn guess(request: &Request, sources: &Sources, guessed: &mut Guessed) {
    let places: &[Role] = match request.by_tip {
        true => &[Role::TipX, Role::TipY],
        false => &[Role::Place],
    };
    let forces = [Role::TangentialForce, Role::NormalForce];
    for role in places.iter().chain(&forces) {
        let found = must(request, sources, *role);
        let Some(mut signal) = guessed.or_ask(found) else {
            continue;
        };
        if signal.unit.is_empty() {
            let usual = if forces.contains(role) { "N" } else { "m" };
            signal.unit = usual.to_owned();
        }
        // Friction opposes motion, and what is recorded may be the force on the tip.
        if *role == Role::TangentialForce && signal.guessed {
            signal.column = opposes(&signal.column).unwrap_or(signal.column);
        }
        guessed.signals.push(signal);
    }
    guessed.maybe(request, sources, Role::Temperature, "degC");
}

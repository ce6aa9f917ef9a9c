//! Which columns of files that somebody brought are which signals: as it was said, else by
//! names and numbers. The same for a joint, a contact and an arm, whose own rules are in
//! `signals_of_…` beside this.

use super::{
    NewError,
    chain::ArmChain,
    new_signal::{Guessed, NewSignal, TakenFor, find, signal_of, signal_said, unsure},
    request::Request,
    signals_of_arm, signals_of_contact, signals_of_joint,
    sources::Sources,
};
use crate::guess::{Role, time_unit};

/// Signals and their units, as they were said, or by names and numbers. Without its
/// unit is one that is asked for. `chain` is the arm's, where it is about one.
pub(super) fn guess(request: &Request, sources: &Sources, chain: Option<&ArmChain>) -> Guessed {
    let mut guessed = Guessed::default();
    if sources.tables && request.rate_hz.is_none() {
        let mut taken = Vec::new();
        match time(request, sources, &mut taken) {
            Ok(signal) => guessed.signals.push(signal),
            Err(question) => guessed.questions.push(question),
        }
        guessed.taken.append(&mut taken);
    }
    match chain {
        Some(chain) => signals_of_arm::guess(request, sources, chain, &mut guessed),
        None if request.is_contact() => signals_of_contact::guess(request, sources, &mut guessed),
        None => signals_of_joint::guess(request, sources, &mut guessed),
    }
    for (name, said) in &request.extra {
        let mut signal = signal_said(Role::Temperature, said, sources);
        signal.signal = format!("extra.{name}");
        guessed.signals.push(signal);
    }
    guessed
}

/// The column that is time, by its name or because it ascends.
fn time(
    request: &Request,
    sources: &Sources,
    taken: &mut Vec<TakenFor>,
) -> Result<NewSignal, NewError> {
    let mut signal = match find(request, sources, Role::Time)? {
        Some(signal) => signal,
        None => {
            let mut ascending = sources.columns.iter().filter(|own| own.ascends);
            match (ascending.next(), ascending.next()) {
                (Some(own), None) => {
                    taken.push(TakenFor {
                        text: format!(
                            "signals.time: {:?} is taken for time, since it alone ascends",
                            own.name
                        ),
                        option: String::new(),
                    });
                    signal_of(Role::Time, own, None, true)
                }
                _ => {
                    let why = "no column is called time or t";
                    return Err(unsure(Role::Time, why.to_owned(), Vec::new(), sources));
                }
            }
        }
    };
    if signal.unit.is_empty() {
        let survey = sources.column(&signal.column);
        let (first, step) = survey.map_or((0.0, 0.0), |own| (own.first, own.step));
        signal.unit = match time_unit(first, step) {
            Some(unit) => {
                taken.push(TakenFor {
                    text: format!(
                        "signals.time: {:?} goes in steps of {step}, which cannot be s: taken for {unit}",
                        signal.column
                    ),
                    option: format!("--time {}:s if that is right", signal.column),
                });
                unit.to_owned()
            }
            None => "s".to_owned(),
        };
    }
    Ok(signal)
}

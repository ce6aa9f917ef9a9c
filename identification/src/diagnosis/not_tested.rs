//! What recordings cannot show, whatever the verdict.

use serde::Serialize;

use crate::design::PreparedModel;
use crate::effects::{self, COUPLING};

/// Effects that were not tried, since the recordings could not show them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NotTested {
    /// Their ids.
    pub not_tested: Vec<String>,
    /// The same in words, one line for each reason: `wear_drift: fewer than four sessions …`.
    pub why_not_tested: Vec<String>,
}

impl NotTested {
    /// Of a joint or a contact by itself; `has_others`: whether motions of other joints are at hand.
    pub(crate) fn of(prepared: &PreparedModel, has_others: bool) -> Self {
        let facts = &prepared.facts;
        let mut all = Self::default();
        if !has_others && !facts.joint.is_contact() {
            let why = "the motions of other joints are not among the signals";
            all.push(vec![COUPLING.to_owned()], why);
        }
        // What else is not available is a matter of the model, or of a sensor that is not there.
        let mut reasons: Vec<String> = [
            facts.no_temperature(),
            facts.too_few_temperatures(),
            facts.no_dates(),
            facts.no_warm_up(),
            facts.no_load(),
            facts.no_torque_sensor(),
        ]
        .into_iter()
        .flatten()
        .collect();
        // Without a temperature there are too few of them, too.
        reasons.dedup();
        for why in reasons {
            let missing = effects::for_subject(facts.joint.subject()).into_iter();
            let missing = missing.filter(|effect| {
                let row = effect.row();
                let is_unavailable = effect.unavailable(facts).as_ref() == Some(&why);
                is_unavailable && prepared.offers(row) && !prepared.has(row.id)
            });
            all.push(missing.map(|own| own.row().id.to_owned()).collect(), &why);
        }
        all
    }

    fn push(&mut self, effects: Vec<String>, why: &str) {
        if !effects.is_empty() {
            (self.why_not_tested).push(format!("{}: {why}", effects.join(", ")));
            self.not_tested.extend(effects);
        }
    }
}

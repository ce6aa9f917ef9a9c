//! Every refusal is told.

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// A link says within this time what it refused, a gateway within ten times that \[steps\].
const SAID: i64 = 15;

/// What an end of the link, or a gateway, has refused stands in its counts: at
/// least as many as frames came that were damaged, forged or replayed, and as
/// messages that cannot be acted on.
pub struct RefusalsTold;

impl Invariant for RefusalsTold {
    fn name(&self) -> &'static str {
        "refusals_told"
    }

    fn step(&mut self, seen: &Seen, log: &Log, _: &Facts) -> Option<String> {
        let ends = [("operator's", seen.back), ("arm's", seen.forth)];
        for (place, (name, arrivals)) in ends.into_iter().enumerate() {
            let told = seen.link_told[place];
            // What the page's sliders delay comes later.
            let settled = arrivals.refusable_at + log.channel_delay + 40;
            let said = told.at == seen.tick && told.at > settled && !log.channel_loses;
            if said && told.refused < arrivals.refusable {
                return Some(format!(
                    "the {name} end of the link tells of {} refused frames, {} came",
                    told.refused, arrivals.refusable
                ));
            }
            let told = seen.gateway_told[place];
            let (refusable, at) = log.gateway_refusable[place];
            if told.at == seen.tick && told.at > at + SAID && told.refused < refusable {
                return Some(format!(
                    "the {name} gateway tells of {} refused messages, {refusable} came",
                    told.refused
                ));
            }
        }
        None
    }
}

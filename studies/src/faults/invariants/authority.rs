//! Only the hand that holds the authority moves the arm.

use std::collections::VecDeque;

use super::{
    super::{facts::Facts, fault::Word, log::Log, seen::Seen, truth::length},
    Invariant,
};

/// How long a place of the hand may still be commanded \[steps\]: two ways of the
/// link, the law's own filters, and frames that were held back.
const REMEMBERED: usize = 600;
/// How far a commanded tip may be from where the hand was \[m\]. Laws that shape
/// motion to keep their energy (waves, passivity control, a model of the
/// contact) lead it astray further than those that send it as it is.
const PLAIN: f64 = 0.003;
const SHAPED: f64 = 0.060;

/// By so much more than the hand the clutch may lead the arm in a step, for rounding \[m\].
const ROUNDING: f64 = 1e-6;

/// The tip is commanded to places where the hand was, give or take what the law
/// does to motion; and what the master accepts is where its own hand is. Once there was a word to
/// the clutch, that moves no further than the hand from one step to the next, and counts in its place.
#[derive(Default)]
pub struct Authority {
    hands: VecDeque<[f64; 3]>,
    /// The hand, and what was accepted, when both were told last.
    last: Option<[[f64; 3]; 2]>,
}

/// How far apart two places are \[m\].
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    length([a[0] - b[0], a[1] - b[1], a[2] - b[2]])
}

impl Authority {
    /// Whether the clutch led the arm somewhere.
    fn clutch(&mut self, seen: &Seen, hand: [f64; 3], accepted: [f64; 3]) -> Option<String> {
        let last = self.last.replace([hand, accepted]);
        let [hand_before, before] = last.filter(|_| seen.leader.enabled())?;
        let (led, moved) = (apart(accepted, before), apart(hand, hand_before));
        (led > moved + ROUNDING).then(|| {
            format!("the clutch led the arm by {led:.6} m where the hand went {moved:.6} m")
        })
    }
}

impl Invariant for Authority {
    fn name(&self) -> &'static str {
        "authority"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let clutched = log.words.iter().any(|own| own.word == Word::Clutch);
        if !seen.leader.enabled() {
            self.last = None;
        }
        let leads = match clutched {
            true => seen.accepted_hand,
            false => seen.hand,
        };
        if let Some(hand) = leads {
            if self.hands.len() == REMEMBERED {
                self.hands.pop_front();
            }
            self.hands.push_back(facts.tip_of_hand(hand));
        }
        if let (Some(hand), Some(accepted)) = (seen.hand, seen.accepted_hand) {
            let far = apart(hand, accepted);
            if clutched {
                if let Some(told) = self.clutch(seen, hand, accepted) {
                    return Some(told);
                }
            } else if far > PLAIN {
                return Some(format!("the master accepts a hand {far:.4} m from its own"));
            }
        }
        // Of an arm that does not follow, laws that send velocities run away.
        let command = seen.tip_command.filter(|_| seen.follower.enabled())?;
        let allowed = match facts.law.as_str() {
            "position_force" if !log.law_switched => PLAIN,
            _ => SHAPED,
        };
        // From the newest: mostly it is there within a few steps.
        let mut nearest = f64::INFINITY;
        for hand in self.hands.iter().rev() {
            nearest = nearest.min(apart(*hand, command));
            if nearest <= allowed {
                return None;
            }
        }
        Some(format!(
            "the tip is commanded to ({:.4}, {:.4}, {:.4}) m, {nearest:.4} m from where the hand was",
            command[0], command[1], command[2]
        ))
    }
}

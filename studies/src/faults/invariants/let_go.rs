//! Who falls silent lets go.

use ferntast_model::Joints;

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// From the last word of the other to the release \[steps\]: 30 ms, and what the
/// limit of the rate takes to lead the force to nothing.
const HAND: i64 = 30 + 12;
/// The drives are off after so long without a torque \[steps\].
const DRIVES: i64 = 13;
/// An arm that holds stays within this of where it was \[rad\], springs of gears and
/// servo included.
const STAYS: f64 = 0.03;
/// And that long after it began to hold \[steps\].
const RESTS: i64 = 50;

/// A hand that nobody hears of, or that the link says nothing of, gets no force.
#[derive(Default)]
pub struct HandLetGo {
    accepted: i64,
    reflected: i64,
}

impl Invariant for HandLetGo {
    fn name(&self) -> &'static str {
        "hand_let_go"
    }

    fn step(&mut self, seen: &Seen, log: &Log, _: &Facts) -> Option<String> {
        if seen.accepted_hand.is_some() {
            self.accepted = seen.tick;
        }
        if seen.reflected {
            self.reflected = seen.tick;
        }
        let force = seen.hand_force?;
        let own = force.iter().map(|part| part * part).sum::<f64>().sqrt();
        // A master that was held up itself has just begun to hear again.
        let running = seen.tick - log.master_stalled > HAND;
        let silent = seen.tick - self.accepted.min(self.reflected);
        (own > 1e-9 && running && silent > HAND).then(|| {
            format!(
                "{own:.2} N on the hand, {} ms after it was heard of and {} ms after the link spoke",
                seen.tick - self.accepted,
                seen.tick - self.reflected
            )
        })
    }
}

/// The drives are off when the servo has fallen silent.
#[derive(Default)]
pub struct DrivesOff {
    spoke: i64,
}

impl Invariant for DrivesOff {
    fn name(&self) -> &'static str {
        "drives_off"
    }

    fn step(&mut self, seen: &Seen, _: &Log, facts: &Facts) -> Option<String> {
        if seen.torque.is_some() {
            self.spoke = seen.tick;
        }
        let silent = seen.tick - self.spoke;
        let mut both = seen.driven.iter().zip(facts.noise.iter());
        let driven = both.any(|(torque, noise)| torque.abs() > *noise);
        (seen.arm_stepped && silent > DRIVES && driven).then(|| {
            format!(
                "motors have {:.1?} Nm {silent} ms after the servo fell silent",
                seen.driven
            )
        })
    }
}

/// An arm that is paused stays where it was paused.
#[derive(Default)]
pub struct StaysPut {
    at: Option<(Joints<f64>, i64)>,
}

impl Invariant for StaysPut {
    fn name(&self) -> &'static str {
        "stays_put"
    }

    fn step(&mut self, seen: &Seen, log: &Log, _: &Facts) -> Option<String> {
        let position = seen.truth.motor_position;
        if !seen.follower.paused() || !seen.servo_stepped || seen.tick <= log.sensor_wrong {
            self.at = None;
            return None;
        }
        let (began, since) = *self.at.get_or_insert((position, seen.tick));
        let both = position.iter().zip(began.iter());
        let farthest = both
            .map(|(now, began)| (now - began).abs())
            .fold(0.0, f64::max);
        (farthest > STAYS && seen.tick - since > RESTS).then(|| {
            format!(
                "a joint is {farthest:.3} rad from where the arm was paused {} ms ago",
                seen.tick - since
            )
        })
    }
}

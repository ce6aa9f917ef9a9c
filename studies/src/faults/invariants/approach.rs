//! The way to the first command is slow.

use ferntast_model::{Vector2, kinematics::Elbow};

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// A joint's setpoint has come to the command when it is this near \[rad\].
const THERE: f64 = 0.006;
/// For so long, but for some steps, the arm approaches slowly \[steps\], and grows faster by so much then
/// \[rad/s²\].
const PATIENCE: i64 = 1990;
const HURRY: f64 = 0.2;
/// The hand's own speed is allowed too, their squares added up, averaged over so long \[steps\].
const AVERAGED: f64 = 250.0;
/// Above the approach speed, for rounding \[-\].
const ROUNDING: f64 = 1.001;

/// After every enabling, and after the servo was held up, no joint's setpoint goes faster
/// than hand and approach together (as energies) until all are where the commands are.
#[derive(Default)]
pub struct SlowApproach {
    approaching: bool,
    began: i64,
    command: Option<[f64; 3]>,
    /// Where the joints were commanded to be \[rad\], and how fast \[rad/s\].
    goal: Option<[f64; 2]>,
    hand: [f64; 2],
}

/// Where the joints are with the tip there, bent as at `position` \[rad\].
fn joints(facts: &Facts, tip: [f64; 3], position: [f64; 2]) -> Option<[f64; 2]> {
    let elbow = Elbow::of(&Vector2::from(position));
    let joints = facts
        .kinematics
        .inverse(&Vector2::new(tip[0], tip[1]), elbow);
    joints.ok().map(Into::into)
}

impl SlowApproach {
    /// Notes how fast the hand goes, of which a step says that it is at `tip`.
    fn follow(&mut self, facts: &Facts, tip: Option<[f64; 3]>, position: [f64; 2]) {
        let goal = tip.and_then(|tip| joints(facts, tip, position));
        let before = self.goal;
        self.goal = goal.or(before);
        let (now, before) = (self.goal.unwrap_or_default(), before.or(goal));
        for (joint, hand) in self.hand.iter_mut().enumerate() {
            let travel = before.map_or(0.0, |before| (now[joint] - before[joint]).abs() * 1e3);
            *hand += (travel - *hand) / AVERAGED;
        }
    }
}

impl Invariant for SlowApproach {
    fn name(&self) -> &'static str {
        "slow_approach"
    }

    fn step(&mut self, seen: &Seen, _: &Log, facts: &Facts) -> Option<String> {
        if seen.begins() {
            self.approaching = true;
            self.began = seen.tick;
            self.command = None;
            self.hand = [0.0; 2];
        }
        if !seen.follower.enabled() {
            self.approaching = false;
        }
        // What is published in this step is acted on in the next.
        let before = self.command;
        self.command = seen.tip_command.or(before);
        let (position, velocity) = seen.setpoint?;
        self.follow(facts, seen.tip_command, position);
        if !self.approaching {
            return None;
        }
        let command = joints(facts, before?, position)?;
        if (0..2).all(|joint| (position[joint] - command[joint]).abs() < THERE) {
            self.approaching = false;
        }
        // Who has not come to the hand in two seconds may hurry.
        let late = (seen.tick - self.began - PATIENCE).max(0) as f64 * 1e-3;
        let energies = |hand: f64| facts.approach_speed.hypot(hand);
        let allowed = self.hand.map(|hand| energies(hand) + HURRY * late);
        let joint = (0..2).find(|&joint| velocity[joint].abs() > allowed[joint] * ROUNDING)?;
        self.approaching.then(|| {
            format!(
                "the setpoint of joint {} goes to the first command at {:.3} rad/s, \
                 {:.3} are allowed",
                joint + 1,
                velocity[joint],
                allowed[joint]
            )
        })
    }
}

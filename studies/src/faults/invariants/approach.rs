//! The way to the first command is slow.

use ferntast_model::{Joints, MAX_JOINTS};

use super::{
    super::{body::Leading, facts::Facts, log::Log, seen::Seen},
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
    leading: Option<Leading>,
    /// Where the newest command since the beginning puts the joints \[rad\].
    command: Option<Joints<f64>>,
    /// Where the joints were commanded to be \[rad\], and how fast \[rad/s\].
    goal: Option<Joints<f64>>,
    hand: [f64; MAX_JOINTS],
    /// The setpoint \[rad\].
    position: Option<Joints<f64>>,
}

impl SlowApproach {
    /// Where the tip command of this step, if there is one, puts the joints \[rad\].
    fn commanded(&mut self, seen: &Seen, facts: &Facts) -> Option<Joints<f64>> {
        if self.leading.is_none() {
            // Facts are of an arm that the servo takes.
            self.leading = facts.body.leading().ok();
        }
        let leading = self.leading.as_mut()?;
        if seen.begins() && leading.begin() {
            self.goal = None;
        }
        let position = self.position.unwrap_or(seen.truth.motor_position);
        leading.joints(seen.tick, seen.tip_command?, &position)
    }

    /// Notes how fast the hand goes, of which a step says that the joints belong there.
    fn follow(&mut self, goal: Option<Joints<f64>>) {
        let before = self.goal;
        self.goal = goal.or(before);
        let Some((now, before)) = self.goal.zip(before.or(goal)) else {
            return;
        };
        for (joint, hand) in self.hand.iter_mut().enumerate().take(now.len()) {
            let travel = (now[joint] - before[joint]).abs() * 1e3;
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
            self.hand = [0.0; MAX_JOINTS];
        }
        if !seen.follower.enabled() {
            self.approaching = false;
        }
        let goal = self.commanded(seen, facts);
        // What is published in this step is acted on in the next.
        let before = self.command;
        if seen.tip_command.is_some() {
            self.command = goal;
        }
        let (position, velocity) = seen.setpoint?;
        self.position = Some(position);
        self.follow(goal);
        if !self.approaching {
            return None;
        }
        let command = before?;
        let mut both = position.iter().zip(command.iter());
        if both.all(|(at, to)| (at - to).abs() < THERE) {
            self.approaching = false;
        }
        // Who has not come to the hand in two seconds may hurry.
        let late = (seen.tick - self.began - PATIENCE).max(0) as f64 * 1e-3;
        let energies = |hand: f64| facts.approach_speed.hypot(hand);
        let allowed = self.hand.map(|hand| energies(hand) + HURRY * late);
        let mut joints = 0..velocity.len();
        let joint = joints.find(|&joint| velocity[joint].abs() > allowed[joint] * ROUNDING)?;
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

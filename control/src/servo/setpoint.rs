//! From commands to a setpoint that the arm can follow.
//!
//! Two stages a joint. The **tracker** smooths commands that arrive at their
//! own rate: a second-order filter without steady lag at constant velocity,
//!
//! p̂˙ = v̂ + 2ζω (p − p̂),  v̂˙ = ω² (p − p̂),  ζ = 1
//!
//! (the steady-state α-β filter; Bar-Shalom, Li, Kirubarajan, *Estimation with
//! Applications to Tracking and Navigation*, 2001, section 6.5). The
//! **generator** follows p̂, v̂ within limits of velocity and acceleration and
//! brakes in time: the speed towards the target is at most
//! √(2a(|d| − a/2k²)), with k|d| near it.

use crate::planted::{Planted, Rule};

/// Position, velocity and acceleration that one joint should have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// \[rad\]
    pub position: f64,
    /// \[rad/s\]
    pub velocity: f64,
    /// \[rad/s²\]
    pub acceleration: f64,
}

/// Limits of the setpoint of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetpointLimits {
    /// Largest speed \[rad/s\].
    pub velocity: f64,
    /// Largest acceleration \[rad/s²\].
    pub acceleration: f64,
    /// Largest speed on the way to the first command, for its first two seconds, where the
    /// hand is at rest \[rad/s\].
    pub approach: f64,
    /// Lower end of the range \[rad\].
    pub lower: f64,
    /// Upper end of the range \[rad\].
    pub upper: f64,
}

/// Share of the acceleration limit that braking counts on.
const BRAKING_SHARE: f64 = 0.8;
/// For so long the first command is approached at the approach speed; then faster and
/// faster, so that a hand that does not wait is caught [s].
const PATIENCE: f64 = 2.0;
/// How fast the speed of the approach grows then [rad/s²].
const HURRY: f64 = 0.2;
/// Time over which the speed of the hand is averaged [s].
const HAND_SPEED_TIME: f64 = 0.25;
/// Of that speed, so much is allowed to the approach: what is in its way it meets without
/// the hand having braked for it.
const HAND_SHARE: f64 = 0.8;
/// Joints that come to the first command within so long of each other need not wait \[s\].
const EVEN: f64 = 0.01;
/// Acceleration at the start, as a share of its limit: with that of a motor of 1 kg m²
/// the torque begins with a step of 2 Nm, not of 40.
const FIRST_SHARE: f64 = 0.05;
/// How fast the acceleration may grow that stops a setpoint that is called back [rad/s³]: with
/// a motor of 1 kg m² by 1 Nm in a step.
const BRAKING_JERK: f64 = 1000.0;
/// Time in which the acceleration is led over to its limit after the start [s].
const LEAD_TIME: f64 = 0.3;
/// A joint has come to the first command once the setpoint is this near to the tracker [rad],
const APPROACHED: f64 = 0.5e-3;
/// and this near to what is commanded, which the tracker overshoots after a sudden
/// movement of the hand [rad].
const AT_COMMAND: f64 = 4e-3;

/// Setpoint of one joint.
#[derive(Clone, Copy, Debug)]
pub struct SetpointGenerator {
    frequency: f64,
    limits: SetpointLimits,
    target: Option<f64>,
    tracked_position: f64,
    tracked_velocity: f64,
    approaching: bool,
    near: bool,
    /// Time since the first command \[s\].
    since_first: f64,
    /// Speed of the commands, averaged \[rad/s\].
    hand_speed: f64,
    /// Largest speed of the approach now \[rad/s\], and the share of it that is used.
    top: f64,
    share: f64,
    /// How far the acceleration is led over to its limit, 0 … 1.
    led: f64,
    /// With which a setpoint that is called back is stopped \[rad/s²\].
    braking: f64,
    setpoint: Setpoint,
    pub(super) planted: Planted,
}

impl SetpointGenerator {
    /// A generator whose tracker has the natural frequency `frequency` \[rad/s\].
    pub fn new(frequency: f64, limits: SetpointLimits) -> Self {
        SetpointGenerator {
            frequency,
            limits,
            target: None,
            tracked_position: 0.0,
            tracked_velocity: 0.0,
            approaching: true,
            near: false,
            since_first: 0.0,
            hand_speed: 0.0,
            top: limits.approach,
            share: 1.0,
            led: 0.0,
            braking: 0.0,
            setpoint: Setpoint::default(),
            planted: Planted::NONE,
        }
    }

    /// Starts at rest at `position` \[rad\] without a target.
    pub fn start(&mut self, position: f64) {
        if self.planted.lacks(Rule::BeginWhereMeasured) {
            return;
        }
        self.target = None;
        self.approaching = true;
        self.near = false;
        self.since_first = 0.0;
        self.hand_speed = 0.0;
        self.top = self.limits.approach;
        self.led = 0.0;
        self.braking = 0.0;
        self.setpoint = Setpoint {
            position,
            ..Setpoint::default()
        };
    }

    /// Sets the target \[rad\]; the setpoint moves to it within its limits.
    pub fn set_target(&mut self, target: f64) {
        if self.target.is_none() {
            self.tracked_position = target;
            self.tracked_velocity = 0.0;
        }
        self.target = Some(target);
    }

    /// Whether it waits for a first command.
    pub fn is_waiting(&self) -> bool {
        self.target.is_none()
    }

    /// Whether it is still on its way to the first command.
    pub fn is_approaching(&self) -> bool {
        self.target.is_some() && self.approaching
    }

    /// Whether it follows commands, after the way to the first one.
    pub fn is_following(&self) -> bool {
        self.target.is_some() && !self.approaching
    }

    /// Whether it is where the commands are.
    pub fn is_near(&self) -> bool {
        self.near
    }

    /// How long the way to the command takes at the approach's speed \[s\].
    pub fn time_left(&self) -> f64 {
        (self.tracked_position - self.setpoint.position).abs() / self.top
    }

    /// Goes along with other joints, the slowest of which takes `slowest` \[s\] to the first
    /// command: all come there together, on a straight line. One that is there before the
    /// others takes the tip elsewhere, deeper into what the hand presses on.
    pub fn keep_pace(&mut self, slowest: f64) {
        self.share = ((self.time_left() + EVEN) / (slowest + EVEN)).min(1.0);
    }

    /// The arm has come to the first command: from now on at full speed. That is so when
    /// all its joints are near.
    pub fn end_approach(&mut self) {
        self.approaching = false;
    }

    /// The setpoint.
    pub fn setpoint(&self) -> Setpoint {
        self.setpoint
    }

    /// Stands still where it is, at once; what smooths the commands begins there anew.
    pub fn stand(&mut self) {
        self.tracked_position = self.setpoint.position;
        self.tracked_velocity = 0.0;
        self.setpoint.velocity = 0.0;
        self.setpoint.acceleration = 0.0;
    }

    /// Moves on by `dt` \[s\]. Returns whether velocity or acceleration was limited.
    pub fn step(&mut self, dt: f64) -> bool {
        let Some(target) = self.target else {
            self.setpoint.velocity = 0.0;
            self.setpoint.acceleration = 0.0;
            return false;
        };
        self.track(target, dt);
        let mut limits = self.limits;
        self.led = (self.led + dt / LEAD_TIME).min(1.0);
        // Slowly at first: where it starts to move, friction that is fed forward turns its
        // sign, and the torque would jump with it.
        let share = if self.approaching {
            0.0
        } else {
            self.led * self.led
        };
        limits.acceleration *= FIRST_SHARE + (1.0 - FIRST_SHARE) * share;
        let top = if self.approaching && !self.planted.lacks(Rule::ApproachSpeed) {
            self.since_first += dt;
            self.hand_speed +=
                (self.tracked_velocity.abs() - self.hand_speed) * (dt / HAND_SPEED_TIME).min(1.0);
            let hurry = HURRY * (self.since_first - PATIENCE).max(0.0);
            // What the arm runs into it hits no harder than the hand would have it hit.
            let hand = HAND_SHARE * self.hand_speed;
            self.top = (limits.approach.hypot(hand) + hurry).min(limits.velocity);
            self.share * self.top
        } else {
            limits.velocity
        };
        let distance = self.tracked_position - self.setpoint.position;
        let wanted = self
            .tracked_velocity
            .clamp(-limits.velocity, limits.velocity)
            + self.closing_speed(distance, limits.acceleration);
        let bounded = wanted.clamp(-top, top);
        let speed = self.setpoint.velocity;
        // Called back, from what is in its way perhaps, it stops as soon as torque may change.
        let ends_softly = (2.0 * BRAKING_JERK * speed.abs()).sqrt();
        self.braking = match bounded * speed < 0.0 {
            true => (self.braking + BRAKING_JERK * dt).min(ends_softly),
            false => 0.0,
        };
        limits.acceleration = limits
            .acceleration
            .max(self.braking.min(self.limits.acceleration));
        let step = limits.acceleration * dt;
        let change = bounded - speed;
        let velocity = speed + change.clamp(-step, step);
        let before = self.setpoint.position;
        let position =
            (before + velocity * dt).clamp(limits.lower.min(before), limits.upper.max(before));
        let velocity = (position - before) / dt;
        self.setpoint = Setpoint {
            position,
            velocity,
            acceleration: ((velocity - self.setpoint.velocity) / dt)
                .clamp(-limits.acceleration, limits.acceleration),
        };
        self.near = (self.tracked_position - position).abs() < APPROACHED
            && (target - position).abs() < AT_COMMAND;
        wanted.abs() > top || change.abs() > step * (1.0 + 1e-9)
    }

    fn track(&mut self, target: f64, dt: f64) {
        let omega = self.frequency;
        let error = target - self.tracked_position;
        self.tracked_velocity += omega * omega * error * dt;
        self.tracked_position += (self.tracked_velocity + 2.0 * omega * error) * dt;
    }

    fn closing_speed(&self, distance: f64, acceleration: f64) -> f64 {
        let k = 1.25 * self.frequency;
        let a = BRAKING_SHARE * acceleration;
        let far = distance.abs();
        let speed = if far <= a / (k * k) {
            k * far
        } else {
            (2.0 * a * (far - 0.5 * a / (k * k))).sqrt()
        };
        speed.copysign(distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DT: f64 = 1e-3;
    const LIMITS: SetpointLimits = SetpointLimits {
        velocity: 2.0,
        acceleration: 40.0,
        approach: 0.2,
        lower: -2.0,
        upper: 2.0,
    };

    /// One step of an arm of one joint.
    fn step_alone(generator: &mut SetpointGenerator) {
        generator.step(DT);
        if generator.is_near() {
            generator.end_approach();
        }
    }

    #[test]
    fn constant_velocity_is_followed_without_lag() {
        let mut generator = SetpointGenerator::new(80.0, LIMITS);
        generator.start(0.0);
        let mut worst = 0.0_f64;
        for k in 0..1500 {
            let position = 1.0 * k as f64 * DT;
            // Commands come every 2 ms.
            if k % 2 == 0 {
                generator.set_target(position);
            }
            step_alone(&mut generator);
            if k > 1200 {
                worst = worst.max((generator.setpoint().position - position).abs());
            }
        }
        assert!(worst < 2e-3, "{worst} rad at 1 rad/s");
        assert!(worst > 1e-5, "a held sample must show");
    }

    #[test]
    fn the_first_command_is_approached_slowly() {
        let mut generator = SetpointGenerator::new(80.0, LIMITS);
        generator.start(0.5);
        generator.set_target(1.0);
        let mut steps = 0;
        while !generator.is_near() && steps < 10_000 {
            generator.step(DT);
            assert!(generator.is_approaching());
            let late = (f64::from(steps) * DT - 2.0).max(0.0);
            assert!(generator.setpoint().velocity <= 0.2 + 0.2 * late + 1e-3);
            steps += 1;
        }
        // 0.4 rad at 0.2 rad/s, and 0.1 rad at a little more.
        assert!((2300..2600).contains(&steps), "{steps}");
    }

    #[test]
    fn an_approach_that_is_called_back_stops_soon_and_softly() {
        let mut generator = SetpointGenerator::new(80.0, LIMITS);
        generator.start(0.0);
        generator.set_target(1.0);
        for _ in 0..1000 {
            generator.step(DT);
        }
        let (from, speed) = (generator.setpoint().position, generator.setpoint().velocity);
        assert!(speed > 0.19, "{speed}");
        generator.set_target(0.0);
        let mut furthest = from;
        let mut last = generator.setpoint().acceleration;
        for _ in 0..500 {
            generator.step(DT);
            let now = generator.setpoint().acceleration;
            // The 5 % that it starts with, back and forth, and the jerk.
            assert!((now - last).abs() < 4.0 + 1.5, "{last} to {now} rad/s²");
            last = now;
            furthest = furthest.max(generator.setpoint().position);
        }
        // v √(v/j); by the acceleration of the approach it is 10 mrad.
        let way = speed * (speed / BRAKING_JERK).sqrt();
        let went_on = furthest - from;
        assert!((0.8 * way..1.2 * way).contains(&went_on), "{went_on} rad");
        // Back it goes slowly again.
        assert!(generator.setpoint().velocity < 0.0);
        assert!(generator.is_approaching());
    }

    #[test]
    fn a_hand_that_moves_is_approached_faster_by_its_own_speed() {
        let mut generator = SetpointGenerator::new(80.0, LIMITS);
        generator.start(-0.1);
        let caught = (0..5000).find(|&step| {
            let late = (f64::from(step + 1) * DT - PATIENCE).max(0.0);
            generator.set_target(0.4 * f64::from(step) * DT);
            generator.step(DT);
            let allowed = LIMITS.approach.hypot(HAND_SHARE * 0.4) + HURRY * late;
            assert!(generator.setpoint().velocity <= allowed + 1e-6);
            generator.is_near()
        });
        // The way grows by 0.02 rad/s in two seconds, from 0.1 rad and what was lost while it
        // took up speed; then it hurries.
        assert!(
            caught.is_some_and(|step| (3000..4800).contains(&step)),
            "{caught:?}"
        );
    }

    #[test]
    fn a_hand_that_does_not_wait_is_caught() {
        let mut generator = SetpointGenerator::new(80.0, LIMITS);
        generator.start(-1.0);
        // To and fro at 0.6 rad/s, three times as fast as the approach.
        let hand = |step: u32| 0.3 * (2.0 * f64::from(step) * DT).sin();
        let caught = (0..20_000).find(|step| {
            generator.set_target(hand(*step));
            generator.step(DT);
            generator.is_near()
        });
        assert!(caught.is_some_and(|step| step > 2000), "{caught:?}");
    }

    proptest! {
        #[test]
        fn limits_hold_and_targets_are_reached(
            start in -1.9..1.9f64,
            targets in proptest::collection::vec((-2.0..2.0f64, 1..300usize), 1..12),
        ) {
            let mut generator = SetpointGenerator::new(80.0, LIMITS);
            generator.start(start);
            let mut last = generator.setpoint();
            let mut step = |generator: &mut SetpointGenerator| {
                step_alone(generator);
                let now = generator.setpoint();
                prop_assert!(now.velocity.abs() <= LIMITS.velocity + 1e-9);
                prop_assert!((now.position - last.position).abs() <= LIMITS.velocity * DT + 1e-12);
                prop_assert!(now.position.abs() <= 2.0 + 1e-9);
                last = now;
                Ok(())
            };
            for (target, steps) in &targets {
                generator.set_target(*target);
                for _ in 0..*steps {
                    step(&mut generator)?;
                }
            }
            for _ in 0..25_000 {
                step(&mut generator)?;
            }
            let end = targets[targets.len() - 1].0;
            prop_assert!((generator.setpoint().position - end).abs() < 1e-6);
        }
    }
}

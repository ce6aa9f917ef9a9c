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
    /// Largest speed on the way to the first command \[rad/s\].
    pub approach: f64,
    /// Lower end of the range \[rad\].
    pub lower: f64,
    /// Upper end of the range \[rad\].
    pub upper: f64,
}

/// Share of the acceleration limit that braking counts on.
const BRAKING_SHARE: f64 = 0.8;
/// The approach is over once the setpoint is this near to the tracker [rad].
const APPROACHED: f64 = 1e-3;

/// Setpoint of one joint.
#[derive(Clone, Copy, Debug)]
pub struct SetpointGenerator {
    frequency: f64,
    limits: SetpointLimits,
    target: Option<f64>,
    tracked_position: f64,
    tracked_velocity: f64,
    approaching: bool,
    setpoint: Setpoint,
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
            setpoint: Setpoint::default(),
        }
    }

    /// Starts at rest at `position` \[rad\] without a target.
    pub fn start(&mut self, position: f64) {
        self.target = None;
        self.approaching = true;
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

    /// Whether it is still on its way to the first command.
    pub fn is_approaching(&self) -> bool {
        self.target.is_some() && self.approaching
    }

    /// The setpoint.
    pub fn setpoint(&self) -> Setpoint {
        self.setpoint
    }

    /// Moves on by `dt` \[s\]. Returns whether velocity or acceleration was limited.
    pub fn step(&mut self, dt: f64) -> bool {
        let Some(target) = self.target else {
            self.setpoint.velocity = 0.0;
            self.setpoint.acceleration = 0.0;
            return false;
        };
        self.track(target, dt);
        let limits = self.limits;
        let top = if self.approaching {
            limits.approach.min(limits.velocity)
        } else {
            limits.velocity
        };
        let distance = self.tracked_position - self.setpoint.position;
        let wanted = self
            .tracked_velocity
            .clamp(-limits.velocity, limits.velocity)
            + self.closing_speed(distance);
        let bounded = wanted.clamp(-top, top);
        let step = limits.acceleration * dt;
        let change = bounded - self.setpoint.velocity;
        let velocity = self.setpoint.velocity + change.clamp(-step, step);
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
        let far = (self.tracked_position - position).abs();
        if self.approaching && far < APPROACHED {
            self.approaching = false;
        }
        wanted.abs() > top || change.abs() > step * (1.0 + 1e-9)
    }

    fn track(&mut self, target: f64, dt: f64) {
        let omega = self.frequency;
        let error = target - self.tracked_position;
        self.tracked_velocity += omega * omega * error * dt;
        self.tracked_position += (self.tracked_velocity + 2.0 * omega * error) * dt;
    }

    fn closing_speed(&self, distance: f64) -> f64 {
        let k = 1.25 * self.frequency;
        let a = BRAKING_SHARE * self.limits.acceleration;
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
            generator.step(DT);
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
        while generator.is_approaching() && steps < 10_000 {
            generator.step(DT);
            assert!(generator.setpoint().velocity <= 0.2 + 1e-12);
            steps += 1;
        }
        // 0.5 rad at 0.2 rad/s is 2.5 s.
        assert!((2400..2800).contains(&steps), "{steps}");
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
                generator.step(DT);
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

//! The joint on its bench, integrated at 10 kHz (equation (2)):
//! τ_m = J q̈ + τ + τ_F, with τ_F = level · z + the rest, and the bristles' bend z
//! in place of sign(q̇).
//!
//! Semi-implicit Euler for the motion. Bristles follow the Dahl model
//! (dz/dq = (1 − z sign(q̇))/δ) by implicit Euler, stable at any δ.

use super::effect::{Effect, Friction, State};
use super::parameters::{JointParameters, Transmission};

/// Step of the integration \[s\].
const STEP: f64 = 1e-4;
/// Steps a millisecond.
const STEPS_A_MILLISECOND: usize = 10;
/// Steps between two looks at the hidden effects, which change slowly beside the bristles.
const STEPS_A_LOOK: usize = 5;

/// Stiffness and damping of the teeth that touch, in backlash \[Nm/rad\], \[Nm·s/rad\].
const TOOTH: (f64, f64) = (20_000.0, 40.0);
/// Share of J that lies on the gear's side of a backlash.
const GEAR_SHARE: f64 = 0.15;

/// What does not move.
#[derive(Clone, Debug)]
struct Fixed {
    joint: JointParameters,
    /// Spring stiffness, 0 where the contour is away \[Nm/rad\].
    spring: f64,
    /// One over the inertia that friction acts on, and over the bristles'
    /// travel: divisions would take most of a step's time.
    per_inertia: f64,
    per_bristle: f64,
    /// Factor on the friction of hidden effects in this session.
    hidden_factor: f64,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
struct Moving {
    /// Where friction acts.
    state: State,
    /// Position and velocity on the other side of the transmission: the load's
    /// for an elastic one, the motor's for backlash.
    other: (f64, f64),
    /// τ_F \[Nm\] at the last step.
    friction: f64,
    /// Work of friction since the last millisecond began \[J\].
    work: f64,
}

/// The joint on its bench.
#[derive(Clone, Debug)]
pub(super) struct Plant {
    fixed: Fixed,
    moving: Moving,
    load_before: f64,
    velocity_before: f64,
}

/// What `effects` add to friction at `state`.
pub(super) fn hidden(effects: &[Box<dyn Effect>], state: &State) -> Friction {
    let mut sum = Friction::default();
    for effect in effects {
        effect.friction(state, &mut sum);
    }
    sum
}

/// Equation (4)'s friction of `joint` at `state`, and `factor` times what is
/// `hidden` \[Nm\].
#[inline]
pub(super) fn friction(
    joint: &JointParameters,
    hidden: &Friction,
    factor: f64,
    state: &State,
) -> f64 {
    let speed = state.velocity.abs();
    let level = joint.b0 + joint.b0t * state.load.abs() + factor * hidden.level;
    let viscous = (joint.b1 + (joint.b2 + joint.b3 * speed) * speed) * state.velocity;
    level.max(0.0) * state.bristle + viscous + factor * hidden.torque
}

impl Fixed {
    /// What the contour's springs and the link's damping pull with \[Nm\].
    fn pull(&self, position: f64, velocity: f64) -> f64 {
        let start = self.joint.spring_start;
        let stretch = (position - start).max(0.0) + (position + 2.0 * start).min(0.0);
        self.spring * stretch + self.joint.link_damping * velocity
    }

    /// One step of [`STEP`] under `motor_torque` τ_m \[Nm\], with `hidden`
    /// effects as they were at most half a millisecond ago.
    #[inline(always)]
    fn step(&self, moving: &mut Moving, motor_torque: f64, hidden: &Friction) {
        let joint = &self.joint;
        let friction = friction(joint, hidden, self.hidden_factor, &moving.state);
        let (position, velocity) = (moving.state.position, moving.state.velocity);
        let acceleration;
        match joint.transmission {
            Transmission::Rigid => {
                let pull = self.pull(position, velocity);
                acceleration = (motor_torque - friction - pull) * self.per_inertia;
                moving.state.load = pull + joint.link_inertia * acceleration;
            }
            Transmission::Elastic {
                stiffness,
                cubic_stiffness,
                damping,
                link_friction,
                ..
            } => {
                let twist = position - moving.other.0;
                let load = (stiffness + cubic_stiffness * twist * twist) * twist
                    + damping * (velocity - moving.other.1);
                let pull = self.pull(moving.other.0, moving.other.1);
                acceleration = (motor_torque - friction - load) * self.per_inertia;
                let free = moving.other.1 + STEP * (load - pull) / joint.link_inertia;
                // Friction stops the link, and does not turn it round.
                let slowed = free.abs() - STEP * link_friction / joint.link_inertia;
                moving.other.1 = slowed.max(0.0).copysign(free);
                moving.other.0 += STEP * moving.other.1;
                moving.state.load = load;
            }
            Transmission::Backlash { gap } => {
                let ahead = moving.other.0 - position;
                let pressed = ahead - ahead.clamp(-0.5 * gap, 0.5 * gap);
                let mut tooth = 0.0;
                if pressed != 0.0 {
                    tooth = TOOTH.0 * pressed + TOOTH.1 * (moving.other.1 - velocity);
                    // Teeth push, they do not pull.
                    if tooth * pressed < 0.0 {
                        tooth = 0.0;
                    }
                }
                let pull = self.pull(position, velocity);
                acceleration = (tooth - friction - pull) * self.per_inertia;
                moving.state.load = pull + joint.link_inertia * acceleration;
                let motor = (motor_torque - tooth) / ((1.0 - GEAR_SHARE) * joint.inertia);
                moving.other.1 += STEP * motor;
                moving.other.0 += STEP * moving.other.1;
            }
        }
        let velocity = velocity + STEP * acceleration;
        let travel = STEP * velocity;
        moving.state.velocity = velocity;
        moving.state.position = position + travel;
        let bend = travel * self.per_bristle;
        moving.state.bristle = (moving.state.bristle + bend) / (1.0 + bend.abs());
        moving.friction = friction;
        moving.work += (friction * travel).abs();
    }
}

impl Plant {
    /// At rest at position 0.
    pub(super) fn new(joint: JointParameters, springs: bool, hidden_factor: f64) -> Self {
        let inertia = match joint.transmission {
            Transmission::Rigid => joint.inertia + joint.link_inertia,
            Transmission::Elastic { .. } => joint.inertia,
            Transmission::Backlash { .. } => GEAR_SHARE * joint.inertia + joint.link_inertia,
        };
        Plant {
            fixed: Fixed {
                spring: if springs { joint.spring } else { 0.0 },
                per_inertia: 1.0 / inertia,
                per_bristle: 1.0 / joint.bristle,
                joint,
                hidden_factor,
            },
            moving: Moving::default(),
            load_before: 0.0,
            velocity_before: 0.0,
        }
    }

    /// One millisecond under `motor_torque` τ_m \[Nm\]; work of friction in it \[J\].
    pub(super) fn millisecond(&mut self, motor_torque: f64, effects: &[Box<dyn Effect>]) -> f64 {
        // A copy of its own stays in registers, which halves a step's time.
        let mut moving = self.moving;
        for _ in 0..STEPS_A_MILLISECOND / STEPS_A_LOOK {
            let hidden = hidden(effects, &moving.state);
            for _ in 0..STEPS_A_LOOK {
                self.fixed.step(&mut moving, motor_torque, &hidden);
            }
        }
        self.moving = moving;
        self.tick()
    }

    /// Ends a millisecond: smooths the rates, says what work friction did in it \[J\].
    fn tick(&mut self) -> f64 {
        let state = &mut self.moving.state;
        let acceleration = (state.velocity - self.velocity_before) * 1000.0;
        state.acceleration += (acceleration - state.acceleration) / 5.0;
        self.velocity_before = state.velocity;
        let rate = (state.load - self.load_before) * 1000.0;
        state.load_rate += (rate - state.load_rate) / 20.0;
        self.load_before = state.load;
        std::mem::take(&mut self.moving.work)
    }

    /// Where friction acts.
    pub(super) fn state(&self) -> &State {
        &self.moving.state
    }

    /// Σ J q of what lies before the torque sensor \[kg m²·rad\]: its second
    /// derivative is τ_m − τ_F − τ.
    pub(super) fn inertia_times_angle(&self) -> f64 {
        let position = self.moving.state.position;
        let mean = match self.fixed.joint.transmission {
            Transmission::Rigid | Transmission::Elastic { .. } => position,
            Transmission::Backlash { .. } => {
                GEAR_SHARE * position + (1.0 - GEAR_SHARE) * self.moving.other.0
            }
        };
        self.fixed.joint.inertia * mean
    }

    /// Tells it time \[s\], date \[days\] and temperature \[degC\].
    pub(super) fn set_conditions(&mut self, time: f64, date: f64, temperature: f64) {
        let state = &mut self.moving.state;
        (state.time, state.date, state.temperature) = (time, date, temperature);
    }

    /// Its parameters in this session.
    pub(super) fn joint(&self) -> &JointParameters {
        &self.fixed.joint
    }

    /// Position \[rad\] and velocity \[rad/s\] where position is measured.
    pub(super) fn measured(&self) -> (f64, f64) {
        match self.fixed.joint.transmission {
            Transmission::Elastic {
                measures_motor: false,
                ..
            } => self.moving.other,
            _ => self.motor(),
        }
    }

    /// Position \[rad\] and velocity \[rad/s\] of the motor, which the servo holds.
    pub(super) fn motor(&self) -> (f64, f64) {
        match self.fixed.joint.transmission {
            Transmission::Rigid | Transmission::Elastic { .. } => {
                (self.moving.state.position, self.moving.state.velocity)
            }
            Transmission::Backlash { .. } => self.moving.other,
        }
    }
}

#[cfg(test)]
mod tests;

//! What a controller is commanded, of the torque that the servo wants. Pure.
//!
//! Effort controllers get the torque. Controllers of velocity or position make the arm an
//! admittance (N. Hogan, Impedance Control, J. Dyn. Sys. Meas. Control 107, 1985): a joint that gives
//! way to torques by a damper D,
//!
//! q̇_c = q̇ + (τ_m − τ) / D,    q_c = ∫ q̇_c dt,
//!
//! with τ_m the torque that the servo wants, τ what the joint bears: the torque sensor's
//! through a low pass, or else the modelled weight. D is the servo's own damping k_D, so that in free
//! motion its law q̇_c = q̇_d + k_P/k_D (q_d − q) is what is commanded; pressing, the arm comes to rest
//! where the joint bears the torque that the servo wants, and no more. The servo's setpoint would
//! follow a hand as well, but knows no limit of pressing, no hold and no release: those are in the
//! torque. Without torque sensors nothing here tells a contact: the robot's controller then presses
//! as hard as it can, in position by its stiffness times [`lead`](super::Settings::lead).
//!
//! Where nothing may be commanded (drives off, joint states not believed) the controller is told to
//! stay: its last command would go on for ever else.

use ferntast_model::Joints;

use super::settings::{Interface, Settings};
use crate::weight::Weight;

/// Time constant of the low pass of what a joint bears \[s\]: above the lag of a robot's
/// velocity controller, with which the arm's own inertia would swing otherwise.
const TORQUE_LOW_PASS: f64 = 0.02;

/// A joint of the arm as commands need it.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Where it may be \[rad\] or \[m\].
    pub range: [f64; 2],
    /// How fast it may be \[rad/s\] or \[m/s\].
    pub speed: f64,
    /// D \[Nm·s/rad\].
    pub damping: f64,
    /// Damping while it is carried only \[Nm·s/rad\].
    pub hold_damping: f64,
}

/// What is known when a command is made.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The torque that the servo wants \[Nm\]; `None` where nothing may be commanded.
    pub torque: Option<&'a Joints<f64>>,
    /// Time since the last command \[s\].
    pub elapsed: f64,
    /// Positions measured last \[rad\] or \[m\].
    pub position: &'a Joints<f64>,
    /// Velocities measured last, `None` where they are no longer believed \[rad/s\] or \[m/s\].
    pub velocity: Option<&'a Joints<f64>>,
    /// Joint torques measured last, where there are sensors \[Nm\].
    pub joint_torque: Option<&'a Joints<f64>>,
}

/// Makes commands.
pub struct Commands {
    interface: Interface,
    carries_itself: bool,
    lead: f64,
    joints: Joints<Joint>,
    weight: Weight,
    /// What the joints bear, low-passed \[Nm\].
    borne: Option<Joints<f64>>,
    /// The position commanded last.
    commanded: Option<Joints<f64>>,
    driving: bool,
}

impl Commands {
    /// For an arm of those joints.
    pub fn new(settings: &Settings, joints: Joints<Joint>, weight: Weight) -> Commands {
        Commands {
            interface: settings.interface,
            carries_itself: settings.carries_itself,
            lead: settings.lead,
            joints,
            weight,
            borne: None,
            commanded: None,
            driving: false,
        }
    }

    /// The next command, in the order of the arm's joints.
    pub fn next(&mut self, now: &Situation) -> Joints<f64> {
        let drives = now.torque.zip(now.velocity);
        let begins = drives.is_some() && !self.driving;
        let ends = drives.is_none() && self.driving;
        self.driving = drives.is_some();
        if begins || ends {
            self.borne = None;
            self.commanded = None;
        }
        match self.interface {
            Interface::Effort => self.effort(now),
            Interface::Velocity => self.velocity(now),
            Interface::Position => self.position(now),
        }
    }

    fn effort(&self, now: &Situation) -> Joints<f64> {
        let weight = self.weight.at(now.position);
        let carried = match self.carries_itself {
            true => weight,
            false => weight.map(|_| 0.0),
        };
        Joints::from_fn(weight.count(), |joint| {
            let wanted = match (now.torque, now.velocity) {
                (Some(torque), Some(_)) => torque[joint],
                // Carried where it was, damped as far as its motion is known.
                (_, velocity) => {
                    let damping = self.joints[joint].hold_damping;
                    weight[joint] - velocity.map_or(0.0, |own| damping * own[joint])
                }
            };
            wanted - carried[joint]
        })
    }

    fn velocity(&mut self, now: &Situation) -> Joints<f64> {
        let rest = now.position.map(|_| 0.0);
        let (Some(torque), Some(velocity)) = (now.torque, now.velocity) else {
            return rest;
        };
        let bears = match now.joint_torque {
            Some(measured) => self.low_passed(measured, now.elapsed),
            None => self.weight.at(now.position),
        };
        Joints::from_fn(rest.count(), |joint| {
            let own = &self.joints[joint];
            let wanted = velocity[joint] + (torque[joint] - bears[joint]) / own.damping;
            // NaN would pass `clamp`.
            match wanted.is_finite() {
                true => wanted.clamp(-own.speed, own.speed),
                false => 0.0,
            }
        })
    }

    fn position(&mut self, now: &Situation) -> Joints<f64> {
        let velocity = self.velocity(now);
        let last = *self.commanded.get_or_insert(*now.position);
        let commanded = match self.driving {
            false => last,
            true => Joints::from_fn(last.count(), |joint| {
                let measured = now.position[joint];
                let wanted = last[joint] + velocity[joint] * now.elapsed;
                let [lower, upper] = self.joints[joint].range;
                let near = wanted.clamp(measured - self.lead, measured + self.lead);
                near.clamp(lower, upper)
            }),
        };
        self.commanded = Some(commanded);
        commanded
    }

    fn low_passed(&mut self, measured: &Joints<f64>, elapsed: f64) -> Joints<f64> {
        let share = elapsed / (TORQUE_LOW_PASS + elapsed);
        let before = self.borne.unwrap_or(*measured);
        let borne = Joints::from_fn(measured.count(), |joint| {
            before[joint] + share * (measured[joint] - before[joint])
        });
        self.borne = Some(borne);
        borne
    }
}

#[cfg(test)]
mod tests;

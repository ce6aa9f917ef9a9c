//! The force that the tip's command pushes with.
//!
//! The estimated contact force lags behind the command by the servo. A law that
//! lets the tip give way to a force (an admittance) would close a loop over that
//! lag and chatter on a stiff wall. The force of the servo's spring, k (x_c − x),
//! does not lag, but its size is not well known. So both: the estimate at low
//! frequencies, the spring at high ones (a complementary filter), F = z + k (x_c − x)
//! with ż = (F_est − k (x_c − x) − z)/τ. Out of contact it is zero, and where the estimate
//! is not valid: a torque sensor that is wrong moves the tip as it is measured, and a command
//! that gave way to that spring would run after it.

use super::FollowerInput;
use super::mapping::Mapping;
use crate::low_pass_share;
use nalgebra::Vector3;

/// Time constant τ of the filter [s]: longer than the servo's lag.
const TIME: f64 = 0.05;

/// The last command of an arm's end. It outlives a moment without one, when a packet is too
/// old or the hand was not measured: a command that began anew at the tip would let go of
/// what the servo's spring holds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LastCommand {
    /// Hand units [m].
    position: Option<Vector3<f64>>,
    /// Time since it was given [s].
    since: f64,
}

impl LastCommand {
    /// Hand units \[m\]; `None` where the next one begins at the tip.
    pub fn position(&self) -> Option<Vector3<f64>> {
        self.position
    }

    /// What was commanded in place of what the last step gave, hand units \[m\].
    pub fn replace(&mut self, position: Vector3<f64>) {
        self.position = self.position.and(Some(position));
    }

    /// A step of `dt` \[s\] that gave `command`, or none; forgotten after `life` \[s\], and at
    /// once where nothing may be commanded.
    pub fn step(&mut self, dt: f64, command: Option<Vector3<f64>>, connected: bool, life: f64) {
        self.since += dt;
        if command.is_some() {
            self.position = command;
            self.since = 0.0;
        } else if self.since > life || !connected {
            self.position = None;
        }
    }
}

/// The tip as late as the estimate of the contact's force, which came through two poles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Late([Option<Vector3<f64>>; 2]);

impl Late {
    /// After `dt` \[s\] with the tip at `tip` \[m\], as it was `lag` \[s\] ago.
    pub fn step(&mut self, dt: f64, lag: f64, tip: Vector3<f64>) -> Vector3<f64> {
        let share = dt / (dt + 0.5 * lag);
        self.0.iter_mut().fold(tip, |input, pole| {
            let own = pole.get_or_insert(input);
            *own += share * (input - *own);
            *own
        })
    }
}

/// What a follower whose tip gives way sees, in hand units.
#[derive(Clone, Copy, Debug)]
pub(super) struct TouchingTip {
    /// Force of the contact on the tip, where it is known [N].
    pub contact: Option<Vector3<f64>>,
    /// The tip [m].
    pub tip: Option<Vector3<f64>>,
    /// The command, before the first one the tip [m].
    pub here: Option<Vector3<f64>>,
    /// Lead of the command over the tip, where that is measured [m].
    pub lead: Option<Vector3<f64>>,
    /// There was a command. The first one after a silence begins at the tip: what the
    /// spring had before says nothing of it.
    pub led: bool,
}

impl TouchingTip {
    /// Of `input`, with the last command.
    pub fn new(mapping: &Mapping, input: &FollowerInput, command: &LastCommand) -> Self {
        let command = command.position();
        let tip = input.tip.map(|tip| mapping.tip_at_hand(tip.position));
        let here = command.or(tip);
        TouchingTip {
            contact: input
                .contact_force
                .map(|force| mapping.contact_at_hand(force)),
            tip,
            here,
            lead: here.zip(tip).map(|(here, tip)| here - tip),
            led: command.is_some(),
        }
    }
}

/// The complementary filter, in hand units.
#[derive(Clone, Copy, Debug)]
pub(super) struct CommandForce {
    stiffness: f64,
    low: Vector3<f64>,
    force: Vector3<f64>,
    /// Energy of the servo's spring when contact began, once [J].
    wound: f64,
}

impl CommandForce {
    /// With the servo's stiffness k at the hand's scale [N/m].
    pub fn new(stiffness: f64) -> Self {
        CommandForce {
            stiffness,
            low: Vector3::zeros(),
            force: Vector3::zeros(),
            wound: 0.0,
        }
    }

    /// k \[N/m\].
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// By how much the force grows where the command leads on \[N/m\]: k in contact; none
    /// out of it, where the tip follows.
    pub fn acting(&self) -> f64 {
        match self.force == Vector3::zeros() {
            true => 0.0,
            false => self.stiffness,
        }
    }

    /// The force with which the command pushes [N].
    pub fn step(&mut self, dt: f64, own: &TouchingTip) -> Vector3<f64> {
        let free = self.force == Vector3::zeros();
        let contact = own.contact.filter(|force| force.norm_squared() >= 1e-12);
        let Some(contact) = contact else {
            // What leads now becomes force when the tip is stopped.
            self.low = Vector3::zeros();
            self.force = Vector3::zeros();
            return self.force;
        };
        let Some(lead) = own.lead else {
            return self.force;
        };
        let spring = self.stiffness * lead;
        if free {
            self.wound = 0.5 * self.stiffness * lead.norm_squared();
        }
        let share = if own.led {
            low_pass_share(dt, TIME)
        } else {
            1.0
        };
        self.low += share * (-contact - spring - self.low);
        self.force = self.low + spring;
        self.force
    }

    /// Energy that the lead of the command over the tip will put into a contact
    /// that has just begun [J]; zero when asked again.
    pub fn take_wound(&mut self) -> f64 {
        std::mem::take(&mut self.wound)
    }

    /// The passivity controller of an admittance: `velocity` of the command, along
    /// the force no faster than `level` \[J\] pays for in a step. Where it is
    /// overdrawn, the command gives way with up to `yield_speed` \[m/s\].
    pub fn admitted(
        &self,
        dt: f64,
        velocity: Vector3<f64>,
        level: f64,
        yield_speed: f64,
    ) -> Vector3<f64> {
        let size = self.force.norm();
        if size < 1e-6 || dt <= 0.0 {
            return velocity;
        }
        let along = self.force / size;
        // (|F| + ½ k v Δt) v Δt = level: the servo's spring is wound up too.
        let most = if level > 0.0 {
            2.0 * level / (size + (size * size + 2.0 * self.stiffness * level).sqrt()) / dt
        } else {
            (level / (size * dt)).max(-yield_speed)
        };
        velocity + (most - velocity.dot(&along)).min(0.0) * along
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tip(contact: Option<f64>, lead: f64, led: bool) -> TouchingTip {
        let along = |own| Vector3::new(own, 0.0, 0.0);
        TouchingTip {
            contact: contact.map(along),
            tip: Some(Vector3::zeros()),
            here: Some(along(lead)),
            lead: Some(along(lead)),
            led,
        }
    }

    #[test]
    fn at_rest_it_is_the_estimate_and_at_once_it_is_the_spring() {
        let mut force = CommandForce::new(1000.0);
        let free = force.step(1e-3, &tip(Some(0.0), 1e-3, true));
        assert_eq!(free, Vector3::zeros());
        assert_eq!(force.acting(), 0.0);
        let mut own = Vector3::zeros();
        for _ in 0..1000 {
            own = force.step(1e-3, &tip(Some(-2.0), 1e-3, true));
        }
        assert!((own.x - 2.0).abs() < 1e-6, "{own}");
        assert_eq!(force.acting(), 1000.0);
        let jumped = force.step(1e-3, &tip(Some(-2.0), 2e-3, true));
        assert!((jumped.x - own.x - 1.0).abs() < 0.03, "{jumped}");
    }

    #[test]
    fn an_estimate_that_is_not_valid_is_no_force() {
        let mut force = CommandForce::new(1000.0);
        force.step(1e-3, &tip(Some(-2.0), 1e-3, true));
        let unknown = force.step(1e-3, &tip(None, 1e-3, true));
        assert_eq!((unknown, force.acting()), (Vector3::zeros(), 0.0));
    }

    /// After a silence the command begins at the tip: a spring without a lead pulls nothing.
    #[test]
    fn a_command_that_begins_anew_in_contact_pushes_with_the_estimate() {
        let mut force = CommandForce::new(1000.0);
        for _ in 0..1000 {
            force.step(1e-3, &tip(Some(-2.0), 4e-3, true));
        }
        let anew = force.step(1e-3, &tip(Some(-2.0), 0.0, false));
        assert!((anew.x - 2.0).abs() < 1e-9, "{anew}");
    }
}

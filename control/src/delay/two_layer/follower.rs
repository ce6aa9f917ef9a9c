//! The layers at the arm's end.

use super::inside::InnerFollower;
use super::parameters::TwoLayer;
use super::taking_over::TakingOver;
use crate::delay::contact::{LastCommand, Late, TouchingTip};
use crate::delay::energy_tank::EnergyTank;
use crate::delay::mapping::Mapping;
use crate::delay::{Energy, EnergyMeter, Follower, FollowerInput, FollowerOutput};
use nalgebra::Vector3;

/// Time constant with which a command comes to the lead that the tank pays for, longer than the
/// servo's lag [s].
const YIELD_TIME: f64 = 0.05;
/// Speed of a command that the arm does not keep up with [m/s],
const KEEPS_UP: f64 = 0.03;
/// and of one that a servo has yet to come to, slower than that does [m/s].
const WAITS: f64 = 0.005;
/// With this a command that was kept back speeds up and brakes again [m/s²].
const CATCH_UP: f64 = 0.5;

/// In the first moments of a contact a tip that bounces is quicker than the estimate of its force
/// and seems to take in what it gives out: nothing counts as coming in for so long [s].
const IMPACT: f64 = 0.1;
/// By so much a tank may be overdrawn, at the hand's scale, before the tip stays where it touches [J].
const OVERDRAFT: f64 = 0.012;
/// Where the tip is farther from it than this, nothing is near any more [m].
const NEAR: f64 = 1e-3;

/// What the tip touched, at the hand's scale.
#[derive(Clone, Copy, Debug)]
struct Touched {
    /// Into it.
    along: Vector3<f64>,
    /// The tip there [m].
    place: Vector3<f64>,
}

/// The follower's end: sends what the inner law says, and what it promises.
#[derive(Clone, Debug)]
pub struct TwoLayerFollower {
    parameters: TwoLayer,
    mapping: Mapping,
    inner: InnerFollower,
    tank: EnergyTank,
    /// At the tip, of what is known of its contact.
    meter: EnergyMeter,
    late: Late,
    /// How long it has been touching [s].
    touching: f64,
    /// Seemed to come in by impacts, since the start [J].
    doubted: f64,
    /// Of the contact on the tip at the last step [N].
    contact: Vector3<f64>,
    /// What is near, since the tip touched it.
    near: Option<Touched>,
    command: LastCommand,
    taking_over: TakingOver,
    /// The command is kept back, or catches up.
    kept: bool,
    /// Of the command [m/s].
    speed: f64,
}

impl TwoLayerFollower {
    pub(super) fn new(law: &TwoLayer) -> Self {
        TwoLayerFollower {
            parameters: law.clone(),
            mapping: law.mapping(),
            inner: law.inside.between(&law.mapping()).bare_follower(),
            tank: EnergyTank::with(law.credit),
            meter: EnergyMeter::default(),
            late: Late::default(),
            touching: 0.0,
            doubted: 0.0,
            contact: Vector3::zeros(),
            near: None,
            command: LastCommand::default(),
            taking_over: TakingOver::default(),
            kept: false,
            speed: 0.0,
        }
    }

    /// Counts what went through the tip.
    fn count(&mut self, dt: f64, seen: &TouchingTip) {
        let Some((tip, contact)) = seen.tip.zip(seen.contact) else {
            self.contact = Vector3::zeros();
            self.touching = 0.0;
            self.meter.step([0.0; 3], None);
            return;
        };
        let tip = self.late.step(dt, self.parameters.force_lag, tip);
        // It changed on the way: its mean did the work.
        let mean = 0.5 * (contact + self.contact);
        self.contact = contact;
        let before = self.meter.energy().entered;
        self.meter.step(mean.into(), Some(tip.into()));
        if mean == Vector3::zeros() {
            self.touching = 0.0;
        } else {
            self.touching += dt;
        }
        if self.touching < IMPACT {
            self.doubted += self.meter.energy().entered - before;
        }
    }

    /// What went through the tip since the start, as far as that is believed.
    fn believed(&self) -> Energy {
        let counted = self.meter.energy();
        Energy {
            entered: counted.entered - self.doubted,
            ..counted
        }
    }

    /// What the tip touches or, where the estimate no longer sees it, has touched just before: a
    /// force below its threshold is none, and a command that goes on at once would push again.
    fn near(&mut self, tip: &Vector3<f64>) -> Option<Touched> {
        self.near = match (-self.contact).try_normalize(1e-9) {
            Some(along) => Some(Touched { along, place: *tip }),
            None => self
                .near
                .filter(|own| (tip - own.place).dot(&own.along) > -NEAR),
        };
        self.near
    }

    /// How fast the command may go [m/s]: ½ m v² ≤ E.
    fn fastest(&self) -> f64 {
        // A mass is to be scaled as a stiffness is.
        let mass = self.mapping.stiffness_at_hand(self.parameters.tip_mass);
        let paid = 2.0 * self.tank.level().max(0.0) / mass;
        paid.sqrt().max(self.parameters.least_speed)
    }

    /// How far the command may go in a step of `dt` [s] where it should go on by `ahead` [m], to
    /// what moves with `velocity` [m/s].
    fn stride(&self, dt: f64, ahead: &Vector3<f64>, velocity: &Vector3<f64>) -> f64 {
        let (whole, fastest) = (ahead.norm(), self.fastest() * dt);
        if !self.kept && whole <= fastest {
            return whole;
        }
        let braking = velocity.norm() + (2.0 * CATCH_UP * whole).sqrt();
        fastest.min(braking.min(self.speed + CATCH_UP * dt) * dt)
    }

    /// How far the command may go in a step of `dt` [s] along the force with which it pushes,
    /// `lead` [m] ahead of the tip: ½ k d² ≤ E.
    fn deeper(&self, dt: f64, lead: f64) -> f64 {
        let own = &self.parameters;
        let stiffness = self.mapping.stiffness_at_hand(own.servo_stiffness);
        let most = (2.0 * self.tank.level().max(0.0) / stiffness).sqrt();
        ((most - lead) / YIELD_TIME).max(-own.yield_speed) * dt
    }

    /// Of the command that the inner law wants, position \[m\] and velocity \[m/s\], what the
    /// tank pays for.
    fn allowed(
        &mut self,
        dt: f64,
        seen: &TouchingTip,
        wanted: (Vector3<f64>, Vector3<f64>),
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (position, velocity) = wanted;
        let Some((before, tip)) = seen.here.zip(seen.tip) else {
            return wanted;
        };
        let leash = self.parameters.largest_lead / self.mapping.position_scale;
        let mut ahead = tip + (position - tip).cap_magnitude(leash) - before;
        let near = self.near(&tip);
        if let Some(Touched { along, .. }) = near
            && self.tank.level() < -OVERDRAFT
        {
            // Along a surface with friction every step costs: it may only leave.
            ahead = ahead.dot(&along).min(0.0) * along;
        }
        let mut way = ahead.cap_magnitude(self.stride(dt, &ahead, &velocity));
        let late = (before - tip).norm();
        let free_tip = near.is_none().then_some(&tip);
        if self.taking_over.step(dt, late, free_tip, leash) {
            way = way.cap_magnitude(WAITS * dt);
        } else if late > 0.5 * leash {
            way = way.cap_magnitude(KEEPS_UP * dt);
        }
        if let Some(Touched { along, .. }) = near {
            let lead = (before - tip).dot(&along);
            way += (self.deeper(dt, lead) - way.dot(&along)).min(0.0) * along;
        }
        let given = before + way;
        self.kept = (given - position).norm() > 1e-9;
        self.speed = if dt > 0.0 { way.norm() / dt } else { 0.0 };
        match self.kept && dt > 0.0 {
            true => (given, way / dt),
            false => wanted,
        }
    }
}

impl Follower for TwoLayerFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let seen = TouchingTip::new(&self.mapping, input, &self.command);
        self.count(dt, &seen);
        let own = &self.parameters;
        // All of it, as a hand that is pushed by what moves has to pay for that at once.
        self.tank.port(self.believed(), 1.0);
        if let Some(received) = self.mapping.live(input.connected, input.received) {
            self.tank.promise(f64::from(received.packet.energy[0]));
        }
        self.tank.give(dt / own.transfer_time, own.kept_at_tip);
        self.tank.limit(own.reserve);
        let deadline = own.deadline;
        let wanted = self.inner.step(dt, input, energy);
        let command = wanted.command.map(|command| {
            let position = self.mapping.tip_at_hand(command.position);
            let velocity = Vector3::from(command.velocity) / self.mapping.position_scale;
            self.allowed(dt, &seen, (position, velocity))
        });
        let given = command.map(|(position, _)| position);
        if let Some(position) = given {
            self.inner.commanded(position);
        }
        self.command.step(dt, given, input.connected, deadline);
        FollowerOutput {
            command: command.map(|(position, velocity)| self.mapping.command(position, velocity)),
            packet: self.tank.told_in(wanted.packet, self.meter.energy()),
        }
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated() + self.inner.dissipated()
    }
}

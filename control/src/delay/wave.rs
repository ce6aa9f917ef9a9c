//! Wave variables, their integrals in packets, impedance matched, drift corrected.
//!
//! u = (b v_h + F)/√(2b) goes forward, w = (b v_s − F_s)/√(2b) comes back (Anderson and
//! Spong 1989, "Bilateral control of teleoperators with time delay", IEEE T-AC 34;
//! Niemeyer and Slotine 1991, "Stable adaptive teleoperation", IEEE J-OE 16; 2004,
//! "Telemanipulation with time delays", IJRR 23), F what the hand gives into the
//! two-port, F_s what comes out at the tip. With the hand's velocity and the
//! tip's force as inputs:
//!
//! F = b v_h − √(2b) w,  u = √(2b) v_h − w.
//!
//! **Impedance matching** (Niemeyer and Slotine 2004). The follower ends the line with
//! a damper b, F_s = F̂ + b v_s, so that nothing of u is sent back by itself:
//!
//! v_s = (√(2b) u − F̂)/(2b),  w = −F̂/√(2b),
//!
//! with F̂ the force of the command (`contact.rs`). The hand is no damper: it reflects what
//! comes back. It does so through a low pass, as slow as the delay: what goes to
//! and fro in the line is absorbed, a steady force is not.
//!
//! **In packets.** Integrals of u and w are sent (Niemeyer and Slotine 2004) and played
//! out over no less time than they were gathered in: by Cauchy–Schwarz
//! (∫u)²/2T ≤ ∫½u², so loss, jitter, reordering and duplication can only take energy
//! away (Chopra, Berestesky, Spong 2008, "Bilateral teleoperation over unreliable
//! communication networks", IEEE T-CST 16). The integrals are sent modulo
//! 32 √J·√s, so that single precision holds them. What comes after an outage,
//! or waits longer than `buffer`, is dropped and not made up for.
//!
//! **Drift.** What was dropped leaves the tip beside the hand's image. The position goes
//! along in the packet, and a spring pulls the tip there through the matching damper
//! (after Chopra, Spong, Ortega, Barabanov 2006, "On tracking performance in bilateral
//! teleoperation", IEEE T-RO 22); against the contact only as far as the follower's tank
//! pays. So a steady contact is felt as it is, after some round trips.
//!
//! **What it guarantees.** Each end sends no more wave energy than waves and port
//! have brought it, and overdraws by no more than a step, paid back first; so by its
//! own books the two-port is passive for any delay, jitter and loss. A long line is
//! soft at first: delay T each way acts as a spring b/T. Assumed: clocks that run
//! equally fast (their offset changes the absorption only); the servo from command to
//! tip is passive, up to the kinetic energy of the arm.

use super::contact::{CommandForce, LastCommand, TouchingTip};
use super::energy_tank::EnergyTank;
use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters, shortened};
use super::{
    Energy, EnergyMeter, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput,
    LeaderOutput, Packet, Received, Samples, vector,
};
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct Wave {
        /// b: impedance of the line, at the hand's scale \[N·s/m\].
        pub impedance: f64 [0.1..=1000.0, "N·s/m"] = 10.0,
        /// Damping at the hand on top of it, which pays for what the line loses
        /// \[N·s/m\].
        pub damping: f64 [0.0..=1000.0, "N·s/m"] = 2.0,
        /// Time constant of the low pass on what the hand reflects, by the delay of
        /// what comes back: quicker changes are absorbed \[-\].
        pub absorption: f64 [0.0..=100.0, "-"] = 1.0,
        /// Longest time that waves wait to be played out \[s\].
        pub buffer: f64 [0.002..=1.0, "s"] = 0.02,
        /// Energy that an end may hold in hand; what is beyond counts as
        /// dissipated \[J\].
        pub reserve: f64 [0.0..=1000.0, "J"] = 0.1,
        /// Stiffness with which the drift correction pulls the tip to the hand,
        /// at the hand's scale; below the stiffness of the hand \[N/m\].
        pub drift_stiffness: f64 [0.0..=10000.0, "N/m"] = 60.0,
        /// Largest speed of the drift correction, at the hand's scale \[m/s\].
        pub drift_speed: f64 [0.0..=10.0, "m/s"] = 0.05,
        /// Largest speed at which the tip gives way to pay back, at the hand's
        /// scale \[m/s\].
        pub yield_speed: f64 [0.001..=10.0, "m/s"] = 0.2,
        /// Stiffness of the arm's servo at the tip; a session takes the arm's own
        /// where that is larger \[N/m\].
        pub servo_stiffness: f64 [1.0..=1000000.0, "N/m"] = 7000.0,
    }
}

/// Integrals are sent modulo this [√J·√s].
const MODULUS: f64 = 32.0;

fn wrapped(own: Vector3<f64>) -> Vector3<f64> {
    own.map(|value| value - MODULUS * (value / MODULUS).round())
}

/// The integral that an end sends.
#[derive(Clone, Copy, Debug, Default)]
struct Sent(Vector3<f64>);

impl Sent {
    fn add(&mut self, wave: Vector3<f64>, dt: f64) -> [f64; 3] {
        self.0 = wrapped(self.0 + wave * dt);
        self.0.into()
    }
}

/// Waves that arrived and wait to be played out.
#[derive(Clone, Copy, Debug, Default)]
struct Arrived {
    clock: f64,
    last: Option<(f64, Vector3<f64>)>,
    integral: Vector3<f64>,
    time: f64,
    /// Time without anything to act on [s].
    silence: f64,
}

impl Arrived {
    /// The wave of this step [√W].
    fn step(
        &mut self,
        dt: f64,
        live: Option<Received>,
        connected: bool,
        law: &Wave,
    ) -> Vector3<f64> {
        let buffer = law.buffer;
        self.clock += dt;
        self.silence = live.map_or(self.silence + dt, |_| 0.0);
        if self.silence > law.deadline || !connected {
            *self = Arrived {
                clock: self.clock,
                silence: self.silence,
                ..Arrived::default()
            };
            return Vector3::zeros();
        }
        if let Some(received) = live.filter(|own| own.fresh) {
            let sent = self.clock - received.age;
            let total = vector(received.packet.vector);
            if let Some((before, sum)) = self.last {
                let span = sent - before;
                if span > 1e-6 {
                    self.integral += wrapped(total - sum);
                    self.time += span;
                    self.last = Some((sent, total));
                }
                if self.time > buffer {
                    self.integral *= buffer / self.time;
                    self.time = buffer;
                }
            } else {
                self.last = Some((sent, total));
            }
        }
        if self.time <= 1e-9 || dt <= 0.0 {
            return Vector3::zeros();
        }
        let share = (dt / self.time).min(1.0);
        let played = share * self.integral;
        self.integral -= played;
        self.time -= share * self.time;
        played / dt
    }
}

/// For how long the tank has to be able to pay for a wave that it lets pass
/// whole [s]; a wave that it cannot pay fades within that time.
const HORIZON: f64 = 0.02;

/// The wave as far as the tank can pay for it.
fn paid(tank: &mut EnergyTank, dt: f64, wave: Vector3<f64>) -> Vector3<f64> {
    let power = 0.5 * wave.norm_squared();
    if power <= 0.0 {
        return Vector3::zeros();
    }
    let share = (tank.level().max(0.0) / (power * HORIZON.max(dt))).min(1.0);
    tank.add(-share * power * dt);
    share.sqrt() * wave
}

law_ends!(Wave, "wave", ByItsBooks, WaveLeader, WaveFollower);

impl Wave {
    fn samples(&self) -> [Samples; 2] {
        [Samples::INTEGRAL; 2]
    }
}

/// The leader's end: sends position of the hand and the integral of u \[√J·√s\].
#[derive(Clone, Debug)]
pub struct WaveLeader {
    parameters: Wave,
    mapping: Mapping,
    arrived: Arrived,
    sent: Sent,
    tank: EnergyTank,
    fade: ForceRamp,
    /// What is reflected of the wave that comes back [√W].
    reflected: Vector3<f64>,
    position: Option<Vector3<f64>>,
}

impl WaveLeader {
    fn new(law: &Wave) -> Self {
        WaveLeader {
            mapping: law.mapping(),
            parameters: law.clone(),
            arrived: Arrived::default(),
            sent: Sent::default(),
            tank: EnergyTank::default(),
            fade: ForceRamp::default(),
            reflected: Vector3::zeros(),
            position: None,
        }
    }
}

impl Leader for WaveLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let own = &self.parameters;
        let root = (2.0 * own.impedance).sqrt();
        let live = self.mapping.live(input.connected, input.received);
        let share = self.fade.step(dt, own.force_ramp, live.is_some());
        let back = self.arrived.step(dt, live, input.connected, own);
        self.tank.add(0.5 * back.norm_squared() * dt);
        self.tank.port(energy, 0.0);
        self.tank.limit(own.reserve);
        let here: Option<Vector3<f64>> = input.hand.map(|hand| hand.position.into());
        let moved = match (here, self.position) {
            (Some(here), Some(before)) if dt > 0.0 => (here - before) / dt,
            _ => Vector3::zeros(),
        };
        self.position = here;
        let age = live.map_or(0.0, |received| received.age.max(0.0));
        let pass = if dt > 0.0 {
            dt / (dt + own.absorption * age)
        } else {
            0.0
        };
        self.reflected += pass * (back - self.reflected);
        let wave = paid(&mut self.tank, dt, root * moved - self.reflected);
        let velocity = input
            .hand
            .map_or(Vector3::zeros(), |hand| hand.velocity.into());
        let force = share * (root * back - own.impedance * velocity) - own.damping * velocity;
        let integral = self.sent.add(wave, dt);
        LeaderOutput {
            force: force.into(),
            packet: input.hand.map_or(Packet::empty(energy), |hand| {
                Packet::new(hand.position, integral, energy)
            }),
        }
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated()
    }
}

/// The follower's end: sends position of the tip and the integral of w \[√J·√s\].
#[derive(Clone, Debug)]
pub struct WaveFollower {
    parameters: Wave,
    mapping: Mapping,
    arrived: Arrived,
    sent: Sent,
    tank: EnergyTank,
    /// At the command: the servo behind it is passive by itself.
    meter: EnergyMeter,
    force: CommandForce,
    last: Vector3<f64>,
    command: LastCommand,
}

impl WaveFollower {
    fn new(law: &Wave) -> Self {
        WaveFollower {
            mapping: law.mapping(),
            parameters: law.clone(),
            arrived: Arrived::default(),
            sent: Sent::default(),
            tank: EnergyTank::default(),
            meter: EnergyMeter::default(),
            force: CommandForce::new(law.mapping().stiffness_at_hand(law.servo_stiffness)),
            last: Vector3::zeros(),
            command: LastCommand::default(),
        }
    }
}

impl Follower for WaveFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let own = &self.parameters;
        let b = own.impedance;
        let root = (2.0 * b).sqrt();
        let live = self.mapping.live(input.connected, input.received);
        let forth = self.arrived.step(dt, live, input.connected, own);
        let tip = TouchingTip::new(&self.mapping, input, &self.command);
        let here = tip.here;
        let force = self.force.step(dt, &tip);
        let mean = -0.5 * (force + self.last);
        self.last = force;
        self.meter.step(mean.into(), here.map(Into::into));
        self.tank.add(0.5 * forth.norm_squared() * dt);
        self.tank.port(self.meter.energy(), 0.0);
        self.tank.limit(own.reserve);
        let wave = paid(&mut self.tank, dt, -force / root);
        // Implicit in the servo's spring, which is none where the tip is free.
        let give = 2.0 * b + self.force.acting() * dt;
        let command = live.zip(here).map(|(received, here)| {
            let drift = vector(received.packet.position) - here;
            let pull = shortened(own.drift_stiffness * drift, 2.0 * b * own.drift_speed);
            let velocity = (root * forth - force + pull) / give;
            let velocity = self
                .force
                .admitted(dt, velocity, self.tank.level(), own.yield_speed);
            (here + velocity * dt, velocity)
        });
        let given = command.map(|(position, _)| position);
        self.command.step(dt, given, input.connected, own.deadline);
        let integral = self.sent.add(wave, dt);
        let packet = input.tip.map_or(Packet::empty(energy), |tip| Packet {
            valid: input.contact_force.is_some(),
            ..Packet::new(tip.position, integral, energy)
        });
        FollowerOutput {
            command: command.map(|(position, velocity)| self.mapping.command(position, velocity)),
            packet,
        }
    }

    fn commanded(&mut self, position: Vector3<f64>) {
        self.command.replace(position);
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated()
    }
}

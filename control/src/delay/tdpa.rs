//! Time-domain passivity of the two-port: energy sent in packets, passivity
//! controllers at both ends, drift compensated.
//!
//! Position goes forward, contact force back. Each end observes the energy at its
//! port and keeps a tank: what its port took in, what the other end promised in
//! packets, less what its port gave out and what it promised itself
//! (`tank.rs`; Ryu, Artigas, Preusche 2010, Mechatronics 20). A passivity controller
//! lets no end give out more than its tank holds:
//!
//! * the leader's, of impedance type, takes from the force: F ← F − α v_h;
//! * the follower's, of admittance type, takes from the motion: v ← v − β F.
//!
//! Both look one step ahead (Hannaford and Ryu 2002, "Time-domain passivity
//! control of haptic interfaces", IEEE T-RA 18, take the same energy one step
//! later and chatter): the force makes the hand faster, the motion winds up the
//! servo. What the admittance takes off the motion is drift; the
//! follower makes up for it as fast as `drift_speed` while its tank pays
//! (Artigas, Ryu, Preusche 2010, "Position drift compensation in time domain
//! passivity based teleoperation", IROS).
//!
//! The damping b at the hand takes in the energy of moving it, which pays for the first
//! contact: an end that has taken in nothing may give out nothing. Each end
//! keeps what it can need itself, as the stores of Franken et al. 2011 do, and promises the rest:
//! a force F moves a hand that is held with k_h by F/k_h, for which it takes ½F²/k_h; at the tip
//! it winds the servo up, ½F²/k. So what is kept follows what is asked for; of what comes in an end
//! promises a share at once, and of what it holds beyond its need the share Δt/`transfer_time` in each step.
//!
//! The force on the hand changes evenly (`paid_force.rs`): controllers that act when the energy
//! is gone let it jump.
//!
//! **What it guarantees.** By its own books it gives out no more than it took in, but
//! for what one step may overdraw, which is paid back first: for any
//! delay, jitter, loss, reordering, duplication and outage. Assumed: the force
//! on the hand is the one asked for (the books have what the master's limits leave of it, but
//! the controller cannot act faster than they let it); the servo from command to tip
//! is passive, as a spring and a damper are, up to the kinetic energy of the arm.
//!
//! **On loss.** No command, the force fades out. Afterwards the command begins at the
//! tip and approaches at `drift_speed`.

use super::contact::{CommandForce, LastCommand, TouchingTip};
use super::energy_tank::EnergyTank;
use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters, shortened};
use super::paid_force::PaidForce;
use super::step_velocity::StepVelocity;
use super::{
    Energy, EnergyMeter, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput,
    LeaderOutput, Packet, Samples, vector,
};
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct Tdpa {
        /// b: damping at the hand \[N·s/m\].
        pub damping: f64 [0.0..=1000.0, "N·s/m"] = 10.0,
        /// m: lightest mass of hand and handle \[kg\].
        pub hand_mass: f64 [0.01..=20.0, "kg"] = 0.2,
        /// Largest damping with which a debt is paid back \[N·s/m\].
        pub largest_damping: f64 [0.1..=10000.0, "N·s/m"] = 50.0,
        /// Share of what comes in through its port that an end promises to the other one at
        /// once \[-\].
        pub promised_share: f64 [0.0..=1.0, "-"] = 0.35,
        /// Time constant with which an end promises what it does not need to the other one \[s\].
        pub transfer_time: f64 [0.01..=100.0, "s"] = 0.12,
        /// k_h: how stiffly the hand is held at least \[N/m\].
        pub hand_stiffness: f64 [1.0..=1e5, "N/m"] = 300.0,
        /// Energy that an end needs for itself where no force is asked for, at the hand's
        /// scale \[J\].
        pub kept: f64 [0.0..=100.0, "J"] = 0.005,
        /// Largest change of the force on the hand \[N/s\].
        pub force_rate: f64 [1.0..=1e6, "N/s"] = 450.0,
        /// Energy that an end may hold, at the hand's scale; what is beyond
        /// counts as dissipated \[J\].
        pub reserve: f64 [0.0..=1000.0, "J"] = 0.1,
        /// Time constant of the drift compensation \[s\].
        pub drift_time: f64 [0.005..=10.0, "s"] = 0.05,
        /// Largest speed at which drift is made up for, at the hand's scale \[m/s\].
        pub drift_speed: f64 [0.0..=10.0, "m/s"] = 0.1,
        /// Largest speed at which the tip gives way, at the hand's scale \[m/s\].
        pub yield_speed: f64 [0.001..=10.0, "m/s"] = 0.2,
        /// Stiffness of the arm's servo at the tip; a session takes the arm's own
        /// where that is larger \[N/m\].
        pub servo_stiffness: f64 [1.0..=1000000.0, "N/m"] = 7000.0,
    }
}
law_ends!(Tdpa, "tdpa", ByItsBooks, TdpaLeader, TdpaFollower);

impl Tdpa {
    fn samples(&self) -> [Samples; 2] {
        // The force is at the hand's scale already.
        let force = Samples::force(1.0).with_energy();
        [Samples::MOTION.with_energy(), force]
    }
}

/// Slower than this counts as standing [m/s].
const STANDING: f64 = 1e-6;

/// The leader's end: sends position and velocity \[m/s\] of the hand, and what it
/// promises, at the hand's scale.
#[derive(Clone, Debug)]
pub struct TdpaLeader {
    parameters: Tdpa,
    mapping: Mapping,
    tank: EnergyTank,
    fade: ForceRamp,
    /// The newest force received, hand units [N].
    wanted: Vector3<f64>,
    velocity: StepVelocity,
    force: PaidForce,
}

impl TdpaLeader {
    fn new(law: &Tdpa) -> Self {
        TdpaLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            tank: EnergyTank::default(),
            fade: ForceRamp::default(),
            wanted: Vector3::zeros(),
            velocity: StepVelocity::default(),
            force: PaidForce::new(law.force_rate, law.hand_mass),
        }
    }
}

impl Leader for TdpaLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let own = &self.parameters;
        self.tank.port(energy, own.promised_share);
        let live = self.mapping.live(input.connected, input.received);
        if let Some(received) = live {
            self.tank.promise(f64::from(received.packet.energy[0]));
            self.wanted = vector(received.packet.vector);
        }
        let needed = own.kept + 0.5 * self.wanted.norm_squared() / own.hand_stiffness;
        self.tank.give(dt / own.transfer_time, needed);
        self.tank.limit(own.reserve);
        let share = self.fade.step(dt, own.force_ramp, live.is_some());
        let Some(hand) = input.hand else {
            self.velocity.forget();
            self.force.forget();
            return LeaderOutput {
                force: [0.0; 3],
                packet: Packet::empty(self.tank.told(energy)),
            };
        };
        let velocity = self.velocity.step(dt, &hand);
        let level = self.tank.level();
        let mut taken = own.damping * Vector3::from(hand.velocity);
        let square = velocity.norm_squared();
        if level < 0.0 && square > STANDING * STANDING {
            taken += (-level / (square * dt)).min(own.largest_damping) * velocity;
        }
        let wanted = share * self.wanted;
        let force = self.force.step(dt, wanted, taken, &velocity, &self.tank);
        LeaderOutput {
            force: force.into(),
            packet: Packet::new(hand.position, hand.velocity, self.tank.told(energy)),
        }
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated()
    }
}

/// The follower's end: sends position of the tip, force of the contact at the
/// hand's scale \[N\], and what it promises, at the hand's scale.
#[derive(Clone, Debug)]
pub struct TdpaFollower {
    parameters: Tdpa,
    mapping: Mapping,
    tank: EnergyTank,
    /// At the command: the servo behind it is passive by itself.
    meter: EnergyMeter,
    force: CommandForce,
    last: Vector3<f64>,
    command: LastCommand,
}

impl TdpaFollower {
    fn new(law: &Tdpa) -> Self {
        let mapping = law.mapping();
        TdpaFollower {
            parameters: law.clone(),
            mapping,
            tank: EnergyTank::default(),
            meter: EnergyMeter::default(),
            force: CommandForce::new(mapping.stiffness_at_hand(law.servo_stiffness)),
            last: Vector3::zeros(),
            command: LastCommand::default(),
        }
    }
}

impl Follower for TdpaFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let own = &self.parameters;
        let live = self.mapping.live(input.connected, input.received);
        let tip = TouchingTip::new(&self.mapping, input, &self.command);
        let here = tip.here;
        let force = self.force.step(dt, &tip);
        let mean = -0.5 * (force + self.last);
        self.last = force;
        self.meter.step(mean.into(), here.map(Into::into));
        self.tank.port(self.meter.energy(), own.promised_share);
        if let Some(received) = live {
            self.tank.promise(f64::from(received.packet.energy[0]));
        }
        let needed = own.kept + 0.5 * force.norm_squared() / self.force.stiffness();
        self.tank.give(dt / own.transfer_time, needed);
        self.tank.limit(own.reserve);
        self.tank.add(-self.force.take_wound());
        let motion = live.zip(here).map(|(received, here)| {
            let hand_velocity = vector(received.packet.vector);
            let hand = vector(received.packet.position) + received.silence * hand_velocity;
            let drift = shortened((hand - here) / own.drift_time, own.drift_speed);
            let wanted = hand_velocity + drift;
            let velocity = self
                .force
                .admitted(dt, wanted, self.tank.level(), own.yield_speed);
            (here + velocity * dt, velocity)
        });
        let given = motion.map(|(position, _)| position);
        self.command.step(dt, given, input.connected, own.deadline);
        let energy = self.tank.told(energy);
        FollowerOutput {
            command: motion.map(|(position, velocity)| self.mapping.command(position, velocity)),
            packet: match (input.tip, tip.contact) {
                (Some(tip), Some(contact)) => Packet::new(tip.position, contact.into(), energy),
                _ => Packet::empty(energy),
            },
        }
    }

    fn commanded(&mut self, position: Vector3<f64>) {
        self.command.replace(position);
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated()
    }
}

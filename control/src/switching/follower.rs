//! The follower's end: does as the frames say, and leads the tip command over.

use super::{Laws, MarkedPacket, Outgoing, SWITCH_TIME, between};
use crate::delay::{Energy, EnergyMeter, FollowerEnd, FollowerInput, Motion};

/// What a step of the follower's end gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FollowerSwitchOutput {
    /// A new tip command; `None` when there is nothing new.
    pub command: Option<Motion>,
    /// To send.
    pub outgoing: Outgoing,
}

/// The follower's end of the law in force.
#[derive(Clone, Debug)]
pub struct FollowerSwitch {
    laws: Laws,
    code: u8,
    name: &'static str,
    end: FollowerEnd,
    /// The last command given.
    command: Option<Motion>,
    /// The last command of the law before, while it is left.
    before: Option<Motion>,
    /// How far the command is led over from it, 0 … 1.
    share: f64,
    energy: EnergyMeter,
    /// By the laws that were left [J].
    dissipated: f64,
}

impl FollowerSwitch {
    /// An end that starts with the first of `laws`.
    pub fn new(laws: Laws) -> FollowerSwitch {
        let (law, code) = laws.first();
        FollowerSwitch {
            code,
            name: law.name(),
            end: law.follower(),
            laws,
            command: None,
            before: None,
            share: 1.0,
            energy: EnergyMeter::default(),
            dissipated: 0.0,
        }
    }

    fn follow(&mut self, newest: Option<MarkedPacket>) {
        let Some(code) = newest.map(|own| own.law).filter(|code| *code != self.code) else {
            return;
        };
        // A law that this end does not have: its packets mean nothing here.
        let Some(law) = self.laws.get(code) else {
            return;
        };
        self.dissipated += self.end.dissipated();
        self.code = code;
        self.name = law.name();
        self.end = law.follower();
        self.before = self.command;
        self.share = 0.0;
    }

    /// One step of `dt` \[s\] with the tip and the contact's force on it \[N\],
    /// while they are valid, and the newest packet; `connected` as in
    /// [`FollowerInput`].
    pub fn step(
        &mut self,
        dt: f64,
        tip: Option<Motion>,
        contact_force: Option<[f64; 3]>,
        newest: Option<MarkedPacket>,
        connected: bool,
    ) -> FollowerSwitchOutput {
        let force = contact_force.unwrap_or([0.0; 3]);
        self.energy.step(force, tip.map(|tip| tip.position));
        self.follow(newest);
        let step = self.end.step(
            dt,
            &FollowerInput {
                tip,
                contact_force,
                received: MarkedPacket::of(newest, self.code),
                connected,
            },
        );
        self.share = (self.share + dt / SWITCH_TIME).min(1.0);
        if self.share >= 1.0 || !connected {
            // After an outage there is nothing to lead over from.
            self.before = None;
        }
        let command = match (step.command, self.before) {
            (Some(new), Some(old)) => Some(Motion {
                position: between(self.share, old.position, new.position),
                velocity: between(self.share, old.velocity, new.velocity),
            }),
            (command, _) => command,
        };
        self.command = command.or(self.command.filter(|_| connected));
        FollowerSwitchOutput {
            command,
            outgoing: Outgoing {
                law: self.code,
                packet: step.packet,
            },
        }
    }

    /// Name of the law in force.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Energy at the follower's port: what the contact gave to the tip went in.
    pub fn energy(&self) -> Energy {
        self.energy.energy()
    }

    /// Energy that the laws dissipated at this end \[J\].
    pub fn dissipated(&self) -> f64 {
        self.dissipated + self.end.dissipated()
    }
}

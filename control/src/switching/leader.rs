//! The leader's end: decides, and leads the force over.

use super::{Laws, MarkedPacket, Outgoing, SWITCH_TIME, between};
use crate::delay::{Energy, EnergyMeter, LeaderEnd, LeaderInput, Motion};

/// What a step of the leader's end gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeaderSwitchOutput {
    /// Force on the hand \[N\].
    pub force: [f64; 3],
    /// To send.
    pub outgoing: Outgoing,
}

#[derive(Clone, Debug)]
struct Running {
    code: u8,
    name: &'static str,
    end: LeaderEnd,
}

/// The leader's end of the law in force, and of the one that follows it.
#[derive(Clone, Debug)]
pub struct LeaderSwitch {
    laws: Laws,
    current: Running,
    next: Option<Running>,
    /// How far the force is led over to the next, 0 … 1.
    share: f64,
    /// The last force of the current law while it had packets of its own [N].
    held: [f64; 3],
    wish: Option<u8>,
    energy: EnergyMeter,
    /// On the hand since the last step [N].
    force: [f64; 3],
    /// By the laws that were left [J].
    dissipated: f64,
}

impl LeaderSwitch {
    /// An end that starts with the first of `laws`.
    pub fn new(laws: Laws) -> LeaderSwitch {
        let (law, code) = laws.first();
        let current = Running {
            code,
            name: law.name(),
            end: law.leader(),
        };
        LeaderSwitch {
            current,
            laws,
            next: None,
            share: 0.0,
            held: [0.0; 3],
            wish: None,
            energy: EnergyMeter::default(),
            force: [0.0; 3],
            dissipated: 0.0,
        }
    }

    /// Asks for the law of that code; `false` if there is none. Asked for again
    /// before the switch is done, the last wish counts.
    pub fn switch_to(&mut self, code: u8) -> bool {
        let known = self.laws.get(code).is_some();
        if known {
            self.wish = Some(code);
        }
        known
    }

    fn begin(&mut self) {
        if self.next.is_some() {
            return;
        }
        let Some(code) = self.wish.take().filter(|wish| *wish != self.current.code) else {
            return;
        };
        self.next = self.laws.get(code).map(|law| Running {
            code,
            name: law.name(),
            end: law.leader(),
        });
        self.share = 0.0;
    }

    /// One step of `dt` \[s\] with the hand, while it is valid, and the newest
    /// packet; `connected` as in [`LeaderInput`].
    pub fn step(
        &mut self,
        dt: f64,
        hand: Option<Motion>,
        newest: Option<MarkedPacket>,
        connected: bool,
    ) -> LeaderSwitchOutput {
        let into = self.force.map(|force| -force);
        self.energy.step(into, hand.map(|hand| hand.position));
        self.begin();
        let input = |received| LeaderInput {
            hand,
            received,
            connected,
        };
        let mut outgoing = Outgoing::default();
        // Once answered, the old law has no more packets: its last force is led over.
        if self.share == 0.0 && !answers(&self.next, newest) {
            let received = MarkedPacket::of(newest, self.current.code);
            let old = self.current.end.step(dt, &input(received));
            self.held = old.force;
            outgoing = Outgoing {
                law: self.current.code,
                packet: old.packet,
            };
        }
        let mut output = LeaderSwitchOutput {
            force: self.held,
            outgoing,
        };
        if let Some(next) = &mut self.next {
            let answer = MarkedPacket::of(newest, next.code);
            let new = next.end.step(dt, &input(answer));
            if answer.is_some() {
                self.share = (self.share + dt / SWITCH_TIME).min(1.0);
            }
            output = LeaderSwitchOutput {
                force: between(self.share, self.held, new.force),
                outgoing: Outgoing {
                    law: next.code,
                    packet: new.packet,
                },
            };
        }
        if self.share >= 1.0
            && let Some(next) = self.next.take()
        {
            self.dissipated += self.current.end.dissipated();
            self.current = next;
            self.share = 0.0;
        }
        self.force = output.force;
        output
    }

    /// `force` \[N\] is on the hand until the next step, as in [`LeaderEnd::rendered`].
    pub fn rendered(&mut self, force: [f64; 3]) {
        self.force = force;
        self.current.end.rendered(force);
        if let Some(next) = &mut self.next {
            next.end.rendered(force);
        }
    }

    /// Name of the law that makes the force, or is about to.
    pub fn name(&self) -> &'static str {
        match &self.next {
            Some(next) if self.share > 0.0 => next.name,
            _ => self.current.name,
        }
    }

    /// Whether a switch is under way.
    pub fn is_switching(&self) -> bool {
        self.next.is_some() || self.wish.is_some()
    }

    /// Energy at the leader's port, of the force that was on the hand.
    pub fn energy(&self) -> Energy {
        self.energy.energy()
    }

    /// Energy that the laws dissipated at this end \[J\].
    pub fn dissipated(&self) -> f64 {
        let next = self.next.as_ref().map_or(0.0, |own| own.end.dissipated());
        self.dissipated + self.current.end.dissipated() + next
    }
}

/// Whether the newest packet is of the law that is to follow.
fn answers(next: &Option<Running>, newest: Option<MarkedPacket>) -> bool {
    next.as_ref()
        .is_some_and(|next| MarkedPacket::of(newest, next.code).is_some())
}

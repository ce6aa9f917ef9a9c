//! Energy that an end of a law has in hand.
//!
//! What an end gives out it must have taken in itself or been promised by the
//! other end. Of what its port takes in it promises a share to the other end, as a
//! sum that only grows, so that a packet that is lost or late takes energy away and
//! never adds any (Ryu, Artigas, Preusche 2010, "A passive bilateral control scheme
//! for a teleoperator with time-varying communication delay", Mechatronics 20;
//! stores at both ends: Franken, Stramigioli, Misra, Secchi, Macchelli 2011,
//! "Bilateral telemanipulation with time delays: a two-layer approach combining
//! passivity and transparency", IEEE T-RO 27).

use super::{Energy, Packet};
use nalgebra::Vector3;

/// Energy in hand. In hand units.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EnergyTank {
    /// May be spent; negative: overdrawn, paid back first [J].
    level: f64,
    /// Promised to the other end since the start [J].
    promised: f64,
    /// What the other end had promised at the last packet [J].
    received: Option<f64>,
    /// The port at the last step.
    port: Energy,
    /// Balance of the port that was promised already [J].
    mark: f64,
    dissipated: f64,
}

impl EnergyTank {
    /// A tank that has `level` \[J\].
    pub fn with(level: f64) -> EnergyTank {
        EnergyTank {
            level,
            ..EnergyTank::default()
        }
    }

    /// Books what went through the port (sums since the start).
    pub fn port(&mut self, port: Energy, share: f64) {
        let entered = port.entered - self.port.entered;
        self.level += entered - (port.left - self.port.left);
        self.port = port;
        self.pledge(share * entered);
    }

    /// As [`port`](Self::port) after a step of `dt` \[s\], but promises of the balance only what is beyond what it
    /// was before: what goes out and in again stays.
    /// What it was before is forgotten within `memory` \[s\].
    pub fn port_beyond(&mut self, dt: f64, port: Energy, share: f64, memory: f64) {
        let balance = port.balance();
        self.level += balance - self.port.balance();
        self.port = port;
        self.mark -= (self.mark - balance).max(0.0) * (dt / memory).min(1.0);
        self.pledge(share * (balance - self.mark));
        self.mark = self.mark.max(balance);
    }

    /// Promises `energy` \[J\] to the other end, as far as it is there.
    fn pledge(&mut self, energy: f64) {
        let promise = energy.min(self.level).max(0.0);
        self.level -= promise;
        self.promised += promise;
    }

    /// Books what the other end has promised since its start.
    pub fn promise(&mut self, promised: f64) {
        // Less than before: the other end started over.
        let before = self.received.unwrap_or(promised);
        self.level += (promised - before).max(0.0);
        self.received = Some(promised);
    }

    /// Promises `share` of what is there beyond `kept` to the other end.
    pub fn give(&mut self, share: f64, kept: f64) {
        let promise = share * (self.level - kept).max(0.0);
        self.level -= promise;
        self.promised += promise;
    }

    /// What is beyond `reserve` is dissipated.
    pub fn limit(&mut self, reserve: f64) {
        if self.level > reserve {
            self.dissipated += self.level - reserve;
            self.level = reserve;
        }
    }

    /// [J]
    pub fn level(&self) -> f64 {
        self.level
    }

    /// Since the start [J].
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    /// What a packet says of the energy at the port: promised in place of entered.
    pub fn told(&self, port: Energy) -> Energy {
        Energy {
            entered: self.promised,
            left: port.left,
        }
    }

    /// `packet` with that.
    pub fn told_in(&self, packet: Packet, port: Energy) -> Packet {
        Packet {
            energy: self.told(port).packet(),
            ..packet
        }
    }

    /// `force` \[N\] on a hand as far as the level pays for it in a step of `dt` \[s\]: the force
    /// f gives out f v Δt to a hand that moves along with it at v, and f² Δt²/m more, as it
    /// makes a hand of mass m \[kg\] faster.
    pub fn pays_for(
        &self,
        dt: f64,
        force: Vector3<f64>,
        velocity: Vector3<f64>,
        mass: f64,
    ) -> Vector3<f64> {
        let size = force.norm();
        if size < 1e-9 || dt <= 0.0 {
            return force;
        }
        let speed = velocity.dot(&force) / size;
        // The positive root of f² Δt²/m + f v Δt = level.
        let root = (speed * speed + 4.0 * self.level.max(0.0) / mass).sqrt();
        let most = 0.5 * mass / dt * (root - speed);
        force * (most / size).clamp(0.0, 1.0)
    }

    /// Puts in, or takes out when negative [J].
    pub fn add(&mut self, energy: f64) {
        self.level += energy;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever goes through the ports and however packets are lost: what
        /// both stores hold and what is on its way is never more than went in.
        #[test]
        fn no_energy_comes_from_promises(
            steps in proptest::collection::vec((0.0..1.0f64, 0.0..1.0f64, any::<bool>(), any::<bool>()), 1..200),
            share in 0.0..1.0f64,
            memory in 1e-3..1.0f64,
        ) {
            let mut stores = [EnergyTank::default(); 2];
            let mut ports = [Energy::default(); 2];
            for tank in &mut stores {
                tank.promise(0.0);
            }
            for (entered, left, which, heard) in steps {
                let own = usize::from(which);
                ports[own].entered += entered;
                ports[own].left += left;
                match which {
                    true => stores[own].port(ports[own], share),
                    false => stores[own].port_beyond(1e-3, ports[own], share, memory),
                }
                stores[own].give(share, 0.1);
                if heard {
                    let promised = stores[1 - own].promised;
                    stores[own].promise(promised);
                }
                let balance = ports[0].balance() + ports[1].balance();
                let held = stores[0].level() + stores[1].level();
                prop_assert!(held <= balance + 1e-9, "{held} {balance}");
            }
        }
    }

    #[test]
    fn what_goes_out_and_comes_in_again_is_promised_once() {
        let promised = |to_and_fro: usize, memory: f64| {
            let mut tank = EnergyTank::with(10.0);
            let mut port = Energy::default();
            for _ in 0..to_and_fro {
                port.entered += 1.0;
                tank.port_beyond(1e-3, port, 0.5, memory);
                port.left += 1.0;
                tank.port_beyond(1e-3, port, 0.5, memory);
            }
            tank.promised
        };
        assert_eq!(promised(1, 1e9), 0.5);
        assert!((promised(10, 1e9) - 0.5).abs() < 1e-6);
        // Forgotten at once it is promised each time.
        assert!((promised(10, 1e-3) - 5.0).abs() < 1e-9);
    }

    #[test]
    fn a_debt_is_paid_before_anything_is_promised() {
        let mut tank = EnergyTank::default();
        tank.port(
            Energy {
                entered: 0.0,
                left: 2.0,
            },
            1.0,
        );
        tank.port(
            Energy {
                entered: 1.5,
                left: 2.0,
            },
            1.0,
        );
        assert_eq!((tank.level(), tank.promised), (-0.5, 0.0));
        tank.port(
            Energy {
                entered: 3.0,
                left: 2.0,
            },
            1.0,
        );
        assert_eq!((tank.level(), tank.promised), (0.0, 1.0));
        tank.add(0.3);
        tank.limit(0.1);
        assert!((tank.dissipated() - 0.2).abs() < 1e-12);
    }
}

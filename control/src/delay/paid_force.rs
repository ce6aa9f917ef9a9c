//! The force on a hand that a tank pays for, and that changes evenly.

use super::energy_tank::EnergyTank;
use nalgebra::Vector3;

/// The tank pays for the force so long ahead \[s\].
const FORESIGHT: f64 = 0.002;

/// Force on the hand, from step to step.
#[derive(Clone, Debug)]
pub(super) struct PaidForce {
    /// Largest change \[N/s\].
    rate: f64,
    /// m: lightest mass of hand and handle \[kg\].
    mass: f64,
    /// At the last step \[N\].
    force: Vector3<f64>,
}

impl PaidForce {
    /// None yet; it changes by `rate` \[N/s\] at most, on a hand of `mass` \[kg\] or more.
    pub fn new(rate: f64, mass: f64) -> PaidForce {
        PaidForce {
            rate,
            mass,
            force: Vector3::zeros(),
        }
    }

    /// There is no hand.
    pub fn forget(&mut self) {
        self.force = Vector3::zeros();
    }

    /// The force after `dt` \[s\] on a hand with `velocity` \[m/s\]: of `wanted` \[N\] what `tank`
    /// pays for, less what takes energy from the hand, `taken` \[N\].
    pub fn step(
        &mut self,
        dt: f64,
        wanted: Vector3<f64>,
        taken: Vector3<f64>,
        velocity: &Vector3<f64>,
        tank: &EnergyTank,
    ) -> Vector3<f64> {
        let force = tank.pays_for(FORESIGHT, wanted, *velocity, self.mass);
        let force = force.cap_magnitude(self.releasable(&force, velocity, tank));
        self.force += (force - taken - self.force).cap_magnitude(self.rate * dt);
        self.force
    }

    /// The force along `force` that the tank can let go of [N]: falling to zero at a rate r, f
    /// gives a hand of mass m that lets go the impulse p = f²/2r, and where that moves along with
    /// the force at v already the energy p v + p²/2m ≤ E.
    fn releasable(&self, force: &Vector3<f64>, velocity: &Vector3<f64>, tank: &EnergyTank) -> f64 {
        let speed = force
            .try_normalize(1e-9)
            .map_or(0.0, |along| velocity.dot(&along));
        let energy = tank.level().max(0.0);
        let fastest = (speed * speed + 2.0 * energy / self.mass).sqrt();
        (2.0 * self.rate * self.mass * (fastest - speed)).sqrt()
    }
}

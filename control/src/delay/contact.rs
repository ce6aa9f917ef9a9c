//! The force that the tip's command pushes with.
//!
//! The estimated contact force lags behind the command by the servo. A law that
//! lets the tip give way to a force (an admittance) would close a loop over that
//! lag and chatter on a stiff wall. The force of the servo's spring, k (x_c − x),
//! does not lag, but its size is not well known. So both: the estimate at low
//! frequencies, the spring at high ones (a complementary filter), F = z + k (x_c − x)
//! with ż = (F_est − k (x_c − x) − z)/τ. Out of contact it is zero.

use super::FollowerInput;
use super::mapping::Mapping;
use nalgebra::Vector3;

/// Time constant τ of the filter [s]: longer than the servo's lag.
const TIME: f64 = 0.05;

/// What a follower whose tip gives way sees, in hand units.
#[derive(Clone, Copy, Debug)]
pub(super) struct TouchingTip {
    /// Force of the contact on the tip, zero where it is not known [N].
    pub contact: Vector3<f64>,
    /// The tip [m].
    pub tip: Option<Vector3<f64>>,
    /// The command, before the first one the tip [m].
    pub here: Option<Vector3<f64>>,
    /// Lead of the command over the tip [m].
    pub lead: Vector3<f64>,
}

impl TouchingTip {
    /// Of `input`, with the last command \[m\], hand units.
    pub fn new(mapping: &Mapping, input: &FollowerInput, command: Option<Vector3<f64>>) -> Self {
        let tip = input.tip.map(|tip| mapping.tip_at_hand(tip.position));
        let here = command.or(tip);
        TouchingTip {
            contact: mapping.contact_at_hand(input.contact_force.unwrap_or([0.0; 3])),
            tip,
            here,
            lead: here
                .zip(tip)
                .map_or(Vector3::zeros(), |(here, tip)| here - tip),
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

    /// The force with which the command pushes [N], from the contact's force on
    /// the tip [N] and the command's lead over the tip [m].
    pub fn step(&mut self, dt: f64, contact: Vector3<f64>, lead: Vector3<f64>) -> Vector3<f64> {
        let spring = self.stiffness * lead;
        let began = self.force == Vector3::zeros();
        self.force = if contact.norm_squared() < 1e-12 {
            // What leads now becomes force when the tip is stopped.
            self.low = Vector3::zeros();
            Vector3::zeros()
        } else {
            if began {
                self.wound = 0.5 * self.stiffness * lead.norm_squared();
            }
            let share = dt / (dt + TIME);
            self.low += share * (-contact - spring - self.low);
            self.low + spring
        };
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

    #[test]
    fn at_rest_it_is_the_estimate_and_at_once_it_is_the_spring() {
        let mut force = CommandForce::new(1000.0);
        let contact = Vector3::new(-2.0, 0.0, 0.0);
        let lead = |x: f64| Vector3::new(x, 0.0, 0.0);
        assert_eq!(
            force.step(1e-3, Vector3::zeros(), lead(1e-3)),
            Vector3::zeros()
        );
        assert_eq!(force.acting(), 0.0);
        let mut own = Vector3::zeros();
        for _ in 0..1000 {
            own = force.step(1e-3, contact, lead(1e-3));
        }
        assert!((own.x - 2.0).abs() < 1e-6, "{own}");
        assert_eq!(force.acting(), 1000.0);
        let jumped = force.step(1e-3, contact, lead(2e-3));
        assert!((jumped.x - own.x - 1.0).abs() < 0.03, "{jumped}");
    }
}

//! The gear's elasticity: flex spline and torque sensor together.

/// τ = K δ + K₃ δ³ with the winding δ = θ − q.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elasticity {
    /// K \[Nm/rad\].
    pub(super) stiffness: f64,
    /// K₃ \[Nm/rad³\], not negative.
    pub(super) cubic_stiffness: f64,
}

impl Elasticity {
    /// Torque \[Nm\] at the winding `wound` \[rad\].
    pub(super) fn torque(&self, wound: f64) -> f64 {
        (self.stiffness + self.cubic_stiffness * wound * wound) * wound
    }

    /// Energy \[J\] in it at the winding `wound` \[rad\].
    pub(super) fn energy(&self, wound: f64) -> f64 {
        let square = wound * wound;
        (0.5 * self.stiffness + 0.25 * self.cubic_stiffness * square) * square
    }

    /// Winding \[rad\] that bears `torque` \[Nm\], by Newton's method.
    ///
    /// It starts beyond the root of a function that only bends upwards from
    /// there, and so comes down to it without fail.
    pub(super) fn wound_by(&self, torque: f64) -> f64 {
        let mut wound = torque / self.stiffness;
        for _ in 0..50 {
            let slope = self.stiffness + 3.0 * self.cubic_stiffness * wound * wound;
            wound -= (self.torque(wound) - torque) / slope;
        }
        wound
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn winding_undoes_torque_and_energy_is_its_integral(
            torque in -200.0..200.0f64, stiffness in 10.0..1e5f64, cubic_stiffness in 0.0..1e9f64,
        ) {
            let gear = Elasticity { stiffness, cubic_stiffness };
            let wound = gear.wound_by(torque);
            prop_assert!((gear.torque(wound) - torque).abs() < 1e-9 * (1.0 + torque.abs()));
            let h = 1e-6 * (1e-3 + wound.abs());
            let slope = (gear.energy(wound + h) - gear.energy(wound - h)) / (2.0 * h);
            prop_assert!((slope - torque).abs() < 1e-4 * (1.0 + torque.abs()));
        }
    }
}

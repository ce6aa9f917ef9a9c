//! Contact of the stylus tip with a surface.

use crate::friction::sign;
use crate::parameters;

parameters! {
    /// How a surface pushes and rubs.
    #[derive(Copy)]
    pub struct ContactParameters {
        /// Stiffness along the normal \[N/m\].
        pub stiffness: f64 [1.0..=1e7, "N/m"],
        /// Damping along the normal \[N·s/m\].
        pub damping: f64 [0.0..=1e5, "N·s/m"],
        /// Coulomb coefficient b_0T of equation (6) \[-\].
        pub friction: f64 [0.0..=3.0, "-"],
    }
}

impl ContactParameters {
    /// Normal force F_N \[N\] at `penetration` \[m\] (positive inside) that
    /// grows at `rate` \[m/s\]. Never negative: a surface does not pull.
    pub fn normal_force(&self, penetration: f64, rate: f64) -> f64 {
        if penetration <= 0.0 {
            return 0.0;
        }
        (self.stiffness * penetration + self.damping * rate).max(0.0)
    }

    /// Tangential force on the tip along the tangent \[N\], when it slides
    /// with `velocity` \[m/s\] along it: equation (6), against the motion.
    /// Zero at rest, where equation (6) says nothing.
    pub fn friction_force(&self, normal_force: f64, velocity: f64) -> f64 {
        -self.friction * normal_force.abs() * sign(velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SURFACE: ContactParameters = ContactParameters {
        stiffness: 2e4,
        damping: 50.0,
        friction: 0.3,
    };

    #[test]
    fn a_millimetre_pushes_with_twenty_newtons() {
        assert_eq!(SURFACE.normal_force(1e-3, 0.0), 20.0);
        assert_eq!(SURFACE.normal_force(-1e-3, 1.0), 0.0);
        assert_eq!(SURFACE.friction_force(20.0, 0.1), -6.0);
        assert_eq!(SURFACE.friction_force(20.0, 0.0), 0.0);
    }

    proptest! {
        #[test]
        fn it_never_pulls_and_friction_takes_energy(
            depth in -0.01..0.01f64, rate in -5.0..5.0f64, velocity in -1.0..1.0f64,
        ) {
            let normal = SURFACE.normal_force(depth, rate);
            prop_assert!(normal >= 0.0);
            prop_assert!(SURFACE.friction_force(normal, velocity) * velocity <= 0.0);
        }
    }
}

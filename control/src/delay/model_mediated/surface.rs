//! A surface as the law knows it, and a force as that of several of them.

use nalgebra::Vector3;

/// Surfaces that are known at a time: those of a corner.
pub(super) const SURFACES: usize = 3;
/// Cosine of the angle within which a force belongs to the surface that is
/// known: 40°, friction bends it aside by up to that.
const SAME: f64 = 0.77;
/// Its tangent.
pub(super) const SAME_TANGENT: f64 = 0.83;
/// A stiffness is known well with the first relative standard error, and not with the second [-].
pub(super) const SURE: f64 = 0.1;
const UNSURE: f64 = 0.3;

/// With so many rounds the surfaces of a corner share a force to 2 %.
const ROUNDS: usize = 16;

/// A plane with stiffness and friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceModel {
    /// n: out of the surface, unit length.
    pub normal: Vector3<f64>,
    /// s₀: the surface is where −n·x = s₀ \[m\].
    pub place: f64,
    /// K \[N/m\]; zero: no surface is known.
    pub stiffness: f64,
    /// Its relative standard error, 1 at most: nothing is known of it then \[-\].
    pub stiffness_error: f64,
    /// Coulomb coefficient \[-\].
    pub friction: f64,
}

impl SurfaceModel {
    /// How far `position` \[m\] is behind the surface \[m\]; negative before it.
    pub(super) fn depth(&self, position: &Vector3<f64>) -> f64 {
        -self.normal.dot(position) - self.place
    }

    /// Whether what pushes along `direction`, or has it as its normal, may be this surface.
    pub(super) fn pushes_along(&self, direction: &Vector3<f64>) -> bool {
        self.normal.dot(direction) >= SAME * direction.norm()
    }

    /// How little is known of the stiffness, from 0 to 1 \[-\].
    pub(super) fn doubt(&self) -> f64 {
        ((self.stiffness_error - SURE) / (UNSURE - SURE)).clamp(0.0, 1.0)
    }
}

/// What of `force` \[N\] is of the surface with each of the `normals`, along it \[N\]: never below
/// zero, and together as near to it as they come (coordinate descent on the squares).
pub(super) fn shares(
    normals: &[Option<Vector3<f64>>; SURFACES],
    force: &Vector3<f64>,
) -> [f64; SURFACES] {
    let mut shares = [0.0; SURFACES];
    let mut left = *force;
    for _ in 0..ROUNDS {
        let mut changed = false;
        for (share, normal) in shares.iter_mut().zip(normals) {
            let Some(normal) = normal else { continue };
            let own = (*share + normal.dot(&left)).max(0.0);
            changed |= own != *share;
            left -= (own - *share) * normal;
            *share = own;
        }
        if !changed {
            break;
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Three walls of a corner, neither nearly flat nor nearly a slit.
    fn corner() -> impl Strategy<Value = [Vector3<f64>; SURFACES]> {
        let tilt = || proptest::array::uniform3(-0.3..0.3f64).prop_map(Vector3::from);
        [tilt(), tilt(), tilt()].prop_map(|tilts| {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            std::array::from_fn(|at| (axes[at] + tilts[at]).normalize())
        })
    }

    proptest! {
        /// At the least of the squares nothing is left along a surface that has a share, and
        /// nothing is pushed into one that has none.
        #[test]
        fn shares_are_those_of_least_squares(
            normals in corner(),
            force in proptest::array::uniform3(-20.0..20.0f64),
        ) {
            let force = Vector3::from(force);
            let shares = shares(&normals.map(Some), &force);
            let sum: Vector3<f64> = normals.iter().zip(shares).map(|(own, share)| own * share).sum();
            let left = force - sum;
            for (normal, share) in normals.iter().zip(shares) {
                prop_assert!(share >= 0.0);
                let along = normal.dot(&left);
                prop_assert!(along < 0.02 * force.norm(), "{along}");
                prop_assert!(share == 0.0 || along > -0.02 * force.norm(), "{along}");
            }
        }
    }

    #[test]
    fn a_force_on_one_surface_is_its_own() {
        let normals = [None, Some(-Vector3::x()), None];
        let of = |force| shares(&normals, &force);
        assert_eq!(of(Vector3::new(-3.0, 1.0, 0.0)), [0.0, 3.0, 0.0]);
        assert_eq!(of(Vector3::x()), [0.0; SURFACES]);
    }
}

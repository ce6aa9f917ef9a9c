//! What of a link's masses counts for its motion: ten inertial parameters.

use std::ops::Add;

use nalgebra::{Matrix3, Matrix4, Vector3};

use super::placement::Placement;

/// Inertial parameters of a link.
pub const LINK_PARAMETERS: usize = 10;

/// A rigid body's mass and how it is distributed, in the frame of its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    /// Mass m \[kg\].
    pub mass: f64,
    /// First moment h = m c, mass times centre of mass \[kg m\].
    pub first_moment: Vector3<f64>,
    /// Rotational inertia I about the frame's origin \[kg m²\], symmetric.
    pub rotational: Matrix3<f64>,
}

impl LinkInertia {
    /// No mass at all.
    pub fn zero() -> LinkInertia {
        LinkInertia {
            mass: 0.0,
            first_moment: Vector3::zeros(),
            rotational: Matrix3::zeros(),
        }
    }

    /// From mass \[kg\], centre of mass \[m\] and the rotational inertia about the
    /// centre of mass \[kg m²\], axes as the link's frame: the parallel-axis theorem
    /// (Featherstone 2008, eq. 2.63).
    pub fn about_center_of_mass(
        mass: f64,
        center_of_mass: Vector3<f64>,
        rotational: Matrix3<f64>,
    ) -> LinkInertia {
        let cross = center_of_mass.cross_matrix();
        LinkInertia {
            mass,
            first_moment: center_of_mass * mass,
            rotational: rotational - cross * cross * mass,
        }
    }

    /// The ten parameters in the order m, m c_x, m c_y, m c_z, I_xx, I_xy, I_yy, I_xz,
    /// I_yz, I_zz, with I about the frame's origin; this is Pinocchio's order.
    pub fn parameters(&self) -> [f64; LINK_PARAMETERS] {
        let (h, i) = (&self.first_moment, &self.rotational);
        [
            self.mass, h.x, h.y, h.z, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33,
        ]
    }

    /// Of ten parameters in the order of [`parameters`](Self::parameters).
    pub fn from_parameters(parameters: &[f64; LINK_PARAMETERS]) -> LinkInertia {
        let [mass, x, y, z, xx, xy, yy, xz, yz, zz] = *parameters;
        LinkInertia {
            mass,
            first_moment: Vector3::new(x, y, z),
            rotational: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }

    /// Σ m x xᵀ over its points x, in homogeneous coordinates \[kg m²\], \[kg m\], \[kg\]:
    /// (½ tr(I) 1 − I, h; hᵀ, m). It is positive definite for the bodies that can exist, of
    /// whatever shape, and for no others (Traversaro, Brossette, Escande, Nori 2016;
    /// Wensing, Kim, Slotine 2018).
    pub fn pseudo_inertia(&self) -> Matrix4<f64> {
        let second = Matrix3::identity() * (0.5 * self.rotational.trace()) - self.rotational;
        let mut matrix = Matrix4::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&second);
        matrix
            .fixed_view_mut::<3, 1>(0, 3)
            .copy_from(&self.first_moment);
        let row = self.first_moment.transpose();
        matrix.fixed_view_mut::<1, 3>(3, 0).copy_from(&row);
        matrix[(3, 3)] = self.mass;
        matrix
    }

    /// Whether a body can have it: its pseudo-inertia is positive definite.
    pub fn is_physical(&self) -> bool {
        self.pseudo_inertia().cholesky().is_some()
    }

    /// Centre of mass \[m\] and the rotational inertia about it \[kg m²\], axes as the
    /// link's frame; `None` without mass.
    pub fn at_center_of_mass(&self) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        if self.mass.abs() < 1e-12 {
            return None;
        }
        let center = self.first_moment / self.mass;
        let cross = center.cross_matrix();
        Some((center, self.rotational + cross * cross * self.mass))
    }

    /// The same body, in the frame in which its own frame is at `placement`
    /// (Featherstone 2008, eq. 2.66).
    pub fn placed(&self, placement: &Placement) -> LinkInertia {
        let turn = &placement.rotation;
        let first_moment = turn * self.first_moment;
        let shift = placement.translation.cross_matrix();
        let mixed = shift * first_moment.cross_matrix();
        LinkInertia {
            mass: self.mass,
            first_moment: first_moment + placement.translation * self.mass,
            rotational: turn * self.rotational * turn.transpose()
                - mixed
                - mixed.transpose()
                - shift * shift * self.mass,
        }
    }
}

/// Two bodies in one frame, fixed to each other.
impl Add for LinkInertia {
    type Output = LinkInertia;

    fn add(self, other: LinkInertia) -> LinkInertia {
        LinkInertia {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            rotational: self.rotational + other.rotational,
        }
    }
}

#[cfg(test)]
mod unit_tests {
    use super::*;

    /// Of points, each with its mass: what the definitions say.
    fn of_points(points: &[(f64, Vector3<f64>)]) -> LinkInertia {
        points.iter().fold(LinkInertia::zero(), |sum, (mass, at)| {
            sum + LinkInertia::about_center_of_mass(*mass, *at, Matrix3::zeros())
        })
    }

    #[test]
    fn a_body_that_is_moved_is_its_points_moved() {
        let points = [
            (1.0, Vector3::new(0.1, -0.4, 0.3)),
            (2.5, Vector3::new(-0.7, 0.2, 0.9)),
            (0.3, Vector3::new(0.5, 0.6, -0.1)),
        ];
        let placement =
            Placement::from_roll_pitch_yaw(Vector3::new(0.3, -1.2, 0.5), [0.4, -0.9, 2.0]);
        let moved = points.map(|(mass, at)| (mass, placement.point(&at)));
        let (one, other) = (of_points(&points).placed(&placement), of_points(&moved));
        assert!((one.first_moment - other.first_moment).norm() < 1e-14);
        assert!((one.rotational - other.rotational).norm() < 1e-14);
        assert!((one.rotational - one.rotational.transpose()).norm() < 1e-14);
    }

    #[test]
    fn a_pseudo_inertia_is_the_sum_over_points_and_a_flat_box_cannot_be_flatter_than_flat() {
        let points = [
            (1.0, Vector3::new(0.1, -0.4, 0.3)),
            (2.5, Vector3::new(-0.7, 0.2, 0.9)),
            (0.3, Vector3::new(0.5, 0.6, -0.1)),
            (0.9, Vector3::new(-0.2, 0.1, -0.6)),
        ];
        let sum = points.iter().fold(Matrix4::zeros(), |sum, (mass, x)| {
            sum + x.push(1.0) * x.push(1.0).transpose() * *mass
        });
        let body = of_points(&points);
        assert!((body.pseudo_inertia() - sum).norm() < 1e-12);
        assert!(body.is_physical());
        let (center, about) = body.at_center_of_mass().expect("it has mass");
        let again = LinkInertia::about_center_of_mass(body.mass, center, about);
        assert!((again.rotational - body.rotational).norm() < 1e-12);
        // I_zz of more than I_xx + I_yy: no density gives that.
        let diagonal = Vector3::new(1.0, 1.0, 2.1);
        let turn = Matrix3::from_diagonal(&diagonal);
        assert!(!LinkInertia::about_center_of_mass(1.0, Vector3::zeros(), turn).is_physical());
    }

    #[test]
    fn a_point_on_an_arm_has_its_moment_about_the_axes_across() {
        let body = of_points(&[(2.0, Vector3::new(3.0, 0.0, 0.0))]);
        assert_eq!(
            body.parameters(),
            [2.0, 6.0, 0.0, 0.0, 0.0, 0.0, 18.0, 0.0, 0.0, 18.0]
        );
        assert_eq!(LinkInertia::from_parameters(&body.parameters()), body);
    }
}

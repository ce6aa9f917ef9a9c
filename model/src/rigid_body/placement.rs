//! Where one frame is in another.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// A frame, seen from another: x_there = rotation · x_here + translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Orientation: its columns are this frame's axes in the other one \[-\].
    pub rotation: Matrix3<f64>,
    /// Origin of this frame in the other one \[m\].
    pub translation: Vector3<f64>,
}

impl Placement {
    /// The same frame.
    pub fn identity() -> Placement {
        Placement {
            rotation: Matrix3::identity(),
            translation: Vector3::zeros(),
        }
    }

    /// From a translation \[m\] and roll, pitch, yaw \[rad\] about the other frame's x,
    /// then y, then z axis, as URDF has them: R = R_z(yaw) R_y(pitch) R_x(roll).
    pub fn from_roll_pitch_yaw(
        translation: Vector3<f64>,
        [roll, pitch, yaw]: [f64; 3],
    ) -> Placement {
        let rotation = rotation(&Vector3::z(), yaw)
            * rotation(&Vector3::y(), pitch)
            * rotation(&Vector3::x(), roll);
        Placement {
            rotation,
            translation,
        }
    }

    /// Where `inner`, which is given in this frame, is in the other one.
    pub fn then(&self, inner: &Placement) -> Placement {
        Placement {
            rotation: self.rotation * inner.rotation,
            translation: self.point(&inner.translation),
        }
    }

    /// The other frame as seen from this one.
    pub fn inverse(&self) -> Placement {
        let rotation = self.rotation.transpose();
        Placement {
            rotation,
            translation: -(rotation * self.translation),
        }
    }

    /// The orientation as quaternion x, y, z, w.
    pub fn quaternion(&self) -> [f64; 4] {
        let rotation = Rotation3::from_matrix_unchecked(self.rotation);
        UnitQuaternion::from_rotation_matrix(&rotation)
            .coords
            .into()
    }

    /// A point of this frame \[m\], in the other one.
    pub fn point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }
}

/// Turns by `angle` \[rad\] about the unit vector `axis`, by Rodrigues' formula
/// (Featherstone 2008, eq. 2.30): R = 1 + sin(angle) \[axis\]× + (1 − cos(angle)) \[axis\]×².
pub fn rotation(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = angle.sin_cos();
    let cross = axis.cross_matrix();
    Matrix3::identity() + cross * sine + cross * cross * (1.0 - cosine)
}

/// The vector r \[rad\] along the axis about which R = `rotation` turns, as long as
/// the angle within \[0, π\].
pub fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    // 2 sin(angle) · axis, and 2 cos(angle).
    let twice_sine = Vector3::new(
        rotation.m32 - rotation.m23,
        rotation.m13 - rotation.m31,
        rotation.m21 - rotation.m12,
    );
    let twice_cosine = rotation.trace() - 1.0;
    let sine = twice_sine.norm();
    let angle = sine.atan2(twice_cosine);
    if sine > 1e-6 {
        return twice_sine * (angle / sine);
    }
    if twice_cosine > 0.0 {
        return twice_sine * 0.5;
    }
    // Half a turn: R + 1 = 2 · axis · axisᵀ, whose longest column tells best.
    let doubled = rotation + Matrix3::identity();
    let column = (0..3).max_by(|a, b| doubled[(*a, *a)].total_cmp(&doubled[(*b, *b)]));
    let along = doubled.column(column.unwrap_or(0)).into_owned();
    let sign = if along.dot(&twice_sine) < 0.0 {
        -1.0
    } else {
        1.0
    };
    along.normalize() * (sign * angle)
}

#[cfg(test)]
mod unit_tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn roll_comes_before_yaw() {
        let placement = Placement::from_roll_pitch_yaw(
            Vector3::new(1.0, 2.0, 3.0),
            [FRAC_PI_2, 0.0, FRAC_PI_2],
        );
        // y is rolled to z, which yaw leaves; x is yawed to y.
        assert!((placement.point(&Vector3::y()) - Vector3::new(1.0, 2.0, 4.0)).norm() < 1e-15);
        assert!((placement.point(&Vector3::x()) - Vector3::new(1.0, 3.0, 3.0)).norm() < 1e-15);
    }

    #[test]
    fn a_quarter_turn_about_z_is_half_of_it_in_the_quaternion() {
        let placement = Placement::from_roll_pitch_yaw(Vector3::zeros(), [0.0, 0.0, FRAC_PI_2]);
        let half = 0.5_f64.sqrt();
        let apart = placement
            .quaternion()
            .into_iter()
            .zip([0.0, 0.0, half, half]);
        assert!(apart.into_iter().all(|(a, b)| (a - b).abs() < 1e-15));
    }

    proptest! {
        #[test]
        fn the_rotation_vector_is_axis_times_angle(
            x in -1.0..1.0f64, y in -1.0..1.0f64, z in 0.1..1.0f64,
            angle in prop_oneof![0.0..PI, Just(0.0), Just(1e-9), Just(PI), PI - 1e-7..PI],
        ) {
            let axis = Vector3::new(x, y, z).normalize();
            let found = rotation_vector(&rotation(&axis, angle));
            let wanted = axis * angle;
            // Half a turn is the same about the axis and against it.
            let apart = (found - wanted).norm().min((found + wanted).norm() + (PI - angle));
            prop_assert!(apart < 1e-6, "{found} {wanted}");
        }

        #[test]
        fn a_placement_and_its_inverse_undo_each_other(
            a in -3.0..3.0f64, b in -1.5..1.5f64, c in -3.0..3.0f64, x in -2.0..2.0f64,
        ) {
            let placement = Placement::from_roll_pitch_yaw(Vector3::new(x, b, c), [a, b, c]);
            let same = placement.then(&placement.inverse());
            prop_assert!((same.rotation - Matrix3::identity()).norm() < 1e-14);
            prop_assert!(same.translation.norm() < 1e-14);
        }
    }
}

//! The torques as a linear function of the inertial parameters.

use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::{Joints, MAX_JOINTS};

use super::{chain::Chain, inertia::LINK_PARAMETERS, motion::LinkMotion};

/// Columns of a [`Regressor`].
pub const REGRESSOR_COLUMNS: usize = MAX_JOINTS * LINK_PARAMETERS;

/// A row for each joint; ten columns for each link, in the order of
/// [`LinkInertia::parameters`](super::LinkInertia::parameters), from the base on. Zero
/// behind the last joint and link.
pub type Regressor = SMatrix<f64, MAX_JOINTS, REGRESSOR_COLUMNS>;

impl Chain {
    /// Regressor Y with τ = Y(q, q̇, q̈) φ + armature · q̈, where φ are the inertial
    /// parameters of all links and τ is
    /// [`inverse_dynamics`](Self::inverse_dynamics) in `gravity` \[m/s², base frame\].
    ///
    /// Each link's part is that of Atkeson, An and Hollerbach 1986, about the origin
    /// of its frame; the joints before it feel it along their axes.
    pub fn torque_regressor(
        &self,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
        gravity: &Vector3<f64>,
    ) -> Regressor {
        self.expect_joints(q);
        self.expect_joints(qd);
        self.expect_joints(qdd);
        let mut regressor = Regressor::zeros();
        let mut motion = LinkMotion::of_base(gravity);
        // How this link's origin moves, and how it turns, with each joint before it.
        let mut velocities = [Vector3::zeros(); MAX_JOINTS];
        let mut turns = [Vector3::zeros(); MAX_JOINTS];
        for (joint, link) in self.links.iter().enumerate() {
            let placement = link.placement(q[joint]);
            let (rotation, shift) = (&placement.rotation, &placement.translation);
            for before in 0..joint {
                let moved = velocities[before] + turns[before].cross(shift);
                velocities[before] = rotation.tr_mul(&moved);
                turns[before] = rotation.tr_mul(&turns[before]);
            }
            motion = motion.next(link, &placement, qd[joint], qdd[joint]);
            match link.is_revolute() {
                true => turns[joint] = link.axis,
                false => velocities[joint] = link.axis,
            }
            let columns = link_columns(&motion);
            for before in 0..=joint {
                let (velocity, turn) = (&velocities[before], &turns[before]);
                for (column, (force, moment)) in columns.iter().enumerate() {
                    regressor[(before, LINK_PARAMETERS * joint + column)] =
                        velocity.dot(force) + turn.dot(moment);
                }
            }
        }
        regressor
    }

    /// φ: the ten inertial parameters of each link, from the base on, zero behind the
    /// last one.
    pub fn inertial_parameters(&self) -> SMatrix<f64, REGRESSOR_COLUMNS, 1> {
        let mut all = SMatrix::<f64, REGRESSOR_COLUMNS, 1>::zeros();
        for (joint, link) in self.links.iter().enumerate() {
            for (place, value) in link.inertia.parameters().into_iter().enumerate() {
                all[LINK_PARAMETERS * joint + place] = value;
            }
        }
        all
    }
}

/// Force \[N\] and moment \[Nm\] about its origin that a link needs for a unit of each
/// of its parameters, in its frame, moving with these.
fn link_columns(motion: &LinkMotion) -> [(Vector3<f64>, Vector3<f64>); LINK_PARAMETERS] {
    let LinkMotion {
        turning,
        turning_rate,
        acceleration,
    } = motion;
    let none = Vector3::zeros();
    let spin = turning.cross_matrix();
    // What a unit of first moment along each axis takes: the columns of ω̇× + ω× ω×.
    let lever: Matrix3<f64> = turning_rate.cross_matrix() + spin * spin;
    // I ω̇ + ω × I ω for the inertia with ones at (a, b) and (b, a).
    let rotational = |a: usize, b: usize| {
        let of = |vector: &Vector3<f64>| {
            let mut product = Vector3::zeros();
            product[a] = vector[b];
            product[b] = vector[a];
            product
        };
        (none, of(turning_rate) + turning.cross(&of(turning)))
    };
    let first_moment = |axis: usize| {
        (
            lever.column(axis).into_owned(),
            Vector3::ith(axis, 1.0).cross(acceleration),
        )
    };
    [
        (*acceleration, none),
        first_moment(0),
        first_moment(1),
        first_moment(2),
        rotational(0, 0),
        rotational(0, 1),
        rotational(1, 1),
        rotational(0, 2),
        rotational(1, 2),
        rotational(2, 2),
    ]
}

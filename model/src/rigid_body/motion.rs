//! How a link moves, from the base on.

use nalgebra::Vector3;

use super::chain::Link;
use super::placement::Placement;

/// Motion of a link's frame in that frame, about its origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkMotion {
    /// Angular velocity \[rad/s\].
    pub turning: Vector3<f64>,
    /// Its rate of change \[rad/s²\].
    pub turning_rate: Vector3<f64>,
    /// Acceleration of the origin less gravity \[m/s²\].
    pub acceleration: Vector3<f64>,
}

impl LinkMotion {
    /// The base at rest in `gravity` \[m/s²\]: it accelerates against that, which stands for
    /// the weight of all links.
    pub fn of_base(gravity: &Vector3<f64>) -> LinkMotion {
        LinkMotion {
            turning: Vector3::zeros(),
            turning_rate: Vector3::zeros(),
            acceleration: -gravity,
        }
    }

    /// The next link, at `placement` in this one, whose joint moves with the rate `qd` and its
    /// change `qdd`: the forward recursion of Luh, Walker and Paul 1980.
    pub fn next(&self, link: &Link, placement: &Placement, qd: f64, qdd: f64) -> LinkMotion {
        let (rotation, shift) = (&placement.rotation, &placement.translation);
        let moved = self.acceleration
            + self.turning_rate.cross(shift)
            + self.turning.cross(&self.turning.cross(shift));
        let mut next = LinkMotion {
            turning: rotation.tr_mul(&self.turning),
            turning_rate: rotation.tr_mul(&self.turning_rate),
            acceleration: rotation.tr_mul(&moved),
        };
        let (rate, rate_change) = (link.axis * qd, link.axis * qdd);
        let bent = next.turning.cross(&rate);
        if link.is_revolute() {
            next.turning_rate += rate_change + bent;
            next.turning += rate;
        } else {
            next.acceleration += rate_change + bent * 2.0;
        }
        next
    }
}

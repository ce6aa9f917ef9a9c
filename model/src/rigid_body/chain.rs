//! A serial chain of joints and links, and where its frames are.

use nalgebra::{Matrix3, Vector3};

use crate::{JointCount, Joints, MAX_JOINTS};

use super::{inertia::LinkInertia, placement::Placement};

/// How a joint moves its link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// It turns the link about its axis; positions in rad.
    Revolute,
    /// It shifts the link along its axis; positions in m.
    Prismatic,
}

/// Between which positions a joint may be \[rad\] or \[m\]; infinite where there is no end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionLimits {
    /// The least position.
    pub lower: f64,
    /// The greatest position.
    pub upper: f64,
}

impl PositionLimits {
    /// No ends.
    pub const NONE: PositionLimits = PositionLimits {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };
}

/// A joint and the link that it carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainJoint {
    /// Turning or shifting.
    pub kind: JointKind,
    /// The link's frame at joint position zero, in the frame of the link before it, or
    /// in the base frame.
    pub placement: Placement,
    /// Direction of the joint in the link's frame; its length does not matter.
    pub axis: Vector3<f64>,
    /// Inertia of the motor and its gear as the joint feels it \[kg m²\] or \[kg\].
    pub armature: f64,
    /// Where its ends are.
    pub limits: PositionLimits,
    /// The link, with all that is fixed to it, in the link's frame.
    pub link: LinkInertia,
}

/// Why joints make no chain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// None, or too many.
    #[error(
        "{0} joints where 1 to {MAX_JOINTS} are needed; choose a part of the arm that has so many"
    )]
    JointCount(usize),
    /// A number is NaN or infinite.
    #[error("{what} of joint {joint} (from 1) is not finite; give numbers")]
    NotFinite {
        /// Number from 1.
        joint: usize,
        /// Of what.
        what: &'static str,
    },
    /// The axis has no direction.
    #[error("the axis of joint {joint} (from 1) has length 0; give a direction such as (0, 0, 1)")]
    NoAxis {
        /// Number from 1.
        joint: usize,
    },
    /// A placement's matrix is no rotation.
    #[error(
        "the placement of {what} has a matrix that is no rotation; its columns have to be a right-handed set of unit vectors"
    )]
    NoRotation {
        /// "joint 3", "the tip".
        what: String,
    },
    /// A mass or armature below zero.
    #[error("{what} of joint {joint} (from 1) is {value}; it cannot be negative")]
    Negative {
        /// Number from 1.
        joint: usize,
        /// Of what.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The lower limit is above the upper one.
    #[error(
        "joint {joint} (from 1) may be between {lower} and {upper}, which no position is; exchange the limits"
    )]
    Limits {
        /// Number from 1.
        joint: usize,
        /// The least position.
        lower: f64,
        /// The greatest position.
        upper: f64,
    },
}

/// What of a joint the functions of a state need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    kind: JointKind,
    /// Orientation of the link in the frame before it is
    /// `fixed` + sin q · `by_sine` + (1 − cos q) · `by_cosine`, for a revolute joint.
    fixed: Matrix3<f64>,
    by_sine: Matrix3<f64>,
    by_cosine: Matrix3<f64>,
    /// Origin at position zero \[m\], and how it moves with the joint \[m/m\].
    origin: Vector3<f64>,
    by_position: Vector3<f64>,
    /// Unit vector in the link's frame.
    pub axis: Vector3<f64>,
    pub inertia: LinkInertia,
}

impl Link {
    fn new(joint: &ChainJoint) -> Link {
        let axis = joint.axis.normalize();
        let (fixed, cross) = (joint.placement.rotation, axis.cross_matrix());
        let by_position = match joint.kind {
            JointKind::Revolute => Vector3::zeros(),
            JointKind::Prismatic => fixed * axis,
        };
        Link {
            kind: joint.kind,
            fixed,
            by_sine: fixed * cross,
            by_cosine: fixed * cross * cross,
            origin: joint.placement.translation,
            by_position,
            axis,
            inertia: joint.link,
        }
    }

    /// The link's frame in the frame before it, at joint position `q`.
    #[inline]
    pub fn placement(&self, q: f64) -> Placement {
        match self.kind {
            JointKind::Revolute => {
                let (sine, cosine) = q.sin_cos();
                Placement {
                    rotation: self.fixed + self.by_sine * sine + self.by_cosine * (1.0 - cosine),
                    translation: self.origin,
                }
            }
            JointKind::Prismatic => Placement {
                rotation: self.fixed,
                translation: self.origin + self.by_position * q,
            },
        }
    }

    #[inline]
    pub fn is_revolute(&self) -> bool {
        self.kind == JointKind::Revolute
    }

    /// Of a moment \[Nm\] and a force \[N\] on the link at its origin, what acts along the
    /// joint.
    #[inline]
    pub fn along(&self, moment: &Vector3<f64>, force: &Vector3<f64>) -> f64 {
        match self.kind {
            JointKind::Revolute => self.axis.dot(moment),
            JointKind::Prismatic => self.axis.dot(force),
        }
    }
}

/// A serial arm on a fixed base: joints, links and the tip's frame.
#[derive(Clone, Debug)]
pub struct Chain {
    pub(super) links: Joints<Link>,
    armature: Joints<f64>,
    limits: Joints<PositionLimits>,
    tip: Placement,
}

impl Chain {
    /// The arm of these joints, from the base on, with the tip's frame in that of the
    /// last link.
    ///
    /// # Errors
    ///
    /// [`ChainError`]: no joints or more than eight, or a value that cannot be.
    pub fn new(joints: &[ChainJoint], tip: Placement) -> Result<Chain, ChainError> {
        let count =
            JointCount::new(joints.len()).map_err(|_| ChainError::JointCount(joints.len()))?;
        for (number, joint) in (1..).zip(joints) {
            check(number, joint)?;
        }
        check_rotation(&tip, || "the tip".into())?;
        if !tip.translation.iter().all(|value| value.is_finite()) {
            let (joint, what) = (joints.len(), "the tip behind the link");
            return Err(ChainError::NotFinite { joint, what });
        }
        Ok(Chain {
            links: Joints::from_fn(count, |joint| Link::new(&joints[joint])),
            armature: Joints::from_fn(count, |joint| joints[joint].armature),
            limits: Joints::from_fn(count, |joint| joints[joint].limits),
            tip,
        })
    }

    /// How many joints it has.
    pub fn count(&self) -> JointCount {
        self.links.count()
    }

    /// Inertia of motors and gears, joint by joint \[kg m²\] or \[kg\].
    pub fn armature(&self) -> &Joints<f64> {
        &self.armature
    }

    /// The same arm with other armatures \[kg m²\] or \[kg\].
    ///
    /// # Errors
    ///
    /// [`ChainError::Negative`], [`ChainError::NotFinite`], or
    /// [`ChainError::JointCount`] where there is not one for each joint.
    pub fn with_armature(mut self, armature: &Joints<f64>) -> Result<Chain, ChainError> {
        if armature.len() != self.links.len() {
            return Err(ChainError::JointCount(armature.len()));
        }
        for (joint, value) in (1..).zip(armature.iter()) {
            check_not_negative(joint, "armature", *value)?;
        }
        self.armature = *armature;
        Ok(self)
    }

    /// The same arm with other ends of its joints \[rad\] or \[m\].
    ///
    /// # Errors
    ///
    /// [`ChainError::Limits`], or [`ChainError::JointCount`] where there is not one for each
    /// joint.
    pub fn with_limits(mut self, limits: &Joints<PositionLimits>) -> Result<Chain, ChainError> {
        if limits.len() != self.links.len() {
            return Err(ChainError::JointCount(limits.len()));
        }
        for (joint, own) in (1..).zip(limits.iter()) {
            check_limits(joint, own)?;
        }
        self.limits = *limits;
        Ok(self)
    }

    /// Where the joints' ends are \[rad\] or \[m\].
    pub fn limits(&self) -> &Joints<PositionLimits> {
        &self.limits
    }

    /// The same arm with other links, each in its own frame; a model that is being identified may
    /// have some that cannot exist.
    ///
    /// # Errors
    ///
    /// [`ChainError::JointCount`] where there is not one for each joint.
    pub fn with_inertias(mut self, inertias: &Joints<LinkInertia>) -> Result<Chain, ChainError> {
        if inertias.len() != self.links.len() {
            return Err(ChainError::JointCount(inertias.len()));
        }
        let each = self.links.iter_mut().zip(inertias.iter());
        each.for_each(|(link, inertia)| link.inertia = *inertia);
        Ok(self)
    }

    /// The links' inertias, each in its link's frame.
    pub fn inertias(&self) -> Joints<LinkInertia> {
        self.links.map(|link| link.inertia)
    }

    /// Turning or shifting, joint by joint.
    pub fn kinds(&self) -> Joints<JointKind> {
        self.links.map(|link| link.kind)
    }

    /// Directions of the joints, each a unit vector in its link's frame.
    pub fn axes(&self) -> Joints<Vector3<f64>> {
        self.links.map(|link| link.axis)
    }

    /// The links' frames in the base frame at joint positions `q` \[rad\] or \[m\].
    pub fn link_placements(&self, q: &Joints<f64>) -> Joints<Placement> {
        self.expect_joints(q);
        let mut placed = Placement::identity();
        Joints::from_fn(self.count(), |joint| {
            placed = placed.then(&self.links[joint].placement(q[joint]));
            placed
        })
    }

    /// Forward kinematics: the tip's frame in the base frame at joint positions `q`
    /// \[rad\] or \[m\].
    pub fn forward(&self, q: &Joints<f64>) -> Placement {
        self.tip_on(&self.link_placements(q))
    }

    /// The tip's frame where the links are.
    pub(super) fn tip_on(&self, links: &Joints<Placement>) -> Placement {
        links[links.len() - 1].then(&self.tip)
    }

    /// # Panics
    ///
    /// `values` has not one for each joint.
    #[inline]
    pub(super) fn expect_joints(&self, values: &Joints<f64>) {
        assert_eq!(values.len(), self.links.len(), "one value for each joint");
    }
}

fn check(joint: usize, given: &ChainJoint) -> Result<(), ChainError> {
    check_rotation(&given.placement, || format!("joint {joint} (from 1)"))?;
    let finite = |what, values: &[f64]| {
        let all = values.iter().all(|value| value.is_finite());
        all.then_some(())
            .ok_or(ChainError::NotFinite { joint, what })
    };
    finite("the origin", given.placement.translation.as_slice())?;
    finite("the axis", given.axis.as_slice())?;
    finite("the link's inertia", &given.link.parameters())?;
    if given.axis.norm() < 1e-9 {
        return Err(ChainError::NoAxis { joint });
    }
    check_not_negative(joint, "armature", given.armature)?;
    check_not_negative(joint, "the link's mass", given.link.mass)?;
    check_limits(joint, &given.limits)
}

fn check_limits(joint: usize, limits: &PositionLimits) -> Result<(), ChainError> {
    let PositionLimits { lower, upper } = *limits;
    // Also where one is NaN.
    if !matches!(lower.partial_cmp(&upper), Some(order) if order.is_le()) {
        return Err(ChainError::Limits {
            joint,
            lower,
            upper,
        });
    }
    Ok(())
}

fn check_not_negative(joint: usize, what: &'static str, value: f64) -> Result<(), ChainError> {
    match value {
        value if !value.is_finite() => Err(ChainError::NotFinite { joint, what }),
        value if value < 0.0 => Err(ChainError::Negative { joint, what, value }),
        _ => Ok(()),
    }
}

fn check_rotation(placement: &Placement, what: impl FnOnce() -> String) -> Result<(), ChainError> {
    let rotation = &placement.rotation;
    let apart = (rotation.transpose() * rotation - Matrix3::identity()).norm();
    if apart < 1e-9 && rotation.determinant() > 0.0 {
        return Ok(());
    }
    Err(ChainError::NoRotation { what: what() })
}

//! Effects of an arm: what changes the torques of its links, of all joints together.

use std::ops::Range;

use ferntast_model::friction::{ANGLE, JointType};
use ferntast_model::rigid_body::{LINK_PARAMETERS, Matrix3, Vector3};
use nalgebra::{DMatrix, DVector};

use super::error::ArmError;
use super::motion::States;
use super::rigid_body::RigidBody;
use super::term::ArmTerm;
use crate::data::Term;

/// An effect of the arm. Its coefficients enter τ nonlinearly, of payload, tilt and links only to
/// second order: it is linearised around the coefficients reached.
///
/// A joint's zero is what its position has to be raised by to be that of the links.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmEffect {
    /// A point mass on the last link: mass m and first moment m c in the link's frame.
    Payload,
    /// The base is turned, about two axes across gravity.
    BaseTilt,
    /// The ten inertial parameters of one link.
    LinkInertia(usize),
    /// One joint is elsewhere than its position says, by as much everywhere.
    JointZero(usize),
    /// All of so many joints are, each by its own: the arm is not calibrated.
    JointZeros(usize),
}

const PAYLOAD: [(&str, &str); 4] = [("mass", "kg"), ("x", "m"), ("y", "m"), ("z", "m")];
const TILT: [(&str, &str); 2] = [("tilt_1", "rad"), ("tilt_2", "rad")];
const LINK: [(&str, &str); LINK_PARAMETERS] = [
    ("dm", "kg"),
    ("dm_x", "kg m"),
    ("dm_y", "kg m"),
    ("dm_z", "kg m"),
    ("dI_xx", "kg m²"),
    ("dI_xy", "kg m²"),
    ("dI_yy", "kg m²"),
    ("dI_xz", "kg m²"),
    ("dI_yz", "kg m²"),
    ("dI_zz", "kg m²"),
];

impl ArmEffect {
    /// All that an arm of so many joints may have.
    #[must_use]
    pub fn all(joints: usize) -> Vec<Self> {
        let links = (0..joints).map(Self::LinkInertia);
        let zeros = (0..joints).map(Self::JointZero);
        let first = [Self::Payload, Self::BaseTilt].into_iter();
        let all = first.chain(links).chain(zeros);
        all.chain([Self::JointZeros(joints)]).collect()
    }

    /// Ids of the effects of an arm.
    #[must_use]
    pub const fn ids() -> [&'static str; 5] {
        let [payload, tilt] = ["payload", "base_tilt"];
        [payload, tilt, "link_inertia", "joint_zero", "joint_zeros"]
    }

    /// Its id in files and results.
    #[must_use]
    pub const fn id(self) -> &'static str {
        let [payload, tilt, link, zero, zeros] = Self::ids();
        match self {
            Self::Payload => payload,
            Self::BaseTilt => tilt,
            Self::LinkInertia(_) => link,
            Self::JointZero(_) => zero,
            Self::JointZeros(_) => zeros,
        }
    }

    /// Its joint, or the one that carries its link, where it is of one.
    #[must_use]
    pub const fn joint(self) -> Option<usize> {
        match self {
            Self::LinkInertia(at) | Self::JointZero(at) => Some(at),
            Self::Payload | Self::BaseTilt | Self::JointZeros(_) => None,
        }
    }

    /// As it is named in files: `payload`, `link_inertia@elbow`. `joint` names one by its number.
    #[must_use]
    pub fn term<'a>(self, joint: impl FnOnce(usize) -> Option<&'a String>) -> ArmTerm {
        ArmTerm {
            effect: Term::Catalogue(self.id().to_owned()),
            joint: self.joint().and_then(joint).cloned(),
        }
    }

    /// In words.
    #[must_use]
    pub const fn equation(self) -> &'static str {
        match self {
            Self::Payload => "τ of a point mass on the last link",
            Self::BaseTilt => "τ in a gravity that is turned about two axes across it",
            Self::LinkInertia(_) => "τ of other inertial parameters of a link",
            Self::JointZero(_) => "τ of links whose joint is elsewhere than it says: q + zero",
            Self::JointZeros(_) => "τ of links whose joints all are elsewhere than they say",
        }
    }

    /// The motion that shows it, in words.
    #[must_use]
    pub const fn excited_by(self) -> &'static str {
        match self {
            Self::Payload => "the same motion without the payload, or with one that is weighed",
            Self::BaseTilt => "slow motion with the first joint turned by a quarter and by a half",
            Self::LinkInertia(_) => "fast motion of the joints before the link, in many postures",
            Self::JointZero(_) | Self::JointZeros(_) => {
                "slow motion of the joint and of those before it, in many postures"
            }
        }
    }

    /// The effect of the arm that a term names; `None` where it is one of joints.
    pub(super) fn of(term: &ArmTerm, joints: &[String]) -> Result<Option<Self>, ArmError> {
        let Term::Catalogue(id) = &term.effect else {
            return Ok(None);
        };
        let place = |reason| {
            Err(ArmError::Place {
                effect: term.to_string(),
                reason,
            })
        };
        let [payload, tilt, link, zero, zeros] = Self::ids();
        let of_arm = match id.as_str() {
            id if id == payload => Some(Self::Payload),
            id if id == tilt => Some(Self::BaseTilt),
            id if id == zeros => Some(Self::JointZeros(joints.len())),
            _ => None,
        };
        let of_joint: Option<fn(usize) -> Self> = match id.as_str() {
            id if id == link => Some(Self::LinkInertia),
            id if id == zero => Some(Self::JointZero),
            _ => None,
        };
        match (of_arm, of_joint, &term.joint) {
            (Some(_), _, Some(_)) => place("it is one of the arm: leave the joint out".to_owned()),
            (Some(own), _, None) => Ok(Some(own)),
            (_, Some(_), None) => place(format!("say of which joint: {id}@JOINT")),
            (_, Some(of), Some(joint)) => match joints.iter().position(|own| own == joint) {
                Some(at) => Ok(Some(of(at))),
                None => Err(ArmError::UnknownJoint {
                    effect: id.clone(),
                    joint: joint.clone(),
                    known: joints.join(", "),
                }),
            },
            (None, None, _) => Ok(None),
        }
    }

    /// Number of its coefficients.
    #[must_use]
    pub const fn columns(self) -> usize {
        match self {
            Self::Payload => PAYLOAD.len(),
            Self::BaseTilt => TILT.len(),
            Self::LinkInertia(_) => LINK.len(),
            Self::JointZero(_) => 1,
            Self::JointZeros(joints) => joints,
        }
    }

    /// Changes links, zeros and gravity as the coefficients `value` say.
    pub(super) fn apply(self, body: &mut RigidBody<'_>, value: &[f64]) {
        match (self, value) {
            (Self::Payload, &[mass, x, y, z]) => {
                let inertia = point_inertia(mass, &Vector3::new(x, y, z));
                let last = RigidBody::first_of(body.joints().saturating_sub(1));
                let all = [mass, x, y, z].into_iter().chain(inertia);
                let own = body.parameters.iter_mut().skip(last);
                own.zip(all).for_each(|(own, change)| *own += change);
            }
            (Self::BaseTilt, &[first, second]) => {
                body.gravity = turned(&body.gravity, first, second);
            }
            (Self::LinkInertia(link), changes) => {
                let own = body.parameters.iter_mut().skip(RigidBody::first_of(link));
                own.zip(changes).for_each(|(own, change)| *own += change);
            }
            (Self::JointZero(joint), &[zero]) => {
                let own = body.zeros.get_mut(joint).into_iter();
                own.for_each(|own| *own += zero);
            }
            (Self::JointZeros(_), zeros) => {
                let own = body.zeros.iter_mut().zip(zeros);
                own.for_each(|(own, zero)| *own += zero);
            }
            _ => {}
        }
    }

    /// Derivatives of every joint's τ by its coefficients around `value`, by joint,
    /// coefficient and sample. `body` is without the effect.
    pub(super) fn derivatives(
        self,
        body: &RigidBody<'_>,
        value: &[f64],
        states: &States,
    ) -> Vec<Vec<Vec<f64>>> {
        if let Self::JointZero(_) | Self::JointZeros(_) = self {
            let mut around = body.clone();
            self.apply(&mut around, value);
            let which = match self {
                Self::JointZero(joint) => joint..joint + 1,
                _ => 0..body.joints(),
            };
            return by_zeros(&around, which, states);
        }
        if let Self::BaseTilt = self {
            let each = self.turns(body, value);
            let each = each.iter().map(|turn| body.weights(states, turn));
            return by_joint(body.joints(), each);
        }
        let count = self.columns();
        let mut all = vec![vec![Vec::with_capacity(states.len()); count]; body.joints()];
        let changes = self.changes(value);
        for at in 0..states.len() {
            let link = self.joint().unwrap_or(body.joints().saturating_sub(1));
            let first = RigidBody::first_of(link);
            let rows = body.regressor(states, at);
            for (joint, own) in all.iter_mut().enumerate() {
                for (column, values) in own.iter_mut().enumerate() {
                    let each = (0..LINK_PARAMETERS)
                        .map(|k| rows[(joint, first + k)] * changes[(k, column)]);
                    values.push(each.sum());
                }
            }
        }
        all
    }

    /// Derivatives of a link's ten parameters by the coefficients.
    fn changes(self, value: &[f64]) -> DMatrix<f64> {
        let mut changes = DMatrix::identity(LINK_PARAMETERS, self.columns());
        if let (Self::Payload, &[mass, x, y, z]) = (self, value)
            && mass.abs() > 1e-6
        {
            let moment = Vector3::new(x, y, z);
            let by_mass = point_inertia(mass, &moment).map(|own| -own / mass);
            let by_moment = [0, 1, 2].map(|axis| {
                let unit = Vector3::ith(axis, 1.0);
                let tensor = Matrix3::identity() * (2.0 * moment[axis])
                    - unit * moment.transpose()
                    - moment * unit.transpose();
                packed(&(tensor / mass))
            });
            let [by_x, by_y, by_z] = by_moment;
            for (column, own) in [by_mass, by_x, by_y, by_z].into_iter().enumerate() {
                for (k, own) in own.into_iter().enumerate() {
                    changes[(4 + k, column)] = own;
                }
            }
        }
        changes
    }

    /// Derivatives of gravity by the coefficients \[m/s²\].
    fn turns(self, body: &RigidBody<'_>, value: &[f64]) -> Vec<Vector3<f64>> {
        const NUDGE: f64 = 1e-6;
        let (Self::BaseTilt, &[first, second]) = (self, value) else {
            return Vec::new();
        };
        let at = |first, second| turned(&body.gravity, first, second);
        let slope = |plus: Vector3<f64>, minus: Vector3<f64>| (plus - minus) / (2.0 * NUDGE);
        vec![
            slope(at(first + NUDGE, second), at(first - NUDGE, second)),
            slope(at(first, second + NUDGE), at(first, second - NUDGE)),
        ]
    }

    /// Names and units of its coefficients; `joint` names one by its number, and says its kind.
    fn names(self, joint: impl Fn(usize) -> (String, JointType)) -> Vec<(String, &'static str)> {
        let names: &[(&str, &'static str)] = match self {
            Self::Payload => &PAYLOAD,
            Self::BaseTilt => &TILT,
            Self::LinkInertia(_) => &LINK,
            Self::JointZero(at) => return vec![("zero".to_owned(), ANGLE.of(joint(at).1))],
            Self::JointZeros(joints) => {
                let each = (0..joints).map(joint);
                return each.map(|(name, kind)| (name, ANGLE.of(kind))).collect();
            }
        };
        let each = names.iter();
        each.map(|(name, unit)| ((*name).to_owned(), *unit))
            .collect()
    }

    /// Names and units of its parameters as reported, with values and standard errors: of a payload the
    /// place in place of the first moment. `joint` names one by its number, and says its kind.
    pub(super) fn reported(
        self,
        joint: impl Fn(usize) -> (String, JointType),
        value: &[f64],
        covariance: &DMatrix<f64>,
    ) -> Vec<(String, &'static str, f64, f64)> {
        let mass = match self {
            Self::Payload => value.first().copied().unwrap_or(0.0),
            _ => 0.0,
        };
        let each = self.names(joint).into_iter().zip(value).enumerate();
        each.map(|(at, ((name, unit), own))| {
            let mut gradient = DVector::zeros(value.len());
            let (value, scale) = match (self, at) {
                (Self::Payload, 1..) if mass.abs() > 1e-9 => (own / mass, mass.recip()),
                _ => (*own, 1.0),
            };
            gradient[at] = scale;
            if matches!(self, Self::Payload) && at > 0 && mass.abs() > 1e-9 {
                gradient[0] = -value / mass;
            }
            let variance = (gradient.transpose() * covariance * &gradient)[(0, 0)];
            (name, unit, value, variance.max(0.0).sqrt())
        })
        .collect()
    }
}

/// Derivatives of every joint's τ by the zeros of `which`, by joint, zero and sample. Zeros that turn
/// the arm about gravity change nothing that is not of rounded axes: their columns are zero.
fn by_zeros(body: &RigidBody<'_>, which: Range<usize>, states: &States) -> Vec<Vec<Vec<f64>>> {
    const NUDGE: f64 = 1e-5;
    /// Smallest share of a joint's torque that a radian changes.
    const LEAST: f64 = 1e-3;
    let size = |values: &[f64]| values.iter().map(|own| own * own).sum::<f64>().sqrt();
    let here = body.torques(states);
    let each = which.map(|joint| {
        let at = |nudge: f64| {
            let mut own = body.clone();
            own.zeros[joint] += nudge;
            own.torques(states)
        };
        let both = at(NUDGE).into_iter().zip(at(-NUDGE));
        let slopes = both.map(|(plus, minus)| {
            let each = plus.iter().zip(&minus);
            let each = each.map(|(plus, minus)| (plus - minus) / (2.0 * NUDGE));
            each.collect::<Vec<f64>>()
        });
        let mut slopes: Vec<Vec<f64>> = slopes.collect();
        let mut each = slopes.iter().zip(&here);
        if each.all(|(slope, torque)| size(slope) <= LEAST * size(torque)) {
            slopes.iter_mut().for_each(|slope| slope.fill(0.0));
        }
        slopes
    });
    by_joint(body.joints(), each)
}

/// Columns, each by joint and sample, as [`ArmEffect::derivatives`] gives them.
fn by_joint(joints: usize, columns: impl Iterator<Item = Vec<Vec<f64>>>) -> Vec<Vec<Vec<f64>>> {
    let mut all = vec![Vec::new(); joints];
    for column in columns {
        let each = all.iter_mut().zip(column);
        each.for_each(|(own, column)| own.push(column));
    }
    all
}

/// The rotational inertia of a point mass about the frame's origin, in the order of a
/// link's parameters.
fn point_inertia(mass: f64, moment: &Vector3<f64>) -> [f64; 6] {
    if mass.abs() <= 1e-6 {
        return [0.0; 6];
    }
    let tensor = Matrix3::identity() * moment.norm_squared() - moment * moment.transpose();
    packed(&(tensor / mass))
}

fn packed(tensor: &Matrix3<f64>) -> [f64; 6] {
    let own = tensor;
    [own.m11, own.m12, own.m22, own.m13, own.m23, own.m33]
}

/// `gravity` as seen from a base that is turned by these angles \[rad\] about two axes
/// across it: of a base that stands upright about its x, then its y axis.
fn turned(gravity: &Vector3<f64>, first: f64, second: f64) -> Vector3<f64> {
    let size = gravity.norm();
    if size < 1e-9 {
        return *gravity;
    }
    let down = gravity / size;
    // The base's axis that is least along gravity, made perpendicular to it.
    let least = (0..3).min_by(|a, b| down[*a].abs().total_cmp(&down[*b].abs()));
    let axis = Vector3::ith(least.unwrap_or(0), 1.0);
    let one = (axis - down * axis.dot(&down)).normalize();
    let other = one.cross(&down);
    let angle = first.hypot(second);
    if angle < 1e-15 {
        return *gravity;
    }
    // Turning the base one way turns gravity the other way within it.
    let turn = -(one * first + other * second) / angle;
    let (sine, cosine) = angle.sin_cos();
    (down * cosine + turn.cross(&down) * sine) * size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_upright_base_is_turned_about_its_own_axes() {
        let gravity = Vector3::new(0.0, 0.0, -9.81);
        let about_x = turned(&gravity, 0.1, 0.0);
        let about_y = turned(&gravity, 0.0, 0.1);
        let (sine, cosine) = 0.1_f64.sin_cos();
        // A base turned about x by a positive angle sees gravity turned back.
        let expected_x = Vector3::new(0.0, -9.81 * sine, -9.81 * cosine);
        let expected_y = Vector3::new(9.81 * sine, 0.0, -9.81 * cosine);
        assert!((about_x - expected_x).norm() < 1e-12, "{about_x}");
        assert!((about_y - expected_y).norm() < 1e-12, "{about_y}");
    }

    #[test]
    fn a_payload_is_linear_along_the_ray_to_its_coefficients() {
        let value = [2.0, 0.2, -0.1, 0.3];
        let inertia = point_inertia(value[0], &Vector3::new(value[1], value[2], value[3]));
        let changes = ArmEffect::Payload.changes(&value);
        for (k, own) in inertia.iter().enumerate() {
            let by: f64 = (0..4).map(|c| changes[(4 + k, c)] * value[c]).sum();
            assert!((by - own).abs() < 1e-12);
        }
        // A mass of 2 kg at (0.1, -0.05, 0.15): I_zz = m (x² + y²).
        assert!((inertia[5] - 2.0 * (0.01 + 0.0025)).abs() < 1e-12);
    }
}

//! What the estimator knows of the contact.

use crate::{
    InvalidMessage, Message, Time,
    ros::{ferntast_msgs::ContactState, std_msgs::Header},
};

use super::checks;

/// An edge of the contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Edge(pub u8);

impl Edge {
    /// No edge, or not known which.
    pub const NONE: Edge = Edge(0);
    /// The straight edge with dry-film lubricant.
    pub const LUBRICATED: Edge = Edge(1);
    /// The straight edge of bare aluminium.
    pub const UNLUBRICATED: Edge = Edge(2);
    /// The spring that is pulled.
    pub const SPRING: Edge = Edge(3);

    /// Every edge.
    pub const ALL: [Edge; 4] = [
        Edge::NONE,
        Edge::LUBRICATED,
        Edge::UNLUBRICATED,
        Edge::SPRING,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "none, lubricated, unlubricated, spring";

    /// The name on the wire; `None` for a code that is no edge.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Edge::NONE => Some("none"),
            Edge::LUBRICATED => Some("lubricated"),
            Edge::UNLUBRICATED => Some("unlubricated"),
            Edge::SPRING => Some("spring"),
            _ => None,
        }
    }

    /// The edge of that name.
    pub fn from_name(name: &str) -> Option<Edge> {
        Edge::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// The contact as estimated from joint torques (equations 5 and 6).
/// `ferntast_msgs/msg/ContactState` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct ContactStateSample {
    /// Time of the measurement that it was estimated from.
    pub stamp: Time,
    /// Normal force F_N \[N\], ≥ 0 pushes the tip out of the surface.
    pub normal_force: f64,
    /// Tangential force F_T \[N\], positive when it opposes the tip's motion.
    pub tangential_force: f64,
    /// Friction coefficient b_0T of equation (6) \[-\]; NaN on the wire, and
    /// here zero with an infinite error, before it is identified.
    pub friction_coefficient: f64,
    /// Standard error of the coefficient \[-\].
    pub friction_coefficient_error: f64,
    /// 1 in contact.
    pub in_contact: u8,
    /// 1 when the forces can be used; 0 when the configuration is singular or an input is missing.
    pub valid: u8,
    /// 1 while the tangential force is undefined: the motor turns, the tip still rests.
    pub near_rest: u8,
    /// Which edge.
    pub edge: Edge,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 4],
}

checks::no_padding!(
    ContactStateSample: Time, f64, f64, f64, f64, u8, u8, u8, Edge, [u8; 4]
);

impl ContactStateSample {
    /// Nothing is known: no contact, forces that cannot be used, friction not
    /// identified.
    pub const fn unknown(stamp: Time) -> ContactStateSample {
        ContactStateSample {
            stamp,
            normal_force: 0.0,
            tangential_force: 0.0,
            friction_coefficient: 0.0,
            friction_coefficient_error: f64::INFINITY,
            in_contact: 0,
            valid: 0,
            near_rest: 0,
            edge: Edge::NONE,
            reserved: [0; 4],
        }
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for ContactStateSample {
    type Ros = ContactState;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> ContactState {
        let identified = self.friction_coefficient_error != f64::INFINITY;
        ContactState {
            header: Header::new(self.stamp, ""),
            in_contact: self.in_contact != 0,
            valid: self.valid != 0,
            near_rest: self.near_rest != 0,
            edge: checks::wire_name(self.edge.name(), self.edge.0),
            normal_force: self.normal_force,
            tangential_force: self.tangential_force,
            friction_coefficient: match identified {
                true => self.friction_coefficient,
                false => f64::NAN,
            },
            friction_coefficient_error: self.friction_coefficient_error,
        }
    }

    fn from_ros(ros: &ContactState) -> Result<ContactStateSample, InvalidMessage> {
        let edge = Edge::from_name(&ros.edge)
            .ok_or_else(|| checks::unknown("edge", &ros.edge, Edge::KNOWN))?;
        // Anything else that is not finite is refused by the check.
        let unidentified =
            ros.friction_coefficient.is_nan() && ros.friction_coefficient_error == f64::INFINITY;
        let coefficient = match unidentified {
            true => 0.0,
            false => ros.friction_coefficient,
        };
        let sample = ContactStateSample {
            stamp: ros.header.time(),
            normal_force: ros.normal_force,
            tangential_force: ros.tangential_force,
            friction_coefficient: coefficient,
            friction_coefficient_error: ros.friction_coefficient_error,
            in_contact: ros.in_contact.into(),
            valid: ros.valid.into(),
            near_rest: ros.near_rest.into(),
            edge,
            reserved: [0; 4],
        };
        sample.check()?;
        Ok(sample)
    }

    /// An infinite error of the coefficient is valid: not identified.
    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("normal_force", &[self.normal_force])?;
        checks::finite("tangential_force", &[self.tangential_force])?;
        checks::finite("friction_coefficient", &[self.friction_coefficient])?;
        if self.friction_coefficient_error != f64::INFINITY {
            let error = self.friction_coefficient_error;
            checks::finite("friction_coefficient_error", &[error])?;
        }
        checks::flag("in_contact", self.in_contact)?;
        checks::flag("valid", self.valid)?;
        checks::flag("near_rest", self.near_rest)?;
        checks::code("edge", self.edge.name(), self.edge.0, Edge::KNOWN)
    }
}

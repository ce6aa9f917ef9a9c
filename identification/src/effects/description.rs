//! How an effect describes itself.

use serde::Serialize;

use crate::data::{JointType, Subject};
use crate::proposal::Proposal;

/// A unit, for both kinds of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Unit {
    /// With rad and Nm.
    pub revolute: &'static str,
    /// With m and N: of a contact, too.
    pub prismatic: &'static str,
}

impl Unit {
    /// The same for both.
    #[must_use]
    pub const fn same(unit: &'static str) -> Self {
        Self {
            revolute: unit,
            prismatic: unit,
        }
    }

    /// One unit each.
    #[must_use]
    pub const fn new(revolute: &'static str, prismatic: &'static str) -> Self {
        Self {
            revolute,
            prismatic,
        }
    }

    /// The one for this joint.
    #[must_use]
    pub fn of(&self, joint: JointType) -> &'static str {
        match joint {
            JointType::Revolute => self.revolute,
            JointType::Prismatic | JointType::Contact => self.prismatic,
        }
    }
}

pub(crate) const TORQUE: Unit = Unit::new("Nm", "N");
pub(crate) const ANGLE: Unit = Unit::new("rad", "m");
pub(crate) const SPEED: Unit = Unit::new("rad/s", "m/s");
pub(crate) const STIFFNESS: Unit = Unit::new("Nm/rad", "N/m");
pub(crate) const DAY: Unit = Unit::same("d");
pub(crate) const ONE: Unit = Unit::same("1");

/// A parameter's name and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Name as in results.
    pub name: String,
    /// Unit.
    pub unit: Unit,
}

/// What an effect is and how it shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectDescription {
    /// Name in files, on the command line and in results.
    pub id: String,
    /// What it is an effect of.
    pub of: Subject,
    /// Its part of τ_F, of a contact of F_T.
    pub equation: String,
    /// Where the equation is from.
    pub source: String,
    /// Parameters that are fitted.
    pub coefficients: Vec<Quantity>,
    /// Parameters that are searched.
    pub shape: Vec<Quantity>,
    /// What it looks like in the residual.
    pub shows_as: String,
    /// Motion or condition that makes it visible.
    pub excited_by: String,
    /// The recording that shows it best.
    pub shown_by: Proposal,
    /// Effects that look alike.
    pub taken_for: Vec<String>,
}

/// Makes the struct of an effect whose only field is its description.
/// After the id, `of: Contact` says that it is one of a contact.
macro_rules! describe {
    (@subject) => { $crate::data::Subject::Joint };
    (@subject $of:ident) => { $crate::data::Subject::$of };
    ($name:ident, $id:literal, $(of: $of:ident,)? $equation:literal, $source:literal,
     coefficients: [$($coefficient:literal: $coefficient_unit:expr),* $(,)?],
     shape: [$($shape:literal: $shape_unit:expr),* $(,)?],
     shows_as: $shows:literal, excited_by: $excited:literal, shown_by: $shown:ident,
     taken_for: [$($other:literal),* $(,)?]) => {
        #[doc = $equation]
        pub struct $name($crate::effects::EffectDescription);

        impl Default for $name {
            fn default() -> Self {
                Self($crate::effects::EffectDescription {
                    id: $id.to_owned(),
                    of: $crate::effects::describe!(@subject $($of)?),
                    equation: $equation.to_owned(),
                    source: $source.to_owned(),
                    coefficients: vec![$($crate::effects::Quantity {
                        name: $coefficient.to_owned(), unit: $coefficient_unit }),*],
                    shape: vec![$($crate::effects::Quantity {
                        name: $shape.to_owned(), unit: $shape_unit }),*],
                    shows_as: $shows.to_owned(),
                    excited_by: $excited.to_owned(),
                    shown_by: $crate::proposal::Proposal::$shown,
                    taken_for: vec![$($other.to_owned()),*],
                })
            }
        }
    };
}
pub(crate) use describe;

//! What an effect of the catalogue is, as data.

use super::facts::{Facts, JointType, Subject};
use super::proposal::{Contrast, Proposal};
use serde::Serialize;

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
        Self::new(unit, unit)
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

/// Nm, N.
pub const TORQUE: Unit = Unit::new("Nm", "N");
/// rad, m.
pub const ANGLE: Unit = Unit::new("rad", "m");
/// rad/s, m/s.
pub const SPEED: Unit = Unit::new("rad/s", "m/s");
/// Nm/rad, N/m.
pub const STIFFNESS: Unit = Unit::new("Nm/rad", "N/m");
/// Days.
pub const DAY: Unit = Unit::same("d");
/// No unit.
pub const ONE: Unit = Unit::same("1");

/// A parameter of an effect. Bounds hold where a value is used for control;
/// fits are free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Name in results of fits and in messages of the twin.
    pub name: &'static str,
    /// Key in an arm's file, and name in what the servo publishes: the symbol
    /// of the source. The same as the name but for Table 1's five.
    pub key: &'static str,
    /// Unit.
    pub unit: Unit,
    /// Smallest value allowed (inclusive).
    pub lower: f64,
    /// Largest value allowed (inclusive).
    pub upper: f64,
}

impl EffectParameter {
    /// A parameter whose key is its name.
    #[must_use]
    pub const fn new(name: &'static str, unit: Unit, lower: f64, upper: f64) -> Self {
        Self {
            name,
            key: name,
            unit,
            lower,
            upper,
        }
    }

    /// The same with a key of its own.
    #[must_use]
    pub const fn key(mut self, key: &'static str) -> Self {
        self.key = key;
        self
    }
}

/// A channel that passes the column filter of a fit as it is, so that its column
/// and the measured torque are smoothed alike to the last digit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// 1.
    One,
    /// q.
    Position,
    /// q̇.
    Velocity,
    /// q̈.
    Acceleration,
    /// τ, measured.
    JointTorque,
    /// τ̇, measured.
    JointTorqueRate,
    /// J q̈ + τ with J given.
    Driven,
}

/// How an effect goes with the direction of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// As it is in both directions.
    Same,
    /// Times sign(q̇).
    Opposite,
    /// Either.
    Either,
}

/// What an effect can be about that recordings do not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unmeasured {
    /// The torque of the load behind a gear.
    Load,
    /// The temperature.
    Temperature,
}

impl Unmeasured {
    /// Why nothing can be said of it as of something that is not measured: it is.
    #[must_use]
    pub fn measured(self, facts: &Facts) -> Option<String> {
        let (is_measured, why) = match self {
            Self::Load => (facts.joint_torque, "the torque of the load is given"),
            Self::Temperature => (
                facts.no_temperature().is_none(),
                "the temperature is measured",
            ),
        };
        is_measured.then(|| why.to_owned())
    }
}

/// Signals over which the shape of an effect is fixed: a residual that still
/// depends on them after it has been added says that the shape is not the
/// right one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnSignals {
    /// Names as in results of a diagnosis.
    pub names: &'static [&'static str],
    /// Symmetry.
    pub direction: Direction,
    /// Whether every pair with one of these signals belongs to it, too.
    pub any_pair: bool,
}

impl OwnSignals {
    /// Of an effect that goes with these `names` alone.
    #[must_use]
    pub const fn new(names: &'static [&'static str], direction: Direction) -> Self {
        Self {
            names,
            direction,
            any_pair: false,
        }
    }

    /// Of an effect that varies with one of these `names`, and so shows over
    /// every pair with it.
    #[must_use]
    pub const fn varying(names: &'static [&'static str]) -> Self {
        Self {
            names,
            direction: Direction::Either,
            any_pair: true,
        }
    }
}

/// Parts of friction that scale as a whole from one session to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Constant Coulomb friction.
    Constant,
    /// Coulomb friction that grows with the load.
    ByLoad,
    /// What grows with speed.
    Viscous,
}

/// Where a constant torque comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstantOf {
    /// Friction that differs by direction.
    Friction,
    /// The zero of the joint torque sensor.
    Sensor,
}

/// What happens just after a reversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtReversal {
    /// Friction builds up over travel.
    Bristles,
    /// The motor crosses a gap.
    Gap,
}

/// One effect of the catalogue. Effects that it names are there by their ids.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Name in files, on the command line and in results.
    pub id: &'static str,
    /// What it is an effect of.
    pub of: Subject,
    /// Its part of τ_F, of a contact of F_T.
    pub equation: &'static str,
    /// Where the equation is from.
    pub source: &'static str,
    /// Parameters that are fitted: the equation is linear in them.
    pub coefficients: &'static [EffectParameter],
    /// Parameters that are searched.
    pub shape: &'static [EffectParameter],
    /// What it looks like in the residual.
    pub shows_as: &'static str,
    /// Motion or condition that makes it visible.
    pub excited_by: &'static str,
    /// The recording that shows it best.
    pub shown_by: Proposal,
    /// Recordings that tell it from the other effects that have the same here.
    pub contrasts: &'static [Contrast],
    /// Ids of effects that are easily mistaken for it: their signatures in the
    /// residual are similar.
    pub confusable_with: &'static [&'static str],
    /// The part of friction that it belongs to.
    pub part: Option<Part>,
    /// The effect whose coefficient it lets vary from session to session; it
    /// then shows mainly from one session to the next.
    pub varies: Option<&'static str>,
    /// Effects that are among its columns, and the column that it has beyond each.
    pub contains: &'static [(&'static str, usize)],
    /// It is no more than what it contains: either alone may be enough.
    pub is_sum: bool,
    /// It is one constant, and of what.
    pub constant: Option<ConstantOf>,
    /// It shows at reversals, as what.
    pub at_reversal: Option<AtReversal>,
    /// Signals over which its shape is fixed.
    pub own_signals: OwnSignals,
    /// Channels to which its columns are equal: all of them, the first ones, or none.
    pub exact: &'static [Exact],
    /// It is a load on the joint (spring, weight) rather than friction.
    pub is_load: bool,
    /// It is the inertia of the model, where that is fitted.
    pub is_inertia: bool,
    /// It corrects the inertia given: to add it is to fit the inertia.
    pub corrects_inertia: bool,
    /// Its shape is a period over position, sought in the residual.
    pub is_periodic: bool,
    /// The effect that it is another one of the same kind as: it counts beside that alone.
    pub another: Option<&'static str>,
    /// It shows mainly just after reversals, where rows are left out for other
    /// effects: a model that has it is fitted to these rows too.
    pub shows_at_reversals: bool,
    /// Its columns need the model's own prediction.
    pub needs_prediction: bool,
    /// It acts on what is measured rather than on torque: its columns are right
    /// for a small effect, and a large one has to be taken out of the channels.
    pub acts_on_channels: bool,
    /// It is a channel whose time stamps are late, which smooths as a filter does: noise may look
    /// like it.
    pub is_lateness: bool,
    /// It is about something that nobody measures: where a sensor gives that, another effect is
    /// what this one is there.
    pub of_unmeasured: Option<Unmeasured>,
    /// Numbers that it is free to choose, where these are not its coefficients
    /// and its shape. The fewer, the simpler.
    pub freedom: Option<usize>,
}

impl Row {
    /// An effect of a joint without any property; what is not in the catalogue
    /// (an effect of the user's own) has this row.
    pub const NONE: Row = Row {
        id: "",
        of: Subject::Joint,
        equation: "",
        source: "",
        coefficients: &[],
        shape: &[],
        shows_as: "",
        excited_by: "",
        shown_by: Proposal::LoadSteps,
        contrasts: &[],
        confusable_with: &[],
        part: None,
        varies: None,
        contains: &[],
        is_sum: false,
        constant: None,
        at_reversal: None,
        own_signals: OwnSignals::new(&[], Direction::Either),
        exact: &[],
        is_load: false,
        is_inertia: false,
        corrects_inertia: false,
        is_periodic: false,
        another: None,
        shows_at_reversals: false,
        needs_prediction: false,
        acts_on_channels: false,
        is_lateness: false,
        of_unmeasured: None,
        freedom: None,
    };

    /// Whether it shows mainly from one session to the next.
    #[must_use]
    pub const fn is_between_sessions(&self) -> bool {
        self.varies.is_some()
    }

    /// Whether it drives the joint's mass or loads it: a part of the modelled
    /// load where there is no torque sensor.
    #[must_use]
    pub const fn is_modelled_load(&self) -> bool {
        self.is_load || self.is_inertia
    }

    /// Whether it is Coulomb friction that grows with the load.
    #[must_use]
    pub fn is_load_coulomb(&self) -> bool {
        self.part == Some(Part::ByLoad)
    }

    /// The column that it has beyond the effect `part`, where it contains that.
    #[must_use]
    pub fn column_beyond(&self, part: &str) -> Option<usize> {
        let mut parts = self.contains.iter();
        let (_, column) = parts.find(|(id, _)| *id == part)?;
        Some(*column)
    }

    /// Whether each of its columns is what it has beyond an effect among them: where a
    /// model has one of these, another is what may be missing, and not the whole.
    #[must_use]
    pub fn is_all_parts(&self) -> bool {
        let is_beyond_one = |column| self.contains.iter().any(|(_, beyond)| *beyond == column);
        !self.contains.is_empty() && (0..self.coefficients.len()).all(is_beyond_one)
    }

    /// Ids of the effects among its columns.
    pub fn parts(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.contains.iter().map(|(part, _)| *part)
    }

    /// Whether `part` is among its columns, or is its only one.
    #[must_use]
    pub fn has(&self, part: &Row) -> bool {
        let same = self.id != part.id && self.constant.is_some() && part.constant.is_some();
        same || self.column_beyond(part.id).is_some()
    }
}

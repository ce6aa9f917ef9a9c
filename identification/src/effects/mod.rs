//! The catalogue of physical effects.
//!
//! An effect is a sum of columns, each times a coefficient that is fitted:
//! τ_m − J q̈ − τ = Σ c_i φ_i(state; shape). The *shape* holds the parameters
//! that do not enter linearly (a velocity, a width); it is searched.
//!
//! What an effect is stands in its [`Row`]. Static effects, which are a function of
//! what the joint is doing now, have row and law in `ferntast_model::friction`,
//! where the servo has them too. The others are here, one a file.
//!
//! To add one of these: copy a neighbour, and name it here and in [`all`].

mod backlash;
mod channel_delay;
mod contact_compliance;
mod current_saturation;
mod description;
mod elasticity;
mod inertia;
mod motor_constant;
mod presliding_hysteresis;
mod static_law;
mod torque_sensor_gain;
mod torque_sensor_offset;

use std::{ops::Range, sync::Arc};

use ferntast_model::friction::EffectParameter;
pub use ferntast_model::friction::{
    ANGLE, AtReversal, ConstantOf, Direction, Exact, Facts, Part, Row, Unit, logarithmic, sign,
};

use crate::data::Subject;
use crate::setup::BoundTerm;
use crate::signals::Channels;
pub(crate) use description::row;
pub use description::{EffectDescription, Quantity};
pub use inertia::Inertia;

/// State of the joint at one sample. For a prismatic joint read m for rad and N
/// for Nm. For a contact, too: then q is the place along the contour, τ_m and
/// τ_F are F_T, and the load is F_N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Time \[s\] since the sample before.
    pub period: f64,
    /// q \[rad\].
    pub position: f64,
    /// q̇ \[rad/s\].
    pub velocity: f64,
    /// q̈ \[rad/s²\].
    pub acceleration: f64,
    /// τ_m as recorded \[Nm\].
    pub motor_torque: f64,
    /// Load τ \[Nm\]: the joint torque sensor, or without one the modelled load;
    /// of a contact F_N \[N\].
    pub load: f64,
    /// τ̇ \[Nm/s\].
    pub load_rate: f64,
    /// τ̈ \[Nm/s²\].
    pub load_jerk: f64,
    /// T − T₀ \[K\], T₀ the mean over the recordings; 0 without a sensor.
    pub temperature: f64,
    /// Time \[days\] since the first session's start.
    pub days: f64,
    /// τ_m that the model predicts \[Nm\].
    pub motor_predicted: f64,
    /// τ_F that the model predicts \[Nm\].
    pub friction_predicted: f64,
    /// ∂τ_F/∂q̇ that the model predicts \[Nm s/rad\].
    pub friction_slope: f64,
    /// Size of τ_F that the model predicts just above rest \[Nm\]: what friction
    /// holds by itself.
    pub friction_level: f64,
    /// ∂τ_F/∂|τ| that the model predicts for q̇ > 0 \[-\]: b_0T.
    pub load_slope: f64,
    /// J of the model, given or fitted \[kg m²\].
    pub inertia: f64,
}

impl Point {
    /// sign(q̇), zero at rest.
    #[must_use]
    pub fn sign(&self) -> f64 {
        sign(self.velocity)
    }
}

/// Longest list of columns of one effect.
pub const MAX_COLUMNS: usize = 12;
/// What an effect with a state remembers from sample to sample.
pub type Memory = [f64; 4];

/// A signal that an [`Exact`] channel is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactSignal {
    /// q.
    Position,
    /// τ, measured.
    JointTorque,
}

/// What `channel` is where no signal takes part.
pub(crate) fn constant_of(channel: Exact) -> f64 {
    f64::from(u8::from(channel == Exact::One))
}

/// Signals, the order of their derivative, and factors that add up to `channel`;
/// `inertia` is J.
pub(crate) fn parts_of(
    channel: Exact,
    inertia: f64,
) -> impl Iterator<Item = (ExactSignal, u8, f64)> {
    use ExactSignal::{JointTorque, Position};
    let (first, second) = match channel {
        Exact::One => (None, None),
        Exact::Position => (Some((Position, 0, 1.0)), None),
        Exact::Velocity => (Some((Position, 1, 1.0)), None),
        Exact::Acceleration => (Some((Position, 2, 1.0)), None),
        Exact::JointTorque => (Some((JointTorque, 0, 1.0)), None),
        Exact::JointTorqueRate => (Some((JointTorque, 1, 1.0)), None),
        Exact::Driven => (Some((JointTorque, 0, 1.0)), Some((Position, 2, inertia))),
    };
    first.into_iter().chain(second)
}

/// A physical effect.
pub trait Effect: Send + Sync {
    /// What it is.
    fn description(&self) -> &EffectDescription;

    /// Its row in the catalogue: all its properties. An effect of the user's own
    /// has none.
    fn row(&self) -> &'static Row {
        &Row::NONE
    }

    /// Number of columns.
    fn columns(&self) -> usize {
        self.description().coefficients.len()
    }

    /// Why it cannot be told from these recordings, if it cannot.
    fn unavailable(&self, facts: &Facts) -> Option<String> {
        let _ = facts;
        None
    }

    /// Shapes to try, one vector of shape parameters each.
    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let _ = facts;
        vec![Vec::new()]
    }

    /// Lower and upper bound of each shape parameter when a shape is refined;
    /// empty where a shape is not refined.
    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let _ = facts;
        Vec::new()
    }

    /// Writes the columns at `point` into `columns`, which is as long as
    /// [`Self::columns`]. `memory` starts at zero with each session; samples
    /// come in order of time.
    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]);

    /// Columns over a whole session, for effects that look forward in time;
    /// then [`Self::evaluate`] is not asked.
    fn whole(&self, shape: &[f64], points: &[Point]) -> Option<Vec<Vec<f64>>> {
        let _ = (shape, points);
        None
    }

    /// Samples at which what it does depends on more than is measured: rows of
    /// the regression that reach there are left out of a model that has it.
    fn breaks(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let _ = (shape, points);
        Vec::new()
    }

    /// Takes it out of the channels, sampled every `period` \[s\], that it acts
    /// on. Returns how many samples at the end say nothing then.
    fn undo(
        &self,
        shape: &[f64],
        coefficients: &[f64],
        channels: &mut Channels,
        period: f64,
    ) -> usize {
        let _ = (shape, coefficients, channels, period);
        0
    }

    /// Whether coefficients make physical sense for this effect.
    fn plausible(&self, shape: &[f64], coefficients: &[f64]) -> bool {
        let _ = (shape, coefficients);
        true
    }

    /// Numbers that it is free to choose: coefficients and shape, unless one
    /// follows from the other. The fewer, the simpler.
    fn freedom(&self) -> usize {
        let own = self.row().freedom;
        own.unwrap_or_else(|| self.columns() + self.description().shape.len())
    }

    /// Names of extra signals that the effect reads, see [`Self::evaluate_with`].
    fn extra(&self) -> &[String] {
        &[]
    }

    /// As [`Self::evaluate`], with the values of the signals that
    /// [`Self::extra`] names.
    fn evaluate_with(
        &self,
        shape: &[f64],
        point: &Point,
        extra: &[f64],
        memory: &mut Memory,
        columns: &mut [f64],
    ) {
        let _ = extra;
        self.evaluate(shape, point, memory, columns);
    }
}

/// A shared effect.
pub type EffectHandle = Arc<dyn Effect>;

/// Every effect of the catalogue, of joints and of contacts.
#[must_use]
pub fn all() -> Vec<EffectHandle> {
    let mut effects: Vec<EffectHandle> = static_law::all()
        .map(|own| -> EffectHandle { Arc::new(own) })
        .collect();
    effects.extend([
        Arc::new(presliding_hysteresis::PreslidingHysteresis::default()) as EffectHandle,
        Arc::new(Inertia::correction()),
        Arc::new(elasticity::Elasticity::default()),
        Arc::new(backlash::Backlash::default()),
        Arc::new(motor_constant::MotorConstant::default()),
        Arc::new(torque_sensor_gain::TorqueSensorGain::default()),
        Arc::new(torque_sensor_offset::TorqueSensorOffset::default()),
        Arc::new(channel_delay::ChannelDelay::default()),
        Arc::new(current_saturation::CurrentSaturation::default()),
        Arc::new(contact_compliance::ContactCompliance::default()),
    ]);
    effects
}

/// The effects of the catalogue that are about `subject`.
#[must_use]
pub fn of(subject: Subject) -> Vec<EffectHandle> {
    let mut effects = all();
    effects.retain(|effect| effect.row().of == subject);
    effects
}

/// The effect with this id.
#[must_use]
pub fn find(id: &str) -> Option<EffectHandle> {
    with(|row| row.id == id)
}

/// The first effect of the catalogue whose row is like this.
#[must_use]
pub fn with(is: impl Fn(&Row) -> bool) -> Option<EffectHandle> {
    all().into_iter().find(|effect| is(effect.row()))
}

/// The terms of a model, each with the range of its columns among all.
pub fn with_columns(terms: &[BoundTerm]) -> impl Iterator<Item = (&BoundTerm, Range<usize>)> {
    terms.iter().scan(0, |first, term| {
        let columns = *first..*first + term.effect.columns();
        *first = columns.end;
        Some((term, columns))
    })
}

/// A parameter that no law of the servo uses, without bounds.
const fn free(name: &'static str, unit: Unit) -> EffectParameter {
    EffectParameter::new(name, unit, f64::NEG_INFINITY, f64::INFINITY)
}

//! The catalogue of physical effects.
//!
//! An effect is a sum of columns, each times a coefficient that is fitted:
//! τ_m − J q̈ − τ = Σ c_i φ_i(state; shape). The *shape* holds the parameters
//! that do not enter linearly (a velocity, a width); it is searched.
//!
//! The properties of an effect are data, its [`Row`]. Static effects, which are
//! functions of the current state, have row and law in `ferntast_model::friction`,
//! where the servo uses them too. The others are here, one a file.
//!
//! To add one of these: copy a neighbour, and name it here and in [`all`].

mod backlash;
mod channel_delay;
mod clock_drift;
mod contact_compliance;
mod current_saturation;
mod description;
mod elasticity;
mod exact;
pub mod expression;
mod inertia;
mod joint_coupling;
mod late_channel;
mod load_backlash;
mod load_elasticity;
mod motor_constant;
mod presliding_hysteresis;
mod static_law;
mod term;
mod torque_sensor_calibration;
mod torque_sensor_gain;
mod torque_sensor_offset;
mod warm_up;

use std::sync::Arc;

pub use ferntast_model::friction::{
    ANGLE, AtReversal, ConstantOf, Direction, Exact, Facts, Part, Row, Unit, logarithmic, sign,
};
use ferntast_model::friction::{EffectParameter, FrictionState};

use crate::data::Subject;
pub use crate::signals::Point;
use crate::signals::{Channels, InvalidSamples};
pub(crate) use description::row;
pub use description::{EffectDescription, Quantity};
pub use exact::ExactSignal;
pub(crate) use exact::{constant_of, parts_of};
pub use inertia::Inertia;
pub use joint_coupling::{COUPLING, JointCoupling, LOAD_OF, POSITION_OF, VELOCITY_OF};
pub use load_elasticity::LOAD_SHARE;
pub use term::{BoundTerm, with_columns};

/// Largest number of columns of one effect.
pub const MAX_COLUMNS: usize = 12;
/// Internal state that an effect carries from sample to sample (a bristle's
/// deflection, a place in a gap); zeros at the start of each session, and of no
/// meaning for an effect that is a function of the point alone.
pub type Memory = [f64; 4];

/// A physical effect on the motor torque of a joint \[Nm\], or on F_T of a contact
/// \[N\]: columns over the state, each times a coefficient.
pub trait Effect: Send + Sync {
    /// Its equation, parameters and signature, in words.
    fn description(&self) -> &EffectDescription;

    /// Its row in the catalogue: all its properties. An effect of the user's own
    /// has the row without any, [`Row::NONE`].
    fn row(&self) -> &'static Row {
        &Row::NONE
    }

    /// How far a gear that is soft by it is wound up by the torque of an arm's links at each of
    /// `points`, times the links' mean inertia \[Nm s²\]; `None` of what winds nothing up.
    fn winding(&self, _shape: &[f64], _points: &[Point]) -> Option<Vec<f64>> {
        None
    }

    /// Number of columns.
    fn columns(&self) -> usize {
        self.description().coefficients.len()
    }

    /// Why its coefficients cannot be identified from recordings with these
    /// `facts`, in words; `None` where they can.
    fn unavailable(&self, facts: &Facts) -> Option<String> {
        self.row().of_unmeasured?.measured(facts)
    }

    /// Grid of shapes to try, one vector of shape parameters each; a single empty
    /// one for an effect without shape parameters.
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

    /// Samples at which its torque depends on more than is measured, in order of
    /// time: rows of the regression whose filters reach there are left out of a
    /// model that has it, and its first shape parameter, a travel, is known no closer
    /// than the travel in them.
    fn undetermined_samples(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let _ = (shape, points);
        Vec::new()
    }

    /// Samples whose measured torque is not the motor's, in order of time: what is
    /// measured there explains itself, so that rows whose filters reach there
    /// are fitted but count for no error, neither before nor after.
    fn unjudged_samples(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let _ = (shape, points);
        Vec::new()
    }

    /// Largest share of the samples that may be such, for it to be named.
    fn most_unjudged(&self, shape: &[f64]) -> f64 {
        let _ = shape;
        1.0
    }

    /// Takes its influence out of the measured `channels`, sampled at the times of
    /// `points`, for an effect that acts on these. Returns how many samples are invalid
    /// afterwards.
    fn compensate(
        &self,
        shape: &[f64],
        coefficients: &[f64],
        channels: &mut Channels,
        points: &[Point],
    ) -> InvalidSamples {
        let _ = (shape, coefficients, channels, points);
        InvalidSamples::default()
    }

    /// Other shapes than this, of an effect that acts on channels, which its columns do not tell
    /// from it for certain: only the whole of what it does tells them apart.
    fn alternatives(&self, shape: &[f64], facts: &Facts) -> Vec<Vec<f64>> {
        let _ = (shape, facts);
        Vec::new()
    }

    /// Whether sign and size of the fitted `coefficients` are physically possible
    /// for this effect.
    fn plausible(&self, shape: &[f64], coefficients: &[f64]) -> bool {
        let _ = (shape, coefficients);
        true
    }

    /// Whether it is itself at this `shape`, and not the image of something else: a search goes
    /// through other shapes, too, so that what fits best there is not taken for the effect at
    /// the nearest shape that it may have.
    fn is_itself(&self, shape: &[f64]) -> bool {
        let _ = shape;
        true
    }

    /// Whether it can be named: it is itself, and plausible.
    fn is_possible(&self, shape: &[f64], coefficients: &[f64]) -> bool {
        self.is_itself(shape) && self.plausible(shape, coefficients)
    }

    /// Number of free parameters: coefficients and shape, unless one follows from
    /// the other. The fewer, the simpler.
    fn freedom(&self) -> usize {
        let own = self.row().freedom;
        own.unwrap_or_else(|| self.columns() + self.description().shape.len())
    }

    /// Whether its columns are functions of the measured motion, temperature and date
    /// alone, so that they stay the same whatever is known of the load.
    fn is_of_motion(&self) -> bool {
        false
    }

    /// Whether its columns change with the velocity.
    fn reads_velocity(&self) -> bool {
        true
    }

    /// Columns over a whole session by `states`, for an effect that is a function of these
    /// alone.
    fn of_states(&self, shape: &[f64], states: &[FrictionState]) -> Option<Vec<Vec<f64>>> {
        let _ = (shape, states);
        None
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

/// An effect, shared by the models and candidates that have it.
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
        Arc::new(load_backlash::LoadBacklash::default()),
        Arc::new(load_elasticity::LoadElasticity::default()),
        Arc::new(motor_constant::MotorConstant::default()),
        Arc::new(torque_sensor_gain::TorqueSensorGain::default()),
        Arc::new(torque_sensor_offset::TorqueSensorOffset::default()),
        Arc::new(torque_sensor_calibration::TorqueSensorCalibration::default()),
        Arc::new(channel_delay::ChannelDelay::default()),
        Arc::new(clock_drift::ClockDrift::default()),
        Arc::new(current_saturation::CurrentSaturation::default()),
        Arc::new(warm_up::WarmUp::coulomb()),
        Arc::new(warm_up::WarmUp::viscous()),
        Arc::new(contact_compliance::ContactCompliance::default()),
    ]);
    effects
}

/// The effects of the catalogue that act on `subject`: joints or contacts.
#[must_use]
pub fn for_subject(subject: Subject) -> Vec<EffectHandle> {
    let mut effects = all();
    effects.retain(|effect| effect.row().of == subject);
    effects
}

/// The effect of the catalogue with this id.
#[must_use]
pub fn find(id: &str) -> Option<EffectHandle> {
    find_by_row(|row| row.id == id)
}

/// The first effect of the catalogue whose row satisfies `is`.
#[must_use]
pub fn find_by_row(is: impl Fn(&Row) -> bool) -> Option<EffectHandle> {
    all().into_iter().find(|effect| is(effect.row()))
}

/// Every combination of a value of each axis, those of the last one next to each other.
pub(crate) fn combinations(axes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![Vec::new()], |shapes, values| {
        let each = shapes.iter();
        each.flat_map(|shape| values.iter().map(|v| [shape.as_slice(), &[*v]].concat()))
            .collect()
    })
}

/// Whether shares of a load are possible: they are of the load that a model without the effect
/// has, which may be smaller than it is.
fn are_shares(coefficients: &[f64]) -> bool {
    coefficients.iter().all(|share| (0.05..2.0).contains(share))
}

/// A parameter that no law of the servo uses, without bounds.
const fn free(name: &'static str, unit: Unit) -> EffectParameter {
    EffectParameter::new(name, unit, f64::NEG_INFINITY, f64::INFINITY)
}

/// The only column of an effect over `points`.
#[cfg(test)]
fn column_of(effect: &dyn Effect, shape: &[f64], points: &[Point]) -> Vec<f64> {
    let mut memory = Memory::default();
    let mut column = [0.0];
    let each = points.iter().map(|point| {
        effect.evaluate(shape, point, &mut memory, &mut column);
        column[0]
    });
    each.collect()
}

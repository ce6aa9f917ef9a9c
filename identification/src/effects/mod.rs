//! The catalogue of physical effects, one file each.
//!
//! An effect is a sum of columns, each times a coefficient that is fitted:
//! τ_m − J q̈ − τ = Σ c_i φ_i(state; shape). The *shape* holds the parameters
//! that do not enter linearly (a velocity, a width); it is searched.
//!
//! To add one: copy a neighbour, add it to [`all`].

mod asymmetric_coulomb;
mod asymmetric_viscous;
mod backlash;
mod cable_spring;
mod channel_delay;
mod contact_compliance;
mod contact_coulomb;
mod contact_spot;
mod contact_stribeck;
mod contact_viscous;
mod contact_wear;
mod coulomb;
mod cubic_viscous;
mod current_saturation;
mod description;
mod elasticity;
mod fitted_inertia;
mod gravity;
mod inertia;
mod load_coulomb;
mod local_friction;
mod motor_constant;
mod nonlinear_viscous;
pub(crate) mod parts;
mod presliding_hysteresis;
mod quadratic_viscous;
mod ripple;
mod stribeck;
mod temperature_coulomb;
mod temperature_viscous;
mod torque_sensor_gain;
mod torque_sensor_offset;
mod viscous;
mod wear_drift;

use std::sync::Arc;

use serde::Serialize;

use crate::data::{JointType, Subject};
use crate::signals::Channels;
pub(crate) use description::describe;
pub(crate) use description::{ANGLE, DAY, ONE, SPEED, STIFFNESS, TORQUE};
pub use description::{EffectDescription, Quantity, Unit};
pub use fitted_inertia::FittedInertia;

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

/// sign(x), zero at zero.
#[must_use]
pub fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// What is known of the recordings as a whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// Kind of joint.
    pub joint: JointType,
    /// J \[kg m²\], where it is given.
    pub inertia: Option<f64>,
    /// Motor turns in one turn of the joint.
    pub gear_ratio: Option<f64>,
    /// Whether τ is measured.
    pub joint_torque: bool,
    /// Whether the temperature is measured.
    pub temperature: bool,
    /// T₀ \[degC\], the mean.
    pub reference_temperature: f64,
    /// Range of T \[K\].
    pub temperature_range: f64,
    /// Number of sessions.
    pub sessions: usize,
    /// Days from the first session to the last.
    pub days: f64,
    /// Range of q \[rad\] (second to 98th percentile).
    pub position: [f64; 2],
    /// Second and 98th percentile of |q̇| while moving \[rad/s\].
    pub speed: [f64; 2],
    /// Top of |τ_m| \[Nm\].
    pub motor_torque: f64,
    /// Travel \[rad\] that is seen for certain, for the position's noise.
    pub resolved: f64,
    /// Whether there is a load: a torque sensor, gravity, a spring or an inertia.
    pub loaded: bool,
    /// Working period \[s\].
    pub period: f64,
    /// Whether the model has Coulomb friction that grows with the load.
    pub load_coulomb: bool,
}

impl Facts {
    /// Why nothing can be said of temperature, if nothing can.
    #[must_use]
    pub fn no_temperature(&self) -> Option<String> {
        (!self.temperature || self.temperature_range < 2.0)
            .then(|| "the temperature is not measured or varies by less than 2 K".to_owned())
    }
}

impl Facts {
    /// Length \[rad\] of the range of positions.
    #[must_use]
    pub fn travel(&self) -> f64 {
        self.position[1] - self.position[0]
    }
}

/// Longest list of columns of one effect.
pub const MOST_COLUMNS: usize = 12;
/// What an effect with a state remembers from sample to sample.
pub type Memory = [f64; 4];

/// A channel that passes the column filter as it is, so that its column and
/// the measured torque are smoothed alike to the last digit.
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

/// A signal that an [`Exact`] channel is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactSignal {
    /// q.
    Position,
    /// τ, measured.
    JointTorque,
}

impl Exact {
    /// What it is where no signal takes part.
    pub(crate) fn constant(self) -> f64 {
        f64::from(u8::from(self == Exact::One))
    }

    /// Signals, the order of their derivative, and factors that add up to it;
    /// `inertia` is J.
    pub(crate) fn parts(self, inertia: f64) -> impl Iterator<Item = (ExactSignal, u8, f64)> {
        use ExactSignal::{JointTorque, Position};
        let (first, second) = match self {
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

/// Signals that an effect speaks for, see [`Effect::own_signals`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnSignals {
    /// Names as in [`crate::dependence::Dependence::signals`].
    pub names: &'static [&'static str],
    /// Symmetry.
    pub direction: Direction,
    /// Whether it speaks for every pair with one of these signals, too.
    pub any_pair: bool,
}

/// A physical effect.
pub trait Effect: Send + Sync {
    /// What it is.
    fn description(&self) -> &EffectDescription;

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

    /// Channels to which the columns are equal, where they are.
    fn exact(&self) -> &'static [Exact] {
        &[]
    }

    /// Whether it shows mainly from one session to the next.
    fn between_sessions(&self) -> bool {
        false
    }

    /// Id of the effect whose coefficient it lets vary from session to session.
    fn varies(&self) -> Option<&'static str> {
        None
    }

    /// Signals over which its shape is fixed: a residual that still depends on
    /// them after it has been added says that the shape is not the right one.
    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &[],
            direction: Direction::Either,
            any_pair: false,
        }
    }

    /// Whether it is a load on the joint (spring, weight) rather than friction.
    fn is_load(&self) -> bool {
        false
    }

    /// Whether it shows mainly just after reversals, where other rows are left
    /// out: a model that has it is fitted to these rows too.
    fn shows_at_turns(&self) -> bool {
        false
    }

    /// Samples at which what it does depends on more than is measured: rows of
    /// the regression that reach there are left out of a model that has it.
    fn breaks(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let _ = (shape, points);
        Vec::new()
    }

    /// Whether its columns need the model's own prediction.
    fn needs_prediction(&self) -> bool {
        false
    }

    /// Whether it acts on what is measured rather than on torque. Its columns are
    /// then right for a small effect; of a large one [`Self::undo`] takes out
    /// all.
    fn acts_on_channels(&self) -> bool {
        false
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
        self.columns() + self.description().shape.len()
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
    vec![
        Arc::new(coulomb::Coulomb::default()),
        Arc::new(load_coulomb::LoadCoulomb::default()),
        Arc::new(viscous::Viscous::default()),
        Arc::new(quadratic_viscous::QuadraticViscous::default()),
        Arc::new(cubic_viscous::CubicViscous::default()),
        Arc::new(nonlinear_viscous::NonlinearViscous::default()),
        Arc::new(stribeck::Stribeck::default()),
        Arc::new(asymmetric_coulomb::AsymmetricCoulomb::default()),
        Arc::new(asymmetric_viscous::AsymmetricViscous::default()),
        Arc::new(temperature_coulomb::TemperatureCoulomb::default()),
        Arc::new(temperature_viscous::TemperatureViscous::default()),
        Arc::new(wear_drift::WearDrift::default()),
        Arc::new(ripple::Ripple::default()),
        Arc::new(presliding_hysteresis::PreslidingHysteresis::default()),
        Arc::new(local_friction::LocalFriction::default()),
        Arc::new(inertia::InertiaError::default()),
        Arc::new(gravity::Gravity::default()),
        Arc::new(cable_spring::CableSpring::default()),
        Arc::new(elasticity::Elasticity::default()),
        Arc::new(backlash::Backlash::default()),
        Arc::new(motor_constant::MotorConstant::default()),
        Arc::new(torque_sensor_gain::TorqueSensorGain::default()),
        Arc::new(torque_sensor_offset::TorqueSensorOffset::default()),
        Arc::new(channel_delay::ChannelDelay::default()),
        Arc::new(current_saturation::CurrentSaturation::default()),
        Arc::new(contact_coulomb::ContactCoulomb::default()),
        Arc::new(contact_viscous::ContactViscous::default()),
        Arc::new(contact_stribeck::ContactStribeck::default()),
        Arc::new(contact_compliance::ContactCompliance::default()),
        Arc::new(contact_spot::ContactSpot::default()),
        Arc::new(contact_wear::ContactWear::default()),
    ]
}

/// The effects of the catalogue that are about `subject`.
#[must_use]
pub fn of(subject: Subject) -> Vec<EffectHandle> {
    let mut effects = all();
    effects.retain(|effect| effect.description().of == subject);
    effects
}

/// Whether the effect `id` is Coulomb friction that grows with the load.
pub(crate) fn is_load_coulomb(id: &str) -> bool {
    ["load_coulomb", "contact_coulomb"].contains(&id)
}

/// The effect with this id.
#[must_use]
pub fn find(id: &str) -> Option<EffectHandle> {
    all()
        .into_iter()
        .find(|effect| effect.description().id == id)
}

/// Values from `low` to `high`, evenly in the logarithm.
pub(crate) fn logarithmic(low: f64, high: f64, count: usize) -> Vec<f64> {
    let low = low.max(1e-12);
    let ratio = (high.max(low * 1.01) / low).ln();
    (0..count)
        .map(|i| low * (ratio * i as f64 / (count.max(2) - 1) as f64).exp())
        .collect()
}

//! An effect whose torque is a function of what the joint is doing now.

use super::facts::Facts;
use super::row::Row;

/// What such an effect may depend on, of one joint, on the joint side of the
/// gear. Of a contact the position is the place along the contour, the load F_N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionState {
    /// Motor position q \[rad\].
    pub position: f64,
    /// Motor velocity q̇ \[rad/s\].
    pub velocity: f64,
    /// Load: joint torque τ at the torque sensor \[Nm\].
    pub load: f64,
    /// T − T₀ \[K\].
    pub temperature: f64,
    /// Time since the first recording \[days\].
    pub days: f64,
}

impl FrictionState {
    /// sign(q̇), zero at rest.
    #[must_use]
    pub fn sign(&self) -> f64 {
        sign(self.velocity)
    }
}

/// sign(x) with sign(0) = 0: at rest, friction takes no side.
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

/// What of a [`FrictionState`] an effect reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// q̇.
    Velocity,
    /// q.
    Position,
    /// τ.
    Load,
    /// T − T₀.
    Temperature,
    /// Days since the first recording.
    Date,
}

impl Signal {
    /// For messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
            Self::Load => "load",
            Self::Temperature => "temperature",
            Self::Date => "date",
        }
    }
}

/// A static effect of the catalogue: its row, its law, and how it is sought.
///
/// τ_F = Σ columns(state; shape) · coefficients.
#[derive(Clone, Copy, Debug)]
pub struct StaticEffect {
    /// What it is.
    pub row: Row,
    /// What it reads.
    pub reads: &'static [Signal],
    /// Writes ∂τ_F/∂coefficient for each coefficient, given the shape; both
    /// slices are as long as the row says. Allocates nothing.
    pub columns: fn(&FrictionState, &[f64], &mut [f64]),
    /// Why it cannot be told from these recordings, if it cannot.
    pub unavailable: fn(&Facts) -> Option<String>,
    /// Shapes to try, one vector of shape parameters each.
    pub shapes: fn(&Facts) -> Vec<Vec<f64>>,
    /// Lower and upper bound of each shape parameter when a shape is refined.
    pub bounds: fn(&Facts) -> Vec<[f64; 2]>,
    /// Whether coefficients make physical sense.
    pub is_plausible: fn(&[f64]) -> bool,
}

impl StaticEffect {
    /// An effect without a shape that is always available; its law is to be
    /// filled in.
    pub const NONE: StaticEffect = StaticEffect {
        row: Row::NONE,
        reads: &[Signal::Velocity],
        columns: |_, _, columns| columns.fill(0.0),
        unavailable: |_| None,
        shapes: |_| vec![Vec::new()],
        bounds: |_| Vec::new(),
        is_plausible: |_| true,
    };

    /// Whether it reads `signal`.
    #[must_use]
    pub fn reads(&self, signal: Signal) -> bool {
        self.reads.contains(&signal)
    }

    /// Whether it goes on through rest: it has no sign of q̇, so that a joint at
    /// rest feels it as a moving one does.
    #[must_use]
    pub fn acts_at_rest(&self) -> bool {
        !self.reads(Signal::Velocity)
    }
}

/// Every coefficient is above zero.
pub(super) fn positive(coefficients: &[f64]) -> bool {
    coefficients.iter().all(|c| *c > 0.0)
}

/// Values from `low` to `high`, evenly in the logarithm.
#[must_use]
pub fn logarithmic(low: f64, high: f64, count: usize) -> Vec<f64> {
    let low = low.max(1e-12);
    let ratio = (high.max(low * 1.01) / low).ln();
    (0..count)
        .map(|i| low * (ratio * i as f64 / (count.max(2) - 1) as f64).exp())
        .collect()
}

/// The same as shapes of one parameter.
pub(super) fn logarithmic_shapes(bounds: [f64; 2], count: usize) -> Vec<Vec<f64>> {
    let values = logarithmic(bounds[0], bounds[1], count).into_iter();
    values.map(|value| vec![value]).collect()
}

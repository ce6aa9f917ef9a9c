//! A session made ready: smoothed, differentiated, thinned, masked.

mod filters;
mod kept;
mod part;
mod point;
mod sliding;

use std::collections::BTreeMap;
use std::ops::AddAssign;
use std::sync::Arc;

use crate::data::RecordedSession;
use crate::data::stated_filter::StatedFilter;
use crate::numerics::filter::{Kernel, thin};

pub use filters::Filters;
pub(crate) use filters::RESOLVED;
pub(crate) use kept::{Columns, Kept, Key};
pub use point::Point;
pub(crate) use sliding::{Motion, Sliding};
use sliding::{rows_clear_of_bad_samples, touches_and_moves};

/// Seconds of a day.
pub(crate) const SECONDS_PER_DAY: f64 = 86_400.0;

/// A session at its working rate, and the rows of the regression. For a prismatic
/// joint read m for rad and N for Nm; of a contact see [`Point`].
#[derive(Clone, Debug)]
pub struct Signals {
    /// Name of the session.
    pub name: String,
    /// Working period \[s\].
    pub period: f64,
    /// Smoothing filter on columns of the regression that are not differentiated.
    pub column: Kernel,
    /// Columns of terms that a model needs again and again.
    pub(crate) kept: Arc<Kept>,
    /// States at the working rate, smoothed only as far as their signs and
    /// derivatives need. Shared by models of the same session until one of them writes its own
    /// load or prediction.
    pub points: Arc<Vec<Point>>,
    /// Extra signals at the working rate by name, in the units of the recording.
    pub extra: BTreeMap<String, Vec<f64>>,
    /// Channels at the working rate before smoothing, compensated for the model's
    /// effects that act on channels.
    pub raw: Arc<Channels>,
    /// Channels at the working rate before smoothing, as recorded.
    pub recorded: Arc<Channels>,
    /// Derivatives of the torque balance \[Nm\] by the coefficients of effects that
    /// act on channels, by the effects' ids: one column at the working rate for
    /// each coefficient, in its units.
    pub jacobians: BTreeMap<String, Vec<Vec<f64>>>,
    /// Working samples that are rows of the regression, in order of time: sliding,
    /// away from rest and reversals.
    pub rows: Vec<usize>,
    /// Those of `rows` that are fitted, but count for no error: their torque is not
    /// what was measured, by an effect of the model
    /// ([`Effect::unjudged_samples`](crate::effects::Effect::unjudged_samples)).
    pub unjudged_rows: Vec<usize>,
    /// Whether the session is known to be free of load, see [`RecordedSession::unloaded`].
    pub unloaded: bool,
    /// Rows that include rest and reversals (of a contact while it lasts), for
    /// effects with [`Row::shows_at_reversals`](ferntast_model::friction::Row::shows_at_reversals).
    pub rows_with_reversals: Vec<usize>,
    /// Rows at rest, at reversals and without contact, too: for drawing.
    pub all_rows: Vec<usize>,
}

/// Measured channels at the working rate, all of one length.
#[derive(Clone, Debug, Default)]
pub struct Channels {
    /// q \[rad\].
    pub position: Vec<f64>,
    /// τ_m \[Nm\].
    pub motor_torque: Vec<f64>,
    /// τ \[Nm\]; zero without a sensor.
    pub joint_torque: Vec<f64>,
}

/// Samples at both ends of a session that are invalid, since what they should be was not recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InvalidSamples {
    /// At the start.
    pub first: usize,
    /// At the end.
    pub last: usize,
}

impl InvalidSamples {
    /// Where the first sample is read so many samples later than it is, and the last one.
    #[must_use]
    pub fn read_late_by([first, last]: [f64; 2]) -> Self {
        // Interpolation reads one more.
        let beyond = |samples: f64| match samples > 0.0 {
            true => samples.ceil() as usize + 1,
            false => 0,
        };
        Self {
            first: beyond(-first),
            last: beyond(last),
        }
    }
}

impl AddAssign for InvalidSamples {
    fn add_assign(&mut self, other: Self) {
        self.first += other.first;
        self.last += other.last;
    }
}

impl Signals {
    /// Thins and smooths a session, and finds its rows.
    #[must_use]
    pub fn new(session: &RecordedSession, filters: &Filters) -> Self {
        let thinning = filters.thinning(session.period);
        let period = session.period * thinning as f64;
        let thin = |signal: &[f64]| thin(signal, thinning);
        let raw = Channels {
            position: thin(&session.position),
            motor_torque: thin(&session.motor_torque),
            joint_torque: session
                .joint_torque
                .as_ref()
                .map_or_else(|| vec![0.0; session.len().div_ceil(thinning)], |s| thin(s)),
        };
        let raw = Arc::new(raw);
        let [smooth, ..] = filters.state_kernels(filters.state, period);
        let temperature = session.temperature.as_ref().map(|s| thin(s));
        let links_inertia = session.relative_links_inertia.as_ref().map(|s| thin(s));
        let days = session.start / SECONDS_PER_DAY;
        let points = (0..raw.position.len())
            .map(|at| Point {
                period,
                temperature: temperature.as_ref().map_or(0.0, |t| smooth.at(t, at)),
                time: session.into_recording + at as f64 * period,
                days: days + at as f64 * period / SECONDS_PER_DAY,
                relative_links_inertia: links_inertia.as_ref().map_or(1.0, |own| own[at]),
                ..Point::default()
            })
            .collect();
        let mut signals = Self {
            name: session.name.clone(),
            period,
            column: filters.column_kernel(period),
            kept: Arc::default(),
            points: Arc::new(points),
            extra: session
                .extra
                .iter()
                .map(|(k, v)| (k.clone(), smooth.everywhere(&thin(v))))
                .collect(),
            raw: raw.clone(),
            recorded: raw.clone(),
            jacobians: BTreeMap::new(),
            unloaded: session.unloaded,
            rows: Vec::new(),
            unjudged_rows: Vec::new(),
            rows_with_reversals: Vec::new(),
            all_rows: Vec::new(),
        };
        match session.normal_force.as_ref() {
            Some(force) => signals.derive(filters, &thin(force), InvalidSamples::default()),
            None => signals.derive(filters, &raw.joint_torque, InvalidSamples::default()),
        }
        signals
    }

    /// Replaces the channels, and derives states and rows again; `lost` samples of the channels
    /// are invalid.
    pub(crate) fn replace_channels(
        &mut self,
        channels: Channels,
        lost: InvalidSamples,
        filters: &Filters,
    ) {
        let channels = Arc::new(channels);
        self.kept = Arc::default();
        self.raw = channels.clone();
        self.derive(filters, &channels.joint_torque, lost);
    }

    /// States and rows from the channels.
    fn derive(&mut self, filters: &Filters, load: &[f64], lost: InvalidSamples) {
        let raw = &self.raw;
        let [smooth, slope, curvature] = filters.state_kernels(filters.state, self.period);
        let [_, load_rate, load_jerk] = filters.state_kernels(filters.load, self.period);
        let motion = [&smooth, &slope, &curvature].map(|own| own.everywhere(&raw.position));
        let motor_torque = smooth.everywhere(&raw.motor_torque);
        let is_loaded = load.iter().any(|load| *load != 0.0);
        let loads = is_loaded
            .then(|| [&smooth, &load_rate, &load_jerk].map(|kernel| kernel.everywhere(load)));
        let derived = |(at, point): (usize, &Point)| {
            let loads = loads.as_ref();
            let [load, load_rate, load_jerk] =
                loads.map_or([0.0; 3], |own| own.each_ref().map(|own| own[at]));
            let [position, velocity, acceleration] = motion.each_ref().map(|own| own[at]);
            Point {
                position,
                velocity,
                acceleration,
                motor_torque: motor_torque[at],
                load,
                load_rate,
                load_jerk,
                ..*point
            }
        };
        self.points = Arc::new(self.points.iter().enumerate().map(derived).collect());
        let points = &self.points;
        let samples = points.len().saturating_sub(lost.last);
        let reach = match &filters.stated {
            // Derived twice, the acceleration looks furthest.
            Some(_) => StatedFilter::reach(&curvature, &self.column),
            None => filters.column_reach(),
        };
        self.all_rows = match &filters.stated {
            Some(filter) => filter.rows(samples, reach),
            None => (reach..samples.saturating_sub(reach))
                .step_by(filters.stride.max(1))
                .collect(),
        };
        self.all_rows.retain(|row| *row >= lost.first + reach);
        let mut sliding = Sliding::default();
        let slides: Vec<bool> = points
            .iter()
            .map(|point| sliding.next(point, filters))
            .collect();
        let with_reversals = match filters.touching {
            Some(least) => touches_and_moves(points, filters.rest_speed, least),
            None => vec![true; points.len()],
        };
        let both: Vec<bool> = slides
            .iter()
            .zip(&with_reversals)
            .map(|(slides, counts)| *slides && *counts)
            .collect();
        let rows = |good: &[bool]| match &filters.stated {
            Some(filter) => {
                let all = self.all_rows.iter().copied();
                all.filter(|at| !filter.is_slow(points[*at].velocity))
                    .collect()
            }
            None => rows_clear_of_bad_samples(&self.all_rows, good, reach),
        };
        (self.rows, self.rows_with_reversals) = (rows(&both), rows(&with_reversals));
    }

    /// Time \[s\] of a working sample since the session's start.
    #[must_use]
    pub fn time(&self, at: usize) -> f64 {
        at as f64 * self.period
    }
}

//! A session made ready: smoothed, differentiated, thinned, masked.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::data::{Dataset, Session};
use crate::effects::Point;
use crate::filter::{Kernel, least_width, noise_level, thin};
use crate::stated_filter::StatedFilter;
use crate::statistics;

const SECONDS_PER_DAY: f64 = 86_400.0;
/// Sampling faster than this \[s\] tells nothing more about friction.
const WORKING_PERIOD: f64 = 0.002;
/// Share of the range of positions that is dropped after a reversal: there
/// friction still builds up (presliding) and has no value of its own.
const TRAVEL_AFTER_REVERSAL: f64 = 0.006;
/// Share of the top speed below which a joint is near rest.
const NEAR_REST: f64 = 0.005;
/// Share of the top of F_N below which a tip does not touch for certain.
const LEAST_NORMAL_FORCE: f64 = 0.1;
/// Travel of this many times the position's noise is seen for certain.
pub const RESOLVED: f64 = 10.0;
/// A tip that is near rest for longer than this \[s\] stays there; else it turns.
const LONGEST_TURN: f64 = 0.15;

/// Widths of the filters, the same for all sessions of a dataset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filters {
    /// Samples of the recording in one working sample.
    pub thinning: usize,
    /// Width \[working samples\] of the light smoothing in which states (the
    /// sign of velocity, say) are judged.
    pub state: f64,
    /// The same for the rates of change of the load, which is noisier.
    pub load: f64,
    /// Width \[working samples\] of the filter on every column of the regression.
    pub column: f64,
    /// Working samples from one row of the regression to the next.
    pub stride: usize,
    /// |q̇| \[rad/s\] below which the joint is near rest.
    pub rest_speed: f64,
    /// Travel \[rad\] after a reversal that is dropped.
    pub travel: f64,
    /// Standard deviation of the position's noise \[rad\].
    pub position_noise: f64,
    /// Of a contact: F_N \[N\] below which the tip does not touch; `None` for a joint.
    pub touching: Option<f64>,
    /// What takes the place of all this, if the user states it.
    pub stated: Option<StatedFilter>,
}

/// A session at its working rate, and the rows of the regression.
#[derive(Clone, Debug)]
pub struct Signals {
    /// Name of the session.
    pub name: String,
    /// Working period \[s\].
    pub period: f64,
    /// Smoothing of a column that is not differentiated.
    pub column: Kernel,
    /// States at the working rate, lightly smoothed.
    pub points: Vec<Point>,
    /// Extra signals at the working rate.
    pub extra: BTreeMap<String, Vec<f64>>,
    /// Channels at the working rate before smoothing, without what the model's
    /// effects do to them.
    pub raw: Arc<Channels>,
    /// The same as they were recorded.
    pub recorded: Arc<Channels>,
    /// Columns at the working rate of effects that act on channels, by their ids.
    pub jacobians: BTreeMap<String, Vec<Vec<f64>>>,
    /// Working sample of each row, in order of time; near rest there is none.
    pub rows: Vec<usize>,
    /// See [`Session::unloaded`].
    pub unloaded: bool,
    /// The same with reversals: see [`Effect::shows_at_turns`](crate::effects::Effect::shows_at_turns).
    pub turning_rows: Vec<usize>,
    /// The same rows without regard to rest and reversal, for the eye.
    pub all_rows: Vec<usize>,
}

/// Measured channels at the working rate.
#[derive(Clone, Debug, Default)]
pub struct Channels {
    /// q \[rad\].
    pub position: Vec<f64>,
    /// τ_m \[Nm\].
    pub motor_torque: Vec<f64>,
    /// τ \[Nm\]; zero without a sensor.
    pub joint_torque: Vec<f64>,
}

impl Filters {
    /// What fits these recordings: as stated, else chosen from the noise.
    #[must_use]
    pub fn of(dataset: &Dataset) -> Self {
        let sessions = &dataset.sessions;
        let chosen = match dataset.joint.is_contact() {
            true => Self::of_contact(sessions),
            false => Self::choose(sessions),
        };
        match dataset.filter {
            Some(filter) => Self {
                thinning: 1,
                stride: filter.decimation.max(1),
                stated: Some(filter),
                ..chosen
            },
            None => chosen,
        }
    }

    /// Chooses widths from the noise in the recordings of a joint: as little
    /// smoothing as leaves the acceleration a twentieth noise, at most.
    #[must_use]
    pub fn choose(sessions: &[Session]) -> Self {
        Self::least_smoothing(sessions, 2)
    }

    /// The same of a contact, where no acceleration is needed: the velocity
    /// decides. What winds up before a tip slides is told by travel, so that no
    /// more of it is dropped than the position leaves open, and the filter on
    /// columns reaches no further than it must.
    fn of_contact(sessions: &[Session]) -> Self {
        let normal = sessions.iter().filter_map(|s| s.normal_force.as_ref());
        let mut all: Vec<f64> = normal.flatten().map(|force| force.abs()).collect();
        let chosen = Self::least_smoothing(sessions, 1);
        Self {
            column: chosen.state,
            stride: (2.0 * chosen.state).round() as usize,
            travel: RESOLVED * chosen.position_noise,
            touching: Some(LEAST_NORMAL_FORCE * quantile(&mut all, 0.98)),
            ..chosen
        }
    }

    /// As little smoothing as leaves the derivative of this `order` a twentieth
    /// noise, at most.
    fn least_smoothing(sessions: &[Session], order: u8) -> Self {
        let period = sessions.first().map_or(0.01, |s| s.period);
        let thinning = ((WORKING_PERIOD / period + 1e-6).floor() as usize).max(1);
        let working = period * thinning as f64;
        let positions: Vec<Vec<f64>> = sessions
            .iter()
            .map(|s| thin(&s.position, thinning))
            .collect();
        let noise = positions.iter().map(|q| noise_level(q)).fold(0.0, f64::max);
        let state = least_width(&positions, order, working);
        let loads: Vec<Vec<f64>> = (sessions.iter())
            .filter_map(|s| Some(thin(s.joint_torque.as_ref()?, thinning)))
            .collect();
        let load = match loads.is_empty() {
            true => state,
            false => least_width(&loads, 2, working).max(state),
        };
        let slope = Kernel::sharp(state, 1, working);
        let mut speeds: Vec<f64> = positions
            .iter()
            .flat_map(|q| (0..q.len()).step_by(5).map(|at| slope.at(q, at).abs()))
            .collect();
        let top = quantile(&mut speeds, 0.99);
        let mut all: Vec<f64> = positions.concat();
        let range = quantile(&mut all, 0.98) - quantile(&mut all, 0.02);
        let column = f64::max(2.0, state);
        Self {
            thinning,
            state,
            load,
            column,
            stride: (2.0 * column).round() as usize,
            rest_speed: f64::max(NEAR_REST * top, 4.0 * noise * slope.noise_gain().sqrt()),
            travel: TRAVEL_AFTER_REVERSAL * range,
            position_noise: noise,
            touching: None,
            stated: None,
        }
    }

    /// Smoothing of states by this `width`, and their first two derivatives.
    fn state_kernels(&self, width: f64, period: f64) -> [Kernel; 3] {
        match &self.stated {
            Some(filter) => filter.states(period),
            None => [0, 1, 2].map(|order| Kernel::sharp(width, order, period)),
        }
    }

    /// Smoothing of a column that is not differentiated.
    fn column_kernel(&self, period: f64) -> Kernel {
        match &self.stated {
            Some(filter) => filter.column(),
            None => Kernel::gaussian(self.column, 0, period),
        }
    }
}

/// The [quantile](statistics::quantile) of the numbers; 0 of none.
pub(crate) fn quantile(numbers: &mut [f64], share: f64) -> f64 {
    statistics::quantile(numbers, share, f64::total_cmp).unwrap_or(0.0)
}

impl Signals {
    /// Makes a session ready.
    #[must_use]
    pub fn new(session: &Session, filters: &Filters) -> Self {
        let period = session.period * filters.thinning as f64;
        let thin = |signal: &[f64]| thin(signal, filters.thinning);
        let raw = Channels {
            position: thin(&session.position),
            motor_torque: thin(&session.motor_torque),
            joint_torque: session.joint_torque.as_ref().map_or_else(
                || vec![0.0; session.len().div_ceil(filters.thinning)],
                |s| thin(s),
            ),
        };
        let raw = Arc::new(raw);
        let [smooth, ..] = filters.state_kernels(filters.state, period);
        let temperature = session.temperature.as_ref().map(|s| thin(s));
        let days = session.start / SECONDS_PER_DAY;
        let points = (0..raw.position.len())
            .map(|at| Point {
                period,
                temperature: temperature.as_ref().map_or(0.0, |t| smooth.at(t, at)),
                days: days + at as f64 * period / SECONDS_PER_DAY,
                ..Point::default()
            })
            .collect();
        let mut signals = Self {
            name: session.name.clone(),
            period,
            column: filters.column_kernel(period),
            points,
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
            turning_rows: Vec::new(),
            all_rows: Vec::new(),
        };
        match session.normal_force.as_ref() {
            Some(force) => signals.derive(filters, &thin(force), 0),
            None => signals.derive(filters, &raw.joint_torque, 0),
        }
        signals
    }

    /// Puts other channels in the place of the recorded ones; the last `lost`
    /// samples of these say nothing.
    pub(crate) fn take(&mut self, channels: Channels, lost: usize, filters: &Filters) {
        let channels = Arc::new(channels);
        self.raw = channels.clone();
        self.derive(filters, &channels.joint_torque, lost);
    }

    /// States and rows from the channels.
    fn derive(&mut self, filters: &Filters, load: &[f64], lost: usize) {
        let raw = &self.raw;
        let [smooth, slope, curvature] = filters.state_kernels(filters.state, self.period);
        let [_, load_rate, load_jerk] = filters.state_kernels(filters.load, self.period);
        for (at, point) in self.points.iter_mut().enumerate() {
            point.position = smooth.at(&raw.position, at);
            point.velocity = slope.at(&raw.position, at);
            point.acceleration = curvature.at(&raw.position, at);
            point.motor_torque = smooth.at(&raw.motor_torque, at);
            point.load = smooth.at(load, at);
            point.load_rate = load_rate.at(load, at);
            point.load_jerk = load_jerk.at(load, at);
        }
        let points = &self.points;
        let reach = Kernel::reach(filters.column);
        let last = points.len().saturating_sub(reach + lost);
        self.all_rows = match &filters.stated {
            Some(filter) => filter.rows(points.iter().map(|point| point.velocity)),
            None => (reach..last).step_by(filters.stride.max(1)).collect(),
        };
        let mut sliding = Sliding::default();
        let slides: Vec<bool> = points
            .iter()
            .map(|point| sliding.next(point, filters))
            .collect();
        let turning_too = match filters.touching {
            Some(least) => touching(points, filters.rest_speed, least),
            None => vec![true; points.len()],
        };
        let both: Vec<bool> = slides
            .iter()
            .zip(&turning_too)
            .map(|(slides, counts)| *slides && *counts)
            .collect();
        let rows = |good: &[bool]| match filters.stated {
            Some(_) => self.all_rows.clone(),
            None => clear_of_bad(&self.all_rows, good, reach),
        };
        (self.rows, self.turning_rows) = (rows(&both), rows(&turning_too));
    }

    /// Time \[s\] of a working sample since the session's start.
    #[must_use]
    pub fn time(&self, at: usize) -> f64 {
        at as f64 * self.period
    }
}

/// Which samples slide: faster than rest, and some way past the last reversal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sliding {
    direction: f64,
    travelled: f64,
}

impl Sliding {
    /// Whether the next sample, in order of time, slides.
    pub(crate) fn next(&mut self, point: &Point, filters: &Filters) -> bool {
        // A fast change of speed passes rest between two samples.
        let passing = 2.0 * point.acceleration.abs() * point.period;
        if point.velocity.abs() < filters.rest_speed.max(passing) {
            return false;
        }
        if point.velocity.signum() != self.direction {
            self.direction = point.velocity.signum();
            self.travelled = 0.0;
        }
        self.travelled += point.velocity.abs() * point.period;
        self.travelled > filters.travel
    }
}

/// Rows with no bad sample within `reach`.
fn clear_of_bad(rows: &[usize], good: &[bool], reach: usize) -> Vec<usize> {
    let mut bad = vec![0_usize; good.len() + 1];
    for (at, good) in good.iter().enumerate() {
        bad[at + 1] = bad[at] + usize::from(!good);
    }
    let rows = rows.iter().copied();
    rows.filter(|at| bad[at + reach] == bad[at - reach])
        .collect()
}

/// Which samples of a contact count: the tip touches and does not stay at rest,
/// where F_T may have any value that friction holds. Turns count: what winds up
/// before the tip slides shows nowhere else.
fn touching(points: &[Point], rest_speed: f64, least_force: f64) -> Vec<bool> {
    let mut counts: Vec<bool> = points.iter().map(|p| p.load > least_force).collect();
    let is_slow = |at: usize| points[at].velocity.abs() < rest_speed;
    let mut at = 0;
    while at < points.len() {
        let from = at;
        let mut time = 0.0;
        while at < points.len() && is_slow(at) {
            time += points[at].period;
            at += 1;
        }
        if time > LONGEST_TURN {
            counts[from..at].fill(false);
        }
        at += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tip_counts_where_it_touches_and_where_it_turns_but_not_where_it_stays() {
        let velocity = |at: usize| match at {
            0..50 | 130..150 => 0.01,
            50..55 => 0.0,
            55..100 => -0.01,
            _ => 1e-5,
        };
        let points: Vec<Point> = (0..150)
            .map(|at| Point {
                period: 0.01,
                velocity: velocity(at),
                load: if at < 20 { 0.1 } else { 10.0 },
                ..Point::default()
            })
            .collect();
        let counts = touching(&points, 1e-3, 1.0);
        for (at, counts) in counts.iter().enumerate() {
            let stays = (100..130).contains(&at);
            assert_eq!(*counts, at >= 20 && !stays, "sample {at}");
        }
    }
}

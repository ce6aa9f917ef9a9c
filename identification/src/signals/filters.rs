//! Widths of the filters, chosen from the noise in the recordings.

use crate::data::check::ALIKE;
use crate::data::stated_filter::StatedFilter;
use crate::data::{Dataset, RecordedSession};
use crate::numerics::filter::{Kernel, least_width, noise_level, quiet_width, thin};
use crate::numerics::statistics::quantile_or_zero;

/// Sampling period \[s\] below which a recording holds no more information about friction.
const WORKING_PERIOD: f64 = 0.002;
/// Share of the range of positions that is dropped after a reversal: there
/// friction still builds up (presliding) and has no value of its own.
const TRAVEL_AFTER_REVERSAL: f64 = 0.006;
/// Share of the top speed below which a joint is near rest.
const NEAR_REST: f64 = 0.005;
/// Share of the top of F_N below which a tip does not touch for certain.
const MIN_NORMAL_FORCE_SHARE: f64 = 0.1;
/// Travel that is resolved for certain, in standard deviations of the position's noise.
pub(crate) const RESOLVED: f64 = 10.0;

/// Why filters are as wide as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChosenFor {
    /// Derivative of the position that has to be quiet.
    pub order: u8,
    /// Whether it is: else the filters are the widest there are.
    pub is_quiet: bool,
}

/// Widths of the filters, the same for all sessions of a dataset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filters {
    /// Period \[s\] of working samples, about; each session has a whole number of its own samples
    /// in one.
    pub working_period: f64,
    /// Whether what is sampled faster is thinned for the sake of what is sampled slowest.
    pub thinned_to_slowest: bool,
    /// Width \[working samples\] of the light smoothing in which states (the
    /// sign of velocity, for example) are determined.
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
    /// What the width was chosen for.
    pub chosen_for: ChosenFor,
    /// Filters stated by the user, which replace those chosen from the noise.
    pub stated: Option<StatedFilter>,
}

impl Filters {
    /// The filters for these recordings, at `factor` times the cut-off that is stated,
    /// else chosen from the noise.
    #[must_use]
    pub fn at_cut_off(dataset: &Dataset, factor: f64) -> Self {
        let sessions = &dataset.sessions;
        let common = Working::of(sessions.iter().chain(&dataset.held_out));
        let chosen = match dataset.joint.is_contact() {
            true => Self::choose_for_contact(sessions, common),
            false => Self::least_smoothing(sessions, 2, common),
        };
        match dataset.filter {
            Some(filter) => {
                let filter = filter.at_cut_off(factor);
                Self {
                    thinned_to_slowest: false,
                    stride: filter.decimation.max(1),
                    stated: Some(filter),
                    ..chosen
                }
            }
            None => chosen.narrowed(factor),
        }
    }

    /// Samples of a recording, `period` \[s\] apart, in one working sample.
    #[must_use]
    pub fn thinning(&self, period: f64) -> usize {
        match &self.stated {
            Some(_) => 1,
            None => samples_in(self.working_period, period),
        }
    }

    /// As wide as makes the cut-off `factor` times as high.
    fn narrowed(self, factor: f64) -> Self {
        if factor == 1.0 {
            return self;
        }
        let period = self.working_period;
        let (state, column) = (self.state / factor, self.column / factor);
        // A narrower filter leaves the velocity noisier.
        let noise = Kernel::sharp(state, 1, period).noise_gain().sqrt() * self.position_noise;
        Self {
            state,
            load: self.load / factor,
            column,
            stride: ((2.0 * column).round() as usize).max(1),
            rest_speed: self.rest_speed.max(4.0 * noise),
            ..self
        }
    }

    /// Cut-off \[Hz\] of the filter that torque and columns pass, for working
    /// samples `period` \[s\] apart.
    #[must_use]
    pub fn cut_off(&self, period: f64) -> f64 {
        let column = self.column_kernel(period).cut_off(period);
        match &self.stated {
            Some(filter) => column.min(filter.butterworth_hz),
            None => column,
        }
    }

    /// How far the filters of states and columns, one after the other, look to either side \[s\],
    /// for working samples `period` \[s\] apart.
    #[must_use]
    pub fn reach(&self, period: f64) -> f64 {
        let samples = match &self.stated {
            Some(filter) => {
                let [.., acceleration] = filter.states(period);
                StatedFilter::reach(&acceleration, &filter.column())
            }
            None => Kernel::reach(self.state) + Kernel::reach(self.column),
        };
        samples as f64 * period
    }

    /// Why it is as it is, in words.
    #[must_use]
    pub fn why(&self) -> String {
        if let Some(filter) = &self.stated {
            return format!(
                "as stated in [filter]: Butterworth {} Hz forwards and backwards, every {} samples a row",
                filter.butterworth_hz,
                filter.decimation.max(1)
            );
        }
        let what = match self.chosen_for.order {
            1 => "velocity",
            _ => "acceleration",
        };
        let why = match self.chosen_for.is_quiet {
            true => format!(
                "chosen from the noise in the position: the least smoothing that leaves the {what} 5 % noise or less"
            ),
            false => format!(
                "the most smoothing there is, and the {what} has more than 5 % noise all the same: state a lower one in [filter]"
            ),
        };
        match self.thinned_to_slowest {
            true => format!(
                "{why}; all recordings are taken at about {:.0} Hz, the rate of the slowest of them: without it, the others tell more",
                1.0 / self.working_period
            ),
            false => why,
        }
    }

    /// Chooses widths from the noise in the recordings of a joint: as little
    /// smoothing as leaves the acceleration a twentieth noise, at most.
    #[must_use]
    pub fn choose(sessions: &[RecordedSession]) -> Self {
        Self::least_smoothing(sessions, 2, Working::of(sessions.iter()))
    }

    /// The same for a contact, where no acceleration is needed: the velocity
    /// decides. Compliance before a tip slides shows over travel, so that no more
    /// travel is dropped than the position cannot resolve, and the filter on
    /// columns is as short as possible.
    fn choose_for_contact(sessions: &[RecordedSession], common: Working) -> Self {
        let normal = sessions.iter().filter_map(|s| s.normal_force.as_ref());
        let mut all: Vec<f64> = normal.flatten().map(|force| force.abs()).collect();
        let chosen = Self::least_smoothing(sessions, 1, common);
        Self {
            column: chosen.state,
            stride: (2.0 * chosen.state).round() as usize,
            travel: RESOLVED * chosen.position_noise,
            touching: Some(MIN_NORMAL_FORCE_SHARE * quantile_or_zero(&mut all, 0.98)),
            ..chosen
        }
    }

    /// As little smoothing as leaves the derivative of this `order` a twentieth
    /// noise, at most.
    fn least_smoothing(sessions: &[RecordedSession], order: u8, common: Working) -> Self {
        let working = common.period;
        let thinned =
            |s: &RecordedSession, signal: &[f64]| thin(signal, samples_in(working, s.period));
        let positions: Vec<Vec<f64>> = sessions.iter().map(|s| thinned(s, &s.position)).collect();
        let noise = positions.iter().map(|q| noise_level(q)).fold(0.0, f64::max);
        let quiet = quiet_width(&positions, order, working);
        let state = quiet.unwrap_or_else(|| least_width(&positions, order, working));
        let loads: Vec<Vec<f64>> = (sessions.iter())
            .filter_map(|s| Some(thinned(s, s.joint_torque.as_ref()?)))
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
        let top = quantile_or_zero(&mut speeds, 0.99);
        let mut all: Vec<f64> = positions.concat();
        let range = quantile_or_zero(&mut all, 0.98) - quantile_or_zero(&mut all, 0.02);
        let column = f64::max(2.0, state);
        Self {
            working_period: working,
            thinned_to_slowest: common.is_of_slowest,
            state,
            load,
            column,
            stride: (2.0 * column).round() as usize,
            rest_speed: f64::max(NEAR_REST * top, 4.0 * noise * slope.noise_gain().sqrt()),
            travel: TRAVEL_AFTER_REVERSAL * range,
            position_noise: noise,
            touching: None,
            chosen_for: ChosenFor {
                order,
                is_quiet: quiet.is_some(),
            },
            stated: None,
        }
    }

    /// Smoothing of states by this `width`, and their first two derivatives.
    pub(crate) fn state_kernels(&self, width: f64, period: f64) -> [Kernel; 3] {
        match &self.stated {
            Some(filter) => filter.states(period),
            None => [0, 1, 2].map(|order| Kernel::sharp(width, order, period)),
        }
    }

    /// Smoothing twice as wide as that of states, and the curvature of a position by it. With the
    /// noise of an acceleration, which goes with the width to the power of −5 in square, it has a
    /// thirtieth in common.
    pub(crate) fn broad_kernels(&self, period: f64) -> [Kernel; 2] {
        let [smooth, _, curvature] = match &self.stated {
            Some(filter) => filter.at_cut_off(0.5).states(period),
            None => self.state_kernels(2.0 * self.state, period),
        };
        [smooth, curvature]
    }

    /// Working samples on either side that the filter on columns looks at.
    pub(crate) fn column_reach(&self) -> usize {
        match &self.stated {
            Some(filter) => filter.column_reach(),
            None => Kernel::reach(self.column),
        }
    }

    /// Smoothing of a column that is not differentiated.
    pub(super) fn column_kernel(&self, period: f64) -> Kernel {
        match &self.stated {
            Some(filter) => filter.column(),
            None => Kernel::gaussian(self.column, 0, period),
        }
    }
}

/// Period at which recordings are worked with.
#[derive(Clone, Copy)]
struct Working {
    /// \[s\]
    period: f64,
    /// Whether it is that of the slowest recording, though others are faster.
    is_of_slowest: bool,
}

impl Working {
    /// Of all `sessions`: that of the first, thinned, unless another is much slower.
    fn of<'a>(sessions: impl Iterator<Item = &'a RecordedSession> + Clone) -> Self {
        let first = sessions.clone().next().map_or(0.01, |own| own.period);
        let alone = first * (WORKING_PERIOD / first + 1e-6).floor().max(1.0);
        let periods = sessions.map(|own| own.period);
        let slowest = periods.clone().fold(first, f64::max);
        let period = if slowest > ALIKE * alone {
            slowest
        } else {
            alone
        };
        let fastest = periods.fold(first, f64::min).max(WORKING_PERIOD);
        Self {
            period,
            is_of_slowest: period > ALIKE * fastest,
        }
    }
}

/// Samples `period` apart in one of `working` \[s\], at least one.
fn samples_in(working: f64, period: f64) -> usize {
    ((working / period).round() as usize).max(1)
}

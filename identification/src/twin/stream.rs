//! Samples as they come, made into rows of the regression.
//!
//! The same filters, thinning, mask and columns as for whole recordings
//! ([`Signals`](crate::signals::Signals)): both are short and without phase, so
//! that a row is ready a fixed time after its sample.

use crate::design::PreparedModel;
use crate::effects::{
    BoundTerm, Exact, ExactSignal, MAX_COLUMNS, Memory, Point, constant_of, parts_of, with_columns,
};
use crate::numerics::filter::Kernel;
use crate::signals::{Filters, Sliding};

use super::TwinSample;
use super::history::History;
use super::sample::TwinRow;

/// Extra signals are read by no effect of the catalogue.
const NO_EXTRA: [f64; 0] = [];

/// Grid, filters and states between a sample and its row.
#[derive(Clone)]
pub(super) struct Stream {
    filters: Filters,
    /// Period of the recordings that the filters were chosen on \[s\].
    period: f64,
    inertia: f64,
    reference_temperature: f64,
    has_sensor: bool,
    terms: Vec<BoundTerm>,
    /// Coefficients of the terms, for the modelled load.
    coefficients: Vec<f64>,
    kernels: Kernels,
    state: StreamState,
}

#[derive(Clone)]
struct Kernels {
    thin: Kernel,
    state: [Kernel; 3],
    column: [Kernel; 3],
}

/// Everything that a gap in the samples resets.
#[derive(Clone, Default)]
struct StreamState {
    /// Time of grid sample 0 \[s\].
    start: f64,
    last: Option<TwinSample>,
    /// Channels on the recordings' grid, then thinned: q, τ_m, τ, T.
    grid: [History; 4],
    working: [History; 4],
    points: usize,
    memories: Vec<Memory>,
    /// One history a column.
    columns: Vec<History>,
    velocity: History,
    /// 1 where the joint does not slide.
    stuck: History,
    sliding: Sliding,
    next_row: usize,
}

impl Stream {
    pub(super) fn new(prepared: &PreparedModel, period: f64, coefficients: &[f64]) -> Self {
        let filters = prepared.filters;
        let working = period * filters.thinning(period) as f64;
        let state = |order| Kernel::sharp(filters.state, order, working);
        let column = |order| Kernel::gaussian(filters.column, order, working);
        let mut stream = Self {
            filters,
            period,
            inertia: prepared.facts.inertia.unwrap_or(0.0),
            reference_temperature: if prepared.facts.temperature {
                prepared.facts.reference_temperature
            } else {
                0.0
            },
            has_sensor: prepared.facts.joint_torque,
            terms: prepared.terms.clone(),
            coefficients: coefficients.to_vec(),
            kernels: Kernels {
                thin: Kernel::gaussian(0.5 * filters.thinning(period) as f64, 0, 1.0),
                state: [state(0), state(1), state(2)],
                column: [column(0), column(1), column(2)],
            },
            state: StreamState::default(),
        };
        stream.restart();
        stream
    }

    /// Forgets all samples, as at a gap.
    pub(super) fn restart(&mut self) {
        let columns = self.terms.iter().map(|t| t.effect.columns()).sum();
        self.state = StreamState {
            memories: vec![[0.0; 4]; self.terms.len()],
            columns: vec![History::default(); columns],
            next_row: Kernel::reach(self.filters.column),
            ..StreamState::default()
        };
    }

    /// Time between a sample and its row \[s\].
    pub(super) fn delay(&self) -> f64 {
        let thinning = self.filters.thinning(self.period);
        let thin = Kernel::reach(0.5 * thinning as f64) as f64;
        let working = Kernel::reach(self.filters.state).max(2) + Kernel::reach(self.filters.column);
        self.period * (thin + (working * thinning) as f64)
    }

    /// Working period \[s\].
    fn working_period(&self) -> f64 {
        self.period * self.filters.thinning(self.period) as f64
    }

    /// Takes a sample that is later than the last; appends the rows that it completes.
    pub(super) fn push(&mut self, sample: &TwinSample, rows: &mut Vec<TwinRow>) {
        let Some(last) = self.state.last.replace(*sample) else {
            self.state.start = sample.time;
            self.grid_sample(sample.channels(), rows);
            return;
        };
        // Straight between two samples, onto the recordings' grid.
        loop {
            let next = self.state.start + self.state.grid[0].len() as f64 * self.period;
            if next > sample.time + 1e-9 {
                return;
            }
            let share = ((next - last.time) / (sample.time - last.time)).clamp(0.0, 1.0);
            let (from, to) = (last.channels(), sample.channels());
            let channels = [0, 1, 2, 3].map(|i| from[i] + share * (to[i] - from[i]));
            self.grid_sample(channels, rows);
        }
    }

    fn grid_sample(&mut self, channels: [f64; 4], rows: &mut Vec<TwinRow>) {
        for (history, value) in self.state.grid.iter_mut().zip(channels) {
            history.push(value);
        }
        let thinning = self.filters.thinning(self.period);
        let reach = if thinning > 1 {
            Kernel::reach(0.5 * thinning as f64)
        } else {
            0
        };
        let at = self.state.working[0].len() * thinning;
        if at + reach >= self.state.grid[0].len() {
            return;
        }
        for (working, grid) in self.state.working.iter_mut().zip(&self.state.grid) {
            working.push(if thinning > 1 {
                grid.filtered(&self.kernels.thin, at)
            } else {
                grid.at(at)
            });
        }
        let reach = Kernel::reach(self.filters.state).max(2);
        if self.state.points + reach < self.state.working[0].len() {
            self.point(self.state.points);
            self.state.points += 1;
        }
        let reach = Kernel::reach(self.filters.column);
        if self.state.next_row + reach < self.state.points {
            let row = self.row(self.state.next_row);
            rows.push(row);
            self.state.next_row += self.filters.stride.max(1);
        }
    }

    /// States and columns at working sample `at`.
    fn point(&mut self, at: usize) {
        let [position, motor_torque, joint_torque, temperature] = &self.state.working;
        let [smooth, slope, curvature] = &self.kernels.state;
        let mut point = Point {
            period: self.working_period(),
            position: position.filtered(smooth, at),
            velocity: position.filtered(slope, at),
            acceleration: position.filtered(curvature, at),
            motor_torque: motor_torque.filtered(smooth, at),
            load: joint_torque.filtered(smooth, at),
            load_rate: joint_torque.filtered(slope, at),
            load_jerk: joint_torque.filtered(curvature, at),
            temperature: temperature.filtered(smooth, at) - self.reference_temperature,
            time: at as f64 * self.working_period(),
            days: (self.state.start + at as f64 * self.working_period()) / 86_400.0,
            ..Point::default()
        };
        if !self.has_sensor {
            point.load = self.inertia * point.acceleration;
        }
        // Loads first: without a sensor the others act on their sum.
        for loads in [true, false] {
            for ((term, places), memory) in with_columns(&self.terms).zip(&mut self.state.memories)
            {
                let count = places.len().min(MAX_COLUMNS);
                if term.effect.row().is_modelled_load() == loads {
                    let mut values = [0.0; MAX_COLUMNS];
                    term.effect.evaluate_with(
                        &term.shape,
                        &point,
                        &NO_EXTRA,
                        memory,
                        &mut values[..count],
                    );
                    for (k, value) in places.zip(values) {
                        if let Some(column) = self.state.columns.get_mut(k) {
                            column.push(value);
                        }
                        if loads && !self.has_sensor {
                            point.load += value * self.coefficients.get(k).copied().unwrap_or(0.0);
                        }
                    }
                }
            }
        }
        self.state.velocity.push(point.velocity);
        let stuck = !self.state.sliding.next(&point, &self.filters);
        self.state.stuck.push(f64::from(u8::from(stuck)));
    }

    /// A channel that passes the column filter as it is, at working sample `at`.
    fn exact(&self, channel: Exact, at: usize) -> f64 {
        let [position, _, joint_torque, _] = &self.state.working;
        let parts = parts_of(channel, self.inertia).filter_map(|(signal, order, factor)| {
            let history = match signal {
                ExactSignal::Position => position,
                ExactSignal::JointTorque => joint_torque,
            };
            let kernel = self.kernels.column.get(usize::from(order))?;
            Some(factor * history.filtered(kernel, at))
        });
        constant_of(channel) + parts.sum::<f64>()
    }

    fn row(&self, at: usize) -> TwinRow {
        let [position, motor_torque, joint_torque, temperature] = &self.state.working;
        let [smooth, _, curvature] = &self.kernels.column;
        let load = if self.has_sensor {
            joint_torque.filtered(smooth, at)
        } else {
            0.0
        };
        let acceleration = position.filtered(curvature, at);
        let driven = self.inertia * acceleration + load;
        let motor_torque = motor_torque.filtered(smooth, at);
        let mut phi = Vec::with_capacity(self.state.columns.len());
        for term in &self.terms {
            let exact = term.effect.row().exact;
            for k in 0..term.effect.columns().min(MAX_COLUMNS) {
                phi.push(match exact.get(k) {
                    Some(channel) => self.exact(*channel, at),
                    None => self
                        .state
                        .columns
                        .get(phi.len())
                        .map_or(0.0, |column| column.filtered(smooth, at)),
                });
            }
        }
        let reach = Kernel::reach(self.filters.column);
        let slides = ((at + 1).saturating_sub(reach)..at + reach)
            .all(|near| self.state.stuck.at(near) == 0.0);
        TwinRow {
            time: self.state.start + at as f64 * self.working_period(),
            position: position.filtered(smooth, at),
            velocity: self.state.velocity.at(at),
            joint_torque: load,
            temperature: temperature.filtered(smooth, at),
            motor_torque,
            driven,
            phi,
            slides,
        }
    }
}

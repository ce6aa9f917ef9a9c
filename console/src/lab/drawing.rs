//! Measured against model over time, short enough to send.

use ferntast_identification::comparison::Series;
use serde::Serialize;

/// Points of all sessions together that are sent at most.
pub const MAX_POINTS: usize = 400_000;

/// The signals of one session. Columns are as long as `time` or empty.
#[derive(Debug, Serialize)]
pub struct Drawing {
    session: String,
    held_out: bool,
    /// \[s\]
    time: Vec<f64>,
    position: Vec<f32>,
    velocity: Vec<f32>,
    acceleration: Vec<f32>,
    load: Vec<f32>,
    temperature: Vec<f32>,
    measured: Vec<f32>,
    modelled: Vec<f32>,
    /// 1 where the fit used it.
    used: Vec<u8>,
}

impl Drawing {
    /// Of `series`; numbers keep seven digits, more than a screen shows.
    pub fn of(series: &Series) -> Drawing {
        let short = |values: &[f64]| values.iter().map(|value| *value as f32).collect();
        Drawing {
            session: series.session.clone(),
            held_out: series.held_out,
            time: series
                .time
                .iter()
                .map(|time| (time * 1e4).round() / 1e4)
                .collect(),
            position: short(&series.position),
            velocity: short(&series.velocity),
            acceleration: short(&series.acceleration),
            load: short(&series.load),
            temperature: short(&series.temperature),
            measured: short(&series.measured),
            modelled: short(&series.modelled),
            used: series.used.iter().map(|used| u8::from(*used)).collect(),
        }
    }
}

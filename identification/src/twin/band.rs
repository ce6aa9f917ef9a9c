//! Band of the residual: how large its mean square is in the model's own recordings.

use super::{BAND_ROWS, Twin, TwinSample};
use crate::data::{Dataset, RecordedSession};

/// Ratio of the alarm limit on the squared residual, averaged over [`BAND_ROWS`], to
/// the largest such average in the model's own recordings \[1\]: parameters vary from
/// session to session, and some motions leave larger residuals.
const BAND_EXCESS: f64 = 2.0;

impl Twin {
    /// Mean square \[Nm²\] above which the residual has left its band: by the
    /// recordings that the model was fitted to.
    pub(super) fn limit_of(&self, dataset: &Dataset) -> f64 {
        let mut own = self.clone();
        let mut outputs = Vec::new();
        let mut largest = self.band * self.band;
        for session in &dataset.sessions {
            // Filters start over; the average goes on.
            own.last = None;
            for sample in samples(session) {
                own.push(&sample, &mut outputs);
                outputs.clear();
                if own.settled_rows >= BAND_ROWS {
                    largest = largest.max(own.mean_square);
                }
            }
            own.recent.clear();
        }
        BAND_EXCESS * largest
    }
}

fn samples(session: &RecordedSession) -> impl Iterator<Item = TwinSample> + '_ {
    let channel =
        |of: &Option<Vec<f64>>, at: usize| of.as_ref().and_then(|all| all.get(at)).copied();
    let pairs = session.position.iter().zip(&session.motor_torque);
    pairs
        .enumerate()
        .map(move |(at, (position, motor_torque))| TwinSample {
            time: session.start + at as f64 * session.period,
            position: *position,
            motor_torque: *motor_torque,
            joint_torque: channel(&session.joint_torque, at),
            temperature: channel(&session.temperature, at),
        })
}

//! The latest samples, kept for an assessment.

use super::TwinSample;
use crate::data::RecordedSession;

/// Largest number of samples kept.
const MAX_KEPT_SAMPLES: usize = 600_000;
/// Length of the pieces \[s\] by which samples are kept, and dropped when there are too many.
const PIECE_LENGTH: f64 = 60.0;
/// Largest number of samples of a session that is left out of an assessment.
const MAX_SHORT_SESSION: usize = 200;

/// The latest samples on the grid of the recordings, in pieces of limited length.
#[derive(Clone)]
pub(super) struct RecentSamples {
    /// Sampling period of the grid \[s\].
    period: f64,
    pieces: Vec<RecordedSession>,
    /// Samples in all pieces.
    samples: usize,
}

impl RecentSamples {
    /// None yet, on a grid of this `period` \[s\].
    pub(super) fn new(period: f64) -> Self {
        Self {
            period,
            pieces: Vec::new(),
            samples: 0,
        }
    }

    /// Drops all samples.
    pub(super) fn clear(&mut self) {
        self.pieces.clear();
        self.samples = 0;
    }

    /// Begins a session with the grid at `sample`, as after a gap.
    pub(super) fn begin_session(&mut self, sample: &TwinSample) {
        self.pieces.push(self.empty_piece(sample));
    }

    /// Keeps the newest value at each time of the session's grid.
    pub(super) fn push(&mut self, sample: &TwinSample) {
        let full = |piece: &RecordedSession| {
            sample.time - piece.start > PIECE_LENGTH && piece.period > 0.0
        };
        if let Some(last) = self.pieces.last().filter(|piece| full(piece)) {
            // On the grid of the piece before, so that both can be joined.
            let start = end(last);
            let piece = RecordedSession {
                start,
                ..self.empty_piece(sample)
            };
            self.pieces.push(piece);
        }
        let Some(piece) = self.pieces.last_mut() else {
            return;
        };
        let due = ((sample.time - piece.start) / piece.period + 0.5).floor() + 1.0;
        while (piece.len() as f64) < due {
            append(piece, sample);
            self.samples += 1;
        }
        if self.samples > MAX_KEPT_SAMPLES && self.pieces.len() > 1 {
            self.samples -= self.pieces.remove(0).len();
        }
    }

    /// Pieces that follow each other without a gap as one session each: what is
    /// one session must not count as several where sessions are compared.
    pub(super) fn sessions(&self) -> Vec<RecordedSession> {
        let mut sessions: Vec<RecordedSession> = Vec::new();
        for piece in &self.pieces {
            match sessions.last_mut() {
                Some(last) if (piece.start - end(last)).abs() < 0.5 * piece.period => {
                    extend(last, piece);
                }
                _ => sessions.push(piece.clone()),
            }
        }
        sessions.retain(|session| session.len() > MAX_SHORT_SESSION);
        sessions
    }

    fn empty_piece(&self, sample: &TwinSample) -> RecordedSession {
        let first = self.pieces.first().map_or(sample.time, |first| first.start);
        RecordedSession {
            name: format!("from {:.1} s", sample.time - first),
            start: sample.time,
            period: self.period,
            joint_torque: sample.joint_torque.map(|_| Vec::new()),
            temperature: sample.temperature.map(|_| Vec::new()),
            ..RecordedSession::default()
        }
    }
}

/// When the sample after the last is due \[s\].
fn end(session: &RecordedSession) -> f64 {
    session.start + session.len() as f64 * session.period
}

/// Adds one sample at the end.
fn append(piece: &mut RecordedSession, sample: &TwinSample) {
    piece.position.push(sample.position);
    piece.motor_torque.push(sample.motor_torque);
    if let Some(torques) = &mut piece.joint_torque {
        torques.push(sample.joint_torque.unwrap_or(0.0));
    }
    if let Some(temperatures) = &mut piece.temperature {
        temperatures.push(sample.temperature.unwrap_or(0.0));
    }
}

/// Adds all samples of the `next` piece at the end.
fn extend(session: &mut RecordedSession, next: &RecordedSession) {
    session.position.extend(&next.position);
    session.motor_torque.extend(&next.motor_torque);
    for (all, more) in [
        (&mut session.joint_torque, &next.joint_torque),
        (&mut session.temperature, &next.temperature),
    ] {
        if let (Some(all), Some(more)) = (all, more) {
            all.extend(more);
        }
    }
}

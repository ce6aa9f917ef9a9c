//! What one end of the link measures of it: from what arrives, never from
//! what is configured.
//!
//! * round trip: now − echo − held, exact to the nanosecond, no clocks need agree;
//! * one way: now − sent, true as far as both clocks agree;
//! * jitter: RFC 3550, section 6.4.1, J ← J + (|D| − J)/16;
//! * loss: by sequence number over a sliding second;
//! * order: only frames newer than the newest acted on are acted on.

mod loss;

pub use loss::{Fate, LossWindow};

use crate::frame::{Echo, FrameError, LinkFrame};
use crate::seconds;

/// What becomes of a frame that was decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Newer than all before: act on it.
    Newest,
    /// Overtaken by a newer one: do not act on it.
    Late,
    /// Arrived before: do not act on it.
    Replayed,
}

/// Frames received and not acted on, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefusedCounts {
    /// Not as long as a frame is.
    pub length: u64,
    /// Of another version of the format.
    pub version: u64,
    /// Of another session.
    pub session: u64,
    /// Checksum wrong.
    pub checksum: u64,
    /// From the future, or too old.
    pub time: u64,
    /// Not finite or out of range.
    pub value: u64,
    /// Arrived before.
    pub replayed: u64,
    /// Overtaken by a newer frame.
    pub late: u64,
}

impl RefusedCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.length
            + self.version
            + self.session
            + self.checksum
            + self.time
            + self.value
            + self.replayed
            + self.late
    }
}

/// What was measured, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkMeasurement {
    /// Round trip \[s\]: newest measurement; NaN before the first.
    pub round_trip: f64,
    /// One way, the other end to this one \[s\]; NaN before the first.
    pub delay: f64,
    /// Interarrival jitter \[s\].
    pub jitter: f64,
    /// Share of the frames sent to this end whose fate became known in the
    /// last second and that were lost, 0 … 1; 1 when nothing arrived for a
    /// second; NaN before the first.
    pub loss: f64,
    /// Time since the newest frame arrived \[s\]; infinite before the first.
    pub silence: f64,
    /// Time since the newest frame was sent: age of what is acted on \[s\];
    /// infinite before the first.
    pub age: f64,
    /// Frames sent since the start.
    pub sent: u64,
    /// Frames received and acted on since the start.
    pub received: u64,
    /// Frames lost since the start.
    pub lost: u64,
    /// Frames received and not acted on since the start.
    pub refused: RefusedCounts,
}

#[derive(Clone, Copy, Debug)]
struct Newest {
    sequence: u32,
    sent_ns: i64,
    arrived_ns: i64,
}

/// Measures one end of the link. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct LinkMeter {
    newest: Option<Newest>,
    /// Arrival minus sending of the frame that arrived last, in whatever order [ns].
    transit_ns: Option<i64>,
    round_trip_ns: Option<i64>,
    delay_ns: Option<i64>,
    /// [ns]
    jitter: f64,
    window: LossWindow,
    sent: u64,
    received: u64,
    refused: RefusedCounts,
}

impl Default for LinkMeter {
    fn default() -> Self {
        LinkMeter::new()
    }
}

impl LinkMeter {
    /// A meter that has seen nothing.
    pub fn new() -> Self {
        LinkMeter {
            newest: None,
            transit_ns: None,
            round_trip_ns: None,
            delay_ns: None,
            jitter: 0.0,
            window: LossWindow::new(),
            sent: 0,
            received: 0,
            refused: RefusedCounts::default(),
        }
    }

    /// A frame was sent.
    pub fn sent(&mut self) {
        self.sent += 1;
    }

    /// A frame was refused by [`decode`](crate::frame::decode).
    pub fn refused(&mut self, error: &FrameError) {
        let counter = match error {
            FrameError::Length { .. } => &mut self.refused.length,
            FrameError::Checksum { .. } => &mut self.refused.checksum,
            FrameError::Version { .. } => &mut self.refused.version,
            FrameError::Session { .. } => &mut self.refused.session,
            FrameError::Time { .. } => &mut self.refused.time,
            FrameError::Value { .. } => &mut self.refused.value,
        };
        *counter += 1;
    }

    /// A frame was decoded at `now_ns`. Says whether to act on it.
    ///
    /// A sender that started again counts from zero: its sequence numbers go
    /// back while its clock goes on. Such a frame is the newest, and counting
    /// of losses starts again with it. A frame with a higher number that was
    /// sent earlier is left from before the restart, or replayed: late.
    pub fn received(&mut self, frame: &LinkFrame, now_ns: i64) -> Arrival {
        let left_over = self.newest.is_some_and(|newest| {
            behind(newest.sequence, frame.sequence) && frame.sent_ns < newest.sent_ns
        });
        if left_over {
            self.refused.late += 1;
            return Arrival::Late;
        }
        let restarted = self.newest.is_some_and(|newest| {
            behind(frame.sequence, newest.sequence) && frame.sent_ns > newest.sent_ns
        });
        if restarted {
            self.window.restart();
            self.transit_ns = None;
        }
        match self.window.arrived(frame.sequence, now_ns) {
            Fate::Replayed => {
                self.refused.replayed += 1;
                Arrival::Replayed
            }
            Fate::Late => {
                self.time_transit(frame, now_ns);
                self.refused.late += 1;
                Arrival::Late
            }
            Fate::Newest => {
                self.time_transit(frame, now_ns);
                self.received += 1;
                self.delay_ns = Some(now_ns.saturating_sub(frame.sent_ns));
                if let Some(echo) = frame.echo {
                    let round_trip = now_ns
                        .saturating_sub(echo.sent_ns)
                        .saturating_sub(i64::from(echo.held_ns));
                    if round_trip >= 0 {
                        self.round_trip_ns = Some(round_trip);
                    }
                }
                self.newest = Some(Newest {
                    sequence: frame.sequence,
                    sent_ns: frame.sent_ns,
                    arrived_ns: now_ns,
                });
                Arrival::Newest
            }
        }
    }

    fn time_transit(&mut self, frame: &LinkFrame, now_ns: i64) {
        let transit = now_ns.saturating_sub(frame.sent_ns);
        if let Some(before) = self.transit_ns {
            let difference = transit.saturating_sub(before).unsigned_abs() as f64;
            self.jitter += (difference - self.jitter) / 16.0;
        }
        self.transit_ns = Some(transit);
    }

    /// What to echo in a frame sent at `now_ns`; `None` before the first
    /// arrival, and once it has been held for longer than the field can say (4.3 s).
    pub fn echo(&self, now_ns: i64) -> Option<Echo> {
        let newest = self.newest?;
        let held = now_ns.saturating_sub(newest.arrived_ns);
        Some(Echo {
            sent_ns: newest.sent_ns,
            held_ns: u32::try_from(held).ok()?,
        })
    }

    /// Time since the newest frame arrived \[s\]; infinite before the first.
    pub fn silence(&self, now_ns: i64) -> f64 {
        self.newest.map_or(f64::INFINITY, |newest| {
            seconds(now_ns.saturating_sub(newest.arrived_ns))
        })
    }

    /// What is known at `now_ns`.
    pub fn measure(&mut self, now_ns: i64) -> LinkMeasurement {
        let optional = |nanos: Option<i64>| nanos.map_or(f64::NAN, seconds);
        LinkMeasurement {
            round_trip: optional(self.round_trip_ns),
            delay: optional(self.delay_ns),
            jitter: self.jitter * 1e-9,
            loss: self.window.loss(now_ns),
            silence: self.silence(now_ns),
            age: self.newest.map_or(f64::INFINITY, |newest| {
                seconds(now_ns.saturating_sub(newest.sent_ns))
            }),
            sent: self.sent,
            received: self.received,
            lost: self.window.lost(),
            refused: self.refused,
        }
    }
}

/// Whether sequence number `a` comes before `b`, with wrapping (RFC 1982).
pub(crate) fn behind(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

#[cfg(test)]
mod tests;

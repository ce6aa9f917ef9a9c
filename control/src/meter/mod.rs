//! What one end of the link measures of it: from what arrives, never from
//! what is configured.
//!
//! * round trip: now − echo − held, exact to the nanosecond, no clocks need agree;
//! * how far the clocks are apart, from the echoes ([`ClockEstimate`]);
//! * one way: now − sent, with that offset taken out;
//! * jitter: RFC 3550, section 6.4.1, J ← J + (|D| − J)/16;
//! * loss: by sequence number over a sliding second;
//! * order: only frames newer than the newest acted on are acted on.

mod clock;
mod loss;

pub use clock::ClockEstimate;
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
        self.length + self.time + self.value + self.replayed + self.late
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
    /// The other end's clock, as far as it is known.
    pub clock: ClockMeasurement,
    /// Frames sent since the start.
    pub sent: u64,
    /// Frames received and acted on since the start.
    pub received: u64,
    /// Frames lost since the start.
    pub lost: u64,
    /// Frames received and not acted on since the start.
    pub refused: RefusedCounts,
}

/// What is known of the other end's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockMeasurement {
    /// It is ahead of this one by so much \[s\].
    pub offset: f64,
    /// It is faster than this one by so much \[1\].
    pub drift: f64,
    /// By how much the offset can be wrong \[s\]; infinite before the first echo.
    pub error: f64,
    /// How often one of both jumped.
    pub jumps: u64,
}

#[derive(Clone, Copy, Debug)]
struct Newest {
    sent_ns: i64,
    arrived_ns: i64,
}

/// Measures one end of the link. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct LinkMeter {
    newest: Option<Newest>,
    /// What is echoed: the sender's stamp of the frame that arrived last, of whatever
    /// age, and when it arrived. Without an echo of frames that are refused for
    /// their time two clocks that jumped apart would never meet again \[ns\].
    heard: Option<(i64, i64)>,
    /// Arrival minus sending of the frame that arrived last, in whatever order [ns].
    transit_ns: Option<i64>,
    round_trip_ns: Option<i64>,
    delay_ns: Option<i64>,
    /// [ns]
    jitter: f64,
    window: LossWindow,
    clock: ClockEstimate,
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
            heard: None,
            transit_ns: None,
            round_trip_ns: None,
            delay_ns: None,
            jitter: 0.0,
            window: LossWindow::new(),
            clock: ClockEstimate::default(),
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
            FrameError::Time { .. } => &mut self.refused.time,
            FrameError::Value { .. } => &mut self.refused.value,
        };
        *counter += 1;
    }

    /// The sender was started anew, or is another one: its numbers, its clock and what
    /// it echoes begin again. Its clock is `clock_ahead_ns` ahead, to `error_ns`.
    pub fn restart(&mut self, now_ns: i64, clock_ahead_ns: i64, error_ns: i64) {
        self.window.restart();
        self.newest = None;
        self.heard = None;
        self.transit_ns = None;
        self.round_trip_ns = None;
        self.delay_ns = None;
        self.jitter = 0.0;
        self.clock.begin(now_ns, clock_ahead_ns, error_ns);
    }

    /// How far the sender's clock is ahead at `now_ns` \[ns\].
    pub fn clock_ahead_ns(&self, now_ns: i64) -> i64 {
        self.clock.offset_ns(now_ns)
    }

    /// Learns what a frame tells of the sender's clock, and puts into it when it was
    /// sent by the clock of this end.
    pub fn synchronise(&mut self, frame: &mut LinkFrame, now_ns: i64) {
        self.heard = Some((frame.stamp_ns, now_ns));
        if let Some(echo) = frame.echo {
            let held_ns = i64::from(echo.held_ns);
            let there_ns = frame.stamp_ns.saturating_sub(held_ns);
            self.clock
                .observe(echo.sent_ns, there_ns, frame.stamp_ns, now_ns);
        }
        frame.sent_ns = frame.stamp_ns.saturating_sub(self.clock.offset_ns(now_ns));
    }

    /// A frame was decoded at `now_ns`. Says whether to act on it.
    pub fn received(&mut self, frame: &LinkFrame, now_ns: i64) -> Arrival {
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
        let (stamp_ns, arrived_ns) = self.heard?;
        let held = now_ns.saturating_sub(arrived_ns);
        Some(Echo {
            sent_ns: stamp_ns,
            held_ns: u32::try_from(held).ok()?,
        })
    }

    /// Round trip \[s\]: the newest measurement.
    pub fn round_trip(&self) -> Option<f64> {
        self.round_trip_ns.map(seconds)
    }

    /// When the newest frame arrived \[ns\].
    pub fn arrived_ns(&self) -> Option<i64> {
        self.newest.map(|newest| newest.arrived_ns)
    }

    /// Time since the newest frame arrived \[s\]; infinite before the first.
    pub fn silence(&self, now_ns: i64) -> f64 {
        self.newest
            .map_or(f64::INFINITY, |newest| passed(newest.arrived_ns, now_ns))
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
            clock: ClockMeasurement {
                offset: seconds(self.clock.offset_ns(now_ns)),
                drift: self.clock.drift(),
                error: self.clock.error(),
                jumps: self.clock.jumps(),
            },
            sent: self.sent,
            received: self.received,
            lost: self.window.lost(),
            refused: self.refused,
        }
    }
}

/// Frames may arrive by so much after the step that takes them began \[ns\].
const LATEST_ARRIVAL: i64 = 50_000_000;

/// Time since then \[s\]; infinite where then is ahead: the clock jumped back, and
/// nobody knows.
pub(crate) fn passed(then_ns: i64, now_ns: i64) -> f64 {
    let passed_ns = now_ns.saturating_sub(then_ns);
    match passed_ns < -LATEST_ARRIVAL {
        true => f64::INFINITY,
        false => seconds(passed_ns),
    }
}

/// Whether sequence number `a` comes before `b`, with wrapping (RFC 1982).
pub(crate) fn behind(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

#[cfg(test)]
mod tests;

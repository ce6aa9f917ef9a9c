//! The delay that the damping has to pay for.

use crate::delay::Received;

/// With this time constant a delay that has become shorter is believed \[s\].
const FORGET: f64 = 5.0;
/// Beyond what was measured last \[s\]: frames come every 2 ms, and some are lost.
const MARGIN: f64 = 0.02;

/// τ, the longest round trip of late.
///
/// It grows at once with what is measured, or with twice the age of what is to be acted on, as
/// the other end, whose damping has to grow, too, measures that a round trip later. So what is
/// older than half of what τ was then waits: the delay that is allowed grows by a second a
/// second. The first one is allowed at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredDelay {
    least: f64,
    longest: f64,
    /// τ \[s\]; `None` before the first packet.
    damped: Option<f64>,
    /// What the other end can know of it \[s\].
    allowed: f64,
}

impl MeasuredDelay {
    /// Between `least` and `longest` \[s\].
    pub fn between(least: f64, longest: f64) -> MeasuredDelay {
        MeasuredDelay {
            least,
            longest: longest.max(least),
            damped: None,
            allowed: least,
        }
    }

    /// τ \[s\].
    pub fn round_trip(&self) -> f64 {
        self.damped.unwrap_or(self.least)
    }

    /// `received` after `dt` \[s\], if it may be acted on.
    pub fn step(&mut self, dt: f64, received: Option<Received>) -> Option<Received> {
        let received = received?;
        let measured = received.round_trip.max(2.0 * received.age) + MARGIN;
        let measured = measured.clamp(self.least, self.longest);
        match self.damped {
            None => self.allowed = measured,
            Some(_) => self.allowed += dt,
        }
        let before = self.damped.unwrap_or(measured);
        let forgotten = before + (measured - before) * dt / FORGET;
        let damped = measured.max(forgotten);
        self.damped = Some(damped);
        self.allowed = self.allowed.min(damped);
        (received.age <= 0.5 * self.allowed).then_some(received)
    }
}

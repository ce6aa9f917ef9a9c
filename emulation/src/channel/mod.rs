//! The channel emulator: what a space link does to frames, from a seed.
//!
//! In the order that a frame meets them: blackout, loss, queue and bandwidth,
//! delay with jitter, reordering, duplication. Time is an argument; the same
//! seed and the same calls give the same bytes at the same times. Everything
//! is allocated when the channel is made.

mod config;

pub use config::{
    Bandwidth, Blackout, ChannelConfig, Jitter, LONGEST_DELAY, LinkConfig, Loss, Reordering,
};

use crate::random::Random;
use ferntast_model::{ParameterError, check};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Longest frame that a channel carries \[bytes\].
pub const LONGEST_FRAME: usize = 256;
/// Frames that a channel holds at a time: four seconds at 500 Hz, each twice.
pub const CAPACITY: usize = 4096;

/// What became of a frame that was pushed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pushed {
    /// It is on its way.
    Accepted,
    /// It is lost.
    Lost,
    /// It is lost in a blackout.
    Blackout,
    /// It is dropped: the queue before the transmission is full.
    QueueFull,
    /// It is dropped: longer than [`LONGEST_FRAME`].
    TooLong,
    /// It is dropped: [`CAPACITY`] frames are on their way.
    Full,
}

/// What a channel did, since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChannelCounts {
    /// Frames pushed.
    pub pushed: u64,
    /// Frames popped, copies included.
    pub popped: u64,
    /// Frames lost, outside blackouts.
    pub lost: u64,
    /// Frames lost in blackouts.
    pub blackout: u64,
    /// Frames dropped for want of room or for their length.
    pub dropped: u64,
    /// Frames held back.
    pub reordered: u64,
    /// Frames doubled.
    pub duplicated: u64,
}

/// When to release which slot: earliest first, equal times in order of pushing.
type Due = Reverse<(i64, u64, u16)>;

/// One direction of a link.
#[derive(Clone, Debug)]
pub struct Channel {
    config: ChannelConfig,
    random: Random,
    /// Frames on their way, and how long each is. Zeros, so that memory is taken
    /// when it is needed.
    /// Room for [`CAPACITY`] frames, taken from the heap when made, and filled when needed.
    slots: Vec<([u8; LONGEST_FRAME], u16)>,
    free: Vec<u16>,
    due: BinaryHeap<Due>,
    order: u64,
    first_ns: Option<i64>,
    /// When the transmission of all accepted frames ends [ns].
    sent_ns: i64,
    /// Latest release so far, of frames that keep their order [ns].
    released_ns: i64,
    bad: bool,
    /// Delay at the last frame, on its way to that of the configuration \[s\].
    delay: f64,
    /// When that frame came \[ns\].
    delay_ns: i64,
    counts: ChannelCounts,
}

/// Seconds that the delay changes in a second after it was set again. A delay
/// that grew at once would leave a silence as long as its growth, which is an
/// outage and no longer way.
const DELAY_RATE: f64 = 0.5;

impl Channel {
    /// A channel with nothing on its way.
    ///
    /// # Errors
    ///
    /// The first value of `config` that is out of bounds.
    pub fn new(config: ChannelConfig, seed: u64) -> Result<Channel, ParameterError> {
        config.validate()?;
        Ok(Channel {
            delay: config.delay,
            delay_ns: 0,
            config,
            random: Random::new(seed),
            slots: Vec::with_capacity(CAPACITY),
            free: Vec::with_capacity(CAPACITY),
            due: BinaryHeap::with_capacity(CAPACITY),
            order: 0,
            first_ns: None,
            sent_ns: i64::MIN,
            released_ns: i64::MIN,
            bad: false,
            counts: ChannelCounts::default(),
        })
    }

    /// What it did so far.
    pub fn counts(&self) -> ChannelCounts {
        self.counts
    }

    /// Frames on their way.
    pub fn in_flight(&self) -> usize {
        self.due.len()
    }

    /// From now on frames are delayed by `delay` \[s\], give or take a jitter of
    /// at most `jitter` \[s\], uniformly distributed, and lost independently with
    /// probability `loss`. The delay gets there by half a second a second.
    /// Allocates nothing.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds; everything stays as it was.
    pub fn retune(&mut self, delay: f64, jitter: f64, loss: f64) -> Result<(), ParameterError> {
        check("delay", delay, 0.0, LONGEST_DELAY, "s")?;
        check("jitter", jitter, 0.0, LONGEST_DELAY, "s")?;
        check("loss", loss, 0.0, 1.0, "-")?;
        self.config.delay = delay;
        self.config.jitter = (jitter > 0.0).then_some(Jitter::Uniform { half_width: jitter });
        self.config.loss = (loss > 0.0).then_some(Loss::Independent { probability: loss });
        Ok(())
    }

    /// What it does to frames now.
    pub fn config(&self) -> &ChannelConfig {
        &self.config
    }

    /// Sends `frame` at `now_ns`.
    pub fn push(&mut self, now_ns: i64, frame: &[u8]) -> Pushed {
        self.counts.pushed += 1;
        let outcome = self.accept(now_ns, frame);
        match outcome {
            Pushed::Accepted => {}
            Pushed::Lost => self.counts.lost += 1,
            Pushed::Blackout => self.counts.blackout += 1,
            Pushed::QueueFull | Pushed::TooLong | Pushed::Full => self.counts.dropped += 1,
        }
        outcome
    }

    fn accept(&mut self, now_ns: i64, frame: &[u8]) -> Pushed {
        if frame.len() > LONGEST_FRAME {
            return Pushed::TooLong;
        }
        let first_ns = *self.first_ns.get_or_insert(now_ns);
        // The chain moves on through a blackout too.
        let lost = self.is_lost();
        let time = (now_ns - first_ns) as f64 * 1e-9;
        if self.config.blackout.iter().any(|own| own.covers(time)) {
            return Pushed::Blackout;
        }
        let Some(sent_ns) = self.transmit(now_ns, frame.len()) else {
            return Pushed::QueueFull;
        };
        if lost {
            return Pushed::Lost;
        }
        let mut release_ns = sent_ns + nanoseconds(self.delay(now_ns));
        let held_back = self
            .config
            .reordering
            .filter(|own| self.random.chance(own.probability));
        if let Some(own) = held_back {
            release_ns += nanoseconds(own.hold_back);
            self.counts.reordered += 1;
        } else {
            if !self.config.overtaking {
                release_ns = release_ns.max(self.released_ns);
            }
            self.released_ns = self.released_ns.max(release_ns);
        }
        let twice = self.config.duplication > 0.0 && self.random.chance(self.config.duplication);
        if !self.store(release_ns, frame) {
            return Pushed::Full;
        }
        if twice && self.store(release_ns, frame) {
            self.counts.duplicated += 1;
        }
        Pushed::Accepted
    }

    fn is_lost(&mut self) -> bool {
        match self.config.loss {
            None => false,
            Some(Loss::Independent { probability }) => self.random.chance(probability),
            Some(Loss::GilbertElliott {
                good_to_bad,
                bad_to_good,
                loss_in_good,
                loss_in_bad,
            }) => {
                let change = if self.bad { bad_to_good } else { good_to_bad };
                self.bad ^= self.random.chance(change);
                let probability = if self.bad { loss_in_bad } else { loss_in_good };
                self.random.chance(probability)
            }
        }
    }

    /// When the last bit is in; `None` when the queue is full.
    fn transmit(&mut self, now_ns: i64, bytes: usize) -> Option<i64> {
        let Some(own) = self.config.bandwidth else {
            return Some(now_ns);
        };
        let per_byte = 8.0 / own.rate;
        let start_ns = self.sent_ns.max(now_ns);
        let waiting = (start_ns - now_ns) as f64 * 1e-9 / per_byte;
        if waiting > f64::from(own.queue) {
            return None;
        }
        let cost = bytes as f64 + f64::from(own.overhead);
        self.sent_ns = start_ns + nanoseconds(cost * per_byte);
        Some(self.sent_ns)
    }

    fn delay(&mut self, now_ns: i64) -> f64 {
        let passed = (now_ns.saturating_sub(self.delay_ns)) as f64 * 1e-9;
        let step = (passed * DELAY_RATE).clamp(0.0, 0.05);
        self.delay += (self.config.delay - self.delay).clamp(-step, step);
        self.delay_ns = now_ns;
        let jitter = match self.config.jitter {
            None => 0.0,
            Some(Jitter::Uniform { half_width }) => {
                half_width * (2.0 * self.random.uniform() - 1.0)
            }
            Some(Jitter::Normal { deviation }) => deviation * self.random.normal(),
            Some(Jitter::Exponential { mean }) => mean * self.random.exponential(),
        };
        (self.delay + jitter).max(0.0)
    }

    fn store(&mut self, release_ns: i64, frame: &[u8]) -> bool {
        let index = match self.free.pop() {
            Some(index) => index,
            None if self.slots.len() == CAPACITY => return false,
            None => {
                self.slots.push(([0; LONGEST_FRAME], 0));
                (self.slots.len() - 1) as u16
            }
        };
        let Some((slot, length)) = self.slots.get_mut(usize::from(index)) else {
            return false;
        };
        slot[..frame.len()].copy_from_slice(frame);
        *length = frame.len() as u16;
        self.due.push(Reverse((release_ns, self.order, index)));
        self.order += 1;
        true
    }

    /// When the next frame arrives \[ns\]; `None` while none is on its way.
    pub fn next_ns(&self) -> Option<i64> {
        self.due
            .peek()
            .map(|Reverse((release_ns, _, _))| *release_ns)
    }

    /// Receives the earliest frame that arrived by `now_ns` into `buffer`:
    /// its length and when exactly it arrived \[ns\]. Call until `None`.
    ///
    /// A `buffer` shorter than the frame gets its beginning.
    pub fn pop(&mut self, now_ns: i64, buffer: &mut [u8]) -> Option<(usize, i64)> {
        if self.next_ns()? > now_ns {
            return None;
        }
        let Reverse((release_ns, _, index)) = self.due.pop()?;
        let (slot, length) = self.slots.get(usize::from(index))?;
        let length = usize::from(*length).min(buffer.len());
        buffer[..length].copy_from_slice(&slot[..length]);
        self.free.push(index);
        self.counts.popped += 1;
        Some((length, release_ns))
    }
}

fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

#[cfg(test)]
mod tests;

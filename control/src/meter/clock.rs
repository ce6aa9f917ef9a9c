//! How far the other end's clock is from this one's, from the echoes.
//!
//! Sent at T₁ here, received at T₂ and answered at T₃ there, received at T₄ here:
//! offset θ = ((T₂ − T₁) + (T₃ − T₄))/2, delay δ = (T₄ − T₁) − (T₃ − T₂)
//! (RFC 5905, section 8). Both ways take some time, so θ is off by δ/2 at most; of
//! each second the answer with the least delay counts (clock filter, section 10),
//! and a line through those of the last [`SLOTS`] seconds is offset and drift.
//!
//! What a path has of delay in one direction only is not to be told from an offset,
//! here as with any two-way method: half of it.
//!
//! An answer that is further off than its delay allows cannot be: a clock jumped.
//! After [`SURE`] of those in a row the estimate begins anew.

use crate::seconds;

/// Seconds that are remembered.
pub const SLOTS: usize = 16;
/// From one slot to the next \[ns\].
const SLOT: i64 = 1_000_000_000;
/// Answers in a row that say that a clock jumped.
const SURE: u32 = 8;
/// What a step of a node and a drift of 1000 ppm may add to δ/2 \[ns\].
const MARGIN: i64 = 5_000_000;
/// An answer that took this much longer than the quickest has half of its weight \[s\].
const WIDTH: f64 = 0.5e-3;
/// No clock is as fast as this: what is beyond is noise.
const LARGEST_DRIFT: f64 = 1e-3;
/// Slots that a drift needs.
const DRIFT_NEEDS: usize = 4;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    at_ns: i64,
    offset_ns: i64,
    delay_ns: i64,
}

/// The line through the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Line {
    at_ns: i64,
    offset_ns: i64,
    /// Seconds a second.
    drift: f64,
    /// \[ns\]
    error_ns: i64,
}

/// Offset and drift of the other end's clock. Allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct ClockEstimate {
    slots: [Option<Sample>; SLOTS],
    line: Option<Line>,
    suspicious: u32,
    jumps: u64,
}

impl ClockEstimate {
    /// Begins anew with a clock that is `offset_ns` ahead, as a handshake told at
    /// `now_ns`, give or take `error_ns`.
    pub fn begin(&mut self, now_ns: i64, offset_ns: i64, error_ns: i64) {
        self.slots = [None; SLOTS];
        self.suspicious = 0;
        self.put(Sample {
            at_ns: now_ns,
            offset_ns,
            delay_ns: error_ns.saturating_mul(2),
        });
    }

    /// An answer came: sent, received, answered, received.
    pub fn observe(&mut self, t1: i64, t2: i64, t3: i64, t4: i64) {
        let (there, back) = (t2.saturating_sub(t1), t3.saturating_sub(t4));
        let sample = Sample {
            at_ns: t4,
            offset_ns: there.midpoint(back),
            delay_ns: t4.saturating_sub(t1).saturating_sub(t3.saturating_sub(t2)),
        };
        if self.line.is_some_and(|line| !possible(&line, &sample)) {
            self.suspicious += 1;
            if self.suspicious < SURE {
                return;
            }
            self.jumps += 1;
            self.slots = [None; SLOTS];
        }
        self.suspicious = 0;
        self.put(sample);
    }

    fn put(&mut self, sample: Sample) {
        if sample.delay_ns < 0 {
            return;
        }
        let slot = |at_ns: i64| at_ns.div_euclid(SLOT);
        let place = slot(sample.at_ns).rem_euclid(SLOTS as i64) as usize;
        let Some(own) = self.slots.get_mut(place) else {
            return;
        };
        let better = own.is_none_or(|own| {
            slot(own.at_ns) != slot(sample.at_ns) || sample.delay_ns < own.delay_ns
        });
        if better {
            *own = Some(sample);
            self.fit(sample.at_ns);
        }
    }

    /// Least squares with less weight for what took longer.
    fn fit(&mut self, now_ns: i64) {
        let oldest_ns = now_ns.saturating_sub(SLOTS as i64 * SLOT);
        let fresh = |own: &&Sample| own.at_ns >= oldest_ns;
        let samples = || self.slots.iter().flatten().filter(fresh);
        let Some(best) = samples().min_by_key(|own| own.delay_ns) else {
            return;
        };
        let (mut count, mut sums) = (0, [0.0; 5]);
        for own in samples() {
            let longer = seconds(own.delay_ns.saturating_sub(best.delay_ns)) / WIDTH;
            let weight = 1.0 / (1.0 + longer * longer);
            // Relative to the best: numbers stay small.
            let x = seconds(own.at_ns.saturating_sub(best.at_ns));
            let y = own.offset_ns.saturating_sub(best.offset_ns) as f64;
            let terms = [1.0, x, x * x, y, x * y];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += weight * term;
            }
            count += usize::from(longer < 4.0);
        }
        let [w, x, xx, y, xy] = sums;
        let spread = w * xx - x * x;
        let drift = match count >= DRIFT_NEEDS && spread > 0.0 {
            true => ((w * xy - x * y) / spread * 1e-9).clamp(-LARGEST_DRIFT, LARGEST_DRIFT),
            false => 0.0,
        };
        let at_best = match count >= DRIFT_NEEDS {
            true => (y - drift * 1e9 * x) / w,
            false => 0.0,
        };
        self.line = Some(Line {
            at_ns: best.at_ns,
            offset_ns: best.offset_ns.saturating_add(at_best as i64),
            drift,
            error_ns: best.delay_ns / 2,
        });
    }

    /// The other clock less this one at `now_ns` \[ns\]; zero as long as nothing is known.
    pub fn offset_ns(&self, now_ns: i64) -> i64 {
        self.line.map_or(0, |line| line.at(now_ns))
    }

    /// By how much the other clock is faster \[1\].
    pub fn drift(&self) -> f64 {
        self.line.map_or(0.0, |line| line.drift)
    }

    /// By how much the offset can be wrong at most, where the clocks run evenly
    /// \[s\]; infinite as long as nothing is known.
    pub fn error(&self) -> f64 {
        self.line
            .map_or(f64::INFINITY, |line| seconds(line.error_ns))
    }

    /// How often a clock jumped.
    pub fn jumps(&self) -> u64 {
        self.jumps
    }
}

impl Line {
    fn at(&self, now_ns: i64) -> i64 {
        let passed = now_ns.saturating_sub(self.at_ns) as f64;
        self.offset_ns.saturating_add((self.drift * passed) as i64)
    }
}

/// Whether both clocks can have run evenly since.
fn possible(line: &Line, sample: &Sample) -> bool {
    let difference = sample.offset_ns.saturating_sub(line.at(sample.at_ns));
    let passed_ns = sample.at_ns.saturating_sub(line.at_ns);
    let drift_ns = (LARGEST_DRIFT * passed_ns as f64) as i64;
    let ways_ns = (sample.delay_ns / 2).saturating_add(line.error_ns);
    let most_ns = ways_ns.saturating_add(drift_ns).saturating_add(MARGIN);
    sample.delay_ns >= 0 && difference.saturating_abs() <= most_ns
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const START: i64 = 1_700_000_000_000_000_000;
    const MS: f64 = 1e6;

    /// The other clock, and how long a frame takes each way.
    struct World {
        offset_s: f64,
        drift: f64,
        delay_ms: [f64; 2],
        jitter_ms: f64,
        random: u64,
    }

    impl World {
        fn there(&self, ns: i64) -> i64 {
            let passed = (ns - START) as f64;
            ns + (self.offset_s * 1e9) as i64 + (self.drift * passed) as i64
        }

        fn way(&mut self, way: usize) -> i64 {
            self.random = self
                .random
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let uniform = (self.random >> 11) as f64 / (1u64 << 53) as f64;
            ((self.delay_ms[way] + self.jitter_ms * uniform) * MS) as i64
        }

        /// `seconds` of answers, one every 10 ms, from `from` \[s\] on.
        fn run(&mut self, estimate: &mut ClockEstimate, from: f64, seconds: f64) -> i64 {
            let mut now = START + (from * 1e9) as i64;
            for step in 0..(seconds * 100.0) as i64 {
                let t1 = START + (from * 1e9) as i64 + step * 10_000_000;
                let t2 = t1 + self.way(0);
                let t3 = t2 + 1_300_000;
                let t4 = t3 + self.way(1);
                estimate.observe(t1, self.there(t2), self.there(t3), t4);
                now = t4;
            }
            now
        }
    }

    #[test]
    fn ten_hours_of_100_ppm_ten_seconds_apart_are_followed() {
        let mut world = World {
            offset_s: 10.0,
            drift: 100e-6,
            delay_ms: [150.0, 150.0],
            jitter_ms: 4.0,
            random: 1,
        };
        let mut estimate = ClockEstimate::default();
        // Of ten hours a minute now and then: between them the link was away.
        for hour in 0..10 {
            let from = 3600.0 * f64::from(hour);
            let now = world.run(&mut estimate, from, 60.0);
            let error = (estimate.offset_ns(now) - (world.there(now) - now)) as f64 / MS;
            assert!(error.abs() < 0.3, "{error} ms in hour {hour}");
            let drift = estimate.drift() * 1e6;
            assert!((drift - 100.0).abs() < 30.0, "{drift} ppm in hour {hour}");
        }
    }

    #[test]
    fn a_jump_is_followed_after_some_answers_and_counted() {
        for jump in [10.0, -10.0, 0.2, -0.2] {
            let mut world = World {
                offset_s: 0.0,
                drift: 0.0,
                delay_ms: [10.0, 10.0],
                jitter_ms: 1.0,
                random: 2,
            };
            let mut estimate = ClockEstimate::default();
            world.run(&mut estimate, 0.0, 30.0);
            world.offset_s = jump;
            let now = world.run(&mut estimate, 30.0, 0.2);
            assert_eq!(estimate.jumps(), 1, "{jump}");
            let error = (estimate.offset_ns(now) - (world.there(now) - now)) as f64 / MS;
            assert!(error.abs() < 1.0, "{error} ms after {jump} s");
        }
    }

    #[test]
    fn a_path_that_becomes_longer_is_no_jump() {
        let mut world = World {
            offset_s: 3.0,
            drift: 0.0,
            delay_ms: [10.0, 10.0],
            jitter_ms: 1.0,
            random: 3,
        };
        let mut estimate = ClockEstimate::default();
        world.run(&mut estimate, 0.0, 20.0);
        world.delay_ms = [300.0, 300.0];
        let now = world.run(&mut estimate, 20.0, 40.0);
        assert_eq!(estimate.jumps(), 0);
        let error = (estimate.offset_ns(now) - (world.there(now) - now)) as f64 / MS;
        assert!(error.abs() < 1.0, "{error} ms");
    }

    #[test]
    fn one_strange_answer_changes_nothing() {
        let mut world = World {
            offset_s: 1.0,
            drift: 0.0,
            delay_ms: [5.0, 5.0],
            jitter_ms: 0.0,
            random: 4,
        };
        let mut estimate = ClockEstimate::default();
        let now = world.run(&mut estimate, 0.0, 5.0);
        let before = estimate.offset_ns(now);
        estimate.observe(
            now,
            now + 90_000_000_000,
            now + 90_000_000_000,
            now + 1_000_000,
        );
        assert_eq!(estimate.offset_ns(now), before);
        assert_eq!(estimate.jumps(), 0);
    }

    proptest! {
        /// Never further off than half of the round trip, whatever the path does.
        #[test]
        fn the_error_is_within_half_a_round_trip(
            offset_s in -10.0..10.0f64,
            drift in -100e-6..100e-6f64,
            up in 0.1..500.0f64,
            down in 0.1..500.0f64,
            jitter_ms in 0.0..50.0f64,
            random: u64,
        ) {
            let mut world = World { offset_s, drift, delay_ms: [up, down], jitter_ms, random };
            let mut estimate = ClockEstimate::default();
            let now = world.run(&mut estimate, 0.0, 25.0);
            let error = (estimate.offset_ns(now) - (world.there(now) - now)) as f64 / MS;
            prop_assert!(error.abs() <= (up - down).abs() / 2.0 + jitter_ms / 2.0 + 2.0, "{} ms", error);
            prop_assert_eq!(estimate.jumps(), 0);
        }

        #[test]
        fn no_numbers_panic(times in proptest::collection::vec(any::<[i64; 4]>(), 0..50), now: i64) {
            let mut estimate = ClockEstimate::default();
            for [t1, t2, t3, t4] in times {
                estimate.observe(t1, t2, t3, t4);
                let _ = (estimate.offset_ns(now), estimate.error());
            }
        }
    }
}

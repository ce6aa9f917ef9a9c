//! Which way to read all joints explains most.

use super::MIN_FALL;
use super::reading::Reading;
use super::samples::Samples;

/// By how much the logarithms rise if one part of a reading is taken back, for that to stay.
const MIN_PART: f64 = 0.2;
/// What a part has to explain for a reading with it to be better than one without.
const PART: f64 = 0.02;
/// Smallest error that counts, as a share of the torque: below, friction has more to say.
const LEAST: f64 = 0.02;

impl Samples<'_> {
    /// Sum of the logarithms of the joints' errors over their torques; of readings that explain as
    /// much, as of an arm and its mirror image, that with fewer parts is less.
    pub fn score(&self, readings: &[Reading]) -> f64 {
        let each = self.errors(readings).into_iter().zip(&self.sizes);
        let each = each.zip(&self.counts).filter(|(_, counts)| **counts);
        let each = each.map(|((error, size), _)| (error / size.max(1e-12)).max(LEAST).ln());
        let parts: usize = (readings.iter().enumerate())
            .map(|(at, own)| own.parts(at))
            .sum();
        each.sum::<f64>() + PART * parts as f64
    }

    /// The way to read all joints that explains most, from where they are as they are read, or all the
    /// other way round.
    pub fn search(&self, as_read: &[Reading]) -> Vec<Reading> {
        let turned = |direction: f64, torque: f64| -> Vec<Reading> {
            let each = as_read.iter().map(|own| Reading {
                direction,
                torque,
                ..*own
            });
            each.collect()
        };
        let starts = [as_read.to_vec(), turned(1.0, -1.0), turned(-1.0, -1.0)];
        let found = starts.map(|start| self.search_from(start));
        let [first, others @ ..] = found;
        let (mut best, mut score) = first;
        for (readings, own) in others {
            if own < score - MIN_PART {
                (best, score) = (readings, own);
            }
        }
        self.without_idle_parts(best, score)
    }

    /// One joint after the other in the other way that explains most, until none explains much.
    fn search_from(&self, start: Vec<Reading>) -> (Vec<Reading>, f64) {
        let mut score = self.score(&start);
        let mut best = start;
        for _ in 0..2 * self.joints {
            let tried = self.around(&best).into_iter();
            let tried = tried.map(|own| (self.score(&own), own));
            let least = tried.min_by(|a, b| a.0.total_cmp(&b.0));
            match least.filter(|(next, _)| *next < score - MIN_FALL) {
                Some((next, readings)) => (best, score) = (readings, next),
                None => break,
            }
        }
        (best, score)
    }

    /// Without the parts that explain nothing by themselves.
    fn without_idle_parts(&self, mut best: Vec<Reading>, mut score: f64) -> Vec<Reading> {
        for at in 0..self.joints {
            let own = best[at];
            let idle = [
                Reading { quarters: 0, ..own },
                Reading {
                    direction: 1.0,
                    torque: own.direction * own.torque,
                    ..own
                },
                Reading {
                    torque: own.direction,
                    ..own
                },
            ];
            for simpler in idle {
                let mut tried = best.clone();
                tried[at] = simpler;
                if tried != best {
                    let without = self.score(&tried);
                    if without < score + MIN_PART {
                        (best, score) = (tried, without);
                    }
                }
            }
        }
        best
    }

    /// Every way to read all joints that differs in one, or in the order or the directions of two.
    fn around(&self, readings: &[Reading]) -> Vec<Vec<Reading>> {
        let mut all = Vec::new();
        for (at, own) in readings.iter().enumerate() {
            for other in own.others(self.kinds[at]) {
                let mut tried = readings.to_vec();
                tried[at] = other;
                all.push(tried);
            }
            for with in 0..at {
                let mut tried = readings.to_vec();
                let [one, two] = [readings[at].torque_of, readings[with].torque_of];
                (tried[at].torque_of, tried[with].torque_of) = (two, one);
                all.push(tried.clone());
                let [one, two] = [readings[at].position_of, readings[with].position_of];
                (tried[at].position_of, tried[with].position_of) = (two, one);
                all.push(tried);
                let mut tried = readings.to_vec();
                for own in [at, with] {
                    tried[own].direction *= -1.0;
                    tried[own].torque *= -1.0;
                }
                all.push(tried);
            }
        }
        all
    }
}

//! Numbers of a session of any length, in memory of a fixed size.

/// So many numbers are held at most.
const MOST: usize = 1 << 13;

/// Evenly spaced ones of all numbers that were given: all of them at first; when
/// there are too many every second is dropped, and half as many taken from then on.
#[derive(Clone, Debug)]
pub struct Thinned {
    kept: Vec<f64>,
    /// One of so many is kept.
    stride: usize,
    skipped: usize,
}

impl Default for Thinned {
    fn default() -> Self {
        Thinned {
            kept: Vec::with_capacity(MOST),
            stride: 1,
            skipped: 0,
        }
    }
}

impl Thinned {
    /// Takes one more.
    pub fn push(&mut self, value: f64) {
        self.skipped += 1;
        if self.skipped < self.stride {
            return;
        }
        self.skipped = 0;
        if self.kept.len() == MOST {
            let mut even = false;
            self.kept.retain(|_| {
                even = !even;
                even
            });
            self.stride *= 2;
        }
        self.kept.push(value);
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        *self = Thinned::default();
    }

    /// Those that are held, in any order.
    pub fn values(&mut self) -> &mut [f64] {
        &mut self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_stays_and_quantiles_too() {
        let mut thinned = Thinned::default();
        for k in 0..1_000_000 {
            thinned.push(f64::from(k));
        }
        let values = thinned.values();
        assert!(
            (MOST / 2..=MOST).contains(&values.len()),
            "{}",
            values.len()
        );
        values.sort_by(f64::total_cmp);
        let median = values[values.len() / 2];
        assert!((median - 500_000.0).abs() < 1000.0, "{median}");
        thinned.clear();
        thinned.push(1.0);
        assert_eq!(thinned.values(), [1.0]);
    }
}

//! The latest samples of a signal, indexed from its first sample.

use crate::numerics::filter::Kernel;

/// Samples kept when old ones are dropped.
const KEPT_SAMPLES: usize = 2048;

/// A signal of which only the end is kept.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    dropped: usize,
    values: Vec<f64>,
}

impl History {
    /// Adds a sample; old ones are dropped now and then.
    pub(super) fn push(&mut self, value: f64) {
        if self.values.len() >= 2 * KEPT_SAMPLES {
            let dropped = self.values.len() - KEPT_SAMPLES;
            self.values.drain(..dropped);
            self.dropped += dropped;
        }
        self.values.push(value);
    }

    /// Number of samples since the first.
    pub(super) fn len(&self) -> usize {
        self.dropped + self.values.len()
    }

    /// The signal through `kernel` at sample `at`, which must not be long ago.
    pub(super) fn filtered(&self, kernel: &Kernel, at: usize) -> f64 {
        kernel.at(&self.values, at.saturating_sub(self.dropped))
    }

    /// Sample `at`, zero if it is not kept.
    pub(super) fn at(&self, at: usize) -> f64 {
        at.checked_sub(self.dropped)
            .and_then(|at| self.values.get(at))
            .copied()
            .unwrap_or(0.0)
    }
}

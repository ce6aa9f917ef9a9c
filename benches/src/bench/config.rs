//! What a recording is to be like.

use ferntast_emulation::random::Random;

use super::{BenchError, Hideable, Stream, random};

/// What a recording is to be like. The same configuration gives the same bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchConfig<Hidden, Motion> {
    /// Decides parameters, dates, temperatures, random motion and noise.
    pub seed: u64,
    /// Effects in the truth that the believed model lacks; empty: nothing is
    /// hidden. None twice, at most four.
    pub hidden: Vec<Hidden>,
    /// Size of the hidden effects, 0.05 … 2; each bench says how far they stand
    /// out from the filtered noise at 1.
    pub strength: f64,
    /// Sessions on different dates and at different temperatures, 1 … 32.
    pub sessions: usize,
    /// Motion of the sessions; session n moves by `motions[n % motions.len()]`.
    pub motions: Vec<Motion>,
    /// Sensor noise, as a factor on its usual size, 0 … 10. At 0 nothing is quantised either.
    pub noise: f64,
    /// How much parameters differ between sessions, as a factor on what each
    /// bench has for usual, 0 … 10.
    pub scatter: f64,
}

impl<Hidden, Motion: Default> Default for BenchConfig<Hidden, Motion> {
    fn default() -> Self {
        BenchConfig {
            seed: 1,
            hidden: Vec::new(),
            strength: 1.0,
            sessions: 6,
            motions: vec![Motion::default()],
            noise: 1.0,
            scatter: 1.0,
        }
    }
}

impl<Hidden: Hideable, Motion> BenchConfig<Hidden, Motion> {
    /// Checks every value.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, or what of the hidden effects does not go together.
    pub fn validate(&self) -> Result<(), BenchError> {
        let within = |key, value: f64, low, high| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(BenchError::OutOfBounds {
                    key,
                    value,
                    low,
                    high,
                })
            }
        };
        within("strength", self.strength, 0.05, 2.0)?;
        within("sessions", self.sessions as f64, 1.0, 32.0)?;
        within("hidden.len()", self.hidden.len() as f64, 0.0, 4.0)?;
        within("noise", self.noise, 0.0, 10.0)?;
        within("scatter", self.scatter, 0.0, 10.0)?;
        if self.motions.is_empty() {
            return Err(BenchError::NoMotion);
        }
        for (index, &first) in self.hidden.iter().enumerate() {
            for &second in &self.hidden[..index] {
                if first == second {
                    return Err(BenchError::Twice { effect: first.id() });
                }
                if let Some(shared) = first.overlap(second) {
                    return Err(BenchError::Overlap {
                        first: second.id(),
                        second: first.id(),
                        shared,
                    });
                }
            }
        }
        Ok(())
    }

    /// Draws every hidden effect, each as if it were alone.
    pub(crate) fn draw_hidden<Effect>(
        &self,
        draw: impl Fn(Hidden, &mut Random) -> Effect,
    ) -> Vec<Effect> {
        let each = self.hidden.iter();
        each.map(|&hidden| {
            let mut random = random(self.seed, Stream::Effect, hidden.index());
            draw(hidden, &mut random)
        })
        .collect()
    }
}

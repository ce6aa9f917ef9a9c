//! Sines that sums in even bins hold.

/// Bins after which sine and cosine are computed anew.
const EXACT: usize = 256;

/// Sine and cosine of one wave number, turned on from bin to bin, and what they sum up to.
#[derive(Clone, Copy, Default)]
struct Wave {
    turn: (f64, f64),
    sine: f64,
    cosine: f64,
    a: f64,
    b: f64,
    ss: f64,
    cc: f64,
    sc: f64,
}

impl Wave {
    #[inline]
    fn add(&mut self, sum: f64, weight: f64) {
        let (sine, cosine) = (self.sine, self.cosine);
        let (step_sine, step_cosine) = self.turn;
        self.a += sum * sine;
        self.b += sum * cosine;
        self.ss += weight * sine * sine;
        self.cc += weight * cosine * cosine;
        self.sc += weight * sine * cosine;
        self.sine = sine * step_cosine + cosine * step_sine;
        self.cosine = cosine * step_cosine - sine * step_sine;
    }

    fn strength(&self) -> f64 {
        let Wave {
            a, b, ss, cc, sc, ..
        } = *self;
        let determinant = ss * cc - sc * sc;
        if determinant <= 1e-9 * ss * cc {
            return 0.0;
        }
        (a * a * cc - 2.0 * a * b * sc + b * b * ss) / determinant
    }
}

/// Weighted share of the bins' sum of squares that sine and cosine of each wave number
/// of `k` explain, per unit. Several at once: each is a chain of products that the processor
/// waits for, and does the others meanwhile.
pub(crate) fn strengths<const N: usize>(sums: &[(f64, f64)], width: f64, k: [f64; N]) -> [f64; N] {
    let mut waves = k.map(|k| Wave {
        turn: (k * width).sin_cos(),
        ..Wave::default()
    });
    for (block, sums) in sums.chunks(EXACT).enumerate() {
        let begin = (block * EXACT) as f64;
        for (wave, k) in waves.iter_mut().zip(k) {
            (wave.sine, wave.cosine) = (k * width * begin).sin_cos();
        }
        for (sum, weight) in sums {
            for wave in &mut waves {
                wave.add(*sum, *weight);
            }
        }
    }
    waves.map(|wave| wave.strength())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over 1000 bins: turned on from bin to bin as by the definition, and each wave number as
    /// if it were alone.
    #[test]
    fn what_is_there_is_explained_whole_and_several_at_once_as_each_alone() {
        let (width, there) = (1e-3, 140.0);
        let sums: Vec<(f64, f64)> = (0..1000)
            .map(|bin| {
                let weight = 1.0 + f64::from(bin % 7);
                let (sine, cosine) = (there * width * f64::from(bin)).sin_cos();
                (weight * (3.0 * sine - 4.0 * cosine), weight)
            })
            .collect();
        let squares: f64 = sums.iter().map(|(sum, weight)| sum * sum / weight).sum();
        let waves = [100.0, there, 141.0];
        let strong = strengths(&sums, width, waves);
        assert!((strong[1] / squares - 1.0).abs() < 1e-9, "{strong:?}");
        assert!(
            strong[0] < 0.1 * squares && strong[2] < strong[1],
            "{strong:?}"
        );
        let alone = waves.map(|wave| strengths(&sums, width, [wave])[0]);
        assert_eq!(strong, alone);
    }
}

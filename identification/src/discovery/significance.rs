//! What chance reaches in the same search: the residual with the signs of its blocks
//! of time turned at random.
//!
//! Within a block all stays as it is, so that the dependence of samples does; the
//! largest gain over the whole dictionary is taken each time, so that everything
//! that was searched is paid for (Westfall and Young 1993; the wild cluster
//! bootstrap's signs, Cameron, Gelbach and Miller 2008).

/// How often the signs are turned.
pub(super) const TURNS: usize = 999;

/// A sequence of numbers that a seed decides (SplitMix64, Steele et al. 2014).
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }
}

/// The largest gains by chance \[Nm²\], least first.
pub(super) struct Chance {
    largest: Vec<f64>,
}

impl Chance {
    /// From the products of each column with the residual, block by block, of
    /// columns of length one: `products[column * blocks + block]`.
    pub(super) fn new(products: &[f32], blocks: usize, seed: u64) -> Self {
        let mut sequence = Sequence(seed);
        let mut largest = Vec::with_capacity(TURNS);
        let mut signs = vec![0.0_f32; blocks];
        for _ in 0..TURNS {
            for chunk in signs.chunks_mut(64) {
                let bits = sequence.next();
                for (at, sign) in chunk.iter_mut().enumerate() {
                    *sign = if bits >> at & 1 == 0 { 1.0 } else { -1.0 };
                }
            }
            let gains = products.chunks_exact(blocks.max(1)).map(|own| {
                let both = own.iter().zip(&signs);
                let along: f32 = both.map(|(product, sign)| product * sign).sum();
                along * along
            });
            largest.push(f64::from(gains.fold(0.0, f32::max)));
        }
        largest.sort_by(f64::total_cmp);
        Self { largest }
    }

    /// How often chance alone reaches `gain`, the gain itself counted in.
    pub(super) fn p_value(&self, gain: f64) -> f64 {
        let below = self.largest.partition_point(|own| *own < gain);
        (1 + self.largest.len() - below) as f64 / (1 + self.largest.len()) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of noise the p-value of the largest gain is even between 0 and 1.
    #[test]
    fn noise_is_as_significant_as_it_says() {
        let (blocks, columns, trials) = (24, 40, 300);
        let mut noise = Sequence(7);
        let mut normal = || -> f32 {
            let twelve = (0..12).map(|_| noise.next() as f64 / u64::MAX as f64);
            (twelve.sum::<f64>() - 6.0) as f32
        };
        let mut p_values = Vec::new();
        for trial in 0..trials {
            let products: Vec<f32> = (0..blocks * columns).map(|_| normal()).collect();
            let gain = products
                .chunks_exact(blocks)
                .map(|own| own.iter().sum::<f32>().powi(2))
                .fold(0.0, f32::max);
            let chance = Chance::new(&products, blocks, trial);
            p_values.push(chance.p_value(f64::from(gain)));
        }
        for level in [0.05, 0.2, 0.5] {
            let below = p_values.iter().filter(|p| **p <= level).count() as f64;
            let share = below / trials as f64;
            let error = (level * (1.0 - level) / trials as f64).sqrt();
            assert!((share - level).abs() < 4.0 * error, "{share} at {level}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_answer() {
        let products: Vec<f32> = (0..200).map(|i| (i as f32 * 0.7).sin()).collect();
        let p = |seed| Chance::new(&products, 20, seed).p_value(3.0);
        assert_eq!(p(3), p(3));
        assert!((p(3) - p(4)).abs() < 0.1);
    }
}

//! Random numbers for each purpose.

use ferntast_emulation::random::Random;

/// Streams of random numbers, so that one's length does not change another.
#[derive(Clone, Copy)]
pub(crate) enum Stream {
    /// What is on the bench.
    Subject = 1,
    Conditions = 2,
    Effect = 3,
    Motion = 4,
    Session = 5,
    Noise = 6,
}

/// Mixes seed, stream and index (SplitMix64's finaliser).
pub(crate) fn random(seed: u64, stream: Stream, index: usize) -> Random {
    let mut mixed = seed
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add((stream as u64) << 32)
        .wrapping_add(index as u64 + 1);
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    Random::new(mixed ^ (mixed >> 31))
}

/// `size` within ±15 %, with either sign.
pub(crate) fn either_sign(size: f64, random: &mut Random) -> f64 {
    let size = about(size, random);
    if random.chance(0.5) { size } else { -size }
}

/// `size` within ±15 %.
pub(crate) fn about(size: f64, random: &mut Random) -> f64 {
    size * (0.85 + 0.3 * random.uniform())
}

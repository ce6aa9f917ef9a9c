//! Random numbers for each purpose.

use ferntast_emulation::random::{Random, mixed};

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
    /// How a recording is like a real one.
    RealLike = 7,
}

/// The random numbers of an element of a stream.
pub(crate) fn random(seed: u64, stream: Stream, index: usize) -> Random {
    let number = seed
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add((stream as u64) << 32)
        .wrapping_add(index as u64 + 1);
    Random::new(mixed(number))
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

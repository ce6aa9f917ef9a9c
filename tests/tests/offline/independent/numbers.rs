//! Random numbers to compare with.

/// Numbers within −1 … 1, the same every time (xorshift).
pub struct Numbers(u64);

impl Numbers {
    /// From a seed other than zero.
    pub fn new(seed: u64) -> Numbers {
        Numbers(seed)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn pair(&mut self, scale: f64) -> [f64; 2] {
        [scale * self.next(), scale * self.next()]
    }
}

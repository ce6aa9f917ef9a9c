//! The normal force that a controller holds, as well as it can.

use ferntast_emulation::random::Random;

/// How fast it follows what is asked for \[1/s\].
const BANDWIDTH: f64 = 6.0;
/// Its error, as a share of the force, and for how long that lasts \[s\].
const ERROR: f64 = 0.03;
const LASTS: f64 = 0.25;
const MILLISECOND: f64 = 1e-3;

/// F_N from millisecond to millisecond.
#[derive(Clone, Debug)]
pub(super) struct NormalForce {
    held: f64,
    error: f64,
    random: Random,
}

impl NormalForce {
    pub(super) fn new(random: Random) -> Self {
        NormalForce {
            held: 0.0,
            error: 0.0,
            random,
        }
    }

    /// F_N \[N\] a millisecond later, where `wanted` \[N\] is asked for.
    pub(super) fn step(&mut self, wanted: f64) -> f64 {
        self.held += BANDWIDTH * MILLISECOND * (wanted - self.held);
        let kept = 1.0 - MILLISECOND / LASTS;
        let fresh = ERROR * (1.0 - kept * kept).sqrt();
        self.error = kept * self.error + fresh * self.random.normal();
        (self.held * (1.0 + self.error)).max(0.0)
    }
}

//! Noise of the force of a contact, as far as no surface explains it.

use super::compliance::STIFFEST;
use crate::low_pass_share;

/// What is noise shows over this time [s].
const WINDOW: f64 = 0.3;
/// What is known of it is forgotten with this time constant [s].
const LIFE: f64 = 10.0;

/// A surface explains at most so many times what the force changes by [-]: it was a moving tip.
const MOST: f64 = 10.0;

/// Standard deviation of the force that is noise, at least: what of its changes not even the
/// stiffest surface that is distinguished would make of those of the depth, σ² ≥ ⟨F²⟩ − K²⟨s²⟩.
/// Means of squares do not mind that one of the two is late.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noise {
    /// ⟨F²⟩ [N²].
    changed: f64,
    /// K²⟨s²⟩ [N²].
    explained: f64,
    /// [N]
    level: f64,
}

impl Noise {
    /// After `dt` \[s\] in which the force changed by `apart` \[N\] and the depth by `away` \[m\].
    pub fn add(&mut self, dt: f64, [apart, away]: [f64; 2]) {
        let share = low_pass_share(dt, WINDOW);
        self.changed += share * (apart * apart - self.changed);
        self.explained += share * ((STIFFEST * away).powi(2) - self.explained);
        self.explained = self.explained.min(MOST * self.changed);
        let variance = (self.changed - self.explained).max(0.0);
        self.level = (self.level * (1.0 - dt / LIFE)).max(variance.sqrt());
    }

    /// \[N\]
    pub fn level(&self) -> f64 {
        self.level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 s of a force that trembles by `force` \[N\] where the depth does by `depth` \[m\], late.
    fn trembles(force: f64, depth: f64) -> f64 {
        let mut noise = Noise::default();
        for k in 0..2000 {
            let phase = 0.2 * f64::from(k);
            noise.add(1e-3, [force * phase.sin(), depth * (phase - 0.7).sin()]);
        }
        noise.level() / (force / std::f64::consts::SQRT_2)
    }

    #[test]
    fn what_a_surface_explains_is_no_noise() {
        for stiffness in [100.0, 2000.0, 20_000.0, 35_000.0] {
            // Where it begins, for a moment, none of what is late has come.
            let found = trembles(1.0, 1.0 / stiffness);
            assert!((0.0..0.15).contains(&found), "{stiffness} N/m: {found}");
        }
        // At rest all is noise, but for what the stiffest surface would explain.
        assert!((0.95..1.05).contains(&trembles(1.0, 0.0)));
        let left = trembles(1.0, 0.5 / STIFFEST);
        assert!((0.8..0.93).contains(&left), "{left} beside √(1 − ¼)");
    }
}

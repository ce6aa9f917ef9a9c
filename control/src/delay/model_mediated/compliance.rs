//! Compliance of a surface: the slope of depth over force of what changes unevenly, and how
//! two estimates of it are combined.

use super::even::Even;

/// Softest and stiffest surface that is distinguished [N/m].
pub(super) const SOFTEST: f64 = 10.0;
pub(super) const STIFFEST: f64 = 40_000.0;
/// What changes evenly is what is slower than this [rad/s].
const EVEN: f64 = 25.0;
/// At the tip, forces that change by less than this tell nothing of compliance: some times
/// their noise [N].
pub(super) const SPREAD: f64 = 0.3;
/// What of a depth is not the line's, at least [m], and the time over which the filters of
/// the force correlate it [s].
const NOISE: f64 = 5e-6;
pub(super) const CORRELATION: f64 = 0.016;
/// A line is not all that a surface is: its stiffness is known no better [-],
const LEAST_ERROR: f64 = 0.01;
/// and at a new contact no better than this [-].
const ANEW: f64 = 0.2;

/// What is known of a compliance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// [m/N]
    pub compliance: f64,
    /// One by its relative variance [-].
    pub weight: f64,
}

impl Known {
    /// Relative standard error, 1 at most \[-\].
    pub fn error(&self) -> f64 {
        1.0 / self.weight.max(1.0).sqrt()
    }

    /// Of both, where `other` counts by `part` of 1: what is known well of a stiff surface holds,
    /// whatever a chord tells.
    pub fn with(self, other: Known, part: f64) -> Known {
        let weight = self.weight + part * other.weight;
        let share = part * other.weight / (self.weight + other.weight);
        let ratio = other.compliance / self.compliance;
        Known {
            compliance: self.compliance * ratio.powf(share),
            weight,
        }
    }
}

/// Compliance as the slope of depth over force, both less what of them changes evenly: a
/// surface that moves by itself changes them evenly over some hundredths of a second, a
/// tip that meets it or is pushed does not. Recursive least squares whose weights are what
/// these values tell, so that it forgets only for something that is known better.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    force: Option<Even>,
    depth: Even,
    /// [m/N]
    compliance: f64,
    /// One by the variance of the compliance [N²/m²].
    information: f64,
    /// Variance of the depth about the line [m²].
    scatter: f64,
}

impl Slope {
    pub const UNKNOWN: Slope = Slope {
        force: None,
        depth: Even {
            value: 0.0,
            rate: 0.0,
        },
        compliance: 1.0 / STIFFEST,
        information: 0.0,
        scatter: 0.0,
    };

    pub fn known(&self) -> Known {
        Known {
            compliance: self.compliance,
            weight: self.information * self.compliance * self.compliance,
        }
    }

    /// A new contact, maybe with something else than where `known` is from.
    pub fn anew(known: Known) -> Slope {
        let weight = known.weight.min(1.0 / (ANEW * ANEW));
        Slope {
            compliance: known.compliance,
            information: weight / (known.compliance * known.compliance),
            ..Slope::UNKNOWN
        }
    }

    /// After `dt` \[s\], at `depth` \[m\] under `force` \[N\] of which changes from `spread`
    /// \[N\] on count; gives what of force \[N\] and depth \[m\] changed unevenly.
    pub fn add(&mut self, dt: f64, depth: f64, force: f64, spread: f64) -> [f64; 2] {
        let Some(even) = &mut self.force else {
            (self.force, self.depth) = (Some(Even::at(force)), Even::at(depth));
            return [0.0; 2];
        };
        let apart = even.step(dt, EVEN, force);
        let away = self.depth.step(dt, EVEN, depth);
        let left = away - self.compliance * apart;
        self.scatter += EVEN * dt * (left * left - self.scatter);
        if apart.abs() < spread {
            return [apart, away];
        }
        let told = apart * apart / self.scatter.max(NOISE * NOISE) * dt / CORRELATION;
        self.information += told;
        let compliance = self.compliance + told / self.information * left / apart;
        self.compliance = compliance.clamp(1.0 / STIFFEST, 1.0 / SOFTEST);
        let best = (LEAST_ERROR * self.compliance).powi(-2);
        self.information = self.information.min(best);
        [apart, away]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Onset of a contact: 0 to 10 N within some 50 ms.
    fn onset(slope: &mut Slope, stiffness: f64) {
        for k in 0..400 {
            let time = 1e-3 * f64::from(k);
            let force = 10.0 * (1.0 - (-time / 0.03).exp());
            slope.add(1e-3, force / stiffness, force, SPREAD);
        }
    }

    #[test]
    fn a_stiffness_is_known_after_an_onset() {
        for stiffness in [100.0, 2000.0, 20_000.0] {
            let mut slope = Slope::UNKNOWN;
            onset(&mut slope, stiffness);
            let known = 1.0 / slope.compliance / stiffness;
            assert!((0.95..1.05).contains(&known), "{stiffness} N/m: {known}");
        }
    }

    #[test]
    fn noise_of_the_force_makes_a_surface_stiffer_and_never_softer() {
        let stiffness = 2000.0;
        let mut slope = Slope::UNKNOWN;
        for k in 0..3000 {
            let time = 1e-3 * f64::from(k);
            let force = 5.0 + 0.5 * (40.0 * time).sin();
            // As large as a fifth of what it changes by, and not in the depth.
            let noise = 0.1 * (97.0 * time).sin();
            slope.add(1e-3, force / stiffness, force + noise, SPREAD);
        }
        let known = 1.0 / slope.compliance / stiffness;
        assert!((1.0..1.2).contains(&known), "{known}");
    }

    #[test]
    fn a_surface_that_moves_does_not_move_the_stiffness() {
        let stiffness = 2000.0;
        let mut slope = Slope::UNKNOWN;
        onset(&mut slope, stiffness);
        // The surface goes to and fro by 5 mm at 0.5 Hz; the tip, which is pressed as if by
        // a spring as stiff, goes half of the way, so that depth falls as the force rises.
        for k in 0..4000 {
            let turn = std::f64::consts::PI * 1e-3 * f64::from(k);
            let place = 0.0025 * (1.0 - turn.cos());
            let depth = 10.0 / stiffness - 0.5 * place;
            let force = 10.0 + 0.5 * stiffness * place;
            slope.add(1e-3, depth, force, SPREAD);
        }
        let known = 1.0 / slope.compliance / stiffness;
        assert!((0.95..1.05).contains(&known), "{known}");
    }
}

//! Stiffness of a joint from a saw-tooth of torque against the fixed tip: the
//! paper's Fig. 15.

use serde::Serialize;

use crate::numerics::filter::Kernel;
use crate::numerics::regression::by_blocks;

/// Width of the filter on both signals \[samples\].
const SMOOTHING: f64 = 2.0;
/// Smallest torque, as a share of the largest, at which the tip is fixed for certain.
const MIN_TORQUE_SHARE: f64 = 0.1;
/// Blocks of time that are left out in turn for the standard errors.
const BLOCKS: usize = 10;
/// Bins of the curve.
const BINS: usize = 12;

/// Stiffness of a joint with its standard error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stiffness {
    /// K \[Nm/rad\].
    pub stiffness: f64,
    /// Its standard error \[Nm/rad\]: of noise, and of what is wrong all the time.
    pub std_error: f64,
    /// What noise alone makes of it \[Nm/rad\].
    pub random_error: f64,
    /// K_3 of τ = K δ + K_3 δ³ \[Nm/rad³\], fitted together with K.
    pub cubic: f64,
    /// Its standard error.
    pub cubic_error: f64,
    /// RMS of the residual of the deformation around the straight line \[rad\].
    pub rms: f64,
    /// The curve: torque \[Nm\] and deformation \[rad\] in bins.
    pub curve: Vec<[f64; 2]>,
}

/// Motor `position` θ \[rad\] over joint `torque` τ \[Nm\]: θ − q = q_0 + τ/K, with the
/// position q of the `link` \[rad\] but for a constant, as what holds the tip and the other
/// joint's deflection have it. `None` when the torque hardly changes.
#[must_use]
pub fn stiffness(position: &[f64], link: &[f64], torque: &[f64]) -> Option<Stiffness> {
    let smooth = Kernel::gaussian(SMOOTHING, 0, 1.0);
    let wound: Vec<f64> = position.iter().zip(link).map(|(p, q)| p - q).collect();
    let (wound, torque) = (smooth.everywhere(&wound), smooth.everywhere(torque));
    let largest = torque
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let fixed: Vec<usize> = (0..wound.len().min(torque.len()))
        .filter(|&at| torque[at].abs() > MIN_TORQUE_SHARE * largest)
        .collect();
    if largest < 0.1 || fixed.len() < 10 * BLOCKS {
        return None;
    }
    let load: Vec<f64> = fixed.iter().map(|&at| torque[at]).collect();
    let cube: Vec<f64> = load.iter().map(|tau| tau.powi(3)).collect();
    let wound: Vec<f64> = fixed.iter().map(|&at| wound[at]).collect();
    let one = vec![1.0; load.len()];
    let line = by_blocks(&[&one, &load], &wound, BLOCKS)?;
    let (slope, slope_error) = (line.values[1], line.errors[1]);
    if slope <= 0.0 {
        return None;
    }
    let stiffness = 1.0 / slope;
    let curved = by_blocks(&[&one, &load, &cube], &wound, BLOCKS)?;
    // δ = a τ + e τ³ is τ = δ/a − (e/a⁴) δ³ up to the third order.
    let fourth = curved.values[1].powi(4);
    Some(Stiffness {
        stiffness,
        std_error: slope_error * stiffness * stiffness,
        random_error: slope_error * stiffness * stiffness,
        cubic: -curved.values[2] / fourth,
        cubic_error: curved.errors[2] / fourth,
        rms: line.rms,
        curve: curve(&load, &wound, line.values[0]),
    })
}

impl Stiffness {
    /// With what independent `changes` \[Nm/rad\] of K, each by one standard uncertainty of
    /// something that is wrong all the time, add to its standard error.
    #[must_use]
    pub fn with_systematic(mut self, changes: &[f64]) -> Self {
        let squares: f64 = changes.iter().map(|change| change * change).sum();
        self.std_error = (self.random_error.powi(2) + squares).sqrt();
        self
    }
}

fn curve(load: &[f64], wound: &[f64], origin: f64) -> Vec<[f64; 2]> {
    let least = load.iter().copied().fold(f64::INFINITY, f64::min);
    let most = load.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = ((most - least) / BINS as f64).max(1e-12);
    (0..BINS)
        .filter_map(|bin| {
            let low = least + bin as f64 * width;
            let inside = load
                .iter()
                .zip(wound)
                .filter(|(tau, _)| (low..low + width).contains(*tau));
            let (mut tau_sum, mut delta_sum, mut count) = (0.0, 0.0, 0.0);
            for (tau, delta) in inside {
                tau_sum += tau;
                delta_sum += delta - origin;
                count += 1.0;
            }
            (count > 0.0).then(|| [tau_sum / count, delta_sum / count])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tooth() -> Vec<f64> {
        (0..3000)
            .map(|k| 30.0 * f64::from(k % 500) / 500.0)
            .collect()
    }

    #[test]
    fn a_spring_behind_a_compliant_hold_is_found() {
        let torque = tooth();
        let hold = 1.0 / 25_000.0;
        let position: Vec<f64> = torque.iter().map(|t| 0.3 + t / 4900.0 + t * hold).collect();
        let link: Vec<f64> = torque.iter().map(|t| 0.3 + t * hold).collect();
        let found = stiffness(&position, &link, &torque).unwrap();
        assert!((found.stiffness - 4900.0).abs() < 1.0, "{found:?}");
        assert!(found.cubic.abs() < 1e6 && found.std_error < 5.0);
        let with = found.clone().with_systematic(&[30.0, -40.0]);
        assert!((with.std_error - 50.0).abs() < 0.1 && with.random_error == found.std_error);
        let without = stiffness(&position, &[0.3; 3000], &torque).unwrap();
        assert!((without.stiffness - 1.0 / (1.0 / 4900.0 + hold)).abs() < 1.0);
    }

    #[test]
    fn a_cubic_spring_is_distinguished_from_a_linear_one() {
        let torque = tooth();
        // τ = 4000 δ + 2e7 δ³, solved for δ by Newton's method.
        let position: Vec<f64> = torque
            .iter()
            .map(|t| {
                (0..30).fold(t / 4000.0, |d: f64, _| {
                    d - (4000.0 * d + 2e7 * d.powi(3) - t) / (4000.0 + 6e7 * d * d)
                })
            })
            .collect();
        let found = stiffness(&position, &[0.0; 3000], &torque).unwrap();
        assert!(found.cubic > 8e6 && found.cubic < 3e7, "{found:?}");
        assert!(found.cubic > 10.0 * found.cubic_error);
    }

    #[test]
    fn constant_torque_gives_no_stiffness() {
        assert!(stiffness(&[0.0; 500], &[0.0; 500], &[0.0; 500]).is_none());
    }
}

//! Contact friction by equation (6), F_T = b_0T |F_N| sign(q̇): the paper's Fig. 17.

use serde::Serialize;

use crate::numerics::regression::by_blocks;

/// Blocks of time that are left out in turn for the standard error.
const BLOCKS: usize = 10;

/// Coefficient of contact friction with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactFriction {
    /// b_0T \[-\].
    pub coefficient: f64,
    /// Its standard error.
    pub std_error: f64,
    /// RMS of the residual of F_T \[N\].
    pub rms: f64,
    /// Samples used.
    pub used: usize,
}

/// From `tangential` F_T \[N\] (positive when it opposes the motion) and
/// `normal` F_N \[N\], where `usable`: sliding, not near rest. `None` when
/// fewer than 50 samples are.
#[must_use]
pub fn contact_friction(
    tangential: &[f64],
    normal: &[f64],
    usable: &[bool],
) -> Option<ContactFriction> {
    let rows = tangential
        .iter()
        .zip(normal)
        .zip(usable)
        .filter(|(_, usable)| **usable);
    let (measured, column): (Vec<f64>, Vec<f64>) = rows.map(|((t, n), _)| (*t, n.abs())).unzip();
    if measured.len() < 50 {
        return None;
    }
    let fit = by_blocks(&[&column], &measured, BLOCKS)?;
    Some(ContactFriction {
        coefficient: *fit.values.first()?,
        std_error: *fit.errors.first()?,
        rms: fit.rms,
        used: measured.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coulomb_friction_is_found_and_rest_left_out() {
        let normal: Vec<f64> = (0..600)
            .map(|k| 20.0 + 5.0 * (0.05 * f64::from(k)).sin())
            .collect();
        let usable: Vec<bool> = (0..600).map(|k| k % 60 > 10).collect();
        let tangential: Vec<f64> = (0..600_usize)
            .map(|k| match usable[k] {
                true => 0.4 * normal[k] + 0.2 * (k as f64 * 1.7).sin(),
                false => -8.0,
            })
            .collect();
        let found = contact_friction(&tangential, &normal, &usable).unwrap();
        assert!(
            (found.coefficient - 0.4).abs() < 3.0 * found.std_error.max(1e-3),
            "{found:?}"
        );
        assert!(found.std_error < 0.002 && found.rms < 0.2);
        assert!(contact_friction(&tangential[..40], &normal[..40], &usable[..40]).is_none());
    }
}

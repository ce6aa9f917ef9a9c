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
    /// Its standard error: of noise, and of what is wrong all the time.
    pub std_error: f64,
    /// What noise alone makes of it.
    pub random_error: f64,
    /// RMS of the residual of F_T \[N\].
    pub rms: f64,
    /// Samples used.
    pub used: usize,
}

/// What one thing that is wrong all the time, and so does not average out, makes of the
/// forces at each sample, by one standard uncertainty \[N\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystematicError {
    /// Error of F_N.
    pub normal: Vec<f64>,
    /// Error of F_T.
    pub tangential: Vec<f64>,
}

/// From `tangential` F_T \[N\] (positive when it opposes the motion) and
/// `normal` F_N \[N\], where `usable`: sliding, not near rest. Each of `systematic`, which
/// are independent, adds what it makes of b_0T, of the first order
/// δb = Σ |F_N| (δF_T − b δF_N) / Σ F_N² (JCGM 100:2008, equation (10)). `None` when
/// fewer than 50 samples are usable.
#[must_use]
pub fn contact_friction(
    tangential: &[f64],
    normal: &[f64],
    usable: &[bool],
    systematic: &[SystematicError],
) -> Option<ContactFriction> {
    let rows: Vec<usize> = (0..tangential.len().min(normal.len()).min(usable.len()))
        .filter(|&at| usable[at])
        .collect();
    if rows.len() < 50 {
        return None;
    }
    let of = |values: &[f64]| -> Vec<f64> {
        let at = rows.iter().map(|&at| values.get(at).copied());
        at.map(|value| value.unwrap_or(0.0)).collect()
    };
    let measured = of(tangential);
    let column: Vec<f64> = of(normal).into_iter().map(f64::abs).collect();
    let fit = by_blocks(&[&column], &measured, BLOCKS)?;
    let (coefficient, random_error) = (*fit.values.first()?, *fit.errors.first()?);
    let squares: f64 = column.iter().map(|normal| normal * normal).sum();
    let variance: f64 = systematic
        .iter()
        .map(|error| {
            let errors = of(&error.normal).into_iter().zip(of(&error.tangential));
            let moved = column.iter().zip(errors);
            let sum: f64 = moved
                .map(|(column, (normal, tangential))| column * (tangential - coefficient * normal))
                .sum();
            (sum / squares).powi(2)
        })
        .sum();
    Some(ContactFriction {
        coefficient,
        std_error: (random_error * random_error + variance).sqrt(),
        random_error,
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
        let found = contact_friction(&tangential, &normal, &usable, &[]).unwrap();
        assert!(
            (found.coefficient - 0.4).abs() < 3.0 * found.std_error.max(1e-3),
            "{found:?}"
        );
        assert!(found.std_error < 0.002 && found.rms < 0.2);
        assert!(contact_friction(&tangential[..40], &normal[..40], &usable[..40], &[]).is_none());
    }

    /// A gain of the normal force of 2 % is 2 % of b_0T; an error of F_T that turns with the
    /// motion is none.
    #[test]
    fn what_is_wrong_all_the_time_is_in_the_error() {
        let normal = vec![20.0; 400];
        let tangential = vec![8.0; 400];
        let gain = SystematicError {
            normal: vec![0.4; 400],
            tangential: vec![0.0; 400],
        };
        let turn = SystematicError {
            normal: vec![0.0; 400],
            tangential: (0..400).map(|k| if k < 200 { 0.7 } else { -0.7 }).collect(),
        };
        let of = |errors: &[SystematicError]| {
            contact_friction(&tangential, &normal, &[true; 400], errors).unwrap()
        };
        let with = of(&[gain.clone(), turn]);
        assert!((with.std_error - 0.02 * 0.4).abs() < 1e-9, "{with:?}");
        assert!(with.random_error < 1e-9);
        let twice = of(&[gain.clone(), gain]);
        assert!((twice.std_error / with.std_error - 2.0_f64.sqrt()).abs() < 1e-9);
    }
}

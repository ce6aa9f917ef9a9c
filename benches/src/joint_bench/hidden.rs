//! Names of what a recording can hide, and what the experimenter still believes.

use super::config::overlap;
use super::effect::HiddenEffect;
use crate::bench::Hideable;

/// The effects of equation (4), which every believed model starts from.
const BASE: [HiddenEffect; 5] = [
    HiddenEffect::Coulomb,
    HiddenEffect::LoadCoulomb,
    HiddenEffect::Viscous,
    HiddenEffect::QuadraticViscous,
    HiddenEffect::CubicViscous,
];

impl Hideable for HiddenEffect {
    const ALL: &'static [Self] = HiddenEffect::ALL;
    const IDS: &'static [&'static str] = HiddenEffect::IDS;

    fn id(self) -> &'static str {
        self.id()
    }

    // The quadratic and the cubic term together are found by naming either.
    fn accepted(self) -> &'static [&'static str] {
        match self {
            HiddenEffect::QuadraticViscous => &["quadratic_viscous", "nonlinear_viscous"],
            HiddenEffect::CubicViscous => &["cubic_viscous", "nonlinear_viscous"],
            HiddenEffect::NonlinearViscous => {
                &["nonlinear_viscous", "quadratic_viscous", "cubic_viscous"]
            }
            _ => self.own_id(),
        }
    }

    fn overlap(self, other: Self) -> Option<&'static str> {
        overlap(self, other)
    }
}

impl HiddenEffect {
    /// True where the believed model lacks `base` because `self` hides it.
    fn hides(self, base: HiddenEffect) -> bool {
        match self {
            HiddenEffect::NonlinearViscous => matches!(
                base,
                HiddenEffect::QuadraticViscous | HiddenEffect::CubicViscous
            ),
            _ => self == base,
        }
    }
}

/// Ids of the effects in the believed model: equation (4) minus what is hidden.
pub(super) fn believed_effects(hidden: &[HiddenEffect]) -> Vec<&'static str> {
    BASE.into_iter()
        .filter(|&base| !hidden.iter().any(|effect| effect.hides(base)))
        .map(HiddenEffect::id)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_id_reads_back() {
        for &effect in HiddenEffect::ALL {
            assert_eq!(effect.id().parse::<HiddenEffect>().unwrap(), effect);
            assert_eq!(effect.in_catalogue(), !effect.accepted().is_empty());
            assert!(!effect.in_catalogue() || effect.accepted()[0] == effect.id());
        }
        let error = "stribek".parse::<HiddenEffect>().unwrap_err().to_string();
        assert!(error.contains("stribek") && error.contains("stribeck"));
    }

    #[test]
    fn the_believed_model_is_equation_4_without_what_is_hidden() {
        assert_eq!(believed_effects(&[]).len(), 5);
        assert_eq!(
            believed_effects(&[HiddenEffect::NonlinearViscous]),
            ["coulomb", "load_coulomb", "viscous"]
        );
        assert_eq!(believed_effects(&[HiddenEffect::Ripple]).len(), 5);
        assert_eq!(
            believed_effects(&[HiddenEffect::Coulomb, HiddenEffect::LoadCoulomb]).len(),
            3
        );
    }
}

//! What a recording of a joint is to be like.

use super::{HiddenEffect, Motion};

/// What a recording of a joint is to be like.
///
/// At strength 1 the smallest effects (inertia, load, delays) stand out from the
/// filtered noise by about 4 in the standard motion, most by 5 to 12, the terms
/// of equation (4) by far more. Between sessions Coulomb friction differs by
/// 2 %, the rest by 0.7 %.
pub type BenchConfig = crate::bench::BenchConfig<HiddenEffect, Motion>;

/// What both effects change, where they cannot act side by side.
pub(super) fn overlap(first: HiddenEffect, second: HiddenEffect) -> Option<&'static str> {
    use HiddenEffect::{
        Backlash, CubicViscous, Elasticity, NonlinearViscous, QuadraticViscous,
        TorqueSensorCalibration, TorqueSensorGain, TorqueSensorOffset, Viscous,
    };
    let both = |group: &[HiddenEffect]| group.contains(&first) && group.contains(&second);
    if both(&[Viscous, QuadraticViscous, CubicViscous, NonlinearViscous]) {
        Some("the viscous terms, whose share of each other is their answer")
    } else if both(&[Elasticity, Backlash]) {
        Some("the transmission")
    } else if both(&[
        TorqueSensorGain,
        TorqueSensorOffset,
        TorqueSensorCalibration,
    ]) {
        Some("the torque sensor's calibration, which both together are")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl FnOnce(&mut BenchConfig)) -> String {
        let mut config = BenchConfig::default();
        config.validate().unwrap();
        change(&mut config);
        config.validate().unwrap_err().to_string()
    }

    #[test]
    fn what_is_out_of_bounds_is_refused_by_name() {
        assert!(refused(|c| c.strength = f64::NAN).contains("strength"));
        assert!(refused(|c| c.strength = 2.5).contains("2.5"));
        assert!(refused(|c| c.sessions = 0).contains("sessions"));
        assert!(refused(|c| c.noise = -1.0).contains("noise"));
        assert!(refused(|c| c.scatter = 11.0).contains("scatter"));
        assert!(refused(|c| c.motions.clear()).contains("motion"));
    }

    #[test]
    fn effects_that_do_not_go_together_are_refused() {
        use HiddenEffect::{Backlash, Elasticity, Ripple, Viscous};
        assert!(refused(|c| c.hidden = vec![Ripple, Ripple]).contains("twice"));
        assert!(refused(|c| c.hidden = vec![Elasticity, Backlash]).contains("transmission"));
        let sensor = vec![
            HiddenEffect::TorqueSensorGain,
            HiddenEffect::TorqueSensorOffset,
        ];
        assert!(refused(|c| c.hidden = sensor).contains("calibration"));
        let viscous = vec![Viscous, HiddenEffect::CubicViscous];
        assert!(refused(|c| c.hidden = viscous).contains("viscous"));
        assert!(refused(|c| c.hidden = HiddenEffect::ALL.to_vec()).contains("hidden"));
    }
}

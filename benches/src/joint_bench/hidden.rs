//! Names of what a recording can hide, and what the experimenter still believes.

use super::config::overlap;
use crate::bench::{Hideable, named};

named! {
    /// An effect that is in the truth of a joint's recording and not in the
    /// model that the experimenter believes in.
    ///
    /// The first 24 are the joint effects of the catalogue; those whose id
    /// begins with `unknown_` are in no catalogue.
    pub enum HiddenEffect or UnknownEffect {
        /// b_0 sign(q̇).
        Coulomb = "coulomb",
        /// b_0T |τ| sign(q̇).
        LoadCoulomb = "load_coulomb",
        /// b_1 q̇.
        Viscous = "viscous",
        /// b_2 q̇|q̇|.
        QuadraticViscous = "quadratic_viscous",
        /// b_3 q̇³.
        CubicViscous = "cubic_viscous",
        /// b_2 q̇|q̇| + b_3 q̇³: the step from equation (3) to (4).
        NonlinearViscous = "nonlinear_viscous",
        /// More Coulomb friction near rest.
        Stribeck = "stribeck",
        /// Coulomb friction that differs by direction.
        AsymmetricCoulomb = "asymmetric_coulomb",
        /// Coulomb friction that changes with temperature.
        TemperatureCoulomb = "temperature_coulomb",
        /// Viscous friction that changes with temperature.
        TemperatureViscous = "temperature_viscous",
        /// Coulomb friction that grows with the days.
        WearDrift = "wear_drift",
        /// Torque periodic in the wave generator's turn.
        Ripple = "ripple",
        /// Bristles that bend before the joint slides.
        PreslidingHysteresis = "presliding_hysteresis",
        /// More Coulomb friction at one position.
        LocalFriction = "local_friction",
        /// Inertia that the believed model does not have.
        Inertia = "inertia",
        /// Weight that the torque sensor does not feel.
        Gravity = "gravity",
        /// A cable along the joint that pulls back.
        CableSpring = "cable_spring",
        /// Compliance between motor and the measured position.
        Elasticity = "elasticity",
        /// Dead zone between motor and gear.
        Backlash = "backlash",
        /// Wrong motor constant.
        MotorConstant = "motor_constant",
        /// Wrong gain of the torque sensor.
        TorqueSensorGain = "torque_sensor_gain",
        /// Wrong zero of the torque sensor.
        TorqueSensorOffset = "torque_sensor_offset",
        /// One channel stamped late.
        ChannelDelay = "channel_delay",
        /// Motor torque clipped.
        CurrentSaturation = "current_saturation",
        /// Outside the catalogue: a pull that turns with temperature and position.
        UnknownTemperaturePosition = "unknown_temperature_position",
        /// Outside the catalogue: friction that differs while load builds up or falls.
        UnknownTorqueRate = "unknown_torque_rate",
        /// Outside the catalogue: friction that grows while the speed changes.
        UnknownAcceleration = "unknown_acceleration",
        /// Outside the catalogue: viscous friction that grows with the square of the load.
        UnknownVelocityLoad = "unknown_velocity_load",
        /// Outside the catalogue: a step of torque at one position, whatever the direction.
        UnknownPositionStep = "unknown_position_step",
        /// Outside the catalogue: a slow oscillation in time, as from a supply.
        UnknownOscillation = "unknown_oscillation",
        /// Outside the catalogue: friction that falls as the joint's own work warms it.
        UnknownWorkHeating = "unknown_work_heating",
    }
}

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
    fn the_catalogue_has_24_joint_effects_and_7_are_outside() {
        let inside = HiddenEffect::ALL
            .iter()
            .filter(|e| e.in_catalogue())
            .count();
        assert_eq!((inside, HiddenEffect::ALL.len() - inside), (24, 7));
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

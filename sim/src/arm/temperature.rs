//! How friction depends on the temperature of the gear.
//!
//! The paper measures (Figs. 12–14) that damping falls with temperature near
//! rest, does not change around 5 °/s, and grows at high speed. It gives no
//! equation; this one has exactly these three ranges:
//!
//! τ_F(v, T) = τ_F(v, T₀) · (1 + k(v) (T − T₀)),
//! k(v) = k_fast + (k_slow − k_fast) exp(−λ|v|), λ such that k(v_neutral) = 0.

use ferntast_model::parameters;

/// Friction is never less than this share of what it is at the reference
/// temperature, however far that is.
const LEAST_SHARE: f64 = 0.1;

parameters! {
    /// Temperature dependence of one joint's friction.
    #[derive(Copy)]
    pub struct TemperatureDependence {
        /// Temperature T₀ at which the friction parameters hold as they are \[degC\].
        pub reference: f64 [-150.0..=150.0, "degC"],
        /// Change per kelvin at rest, as a share: k_slow < 0 \[1/K\].
        pub slow: f64 [-0.1..=-1e-6, "1/K"],
        /// Change per kelvin at high speed, as a share: k_fast > 0 \[1/K\].
        pub fast: f64 [1e-6..=0.1, "1/K"],
        /// Speed v_neutral at which temperature changes nothing \[rad/s\].
        pub neutral_speed: f64 [1e-3..=10.0, "rad/s"],
    }
}

impl TemperatureDependence {
    /// −λ of the equation \[s/rad\]. The bounds keep it finite and negative.
    fn decay(&self) -> f64 {
        (self.fast / (self.fast - self.slow)).ln() / self.neutral_speed
    }
}

/// The dependence with what need not be computed in every step.
#[derive(Clone, Copy, Debug)]
pub(super) struct TemperatureShare {
    parameters: TemperatureDependence,
    decay: f64,
}

impl TemperatureShare {
    pub(super) fn new(parameters: &TemperatureDependence) -> Self {
        Self {
            parameters: *parameters,
            decay: parameters.decay(),
        }
    }

    /// What friction is multiplied by at `speed` = |θ̇| \[rad/s\] and `temperature` \[degC\].
    pub(super) fn at(&self, speed: f64, temperature: f64) -> f64 {
        let p = &self.parameters;
        let per_kelvin = if speed == 0.0 {
            p.slow
        } else {
            p.fast + (p.slow - p.fast) * (self.decay * speed).exp()
        };
        (1.0 + per_kelvin * (temperature - p.reference)).max(LEAST_SHARE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINT: TemperatureDependence = TemperatureDependence {
        reference: 10.0,
        slow: -0.031,
        fast: 0.0111,
        neutral_speed: 0.0873,
    };

    /// Figs. 12, 13, 14 with the temperatures that the text names.
    #[test]
    fn it_has_the_three_ranges_of_the_paper() {
        let ratio = |degrees_per_second: f64, warm, cold| {
            let speed = degrees_per_second.to_radians();
            TemperatureShare::new(&JOINT).at(speed, warm)
                / TemperatureShare::new(&JOINT).at(speed, cold)
        };
        assert!((ratio(1.0, 20.0, -5.0) - 0.60).abs() < 0.02);
        assert!((ratio(5.0, 30.0, -20.0) - 1.0).abs() < 1e-3);
        assert!((ratio(31.0, 25.0, -5.0) - 1.40).abs() < 0.02);
    }

    #[test]
    fn at_the_reference_nothing_changes_and_nothing_turns_negative() {
        for speed in [0.0, 0.01, 0.1, 1.0, 100.0] {
            assert_eq!(TemperatureShare::new(&JOINT).at(speed, 10.0), 1.0);
            assert!(TemperatureShare::new(&JOINT).at(speed, 150.0) >= LEAST_SHARE);
            assert!(TemperatureShare::new(&JOINT).at(speed, -150.0) >= LEAST_SHARE);
        }
    }

    #[test]
    fn a_dependence_that_does_not_turn_its_sign_is_refused() {
        let wrong = TemperatureDependence {
            slow: 0.01,
            ..JOINT
        };
        assert_eq!(wrong.validate().unwrap_err().key(), "slow");
        JOINT.validate().unwrap();
    }
}

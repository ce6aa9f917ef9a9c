//! What a joint torque sensor feels of the torque, in the order in which it
//! goes wrong in one:
//!
//! true torque → lag → hysteresis → gain → zero (→ noise → steps → range).
//!
//! Lag and hysteresis come first, as they are of the strained body; gain and zero
//! are of the bridge's amplifier, and what is in brackets of the converter behind it.

use ferntast_model::parameters;

/// The torque over which the hysteresis turns over, as a multiple of its loop's
/// whole width: within the loop the reading follows the torque by nine tenths.
const TURNS_OVER: f64 = 10.0;

parameters! {
    /// What a torque sensor has wrong, apart from noise, steps and range. None of it
    /// is published of ROKVISS's.
    #[derive(Copy)]
    pub struct TorqueSensorErrors {
        /// Reading without torque \[Nm\].
        pub zero: f64 [-10.0..=10.0, "Nm"] = 0.0,
        /// Change of the reading for a change of the torque \[-\].
        pub gain: f64 [0.5..=2.0, "-"] = 1.0,
        /// How far the reading trails a torque that has turned, at most \[Nm\]: half
        /// of the loop's width.
        pub hysteresis: f64 [0.0..=10.0, "Nm"] = 0.0,
        /// Time constant of first order \[s\].
        pub lag: f64 [0.0..=1.0, "s"] = 0.0,
    }
}

/// The body and the amplifier of one joint's torque sensor.
#[derive(Clone, Debug)]
pub(crate) struct TorqueSensor {
    errors: TorqueSensorErrors,
    /// The torque behind the lag \[Nm\].
    felt: f64,
    /// How far the reading trails it \[Nm\], within ± hysteresis.
    trail: f64,
}

impl TorqueSensor {
    /// A sensor that has felt `torque` \[Nm\] for long, and no other before.
    pub(crate) fn new(errors: TorqueSensorErrors, torque: f64) -> Self {
        Self {
            errors,
            felt: torque,
            trail: 0.0,
        }
    }

    /// Takes in the true torque \[Nm\], `elapsed` \[s\] after the last one; what is
    /// felt of it \[Nm\].
    pub(crate) fn feel(&mut self, truth: f64, elapsed: f64) -> f64 {
        let errors = &self.errors;
        let felt = if errors.lag > 0.0 {
            truth + (self.felt - truth) * (-elapsed / errors.lag).exp()
        } else {
            truth
        };
        // A stop operator (Prandtl): rate-independent, it knows no more than the last turn.
        let followed = (felt - self.felt) / TURNS_OVER;
        self.trail = (self.trail + followed).clamp(-errors.hysteresis, errors.hysteresis);
        self.felt = felt;
        errors.gain * (felt - self.trail) + errors.zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: f64 = 1e-3;

    /// What a sensor feels of `torques`, a tick apart, after long rest.
    fn felt(errors: TorqueSensorErrors, torques: &[f64]) -> Vec<f64> {
        let mut sensor = TorqueSensor::new(errors, 0.0);
        let each = torques.iter();
        each.map(|&torque| sensor.feel(torque, TICK)).collect()
    }

    #[test]
    fn without_errors_the_torque_is_felt_to_the_bit() {
        let torques = [0.0, 3.0, -7.1, 1e-3, 39.0];
        assert_eq!(felt(TorqueSensorErrors::default(), &torques), torques);
    }

    #[test]
    fn gain_and_zero_make_a_straight_line() {
        let errors = TorqueSensorErrors {
            zero: 0.3,
            gain: 1.03,
            ..Default::default()
        };
        let felt = felt(errors, &[0.0, 10.0, -10.0]);
        for (felt, expected) in felt.iter().zip([0.3, 10.6, -10.0]) {
            assert!((felt - expected).abs() < 1e-12, "{felt}");
        }
    }

    #[test]
    fn the_loop_is_as_wide_as_stated_at_any_speed() {
        let errors = TorqueSensorErrors {
            hysteresis: 0.1,
            ..Default::default()
        };
        for steps in [40, 4000] {
            let up = (0..=steps).map(|k| 10.0 * f64::from(k) / f64::from(steps));
            let torques: Vec<f64> = up.clone().chain(up.clone().rev()).chain(up).collect();
            let felt = felt(errors, &torques);
            let count = felt.len() / 3;
            let middle = |pass: usize| felt[pass * count + count / 2];
            // Down it reads too much, up again too little; the loop turns over in 2 Nm.
            assert!((middle(1) - 5.1).abs() < 1e-9 && (middle(2) - 4.9).abs() < 1e-9);
            let behind = torques.iter().zip(&felt).map(|(x, y)| (x - y).abs());
            assert!(behind.fold(0.0, f64::max) < 0.1 + 1e-9);
            // Back without torque the body has kept half of the loop.
            assert!((felt[2 * count - 1] - 0.1).abs() < 1e-9);
        }
    }

    #[test]
    fn a_step_comes_through_as_a_low_pass_of_first_order_has_it() {
        let errors = TorqueSensorErrors {
            lag: 0.005,
            ..Default::default()
        };
        for (tick, felt) in felt(errors, &[10.0; 20]).iter().enumerate() {
            let grown = 1.0 - (-(tick as f64 + 1.0) * TICK / 0.005).exp();
            assert!((felt - 10.0 * grown).abs() < 1e-9, "{tick}: {felt}");
        }
    }
}

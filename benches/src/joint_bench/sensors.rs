//! Noise and quantisation of what is logged.

use ferntast_emulation::random::Random;

use super::effect::Reading;

/// Standard deviation of each reading's noise, and a position of 20 bits a
/// turn. Assumed: the paper gives no noise.
const POSITION: f64 = 5e-6;
pub(super) const POSITION_QUANTUM: f64 = std::f64::consts::TAU / (1u64 << 20) as f64;
const MOTOR_TORQUE: f64 = 0.35;
/// Noise of the current that outlasts a sample, and what is left of it after one.
const MOTOR_TORQUE_SLOW: f64 = 0.18;
const SLOW_KEPT: f64 = 0.88;
const JOINT_TORQUE: f64 = 0.05;
const TEMPERATURE: f64 = 0.05;
const TEMPERATURE_QUANTUM: f64 = 1.0 / 16.0;

/// Turns readings into what a log holds.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    noise: f64,
    /// What a position is a multiple of \[rad\].
    position_quantum: f64,
    slow: f64,
    random: Random,
}

impl Sensors {
    pub(super) fn new(noise: f64, position_quantum: f64, random: Random) -> Self {
        Sensors {
            noise,
            position_quantum,
            slow: 0.0,
            random,
        }
    }

    /// `reading` with noise; then the temperature \[degC\] with noise.
    pub(super) fn log(&mut self, reading: &Reading, temperature: f64) -> (Reading, f64) {
        let mut noise = |deviation: f64| self.noise * deviation * self.random.normal();
        let fresh = noise(MOTOR_TORQUE_SLOW * (1.0 - SLOW_KEPT * SLOW_KEPT).sqrt());
        self.slow = SLOW_KEPT * self.slow + fresh;
        let logged = Reading {
            position: reading.position + noise(POSITION),
            motor_torque: reading.motor_torque + self.slow + noise(MOTOR_TORQUE),
            joint_torque: reading.joint_torque + noise(JOINT_TORQUE),
        };
        let temperature = temperature + noise(TEMPERATURE);
        if self.noise == 0.0 {
            return (logged, temperature);
        }
        let quantised = |value: f64, quantum: f64| (value / quantum).round() * quantum;
        (
            Reading {
                position: quantised(logged.position, self.position_quantum),
                ..logged
            },
            quantised(temperature, TEMPERATURE_QUANTUM),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_documented_size() {
        let mut sensors = Sensors::new(1.0, POSITION_QUANTUM, Random::new(4));
        let count = 20_000;
        let (mut position, mut motor, mut joint, mut warmth) = (0.0, 0.0, 0.0, 0.0);
        for _ in 0..count {
            let (reading, temperature) = sensors.log(&Reading::default(), 20.0);
            position += reading.position.powi(2);
            motor += reading.motor_torque.powi(2);
            joint += reading.joint_torque.powi(2);
            warmth += (temperature - 20.0).powi(2);
        }
        let rms = |sum: f64| (sum / f64::from(count)).sqrt();
        assert!((5e-6..6e-6).contains(&rms(position)));
        assert!((0.37..0.42).contains(&rms(motor)), "{}", rms(motor));
        assert!((0.048..0.052).contains(&rms(joint)));
        assert!((0.05..0.058).contains(&rms(warmth)));
    }

    #[test]
    fn without_noise_readings_are_exact() {
        let mut sensors = Sensors::new(0.0, POSITION_QUANTUM, Random::new(4));
        let reading = Reading {
            position: 0.123_456_789,
            motor_torque: 1.5,
            joint_torque: -2.5,
        };
        let (logged, temperature) = sensors.log(&reading, 3.21);
        assert_eq!(logged.position, reading.position);
        assert_eq!((logged.motor_torque, temperature), (1.5, 3.21));
    }
}

//! What the sensors make of the truth: errors of the torque sensor
//! ([`TorqueSensorErrors`]), noise, steps, range, in this order.

use super::noise::Noise;
use super::torque_sensor::TorqueSensorErrors;
use ferntast_model::parameters;

parameters! {
    /// Sensors of one joint.
    #[derive(Copy)]
    pub struct SensorParameters {
        /// Steps of the motor encoder in one turn of the motor \[-\].
        pub encoder_counts: f64 [4.0..=1e9, "-"],
        /// Time constant of the drive's velocity filter \[s\].
        pub velocity_time_constant: f64 [0.0..=1.0, "s"],
        /// Noise of the torque sensor, standard deviation \[Nm\].
        pub torque_noise: f64 [0.0..=10.0, "Nm"],
        /// Step of the torque sensor \[Nm\].
        pub torque_step: f64 [0.0..=10.0, "Nm"],
        /// Noise of the current measurement, standard deviation \[A\].
        pub current_noise: f64 [0.0..=10.0, "A"],
        /// Step of the current measurement \[A\].
        pub current_step: f64 [0.0..=10.0, "A"],
        /// What else the torque sensor has wrong; nothing when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub torque_errors: Option<TorqueSensorErrors> [section],
    }
}

/// One joint's encoder and the velocity that the drive takes from it.
#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    step: f64,
    time_constant: f64,
    position: f64,
    velocity: f64,
}

impl Encoder {
    /// An encoder at rest at `position` \[rad\], on the joint side.
    pub(crate) fn new(parameters: &SensorParameters, gear_ratio: f64, position: f64) -> Self {
        let step = std::f64::consts::TAU / (parameters.encoder_counts * gear_ratio);
        Self {
            step,
            time_constant: parameters.velocity_time_constant,
            position: quantise(position, step),
            velocity: 0.0,
        }
    }

    /// Position \[rad\] and velocity \[rad/s\], `elapsed` \[s\] after the last call.
    pub(crate) fn measure(&mut self, truth: f64, elapsed: f64) -> (f64, f64) {
        let position = quantise(truth, self.step);
        if elapsed > 0.0 {
            let difference = (position - self.position) / elapsed;
            let share = elapsed / (elapsed + self.time_constant);
            self.velocity += share * (difference - self.velocity);
            self.position = position;
        }
        (position, self.velocity)
    }
}

/// Joint torque \[Nm\] as the sensor with range ±`range` gives what it `feels`, and whether it is
/// at the end of it.
pub(crate) fn joint_torque(
    feels: f64,
    parameters: &SensorParameters,
    range: f64,
    noise: &mut Noise,
) -> (f64, bool) {
    let reading = quantise(
        feels + noise.normal(parameters.torque_noise),
        parameters.torque_step,
    );
    (reading.clamp(-range, range), reading.abs() >= range)
}

/// Motor current \[A\] as it is measured.
pub(crate) fn current(truth: f64, parameters: &SensorParameters, noise: &mut Noise) -> f64 {
    quantise(
        truth + noise.normal(parameters.current_noise),
        parameters.current_step,
    )
}

/// `value` in whole steps of `step`; as it is when there is no step.
fn quantise(value: f64, step: f64) -> f64 {
    if step > 0.0 {
        (value / step).round() * step
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSORS: SensorParameters = SensorParameters {
        encoder_counts: 4096.0,
        velocity_time_constant: 0.002,
        torque_noise: 0.05,
        torque_step: 0.01,
        current_noise: 0.0,
        current_step: 0.005,
        torque_errors: None,
    };

    #[test]
    fn the_torque_sensor_ends_at_its_range() {
        let mut noise = Noise::new(3);
        assert_eq!(joint_torque(50.0, &SENSORS, 40.0, &mut noise), (40.0, true));
        assert_eq!(
            joint_torque(-50.0, &SENSORS, 40.0, &mut noise),
            (-40.0, true)
        );
        let (inside, saturated) = joint_torque(20.0, &SENSORS, 40.0, &mut noise);
        assert!((inside - 20.0).abs() < 0.4 && !saturated);
    }

    #[test]
    fn readings_come_in_steps() {
        let mut noise = Noise::new(3);
        assert_eq!(current(0.0112, &SENSORS, &mut noise), 0.01);
        let mut encoder = Encoder::new(&SENSORS, 160.0, 0.0);
        let step = std::f64::consts::TAU / (4096.0 * 160.0);
        assert_eq!(encoder.measure(1.4 * step, 1e-3).0, step);
    }

    #[test]
    fn the_drive_sees_a_steady_velocity() {
        let mut encoder = Encoder::new(&SENSORS, 160.0, 0.0);
        let velocity = (1..=200)
            .map(|tick| encoder.measure(0.3e-3 * f64::from(tick), 1e-3).1)
            .last();
        assert!((velocity.unwrap() - 0.3).abs() < 0.005, "{velocity:?}");
    }
}

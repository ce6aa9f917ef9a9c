//! A joint's temperature: one heat capacity, warmed by friction, cooled by its surroundings.

use super::noise::Noise;
use ferntast_model::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Temperature sensors of a joint; the paper averages five of them.
pub const TEMPERATURE_SENSORS: usize = 5;

/// Thermal parameters of one joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalParameters {
    /// Temperature of the surroundings, held by heater and sun \[degC\].
    pub ambient: f64,
    /// Temperature at the start \[degC\].
    pub initial: f64,
    /// Heat capacity \[J/K\].
    pub capacity: f64,
    /// Conductance to the surroundings \[W/K\].
    pub conductance: f64,
    /// Standard deviation of the sensors' fixed offsets \[K\].
    pub sensor_offset: f64,
    /// Standard deviation of one reading \[K\].
    pub sensor_noise: f64,
    /// Time between two readings \[s\].
    pub sensor_period: f64,
}

impl ThermalParameters {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("ambient", self.ambient, -150.0, 150.0, "degC")?;
        check("initial", self.initial, -150.0, 150.0, "degC")?;
        check("capacity", self.capacity, 1.0, 1e6, "J/K")?;
        check("conductance", self.conductance, 0.0, 1e3, "W/K")?;
        check("sensor_offset", self.sensor_offset, 0.0, 20.0, "K")?;
        check("sensor_noise", self.sensor_noise, 0.0, 20.0, "K")?;
        check("sensor_period", self.sensor_period, 1e-3, 60.0, "s")
    }
}

/// One joint's temperature and its sensors.
#[derive(Clone, Debug)]
pub(super) struct Thermal {
    parameters: ThermalParameters,
    temperature: f64,
    offsets: [f64; TEMPERATURE_SENSORS],
    reading: f64,
    since_reading: f64,
}

impl Thermal {
    pub(super) fn new(parameters: &ThermalParameters, noise: &mut Noise) -> Self {
        let offsets = std::array::from_fn(|_| noise.normal(parameters.sensor_offset));
        let mut thermal = Self {
            parameters: *parameters,
            temperature: parameters.initial,
            offsets,
            reading: 0.0,
            since_reading: 0.0,
        };
        thermal.read(noise);
        thermal
    }

    pub(super) fn temperature(&self) -> f64 {
        self.temperature
    }

    /// Takes in `heat` \[J\] and moves on by `dt` \[s\].
    pub(super) fn advance(&mut self, heat: f64, dt: f64) {
        let p = &self.parameters;
        let loss = p.conductance * (self.temperature - p.ambient) * dt;
        self.temperature += (heat - loss) / p.capacity;
        self.since_reading += dt;
    }

    /// Mean of the sensors \[degC\], held between readings.
    pub(super) fn measure(&mut self, noise: &mut Noise) -> f64 {
        // Half a microsecond of slack: periods are sums of rounded steps.
        if self.since_reading + 5e-7 >= self.parameters.sensor_period {
            self.read(noise);
        }
        self.reading
    }

    fn read(&mut self, noise: &mut Noise) {
        let deviation = self.parameters.sensor_noise;
        let sum: f64 = self
            .offsets
            .iter()
            .map(|offset| self.temperature + offset + noise.normal(deviation))
            .sum();
        self.reading = sum / TEMPERATURE_SENSORS as f64;
        self.since_reading = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINT: ThermalParameters = ThermalParameters {
        ambient: 10.0,
        initial: 10.0,
        capacity: 100.0,
        conductance: 0.5,
        sensor_offset: 0.3,
        sensor_noise: 0.1,
        sensor_period: 0.1,
    };

    #[test]
    fn five_watts_warm_it_by_ten_kelvin_in_the_end() {
        let mut noise = Noise::new(1);
        let mut joint = Thermal::new(&JOINT, &mut noise);
        // One time constant of 200 s, then many.
        for _ in 0..2000 {
            joint.advance(0.5, 0.1);
        }
        let expected = 10.0 + 10.0 * (1.0 - (-1.0_f64).exp());
        assert!((joint.temperature() - expected).abs() < 0.01);
        for _ in 0..40_000 {
            joint.advance(0.5, 0.1);
        }
        assert!((joint.temperature() - 20.0).abs() < 0.01);
        let reading = joint.measure(&mut noise);
        assert!((reading - 20.0).abs() < 1.0 && reading != 20.0);
        assert_eq!(
            joint.measure(&mut noise),
            reading,
            "held until the next reading"
        );
    }
}

//! A joint's temperature: one heat capacity, warmed by friction, sun and
//! heater, cooled by its ambient.
//!
//! C Ṫ = P_friction + P_sun(t) + P_heater(T) − G (T − T_shade)

use super::environment::{Environment, SECONDS_PER_DAY, Sun};
use super::noise::Noise;
use ferntast_model::{ParameterError, check, parameters};

/// Temperature sensors of a joint; the paper averages five of them.
pub const TEMPERATURE_SENSORS: usize = 5;

parameters! {
    /// Thermal parameters of one joint.
    #[derive(Copy)]
    pub struct ThermalParameters {
        /// Temperature T_shade that it would come to without sun and heater \[degC\].
        pub shade: f64 [-150.0..=150.0, "degC"],
        /// Mean power of the sun while it shines on it \[W\].
        pub sun_power: f64 [0.0..=1e4, "W"],
        /// Power of the heater \[W\].
        pub heater_power: f64 [0.0..=1e4, "W"],
        /// Temperature below which the heater is switched on \[degC\].
        pub heater_on: f64,
        /// Temperature above which it is switched off \[degC\].
        pub heater_off: f64 [-150.0..=150.0, "degC"],
        /// Heat capacity \[J/K\].
        pub capacity: f64 [1.0..=1e6, "J/K"],
        /// Conductance to the ambient \[W/K\].
        pub conductance: f64 [0.0..=1e3, "W/K"],
        /// Standard deviation of the sensors' fixed offsets \[K\].
        pub sensor_offset: f64 [0.0..=20.0, "K"],
        /// Standard deviation of one reading \[K\].
        pub sensor_noise: f64 [0.0..=20.0, "K"],
        /// Time between two readings \[s\].
        pub sensor_period: f64 [1e-3..=60.0, "s"],
    }
    check ThermalParameters::heater_goes_on_below;
}

impl ThermalParameters {
    fn heater_goes_on_below(&self) -> Result<(), ParameterError> {
        check("heater_on", self.heater_on, -150.0, self.heater_off, "degC")
    }
}

/// How the ambient keep a joint.
#[derive(Clone, Copy, Debug)]
enum Ambient {
    /// At a temperature \[degC\].
    Held(f64),
    /// With sun and heater, `seconds` after the start of the mission.
    Outside { sun: Sun, seconds: f64, heats: bool },
}

/// One joint's temperature and its sensors.
#[derive(Clone, Debug)]
pub(crate) struct Thermal {
    parameters: ThermalParameters,
    ambient: Ambient,
    temperature: f64,
    offsets: [f64; TEMPERATURE_SENSORS],
    reading: f64,
    since_reading: f64,
}

/// Before the start the joint is left to sun and heater for this long \[s\],
/// many of its time constants, in steps of [`SOAK_STEP`].
const SOAK: f64 = 40_000.0;
const SOAK_STEP: f64 = 20.0;

impl Thermal {
    /// Joint `joint` at rest in `environment`.
    pub(crate) fn new(
        parameters: &ThermalParameters,
        environment: &Environment,
        joint: usize,
        noise: &mut Noise,
    ) -> Self {
        let held = environment
            .temperature
            .and_then(|both| both.get(joint).copied());
        if let Some(temperature) = held {
            return Self::held(parameters, temperature, noise);
        }
        let outside = Ambient::Outside {
            sun: environment.sun,
            seconds: environment.day * SECONDS_PER_DAY - SOAK,
            heats: false,
        };
        let mut thermal = Self::begin(parameters, outside, parameters.heater_off, noise);
        for _ in 0..(SOAK / SOAK_STEP) as usize {
            thermal.advance(0.0, SOAK_STEP);
        }
        thermal.read(noise);
        thermal
    }

    /// A joint whose surroundings keep one temperature \[degC\].
    pub(crate) fn held(
        parameters: &ThermalParameters,
        temperature: f64,
        noise: &mut Noise,
    ) -> Self {
        let ambient = Ambient::Held(temperature);
        let mut thermal = Self::begin(parameters, ambient, temperature, noise);
        thermal.read(noise);
        thermal
    }

    /// Before the first reading.
    fn begin(
        parameters: &ThermalParameters,
        ambient: Ambient,
        temperature: f64,
        noise: &mut Noise,
    ) -> Self {
        Self {
            parameters: *parameters,
            ambient,
            temperature,
            offsets: std::array::from_fn(|_| noise.normal(parameters.sensor_offset)),
            reading: 0.0,
            since_reading: 0.0,
        }
    }

    pub(crate) fn temperature(&self) -> f64 {
        self.temperature
    }

    /// Takes in `heat` \[J\] and moves on by `dt` \[s\].
    pub(crate) fn advance(&mut self, heat: f64, dt: f64) {
        let p = &self.parameters;
        let (around, power) = match &mut self.ambient {
            Ambient::Held(temperature) => (*temperature, 0.0),
            Ambient::Outside {
                sun,
                seconds,
                heats,
            } => {
                *seconds += dt;
                *heats = self.temperature < if *heats { p.heater_off } else { p.heater_on };
                let heater = if *heats { p.heater_power } else { 0.0 };
                (p.shade, p.sun_power * sun.share(*seconds) + heater)
            }
        };
        let gain = power - p.conductance * (self.temperature - around);
        self.temperature += (heat + gain * dt) / p.capacity;
        self.since_reading += dt;
    }

    /// Mean of the sensors \[degC\], held between readings.
    pub(crate) fn measure(&mut self, noise: &mut Noise) -> f64 {
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
        shade: -50.0,
        sun_power: 48.0,
        heater_power: 30.0,
        heater_on: -12.0,
        heater_off: -9.0,
        capacity: 100.0,
        conductance: 0.5,
        sensor_offset: 0.3,
        sensor_noise: 0.1,
        sensor_period: 0.1,
    };

    const SUN: Sun = Sun {
        orbit_period: 5500.0,
        sunlit: 0.6,
        season_period: 60.0,
        season_peak: 42.0,
        season_share: 0.28,
    };

    fn environment(day: f64, temperature: Option<[f64; 2]>) -> Environment {
        Environment {
            day,
            temperature,
            sun: SUN,
        }
    }

    #[test]
    fn five_watts_warm_it_by_ten_kelvin_in_the_end() {
        let mut noise = Noise::new(1);
        let held = environment(0.0, Some([10.0, 10.0]));
        let mut joint = Thermal::new(&JOINT, &held, 0, &mut noise);
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

    /// The paper: −20 … +30 °C by heater and sun, and only slight changes in a contact of minutes.
    #[test]
    fn sun_and_heater_keep_it_within_the_published_range() {
        let slow = ThermalParameters {
            capacity: 6000.0,
            ..JOINT
        };
        let mut noise = Noise::new(1);
        let (mut coldest, mut warmest) = (f64::INFINITY, f64::NEG_INFINITY);
        for step in 0..1440 {
            let outside = environment(f64::from(step) * 0.513, None);
            let mut joint = Thermal::new(&slow, &outside, 1, &mut noise);
            let begin = joint.temperature();
            coldest = begin.min(coldest);
            warmest = begin.max(warmest);
            for _ in 0..300 {
                joint.advance(0.0, 1.0);
            }
            assert!((joint.temperature() - begin).abs() < 3.0);
        }
        println!("{coldest:.1} … {warmest:.1} °C");
        assert!(coldest > -20.0 && coldest < -10.0);
        assert!(warmest < 30.0 && warmest > 20.0);
    }
}

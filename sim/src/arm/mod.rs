//! The simulated arm: the hardware that is not there.
//!
//! Two flexible joints with motor inertia, gear and friction (equations
//! (1)–(4)), two rigid links, a stylus tip on a contour, and sensors with
//! noise and steps. This is the *truth*. Its parameters and its friction are
//! its own; what servo and estimator believe stands in `ferntast-model`, and
//! the two meet only in what [`SimulatedArm::measure`] gives. From the model
//! come only geometry and the Lagrangian dynamics of rigid links.
//!
//! Time passes by [`SimulatedArm::advance`] alone; all chance comes from the
//! seed: same seed and same inputs, same bytes.

mod contact;
mod elasticity;
mod environment;
mod friction;
mod ground;
mod noise;
mod parameters;
mod plant;
pub(crate) mod sensors;
mod temperature;
mod thermal;
mod torque_sensor;
mod wear;

pub use contact::TrueSurface;
pub use environment::{Environment, GroundJoint, GroundParameters, Sun};
pub use friction::TrueFriction;
pub use parameters::{ArmConfig, TrueJoint, TrueSpringHead, TrueSurfaces, TruthParameters};
pub use sensors::SensorParameters;
pub use temperature::TemperatureDependence;
pub use thermal::{TEMPERATURE_SENSORS, ThermalParameters};
pub use torque_sensor::TorqueSensorErrors;
pub use wear::{GearWear, SurfaceWear};

use ferntast_model::contour::Surface;
use ferntast_model::joint::JointParameters;
use ferntast_model::{ParameterError, Vector2};
// Parts of which an arm of any joints is made too.
pub(crate) use friction::Gear;
pub(crate) use noise::Noise;
use plant::Plant;
pub(crate) use sensors::Encoder;
pub(crate) use thermal::Thermal;
pub(crate) use torque_sensor::TorqueSensor;

/// Joints of the simulated arm: ROKVISS has two.
pub const JOINTS: usize = 2;

/// Why there is no arm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulatedArmError {
    /// A parameter is wrong.
    #[error("arm configuration: {0}")]
    Parameter(#[from] ParameterError),
    /// The tip is on or behind the contour at the start.
    #[error(
        "arm configuration: truth.start_position puts the tip at ({x:.4}, {y:.4}) m, on or behind \
         a {surface:?} surface; start where the tip is free"
    )]
    StartsInContact {
        /// Tip \[m\].
        x: f64,
        /// Tip \[m\].
        y: f64,
        /// The surface.
        surface: Surface,
    },
}

/// What the drives made of a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DriveFlags {
    /// The torque was NaN or infinite; zero was applied instead.
    pub not_finite: [bool; JOINTS],
    /// The torque was beyond the drive's limit and cut to it.
    pub limited: [bool; JOINTS],
}

/// What the sensors give, all on the joint side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Motor position θ \[rad\], in steps of the encoder.
    pub motor_position: [f64; JOINTS],
    /// Motor velocity \[rad/s\]: filtered difference of the encoder.
    pub motor_velocity: [f64; JOINTS],
    /// Joint torque τ \[Nm\] at the torque sensor.
    pub joint_torque: [f64; JOINTS],
    /// The torque sensor is at the end of its range.
    pub torque_saturated: [bool; JOINTS],
    /// Motor current I \[A\].
    pub motor_current: [f64; JOINTS],
    /// Motor torque τ_m \[Nm\] from the current by equation (1), with the
    /// motor constant and gear ratio that are believed.
    pub motor_torque_from_current: [f64; JOINTS],
    /// Mean of the temperature sensors \[degC\].
    pub temperature: [f64; JOINTS],
}

/// What is true, for tests and comparison only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Link positions q \[rad\].
    pub position: [f64; JOINTS],
    /// Link velocities q̇ \[rad/s\].
    pub velocity: [f64; JOINTS],
    /// Motor positions θ \[rad\].
    pub motor_position: [f64; JOINTS],
    /// Motor velocities θ̇ \[rad/s\].
    pub motor_velocity: [f64; JOINTS],
    /// Joint torques τ \[Nm\].
    pub joint_torque: [f64; JOINTS],
    /// Temperatures of the gears \[degC\].
    pub temperature: [f64; JOINTS],
    /// Stylus tip \[m\], base frame.
    pub tip: [f64; 2],
    /// Velocity of the tip \[m/s\], base frame.
    pub tip_velocity: [f64; 2],
    /// Contact force on the tip \[N\], base frame, all fronts together.
    pub force: [f64; 2],
    /// The surface that pushes most; `None` without contact.
    pub surface: Option<Surface>,
    /// Its normal force F_N ≥ 0 \[N\].
    pub normal_force: f64,
    /// Its force on the tip along the tangent, x of the contact frame \[N\].
    pub tangential_force: f64,
    /// Velocity of the tip along the tangent \[m/s\]; zero without contact.
    pub sliding_velocity: f64,
    /// Energy of all parts, kinetic, elastic and potential \[J\].
    pub energy: f64,
    /// Work that the contact did on the tip since the start \[J\].
    pub contact_work: f64,
}

/// The simulated arm.
#[derive(Clone, Debug)]
pub struct SimulatedArm {
    plant: Plant,
    truth: TruthParameters,
    believed: [JointParameters; JOINTS],
    noise: Noise,
    thermal: [Thermal; JOINTS],
    encoders: [Encoder; JOINTS],
    torque_sensors: [TorqueSensor; JOINTS],
    /// True motor torque of the last command \[Nm\].
    motor_torque: Vector2<f64>,
    /// Time since the last measurement \[s\].
    since_measurement: f64,
}

/// Longest time that one call of [`SimulatedArm::advance`] takes \[s\]: a
/// broken clock must not stall the caller.
pub const LONGEST_ADVANCE: f64 = 1.0;

impl SimulatedArm {
    /// An arm at rest at its start position, every sensor reading afterwards
    /// drawn from `seed`.
    ///
    /// # Errors
    ///
    /// A parameter out of bounds, or a start in contact.
    pub fn new(config: &ArmConfig, seed: u64) -> Result<Self, SimulatedArmError> {
        config.validate()?;
        let plant = Plant::new(config);
        let tip = plant.tip();
        for front in &plant.fronts {
            let feature = front.feature();
            if feature.faces(&tip) && feature.distance(&tip) <= 0.0 {
                return Err(SimulatedArmError::StartsInContact {
                    x: tip.x,
                    y: tip.y,
                    surface: feature.surface,
                });
            }
        }
        let mut noise = Noise::new(seed);
        let truth = config.truth.clone();
        let thermal = std::array::from_fn(|joint| {
            let parameters = &truth.joint[joint].thermal;
            Thermal::new(parameters, &truth.environment, joint, &mut noise)
        });
        let encoders = std::array::from_fn(|joint| {
            let parameters = &truth.joint[joint];
            Encoder::new(
                &parameters.sensor,
                parameters.gear_ratio,
                plant.theta[joint],
            )
        });
        let at_start = plant.joint_torque();
        let torque_sensors = std::array::from_fn(|joint| {
            let errors = truth.joint[joint].sensor.torque_errors;
            TorqueSensor::new(errors.unwrap_or_default(), at_start[joint])
        });
        Ok(Self {
            plant,
            believed: config.arm.joints_of_links(&config.joint)?.clone(),
            noise,
            thermal,
            encoders,
            torque_sensors,
            motor_torque: Vector2::zeros(),
            since_measurement: 0.0,
            truth,
        })
    }

    /// Lets `duration` \[s\] pass with the commanded `motor_torque` \[Nm\],
    /// joint side. No time passes for a duration that is not a positive
    /// number; more than [`LONGEST_ADVANCE`] is cut to that.
    ///
    /// The drive turns the torque into a current with the believed motor
    /// constant, and the true one turns the current into torque.
    pub fn advance(&mut self, motor_torque: [f64; JOINTS], duration: f64) -> DriveFlags {
        let mut flags = DriveFlags::default();
        for (joint, mut torque) in motor_torque.into_iter().enumerate() {
            if !torque.is_finite() {
                flags.not_finite[joint] = true;
                torque = 0.0;
            }
            let parameters = &self.truth.joint[joint];
            let limit = parameters.motor_torque_limit;
            flags.limited[joint] = torque.abs() > limit;
            let current = self.believed[joint].motor_current(torque.clamp(-limit, limit));
            self.motor_torque[joint] = parameters.gear_ratio * current / parameters.motor_constant;
        }
        if duration.is_nan() || duration <= 0.0 {
            return flags;
        }
        let duration = duration.min(LONGEST_ADVANCE);
        // The slack keeps a duration of n substeps, rounded, from taking n + 1.
        let count = (duration / self.truth.substep - 1e-6).ceil().max(1.0);
        let dt = duration / count;
        let temperature = [0, 1].map(|joint: usize| self.thermal[joint].temperature());
        let mut heat = [0.0; JOINTS];
        for _ in 0..count as usize {
            let step = self.plant.substep(&self.motor_torque, temperature, dt);
            heat[0] += step[0];
            heat[1] += step[1];
        }
        for (thermal, heat) in self.thermal.iter_mut().zip(heat) {
            thermal.advance(heat, duration);
        }
        self.since_measurement += duration;
        flags
    }

    /// From now on the whole contour is `shift` \[m\] from its place and moves at
    /// `velocity` \[m/s\], base frame.
    pub fn move_contour(&mut self, shift: [f64; 2], velocity: [f64; 2]) {
        self.plant.shift = shift.into();
        self.plant.shift_velocity = velocity.into();
    }

    /// Reads all sensors now.
    pub fn measure(&mut self) -> Measurement {
        let torque = self.plant.joint_torque();
        let mut measurement = Measurement {
            motor_position: [0.0; JOINTS],
            motor_velocity: [0.0; JOINTS],
            joint_torque: [0.0; JOINTS],
            torque_saturated: [false; JOINTS],
            motor_current: [0.0; JOINTS],
            motor_torque_from_current: [0.0; JOINTS],
            temperature: [0.0; JOINTS],
        };
        for joint in 0..JOINTS {
            let parameters = &self.truth.joint[joint];
            let sensor = &parameters.sensor;
            let noise = &mut self.noise;
            let feels = self.torque_sensors[joint].feel(torque[joint], self.since_measurement);
            (
                measurement.motor_position[joint],
                measurement.motor_velocity[joint],
            ) = self.encoders[joint].measure(self.plant.theta[joint], self.since_measurement);
            (
                measurement.joint_torque[joint],
                measurement.torque_saturated[joint],
            ) = sensors::joint_torque(feels, sensor, parameters.torque_sensor_range, noise);
            let current =
                self.motor_torque[joint] * parameters.motor_constant / parameters.gear_ratio;
            let current = sensors::current(current, sensor, noise);
            measurement.motor_current[joint] = current;
            measurement.motor_torque_from_current[joint] =
                self.believed[joint].motor_torque(current);
            measurement.temperature[joint] = self.thermal[joint].measure(noise);
        }
        self.since_measurement = 0.0;
        measurement
    }

    /// What is true now.
    pub fn truth(&self) -> Truth {
        let plant = &self.plant;
        let tip_velocity = plant.tip_velocity();
        let pushing = plant
            .fronts
            .iter()
            .filter(|front| front.normal_force() > 0.0)
            .max_by(|a, b| a.normal_force().total_cmp(&b.normal_force()));
        Truth {
            position: plant.q.into(),
            velocity: plant.qd.into(),
            motor_position: plant.theta.into(),
            motor_velocity: plant.thetad.into(),
            joint_torque: plant.joint_torque().into(),
            temperature: [0, 1].map(|joint: usize| self.thermal[joint].temperature()),
            tip: plant.tip().into(),
            tip_velocity: tip_velocity.into(),
            force: plant.force.into(),
            surface: pushing.map(|front| front.feature().surface),
            normal_force: pushing.map_or(0.0, |front| front.normal_force()),
            tangential_force: pushing.map_or(0.0, |front| front.tangential_force()),
            sliding_velocity: pushing
                .map_or(0.0, |front| tip_velocity.dot(&front.feature().tangent())),
            energy: plant.energy(),
            contact_work: plant.contact_work,
        }
    }
}

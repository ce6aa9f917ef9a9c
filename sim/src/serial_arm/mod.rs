//! A simulated arm of one to eight joints in three dimensions.
//!
//! Motors with inertia, gear and friction, flexible or rigid with rigid links, a ball at
//! the tip that touches planes, boxes, balls and heads of springs, and sensors. As the arm
//! of two joints ([`crate::arm`]), it is the *truth*: of what servo and estimator believe
//! it shares geometry and rigid-body dynamics ([`Chain`]), and no friction or contact.
//!
//! Joint values are in rad or m, torques in Nm or N, all on the joint side of the gear, in
//! the signs of [`rigid_body`](ferntast_model::rigid_body). Time passes by
//! [`SerialArm::advance`] alone; all chance comes from the seed: same seed and same inputs,
//! same bytes. Nothing allocates after [`SerialArm::new`].

mod braking;
mod cholesky;
mod drive;
mod grip;
mod output;
mod parameters;
mod plant;
mod substep;
mod world;

pub use grip::Grip;
pub use output::{DriveFlags, Measurement, Truth};
pub use parameters::{SerialArmParameters, SerialJointParameters};
pub use world::{Motion, Near, ObjectParameters};

use ferntast_model::{
    JointCount, Joints, ParameterError,
    rigid_body::{Chain, ChainError, Vector3},
};

use crate::arm::{Encoder, Gear, LONGEST_ADVANCE, Noise, Thermal, TorqueSensor, sensors};
use drive::Drive;
use plant::Plant;
use substep::substep;
use world::Object;

/// Why there is no arm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SerialArmError {
    /// A parameter is wrong.
    #[error("truth of the arm: {0}")]
    Parameter(#[from] ParameterError),
    /// Joints that make no chain.
    #[error("truth of the arm: {0}")]
    Chain(#[from] ChainError),
    /// The tip is within something at the start.
    #[error(
        "truth of the arm: start_position puts the tip at ({x:.4}, {y:.4}, {z:.4}) m, on or within \
         {object:?}; start where the tip is free, or put {object:?} elsewhere"
    )]
    StartsInContact {
        /// Tip \[m\].
        x: f64,
        /// Tip \[m\].
        y: f64,
        /// Tip \[m\].
        z: f64,
        /// What it touches.
        object: String,
    },
}

/// One joint's drive and sensors.
#[derive(Clone, Debug)]
struct JointParts {
    parameters: SerialJointParameters,
    torque_limit: f64,
    thermal: Option<Thermal>,
    encoder: Encoder,
    torque_sensor: TorqueSensor,
}

/// The simulated arm.
#[derive(Clone, Debug)]
pub struct SerialArm {
    plant: Plant,
    joints: Vec<JointParts>,
    surroundings: f64,
    substep: f64,
    noise: Noise,
    /// True motor torque of the last command.
    motor_torque: Joints<f64>,
    friction_heat: f64,
    since_measurement: f64,
    /// Friction of the gears while no brake is on.
    gears: Joints<Option<Gear>>,
}

impl SerialArm {
    /// An arm at rest at its start position, every sensor reading afterwards drawn from
    /// `seed`. The `chain` is that of the true links; its armatures are the motors' inertias
    /// where the parameters give none. `torque_limits` \[Nm\] or \[N\] hold where they give none.
    ///
    /// # Errors
    ///
    /// A parameter out of bounds, lists of another length, a start in contact, a substep
    /// that does not resolve a contact.
    pub fn new(
        chain: &Chain,
        torque_limits: &Joints<f64>,
        parameters: &SerialArmParameters,
        seed: u64,
    ) -> Result<SerialArm, SerialArmError> {
        parameters.validate()?;
        let count = chain.count();
        count.check("torque limits", torque_limits.len())?;
        let joints = parameters.joints(count.get())?;
        let q = start(count, &parameters.start_position)?;
        let drives = Joints::from_fn(count, |joint| {
            let own = &joints[joint];
            Drive {
                inertia: own.motor_inertia.unwrap_or(chain.armature()[joint]),
                stiffness: own.stiffness,
                damping: own.damping,
                friction: own.friction.map(|friction| friction.on_day(0.0)),
            }
        });
        let links = chain.clone().with_armature(&Joints::filled(count, 0.0))?;
        let gravity = Vector3::from(parameters.gravity);
        let mut plant = Plant::new(links, gravity, drives, parameters.tip_radius, q);
        plant.objects = objects(&plant, parameters)?;
        let substep = substep(&plant, parameters.substep)?;
        let mut noise = Noise::new(seed);
        let parts = joints.into_iter().enumerate();
        let joints = parts.map(|(joint, own)| JointParts {
            torque_limit: own.motor_torque_limit.unwrap_or(torque_limits[joint]),
            thermal: own
                .thermal
                .map(|thermal| Thermal::held(&thermal, parameters.temperature, &mut noise)),
            encoder: Encoder::new(&own.sensor(), own.gear_ratio, plant.theta[joint]),
            torque_sensor: TorqueSensor::new(own.torque_errors(), plant.joint_torque[joint]),
            parameters: own,
        });
        Ok(SerialArm {
            joints: joints.collect(),
            surroundings: parameters.temperature,
            substep,
            noise,
            motor_torque: Joints::filled(count, 0.0),
            friction_heat: 0.0,
            since_measurement: 0.0,
            gears: plant.drives.map(|drive| drive.friction),
            plant,
        })
    }

    /// How many joints it has.
    pub fn count(&self) -> JointCount {
        self.plant.count()
    }

    /// Longest step of its integration \[s\].
    pub fn substep(&self) -> f64 {
        self.substep
    }

    /// Lets `duration` \[s\] pass with the commanded `motor_torque`, joint side. No time
    /// passes for a duration that is not a positive number; more than [`LONGEST_ADVANCE`] is
    /// cut to that.
    ///
    /// The drive turns the torque into a current with the believed motor constant, and the
    /// true one turns the current into torque.
    ///
    /// # Panics
    ///
    /// `motor_torque` has not one value for each joint.
    pub fn advance(&mut self, motor_torque: &Joints<f64>, duration: f64) -> DriveFlags {
        let count = self.count();
        assert_eq!(motor_torque.len(), count.get(), "one value for each joint");
        let mut flags = DriveFlags {
            not_finite: Joints::filled(count, false),
            limited: Joints::filled(count, false),
        };
        for (joint, part) in self.joints.iter().enumerate() {
            let mut torque = motor_torque[joint];
            if !torque.is_finite() {
                flags.not_finite[joint] = true;
                torque = 0.0;
            }
            let limit = part.torque_limit;
            flags.limited[joint] = torque.abs() > limit;
            let true_constant = part.parameters.motor_constant;
            let believed = part.parameters.believed_motor_constant;
            let share = believed.unwrap_or(true_constant) / true_constant;
            self.motor_torque[joint] = torque.clamp(-limit, limit) * share;
        }
        if duration.is_nan() || duration <= 0.0 {
            return flags;
        }
        let duration = duration.min(LONGEST_ADVANCE);
        // The slack keeps a duration of n substeps, rounded, from taking n + 1.
        let steps = (duration / self.substep - 1e-6).ceil().max(1.0);
        let dt = duration / steps;
        let temperature = self.temperature();
        let mut heat = Joints::filled(count, 0.0);
        for _ in 0..steps as usize {
            self.plant
                .substep(&self.motor_torque, &temperature, dt, &mut heat);
        }
        for (part, heat) in self.joints.iter_mut().zip(heat.iter()) {
            self.friction_heat += heat;
            if let Some(thermal) = &mut part.thermal {
                thermal.advance(*heat, duration);
            }
        }
        self.since_measurement += duration;
        flags
    }

    /// Reads all sensors now.
    pub fn measure(&mut self) -> Measurement {
        let zero = Joints::filled(self.count(), 0.0);
        let mut measurement = Measurement {
            motor_position: zero,
            motor_velocity: zero,
            joint_torque: zero,
            torque_saturated: zero.map(|_| false),
            motor_current: zero,
            motor_torque_from_current: zero,
            temperature: zero,
        };
        let (elapsed, noise) = (self.since_measurement, &mut self.noise);
        for (joint, part) in self.joints.iter_mut().enumerate() {
            let (parameters, sensor) = (&part.parameters, part.parameters.sensor());
            let feels = part
                .torque_sensor
                .feel(self.plant.joint_torque[joint], elapsed);
            (
                measurement.motor_position[joint],
                measurement.motor_velocity[joint],
            ) = part.encoder.measure(self.plant.theta[joint], elapsed);
            (
                measurement.joint_torque[joint],
                measurement.torque_saturated[joint],
            ) = sensors::joint_torque(feels, &sensor, parameters.torque_sensor_range, noise);
            let constant = parameters.motor_constant;
            let current = self.motor_torque[joint] * constant / parameters.gear_ratio;
            let current = sensors::current(current, &sensor, noise);
            let believed = parameters.believed_motor_constant.unwrap_or(constant);
            measurement.motor_current[joint] = current;
            measurement.motor_torque_from_current[joint] =
                current * parameters.gear_ratio / believed;
            measurement.temperature[joint] = match &mut part.thermal {
                Some(thermal) => thermal.measure(noise),
                None => self.surroundings,
            };
        }
        self.since_measurement = 0.0;
        measurement
    }

    /// From now on a hand holds the tip like that; `None` lets it go.
    pub fn hold(&mut self, grip: Option<Grip>) {
        self.plant.grip = grip;
    }

    /// Puts the brakes of all motors on, or takes them off. Each holds, and slips under, the
    /// largest torque of its drive.
    pub fn brake(&mut self, on: bool) {
        for (joint, part) in self.joints.iter().enumerate() {
            let friction = match on {
                true => Some(Gear::brake_of(part.torque_limit)),
                false => self.gears[joint],
            };
            self.plant.set_friction(joint, friction);
        }
    }

    fn temperature(&self) -> Joints<f64> {
        Joints::from_fn(self.count(), |joint| {
            let thermal = self.joints[joint].thermal.as_ref();
            thermal.map_or(self.surroundings, Thermal::temperature)
        })
    }

    /// What is true now.
    pub fn truth(&self) -> Truth {
        let plant = &self.plant;
        let (velocity, wrench) = (plant.tip_velocity(), plant.wrench);
        let grip = plant.grip_wrench;
        let touches = plant.objects.iter().map(|object| object.touch).enumerate();
        let pushing = touches
            .filter(|(_, touch)| touch.normal_force > 0.0)
            .max_by(|(_, a), (_, b)| a.normal_force.total_cmp(&b.normal_force));
        let (object, touch) = pushing.unzip();
        let touch = touch.unwrap_or_default();
        Truth {
            position: plant.q,
            velocity: plant.qd,
            motor_position: plant.theta,
            motor_velocity: plant.thetad,
            joint_torque: plant.joint_torque,
            temperature: self.temperature(),
            tip: plant.tip(),
            tip_velocity: velocity.fixed_rows::<3>(0).into_owned(),
            tip_turning: velocity.fixed_rows::<3>(3).into_owned(),
            force: wrench.fixed_rows::<3>(0).into_owned(),
            moment: wrench.fixed_rows::<3>(3).into_owned(),
            grip_force: grip.fixed_rows::<3>(0).into_owned(),
            grip_moment: grip.fixed_rows::<3>(3).into_owned(),
            object,
            normal_force: touch.normal_force,
            normal: touch.normal,
            sliding: touch.sliding,
            energy: plant.energy(),
            contact_work: plant.contact_work,
            motor_work: plant.motor_work,
            friction_heat: self.friction_heat,
        }
    }
}

/// The start position: zero where none is given.
fn start(count: JointCount, given: &[f64]) -> Result<Joints<f64>, ParameterError> {
    if given.is_empty() {
        return Ok(Joints::filled(count, 0.0));
    }
    count.check("start_position", given.len())?;
    Joints::from_slice(given)
}

fn objects(plant: &Plant, parameters: &SerialArmParameters) -> Result<Vec<Object>, SerialArmError> {
    let tip = plant.tip().translation;
    let each = parameters.object.iter().map(|own| {
        let (object, within) = Object::new(own, &tip, parameters.tip_radius);
        if within {
            return Err(SerialArmError::StartsInContact {
                x: tip.x,
                y: tip.y,
                z: tip.z,
                object: own.name.clone(),
            });
        }
        Ok(object)
    });
    each.collect()
}

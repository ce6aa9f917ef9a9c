//! A serial arm before a wall, with the estimator that ships, as a trial has it.

use ferntast_config::{
    ArmFile,
    serial::{Serial, SerialFile},
};
use ferntast_control::{
    estimator::{
        Form, JointMeasurement, MotorMeasurement, SpatialEstimate, SpatialEstimator,
        TorqueByMotorCurrent,
    },
    link::FollowerReadings,
    servo::{Measurement, Servo, ServoConfig, stiffest_serial},
};
use ferntast_drivers::{Choice, Reading, simulated};
use ferntast_model::{Joints, rigid_body::Vector3, serial_arm::Plane};
use ferntast_sim::teleoperation::{Environment, Estimated, TICK, TrialArm, TrueTip};

use super::{
    ArmsError,
    plant::{Plant, Touching},
};

/// An arm out of a URDF, and what it costs to put it before walls.
pub(super) struct ArmOfSweep {
    pub(super) name: String,
    file: SerialFile,
    tip: Vector3<f64>,
    pub(super) joints: usize,
    /// Of its servo at the tip [N/m].
    pub(super) stiffness: Option<f64>,
}

impl ArmOfSweep {
    /// The arm `name`, one that comes along or a file.
    pub(super) fn load(name: &str) -> Result<ArmOfSweep, ArmsError> {
        let arm = simulated::load_arm(name)?;
        let Some(serial) = arm.model.serial() else {
            return Err(ArmsError::Planar(name.to_owned()));
        };
        let file: SerialFile = arm.whole()?;
        Ok(ArmOfSweep {
            name: serial.name.clone(),
            tip: serial.arm.home_tip().translation,
            joints: serial.arm.count().get(),
            stiffness: stiffest_serial(&serial.arm, &file.servo),
            file,
        })
    }

    /// Where the surface begins, base frame \[m\], if the tip at home is at `start` \[m\] before it.
    pub(super) fn origin(&self, start: [f64; 2]) -> [f64; 3] {
        (self.tip - Vector3::new(start[0], start[1], 0.0)).into()
    }

    /// Its servo.
    pub(super) fn servo(&self) -> &ServoConfig {
        &self.file.servo
    }

    /// Its file with nothing to touch but a wall across x through `origin` \[m\].
    fn before(&self, environment: Environment, origin: [f64; 3]) -> Result<ArmFile, ArmsError> {
        let mut file = self.file.clone();
        let (stiffness, damping) = environment.surface();
        file.surface = vec![Plane {
            name: environment.name().to_owned(),
            point: origin,
            normal: [-1.0, 0.0, 0.0],
            stiffness,
            damping,
            friction: environment.friction(),
        }];
        let truth = file.truth.as_mut().and_then(|own| own.as_object_mut());
        truth.and_then(|own| own.remove("object"));
        Ok(ArmFile::serial(&file)?)
    }
}

/// The arm with its plant and its estimator.
pub(super) struct DrivenArm {
    origin: Vector3<f64>,
    plant: Plant,
    estimator: SpatialEstimator,
    /// Joint torques, where no sensor tells them.
    by_motors: Option<TorqueByMotorCurrent>,
    /// What the plant gave last, and before that.
    readings: [Option<Reading>; 2],
    truth: Touching,
}

impl DrivenArm {
    /// At home before a wall through `origin`, with its servo.
    pub(super) fn new(
        arm: &ArmOfSweep,
        driver: &Choice,
        environment: Environment,
        origin: [f64; 3],
        seed: u64,
    ) -> Result<(DrivenArm, Servo), ArmsError> {
        let file = arm.before(environment, origin)?;
        let serial = file.model.serial();
        let serial: &Serial = serial.ok_or_else(|| ArmsError::Planar(arm.name.clone()))?;
        let mut plant = Plant::new(driver, &file, serial, seed)?;
        let rest = Joints::filled(serial.arm.count(), 0.0);
        let first = plant.step(&rest, None);
        let (config, parameters) = (arm.servo(), &file.estimator);
        let by_motors = (parameters.form == Form::MotorCurrent)
            .then(|| TorqueByMotorCurrent::new(serial.arm.joints(), parameters, config.take_over));
        let own = DrivenArm {
            origin: origin.into(),
            truth: plant.touching().ok_or_else(|| match plant.failure() {
                Some(reason) => ArmsError::Plant(reason),
                None => ArmsError::NoTruth,
            })?,
            plant,
            estimator: SpatialEstimator::new(&serial.arm, parameters)?,
            by_motors: by_motors.transpose()?,
            readings: [first; 2],
        };
        Ok((own, Servo::serial(&serial.arm, config)?))
    }

    /// Why the plant can do no more.
    pub(super) fn failure(&self) -> Option<String> {
        self.plant.failure()
    }

    fn step_estimator(&mut self, measured: &Measurement) -> SpatialEstimate {
        let Some(by_motors) = &mut self.by_motors else {
            let measurement = JointMeasurement {
                motor_position: measured.position,
                joint_torque: measured.torque,
            };
            return self.estimator.step(TICK, &measurement);
        };
        let motor = self.readings[1].and_then(|own| own.motor_torque);
        let unknown = Joints::filled(self.estimator.joints(), f64::NAN);
        let measurement = MotorMeasurement {
            position: measured.position,
            torque: motor.unwrap_or(unknown),
        };
        let torque = by_motors.step(TICK, &measurement);
        self.estimator.step_by_motors(TICK, &torque)
    }
}

impl TrialArm for DrivenArm {
    fn advance(&mut self, _since: f64, torque: &Joints<f64>) {
        let reading = self.plant.step(torque, Some(TICK));
        self.readings = [reading, self.readings[0]];
        if let Some(truth) = self.plant.touching() {
            self.truth = truth;
        }
    }

    fn measure(&mut self, now_ns: i64) -> Option<Measurement> {
        let reading = self.readings[0]?;
        Some(Measurement {
            stamp_ns: now_ns,
            position: reading.position,
            velocity: reading.velocity,
            torque: reading
                .joint_torque
                .unwrap_or(Joints::filled(self.estimator.joints(), 0.0)),
        })
    }

    fn temperature(&self) -> Option<Joints<f64>> {
        self.readings[0].and_then(|own| own.temperature)
    }

    fn estimate(&mut self, measured: &Measurement) -> Estimated {
        let estimate = self.step_estimator(measured);
        Estimated {
            tip: (!estimate.state.input_invalid).then_some(estimate.tip),
            force: FollowerReadings::force_of(
                estimate.state.valid,
                estimate.state.touches,
                estimate.force,
            ),
        }
    }

    fn truth(&self) -> TrueTip {
        let Touching { tip, force, work } = self.truth;
        let place = tip - self.origin;
        TrueTip {
            position: [place.x, place.y],
            force: [force.x, force.y],
            work,
        }
    }
}

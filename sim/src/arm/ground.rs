//! The arm on the ground, before the launch.

use super::JOINTS;
use super::parameters::ArmConfig;
use ferntast_model::ParameterError;

impl ArmConfig {
    /// The same arm on the ground, before the launch: gravity along −y, and
    /// stiffness, friction and temperature of the section `[ground]`, which
    /// hold there as they are: nothing is worn. What is believed follows.
    ///
    /// # Errors
    ///
    /// [`ParameterError::Missing`] when there is no such section.
    pub fn on_ground(&self) -> Result<ArmConfig, ParameterError> {
        let Some(ground) = &self.ground else {
            return Err(ParameterError::Missing {
                key: "ground".into(),
                unit: "section",
            });
        };
        let mut config = self.clone();
        config.arm = config.arm.on_ground();
        config.truth.arm = config.truth.arm.map(|arm| arm.on_ground());
        config.truth.environment.day = ground.day;
        config.truth.environment.temperature = Some([ground.temperature; JOINTS]);
        let arm = config.joint.iter_mut().zip(&mut config.truth.joint);
        for ((believed, truth), joint) in arm.zip(&ground.joint) {
            believed.stiffness = joint.stiffness;
            believed.friction = joint.friction.clone();
            truth.stiffness = joint.stiffness;
            truth.friction.set(&joint.friction);
            truth.friction.wear = None;
            if let Some(dependence) = &mut truth.friction.temperature {
                dependence.reference = ground.temperature;
            }
        }
        Ok(config)
    }
}

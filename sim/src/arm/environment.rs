//! Where and when the arm is: date, sun, gravity.

use super::parameters::ArmConfig;
use ferntast_model::friction::FrictionParameters;
use ferntast_model::{JOINTS, ParameterError, check};
use serde::{Deserialize, Serialize};

/// Date and surroundings of the simulated arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Environment {
    /// Days since 2005-01-26 10:00 UTC, when the arm was mounted outside.
    pub day: f64,
    /// Holds surroundings and gears at these temperatures instead of sun and
    /// heaters \[degC\]; friction still warms the gears.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<[f64; JOINTS]>,
    /// The sun as the arm sees it.
    pub sun: Sun,
}

impl Environment {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("day", self.day, -3652.5, 36_525.0, "d")?;
        for (key, value) in ["temperature[0]", "temperature[1]"]
            .into_iter()
            .zip(self.temperature.into_iter().flatten())
        {
            check(key, value, -150.0, 150.0, "degC")?;
        }
        self.sun.validate().map_err(|error| error.within("sun"))
    }
}

/// The sun: it rises and sets once an orbit, and the orbit's plane turns
/// against it in some two months.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    /// Time of one orbit \[s\].
    pub orbit_period: f64,
    /// Share of an orbit that is sunlit \[-\].
    pub sunlit: f64,
    /// Days in which the orbit's plane turns once against the sun \[d\].
    pub season_period: f64,
    /// Mission day of the strongest sun \[d\].
    pub season_peak: f64,
    /// How much the sun's power varies with the season, as a share of its mean \[-\].
    pub season_share: f64,
}

impl Sun {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("orbit_period", self.orbit_period, 60.0, 1e6, "s")?;
        check("sunlit", self.sunlit, 0.0, 1.0, "-")?;
        check("season_period", self.season_period, 0.1, 1e4, "d")?;
        check("season_peak", self.season_peak, -1e5, 1e5, "d")?;
        check("season_share", self.season_share, 0.0, 1.0, "-")
    }

    /// Share of the sun's mean power that reaches the arm at the time `seconds`
    /// \[s\] since the start of the mission.
    pub(super) fn share(&self, seconds: f64) -> f64 {
        let orbit = (seconds / self.orbit_period).rem_euclid(1.0);
        if orbit >= self.sunlit {
            return 0.0;
        }
        let days = seconds / SECONDS_PER_DAY - self.season_peak;
        let season = (std::f64::consts::TAU * days / self.season_period).cos();
        1.0 + self.season_share * season
    }
}

/// Seconds of a day.
pub(super) const SECONDS_PER_DAY: f64 = 86_400.0;

/// What is different on the ground: section `[ground]` of an arm's file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundParameters {
    /// Temperature of the laboratory \[degC\].
    pub temperature: f64,
    /// Mission day of the measurements there, before the launch.
    pub day: f64,
    /// Joint 1 and joint 2.
    pub joint: [GroundJoint; JOINTS],
}

/// One joint on the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundJoint {
    /// Stiffness of flex spline and torque sensor \[Nm/rad\].
    pub stiffness: f64,
    /// Friction, as it is and as it is believed.
    pub friction: FrictionParameters,
}

impl GroundParameters {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("temperature", self.temperature, -150.0, 150.0, "degC")?;
        check("day", self.day, -3652.5, 0.0, "d")?;
        for (index, joint) in self.joint.iter().enumerate() {
            let within = |error: ParameterError| error.within(&format!("joint[{index}]"));
            check("stiffness", joint.stiffness, 10.0, 1e5, "Nm/rad").map_err(within)?;
            joint
                .friction
                .validate()
                .map_err(|error| within(error.within("friction")))?;
        }
        Ok(())
    }
}

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
        for (index, joint) in ground.joint.iter().enumerate() {
            let (believed, truth) = (&mut config.joint[index], &mut config.truth.joint[index]);
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

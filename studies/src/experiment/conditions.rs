//! Place, date and temperature of an experiment.

use ferntast_model::ParameterError;
use ferntast_msgs::Time;
use ferntast_sim::arm::{ArmConfig, JOINTS};
use serde::{Deserialize, Serialize};

/// Day 0 of the mission: 2005-01-26 10:00 UTC \[s since the UNIX epoch\], when
/// the arm was mounted outside.
pub const MISSION_START: i64 = 1_106_733_600;
const SECONDS_PER_DAY: f64 = 86_400.0;

/// Place, date and temperature; what is not given stays as the arm's file says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conditions {
    /// On the ground, before the launch.
    #[serde(default)]
    pub ground: bool,
    /// Days since [`MISSION_START`].
    #[serde(default)]
    pub day: Option<f64>,
    /// Temperature that joints and surroundings are held at \[degC\]; without
    /// it, sun and heaters make it.
    #[serde(default)]
    pub temperature: Option<f64>,
}

impl Conditions {
    /// In space on `day`.
    pub fn on_day(day: f64) -> Self {
        Conditions {
            day: Some(day),
            ..Conditions::default()
        }
    }

    /// The arm under these conditions.
    ///
    /// # Errors
    ///
    /// On the ground, an arm's file that says nothing of it.
    pub fn arm(&self, arm: &ArmConfig) -> Result<ArmConfig, ParameterError> {
        let mut arm = match self.ground {
            true => arm.on_ground()?,
            false => arm.clone(),
        };
        let environment = &mut arm.truth.environment;
        if let Some(day) = self.day {
            environment.day = day;
        }
        if let Some(temperature) = self.temperature {
            environment.temperature = Some([temperature; JOINTS]);
        }
        Ok(arm)
    }

    /// Virtual time at the start, for an arm under these conditions.
    pub fn start(arm: &ArmConfig) -> Time {
        let since = arm.truth.environment.day * SECONDS_PER_DAY;
        Time::from_nanos(MISSION_START * 1_000_000_000).plus_seconds(since)
    }
}

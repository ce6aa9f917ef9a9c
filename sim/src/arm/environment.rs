//! Where and when the arm is: date, sun, gravity.

use super::JOINTS;
use ferntast_model::friction::FrictionParameters;
use ferntast_model::parameters;

parameters! {
    /// Date and surroundings of the simulated arm.
    #[derive(Copy)]
    pub struct Environment {
        /// Days since 2005-01-26 10:00 UTC, when the arm was mounted outside.
        pub day: f64 [-3652.5..=36_525.0, "d"],
        /// Holds surroundings and gears at these temperatures instead of sun and
        /// heaters \[degC\]; friction still warms the gears.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub temperature: Option<[f64; JOINTS]> [-150.0..=150.0, "degC"],
        /// The sun as the arm sees it.
        pub sun: Sun [section],
    }
}

parameters! {
    /// The sun: it rises and sets once an orbit, and the orbit's plane turns
    /// against it in some two months.
    #[derive(Copy)]
    pub struct Sun {
        /// Time of one orbit \[s\].
        pub orbit_period: f64 [60.0..=1e6, "s"],
        /// Share of an orbit that is sunlit \[-\].
        pub sunlit: f64 [0.0..=1.0, "-"],
        /// Days in which the orbit's plane turns once against the sun \[d\].
        pub season_period: f64 [0.1..=1e4, "d"],
        /// Mission day of the strongest sun \[d\].
        pub season_peak: f64 [-1e5..=1e5, "d"],
        /// How much the sun's power varies with the season, as a share of its mean \[-\].
        pub season_share: f64 [0.0..=1.0, "-"],
    }
}

impl Sun {
    /// Share of the sun's mean power that reaches the arm at the time `seconds`
    /// \[s\] since the start of the mission.
    pub(super) fn share(&self, seconds: f64) -> f64 {
        let orbits = seconds / self.orbit_period;
        // The same as `rem_euclid(1.0)`, which divides bit by bit.
        let orbit = orbits - orbits.floor();
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

parameters! {
    /// What is different on the ground: section `[ground]` of an arm's file.
    pub struct GroundParameters {
        /// Temperature of the laboratory \[degC\].
        pub temperature: f64 [-150.0..=150.0, "degC"],
        /// Mission day of the measurements there, before the launch.
        pub day: f64 [-3652.5..=0.0, "d"],
        /// Joint 1 and joint 2.
        pub joint: [GroundJoint; JOINTS] [section],
    }
}

parameters! {
    /// One joint on the ground.
    pub struct GroundJoint {
        /// Stiffness of flex spline and torque sensor \[Nm/rad\].
        pub stiffness: f64 [10.0..=1e5, "Nm/rad"],
        /// Friction, as it is and as it is believed.
        pub friction: FrictionParameters [section],
    }
}

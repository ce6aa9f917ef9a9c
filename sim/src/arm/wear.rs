//! What two years outside do to gears and surfaces.

use super::contact::TrueSurface;
use super::friction::TrueFriction;
use ferntast_model::parameters;

const DAYS_PER_YEAR: f64 = 365.25;

parameters! {
    /// Wear of one gear: all its friction grows evenly with the days (Figs. 7, 10, 11).
    #[derive(Copy)]
    pub struct GearWear {
        /// Growth of friction, as a share of it \[1/year\].
        pub per_year: f64 [0.0..=1.0, "1/year"],
        /// Mission day at which the friction parameters hold as they are.
        pub reference_day: f64 [0.0..=36_525.0, "d"],
    }
}

impl GearWear {
    /// `friction` as it is on `day` of the mission.
    pub(super) fn worn(&self, friction: &TrueFriction, day: f64) -> TrueFriction {
        let years = (day - self.reference_day) / DAYS_PER_YEAR;
        let share = (1.0 + self.per_year * years).max(0.0);
        TrueFriction {
            b_0: friction.b_0 * share,
            b_0t: friction.b_0t * share,
            b_1: friction.b_1 * share,
            b_2: friction.b_2 * share,
            b_3: friction.b_3 * share,
            ..*friction
        }
    }
}

parameters! {
    /// Wear of a surface: its Coulomb coefficient goes from `friction` on day 0
    /// towards `worn_friction` (Fig. 17).
    #[derive(Copy)]
    pub struct SurfaceWear {
        /// Coulomb coefficient in the end \[-\].
        pub worn_friction: f64 [0.0..=3.0, "-"],
        /// Days in which 63 % of the way is gone \[d\].
        pub days: f64 [1e-3..=1e6, "d"],
    }
}

impl SurfaceWear {
    /// `surface` as it is on `day` of the mission; before it, as on day 0.
    pub(super) fn worn(&self, surface: &TrueSurface, day: f64) -> TrueSurface {
        let left = (-day.max(0.0) / self.days).exp();
        TrueSurface {
            friction: self.worn_friction + (surface.friction - self.worn_friction) * left,
            ..*surface
        }
    }
}

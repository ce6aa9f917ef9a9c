//! What two years outside do to gears and surfaces.

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
    /// What friction is multiplied by on `day` of the mission.
    pub(super) fn share(&self, day: f64) -> f64 {
        let years = (day - self.reference_day) / DAYS_PER_YEAR;
        (1.0 + self.per_year * years).max(0.0)
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
    /// The Coulomb coefficient on `day` of the mission, of a surface that had `first` on day 0 and
    /// before it.
    pub(super) fn friction(&self, first: f64, day: f64) -> f64 {
        let left = (-day.max(0.0) / self.days).exp();
        self.worn_friction + (first - self.worn_friction) * left
    }
}

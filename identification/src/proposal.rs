//! What to record next: the motion or condition that shows what these data
//! leave open.

use serde::{Serialize, Serializer};

/// A motion or condition of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Proposal {
    /// Strong and fast moves, free of load.
    FastUnloaded,
    /// Short slow strokes with many reversals, at several loads.
    SlowReversals,
    /// Constant speeds from the slowest to the fastest, free of load.
    WideSpeedRange,
    /// Slow sweeps over the whole range of positions, free of load.
    WidePosition,
    /// The same few speeds at several loads.
    LoadSteps,
    /// Fast changes of speed and load.
    Accelerations,
    /// The same motion over the whole range of temperature, within one day.
    TemperatureSweep,
    /// The same motion at one temperature, on dates far apart.
    DateSweep,
    /// A contact slid along at the same few speeds under several normal forces.
    ContactForces,
    /// A contact slid along at constant speeds from the slowest to the fastest.
    ContactSpeeds,
    /// Many turns of a tip in contact, short and slow, under several normal forces.
    ContactTurns,
    /// A contact slid along from end to end.
    ContactSweep,
    /// The same sliding on dates far apart.
    ContactDates,
}

use Proposal::{
    Accelerations, ContactDates, ContactForces, ContactSpeeds, ContactSweep, ContactTurns,
    DateSweep, FastUnloaded, LoadSteps, SlowReversals, TemperatureSweep, WidePosition,
    WideSpeedRange,
};

/// Which effects a motion tells from each other, the most telling motion first.
const TELLS_APART: [(Proposal, &[&str]); 14] = [
    (
        TemperatureSweep,
        &["temperature_coulomb", "temperature_viscous", "wear_drift"],
    ),
    (
        SlowReversals,
        &[
            "presliding_hysteresis",
            "backlash",
            "elasticity",
            "coulomb",
            "stribeck",
        ],
    ),
    (
        WideSpeedRange,
        &[
            "coulomb",
            "stribeck",
            "viscous",
            "quadratic_viscous",
            "cubic_viscous",
            "nonlinear_viscous",
            "asymmetric_viscous",
        ],
    ),
    (
        FastUnloaded,
        &[
            "motor_constant",
            "torque_sensor_gain",
            "load_coulomb",
            "inertia",
        ],
    ),
    // Free of load, what goes with position is still there, at any speed.
    (
        FastUnloaded,
        &["motor_constant", "torque_sensor_gain", "cable_spring"],
    ),
    (
        FastUnloaded,
        &["motor_constant", "torque_sensor_gain", "gravity"],
    ),
    (
        WidePosition,
        &[
            "gravity",
            "cable_spring",
            "ripple",
            "local_friction",
            "torque_sensor_gain",
            "torque_sensor_offset",
            "asymmetric_coulomb",
        ],
    ),
    (
        LoadSteps,
        &["load_coulomb", "cable_spring", "gravity", "coulomb"],
    ),
    (
        Accelerations,
        &[
            "channel_delay",
            "inertia",
            "viscous",
            "elasticity",
            "ripple",
        ],
    ),
    (
        ContactDates,
        &["contact_wear", "contact_coulomb", "contact_spot"],
    ),
    (ContactTurns, &["contact_compliance", "contact_stribeck"]),
    (
        ContactSpeeds,
        &["contact_coulomb", "contact_viscous", "contact_stribeck"],
    ),
    (
        ContactForces,
        &["contact_coulomb", "contact_viscous", "contact_stribeck"],
    ),
    (
        ContactSweep,
        &["contact_spot", "contact_coulomb", "contact_stribeck"],
    ),
];

impl Proposal {
    /// All of them.
    pub const ALL: [Self; 13] = [
        FastUnloaded,
        SlowReversals,
        WideSpeedRange,
        WidePosition,
        LoadSteps,
        Accelerations,
        TemperatureSweep,
        DateSweep,
        ContactForces,
        ContactSpeeds,
        ContactTurns,
        ContactSweep,
        ContactDates,
    ];

    /// Name in files and results.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            FastUnloaded => "fast_unloaded",
            SlowReversals => "slow_reversals",
            WideSpeedRange => "wide_speed_range",
            WidePosition => "wide_position",
            LoadSteps => "load_steps",
            Accelerations => "accelerations",
            TemperatureSweep => "temperature_sweep",
            DateSweep => "date_sweep",
            ContactForces => "contact_forces",
            ContactSpeeds => "contact_speeds",
            ContactTurns => "contact_turns",
            ContactSweep => "contact_sweep",
            ContactDates => "contact_dates",
        }
    }

    /// What to do, for people.
    #[must_use]
    pub const fn instruction(self) -> &'static str {
        match self {
            FastUnloaded => "strong and fast moves, the joint free of load",
            SlowReversals => "short slow strokes with many reversals, at several loads",
            WideSpeedRange => {
                "constant speeds from the slowest to the fastest, both directions, the joint free of load"
            }
            WidePosition => {
                "slow sweeps over the widest range of positions, the joint free of load"
            }
            LoadSteps => "the same few speeds at several loads",
            Accelerations => "fast changes of speed and load",
            TemperatureSweep => {
                "the same motion over the whole range of temperature, all within a day"
            }
            DateSweep => "the same motion at one temperature, on dates far apart",
            ContactForces => {
                "slide along the contour at the same few speeds under several normal forces"
            }
            ContactSpeeds => {
                "slide along the contour at constant speeds from the slowest to the fastest, both directions"
            }
            ContactTurns => "many short slow strokes along the contour under several normal forces",
            ContactSweep => "slide along the whole contour, slowly, both directions",
            ContactDates => "the same sliding, at one temperature, on dates far apart",
        }
    }

    /// True where the joint is free of load, so that the torque sensor's own
    /// zero shows (list such recordings as `unloaded`).
    #[must_use]
    pub const fn is_unloaded(self) -> bool {
        matches!(self, FastUnloaded | WideSpeedRange | WidePosition)
    }

    /// What tells the effect `own` from its `rivals`, from as many as one
    /// recording can; `alone` is what shows `own` by itself.
    #[must_use]
    pub fn between(own: &str, rivals: &[&str], alone: Self) -> Self {
        let told = |by: Self| {
            let tells = |rival: &str| {
                TELLS_APART.iter().any(|(proposal, effects)| {
                    *proposal == by && effects.contains(&own) && effects.contains(&rival)
                })
            };
            rivals.iter().filter(|rival| tells(rival)).count()
        };
        let mut best = (alone, 0);
        for (proposal, _) in TELLS_APART {
            let told = told(proposal);
            if told > best.1 {
                best = (proposal, told);
            }
        }
        best.0
    }
}

impl Serialize for Proposal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_family_is_put_to_the_motion_that_tells_most_of_it_apart() {
        let between = |own, rivals: &[&str]| Proposal::between(own, rivals, LoadSteps);
        assert_eq!(
            between("wear_drift", &["temperature_coulomb"]),
            TemperatureSweep
        );
        assert_eq!(between("gravity", &["cable_spring"]), WidePosition);
        assert_eq!(
            between("quadratic_viscous", &["cubic_viscous", "nonlinear_viscous"]),
            WideSpeedRange
        );
        assert_eq!(
            between("backlash", &["presliding_hysteresis"]),
            SlowReversals
        );
        assert_eq!(between("inertia", &["channel_delay"]), Accelerations);
        assert_eq!(
            between(
                "torque_sensor_gain",
                &["cable_spring", "gravity", "motor_constant"]
            ),
            FastUnloaded
        );
        // One rival each way: the first.
        assert_eq!(
            between("load_coulomb", &["motor_constant", "cable_spring"]),
            FastUnloaded
        );
        assert_eq!(between("ripple", &[]), LoadSteps);
        assert_eq!(
            between("ripple", &["an effect of the user's own"]),
            LoadSteps
        );
    }
}

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

/// Effects that one recording tells from each other. An effect of the catalogue
/// lists those that it is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contrast {
    /// Temperature against date, by [`TemperatureSweep`].
    TemperatureSweep,
    /// By [`SlowReversals`].
    SlowReversals,
    /// By [`WideSpeedRange`].
    WideSpeedRange,
    /// What goes with load, by [`FastUnloaded`].
    FastByLoad,
    /// The same beside a spring: free of load, what goes with position is still
    /// there, at any speed.
    FastBySpring,
    /// The same beside a weight.
    FastByWeight,
    /// By [`WidePosition`].
    WidePosition,
    /// By [`LoadSteps`].
    LoadSteps,
    /// By [`Accelerations`].
    Accelerations,
    /// By [`ContactDates`].
    ContactDates,
    /// By [`ContactTurns`].
    ContactTurns,
    /// By [`ContactSpeeds`].
    ContactSpeeds,
    /// By [`ContactForces`].
    ContactForces,
    /// By [`ContactSweep`].
    ContactSweep,
}

impl Contrast {
    /// All of them, the most telling first.
    pub const ALL: [Self; 14] = [
        Self::TemperatureSweep,
        Self::SlowReversals,
        Self::WideSpeedRange,
        Self::FastByLoad,
        Self::FastBySpring,
        Self::FastByWeight,
        Self::WidePosition,
        Self::LoadSteps,
        Self::Accelerations,
        Self::ContactDates,
        Self::ContactTurns,
        Self::ContactSpeeds,
        Self::ContactForces,
        Self::ContactSweep,
    ];

    /// The recording.
    #[must_use]
    pub const fn proposal(self) -> Proposal {
        match self {
            Self::TemperatureSweep => TemperatureSweep,
            Self::SlowReversals => SlowReversals,
            Self::WideSpeedRange => WideSpeedRange,
            Self::FastByLoad | Self::FastBySpring | Self::FastByWeight => FastUnloaded,
            Self::WidePosition => WidePosition,
            Self::LoadSteps => LoadSteps,
            Self::Accelerations => Accelerations,
            Self::ContactDates => ContactDates,
            Self::ContactTurns => ContactTurns,
            Self::ContactSpeeds => ContactSpeeds,
            Self::ContactForces => ContactForces,
            Self::ContactSweep => ContactSweep,
        }
    }
}

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

    /// What tells an effect with the contrasts `own` from its `rivals`, from as
    /// many as one recording can; `alone` is what shows it by itself.
    #[must_use]
    pub fn between(own: &[Contrast], rivals: &[&[Contrast]], alone: Self) -> Self {
        let told = |by: Self| {
            let tells = |rival: &&&[Contrast]| {
                let mut shared = own.iter().filter(|contrast| rival.contains(contrast));
                shared.any(|contrast| contrast.proposal() == by)
            };
            rivals.iter().filter(tells).count()
        };
        let mut best = (alone, 0);
        for contrast in Contrast::ALL {
            let told = told(contrast.proposal());
            if told > best.1 {
                best = (contrast.proposal(), told);
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

//! Motions that the lab can ask for, as position over time.

use std::f64::consts::PI;

use ferntast_emulation::random::Random;

use crate::bench::{Programme, named};

named! {
    /// A motion that a session runs.
    ///
    /// Each one after the first shows what the standard motion leaves confounded.
    #[derive(Default)]
    pub enum Motion or UnknownMotion {
        /// The paper's: the contour's spring pulled at 1, 5, 10, 20 and 40 °/s,
        /// then a sine, then moves to random places at random speeds.
        #[default]
        Standard = "standard",
        /// No spring; strong and fast moves. Tells motor constant, torque gain and
        /// load-dependent friction apart, shows inertia and delays.
        FastUnloaded = "fast_unloaded",
        /// Short slow strokes with many reversals, at several loads. Shows
        /// presliding, backlash, elasticity, Stribeck.
        SlowReversals = "slow_reversals",
        /// No spring; constant speeds from 0.5 to 57 °/s in both directions. Tells
        /// the viscous terms and Stribeck apart.
        WideSpeedRange = "wide_speed_range",
        /// No spring; slow sweeps over ±86°. Tells gravity from a cable, ripple
        /// from one local spot.
        WidePosition = "wide_position",
        /// The same few speeds, at strokes that lie at different loads on both
        /// springs. Tells what goes with load from what goes with position.
        LoadSteps = "load_steps",
        /// Sawtooth and sines of rising frequency under load. Tells delays from
        /// inertia and viscous friction.
        Accelerations = "accelerations",
        /// The standard motion with all sessions on one date, spread over the whole
        /// range of temperature and warming up by 8 K each. Tells temperature from wear.
        TemperatureSweep = "temperature_sweep",
        /// The standard motion at one temperature, on dates far apart. Tells wear
        /// from temperature.
        DateSweep = "date_sweep",
    }
}

impl Motion {
    /// True where the joint pulls the contour's springs.
    pub fn has_springs(self) -> bool {
        !matches!(
            self,
            Motion::FastUnloaded | Motion::WideSpeedRange | Motion::WidePosition
        )
    }

    /// Position over time that a session follows, which runs it so many `rounds`.
    pub(super) fn programme(self, rounds: usize, random: &mut Random) -> Programme {
        let mut programme = Programme::default();
        programme.rest(0.3);
        for _ in 0..rounds {
            self.round(&mut programme, random);
            programme.to(0.0, 0.25, 2.0);
        }
        programme.rest(0.3);
        programme
    }

    fn round(self, programme: &mut Programme, random: &mut Random) {
        match self {
            Motion::Standard | Motion::TemperatureSweep | Motion::DateSweep => {
                standard(programme, random);
            }
            Motion::FastUnloaded => fast(programme, random),
            Motion::SlowReversals => slow_reversals(programme, random),
            Motion::WideSpeedRange => wide_speeds(programme),
            Motion::WidePosition => wide_position(programme),
            Motion::LoadSteps => load_steps(programme),
            Motion::Accelerations => accelerations(programme),
        }
    }
}

/// A joint at its work: the same few moves over and over, at one speed, with rests.
pub(super) fn routine(random: &mut Random) -> Programme {
    let mut programme = Programme::default();
    programme.rest(0.3);
    let speed = DEGREE * (8.0 + 10.0 * random.uniform());
    let places: [f64; 4] = std::array::from_fn(|n| 0.14 * n as f64 - 0.1 + 0.06 * random.uniform());
    let rest = 0.6 + 0.6 * random.uniform();
    for _ in 0..12 {
        for place in [places[0], places[2], places[1], places[3]] {
            programme.to(place, speed, 2.0);
            programme.rest(rest);
        }
    }
    programme
}

const DEGREE: f64 = PI / 180.0;

fn standard(programme: &mut Programme, random: &mut Random) {
    // The slowest leg is kept short, or it would be most of the session.
    let reach = 0.38 + 0.14 * random.uniform();
    programme.stroke(0.0, 0.4 * reach, 1.0 * DEGREE, 4.0);
    for speed in [5.0, 10.0, 20.0, 40.0] {
        programme.stroke(0.0, reach, speed * DEGREE, 4.5);
    }
    programme.sine(0.5 * reach, 32.0 * DEGREE, 4.0);
    for _ in 0..13 {
        let target = -0.12 + 0.70 * random.uniform();
        let speed = DEGREE * (4.0 + 37.0 * random.uniform() * random.uniform().sqrt());
        programme.to(target, speed, 2.0 + 6.0 * random.uniform());
    }
}

fn fast(programme: &mut Programme, random: &mut Random) {
    for _ in 0..32 {
        let target = -0.5 + random.uniform();
        let speed = DEGREE * (10.0 + 34.0 * random.uniform());
        programme.to(target, speed, 2.0 + 8.0 * random.uniform());
    }
    for reach in [0.08, 0.16, 0.32] {
        programme.to(0.0, 0.3, 3.0);
        programme.sine(reach, 38.0 * DEGREE, 8.0);
    }
}

fn slow_reversals(programme: &mut Programme, random: &mut Random) {
    for centre in [0.0, 0.12, 0.30] {
        for reach in [0.05, 0.025, 0.012, 0.006, 0.003] {
            let speed = DEGREE * (0.8 + 1.2 * random.uniform());
            programme.to(centre, 0.1, 2.0);
            for _ in 0..2 {
                programme.to(centre + reach, speed, 1.0);
                programme.to(centre - reach, speed, 1.0);
            }
        }
        programme.to(centre, 0.1, 2.0);
        programme.stroke(centre, centre + 0.15, 8.0 * DEGREE, 3.0);
    }
}

fn wide_speeds(programme: &mut Programme) {
    for (speed, reach) in [
        (0.5, 0.06),
        (1.0, 0.08),
        (2.0, 0.10),
        (3.5, 0.15),
        (6.0, 0.2),
        (10.0, 0.3),
        (15.0, 0.4),
        (20.0, 0.5),
        (26.0, 0.6),
        (33.0, 0.7),
        (40.0, 0.8),
        (48.0, 0.9),
        (57.0, 1.0),
    ] {
        programme.stroke(-0.5 * reach, 0.5 * reach, speed * DEGREE, 5.0);
    }
}

fn wide_position(programme: &mut Programme) {
    programme.stroke(-1.5, 1.5, 30.0 * DEGREE, 4.0);
    programme.to(-1.5, 0.5, 4.0);
    programme.stroke(-1.5, 1.5, 8.0 * DEGREE, 4.0);
    programme.to(-0.2, 0.3, 3.0);
    programme.to(0.2, 2.0 * DEGREE, 1.0);
    programme.to(-0.2, 2.0 * DEGREE, 1.0);
}

fn load_steps(programme: &mut Programme) {
    for centre in [0.0, 0.15, 0.3, 0.45, -0.2] {
        programme.to(centre, 0.15, 2.0);
        for (speed, reach) in [(2.0, 0.03), (8.0, 0.05), (20.0, 0.07)] {
            programme.stroke(centre - reach, centre + reach, speed * DEGREE, 4.0);
        }
    }
}

fn accelerations(programme: &mut Programme) {
    for _ in 0..3 {
        programme.to(0.4, 4.0 * DEGREE, 3.0);
        programme.to(0.0, 40.0 * DEGREE, 9.0);
    }
    for (reach, speed) in [(0.25, 20.0), (0.15, 25.0), (0.08, 30.0), (0.04, 30.0)] {
        programme.to(0.2, 0.2, 2.0);
        programme.sine(reach, speed * DEGREE, 10.0);
    }
    for speed in [3.0, 12.0, 30.0] {
        programme.stroke(0.05, 0.4, speed * DEGREE, 9.0);
    }
}

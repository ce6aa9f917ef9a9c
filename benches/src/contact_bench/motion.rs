//! Motions along the edge that the lab can ask for.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use crate::bench::{Programme, named};

/// Acceleration of strokes \[m/s²\].
const ACCELERATION: f64 = 0.2;
/// Speed on the way to where a stroke begins \[m/s\].
const WAY: f64 = 0.03;
const MILLIMETRE: f64 = 1e-3;

named! {
    /// A motion that a session runs.
    #[derive(Default)]
    pub enum Motion or UnknownMotion {
        /// Strokes at 1.5 to 50 mm/s and the paper's sinusoid, under three normal
        /// forces.
        #[default]
        Standard = "standard",
        /// The same two speeds under many normal forces. Tells what goes with F_N.
        ContactForces = "contact_forces",
        /// Constant speeds from 0.7 to 60 mm/s. Tells viscous friction and Stribeck.
        ContactSpeeds = "contact_speeds",
        /// Short slow strokes with many turns. Shows compliance.
        ContactTurns = "contact_turns",
        /// The whole edge. Shows what goes with the place.
        ContactSweep = "contact_sweep",
        /// The standard motion at one temperature. Tells wear from temperature.
        ContactDates = "contact_dates",
    }
}

/// Place over time, and the normal force that is held meanwhile.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    pub(super) path: Programme,
    /// From when \[s\] which F_N \[N\].
    forces: Vec<(f64, f64)>,
}

impl Course {
    /// Presses with `force` \[N\] from now on; the tip waits until it is held.
    fn press(&mut self, force: f64) {
        self.forces.push((self.path.duration(), force));
        self.path.rest(0.8);
    }

    /// There and back once, around `centre` \[m\], `reach` \[m\] to either side.
    fn stroke(&mut self, centre: f64, reach: f64, speed: f64) {
        self.path.to(centre - reach, WAY, ACCELERATION);
        self.path.to(centre + reach, speed, ACCELERATION);
        self.path.to(centre - reach, speed, ACCELERATION);
    }

    /// F_N \[N\] that is asked for at `time` \[s\].
    pub(super) fn force(&self, time: f64) -> f64 {
        let begun = self.forces.iter().take_while(|(from, _)| *from <= time);
        begun.last().map_or(0.0, |(_, force)| *force)
    }
}

impl Motion {
    /// Whether all sessions are run at about one temperature.
    pub(super) fn same_temperature(self) -> bool {
        self == Motion::ContactDates
    }

    /// What a session follows.
    pub(super) fn course(self, random: &mut Random) -> Course {
        let mut course = Course::default();
        course.path.rest(0.5);
        match self {
            Motion::Standard | Motion::ContactDates => standard(&mut course, random),
            Motion::ContactForces => forces(&mut course),
            Motion::ContactSpeeds => speeds(&mut course),
            Motion::ContactTurns => turns(&mut course, random),
            Motion::ContactSweep => sweep(&mut course),
        }
        course.path.rest(0.3);
        course
    }
}

fn standard(course: &mut Course, random: &mut Random) {
    for force in [5.0, 14.0, 28.0] {
        course.press(force * (0.9 + 0.2 * random.uniform()));
        for (speed, reach) in [
            (1.5, 3.0),
            (4.0, 10.0),
            (10.0, 25.0),
            (25.0, 35.0),
            (50.0, 38.0),
        ] {
            let speed = speed * (0.9 + 0.2 * random.uniform()) * MILLIMETRE;
            let reach = reach * MILLIMETRE;
            let room = 40.0 * MILLIMETRE - reach;
            let centre = room * (2.0 * random.uniform() - 1.0);
            course.stroke(centre, reach, speed);
        }
        // The paper's sinusoid: 20 mm at 0.2 to 0.5 Hz.
        let frequency = 0.2 + 0.3 * random.uniform();
        course.path.to(-20.0 * MILLIMETRE, WAY, ACCELERATION);
        course
            .path
            .sine(20.0 * MILLIMETRE, TAU * frequency * 20.0 * MILLIMETRE, 3.0);
    }
}

fn forces(course: &mut Course) {
    for force in [3.0, 6.0, 10.0, 15.0, 21.0, 28.0, 36.0] {
        course.press(force);
        for speed in [5.0, 25.0] {
            course.stroke(0.0, 25.0 * MILLIMETRE, speed * MILLIMETRE);
        }
    }
}

fn speeds(course: &mut Course) {
    course.press(15.0);
    for (speed, reach) in [
        (0.7, 2.0),
        (1.2, 3.0),
        (2.0, 4.0),
        (3.5, 7.0),
        (6.0, 12.0),
        (10.0, 20.0),
        (17.0, 30.0),
        (27.0, 38.0),
        (40.0, 38.0),
        (60.0, 38.0),
    ] {
        course.stroke(0.0, reach * MILLIMETRE, speed * MILLIMETRE);
    }
}

fn turns(course: &mut Course, random: &mut Random) {
    for force in [8.0, 16.0, 28.0] {
        course.press(force);
        for reach in [6.0, 3.0, 1.5] {
            let speed = (3.0 + 6.0 * random.uniform()) * MILLIMETRE;
            for _ in 0..4 {
                course.stroke(0.0, reach * MILLIMETRE, speed);
            }
        }
    }
}

fn sweep(course: &mut Course) {
    for force in [10.0, 25.0] {
        course.press(force);
        for speed in [8.0, 20.0, 40.0] {
            course.stroke(0.0, 45.0 * MILLIMETRE, speed * MILLIMETRE);
        }
    }
}

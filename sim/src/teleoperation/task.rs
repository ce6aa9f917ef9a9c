//! What the operator does, with pauses that are long enough for the link to settle, and in
//! which it is judged.

use ferntast_emulation::hand::ImpedanceParameters;
use serde::{Deserialize, Serialize};

/// Where the hand begins and ends, before the surface [m].
const START: f64 = -0.04;
/// Where the hand wants to be while it presses, behind the surface [m].
const PRESSED: f64 = 0.02;
/// How far it slides along the surface [m].
const SLIDE: f64 = 0.02;
/// At rest before the first motion, and the round trip on top [s].
const WAIT: f64 = 0.5;
/// Time of each motion [s].
const MOTION: f64 = 1.0;
/// Where a tap begins and ends, before the surface, and where it wants to be, behind it [m].
const LIFTED: f64 = -0.01;
const TAPPED: f64 = 0.004;
/// From one tap to the next, and of that the time of a stroke, down and up [s].
const TAP_PERIOD: f64 = 1.0;
const STROKE: f64 = 0.15;
const TAPS: u32 = 3;
/// How far to and fro along the surface a hand roams [m], how long a stroke takes, and how many
/// there are, to and fro.
const ROAM: f64 = 0.06;
const ROAM_STROKE: f64 = 1.0;
const ROAM_STROKES: u32 = 10;
/// What is in nobody's hand: a light handle on its bearings.
const LEFT_ALONE: ImpedanceParameters = ImpedanceParameters {
    mass: 0.2,
    damping: 1.0,
    stiffness: 1.0,
};

/// What an operator does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Reaches, presses while the surface may move, slides, comes back: 0.1 m/s at the surface.
    PressAndSlide,
    /// Taps the surface three times, a stroke takes 0.15 s, and comes back.
    Tap,
    /// Lets go of the handle while it presses.
    LetGo,
    /// Moves to and fro where nothing is, ten strokes of 60 mm, then reaches, presses and comes back.
    Roam,
}

impl Task {
    /// All of them.
    pub const ALL: [Task; 4] = [Task::PressAndSlide, Task::Tap, Task::LetGo, Task::Roam];

    /// As in configurations.
    pub const fn name(self) -> &'static str {
        match self {
            Task::PressAndSlide => "press_and_slide",
            Task::Tap => "tap",
            Task::LetGo => "let_go",
            Task::Roam => "roam",
        }
    }
}

/// Times of the task [s since the start].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Schedule {
    pub task: Task,
    /// The hand begins to move: by then both ends have heard of each other.
    pub begin: f64,
    /// It begins to reach for the surface.
    pub reach: f64,
    /// The surface begins to move.
    pub wall: f64,
    /// Sliding, or tapping, begins.
    pub slide: f64,
    /// From here on the hand at the surface is watched.
    pub watch_pressed: f64,
    /// The way back begins, or the hand lets go.
    pub retreat: f64,
    /// From here on the hand back at the start, or the handle left alone, is watched.
    pub watch_free: f64,
    /// The end.
    pub end: f64,
}

impl Schedule {
    /// For a link of `round_trip` \[s\]. An instability needs some round trips
    /// to show, a slow law some to arrive.
    pub(super) fn new(task: Task, round_trip: f64) -> Self {
        let begin = WAIT + round_trip;
        let roaming = match task {
            Task::Roam => f64::from(ROAM_STROKES) * ROAM_STROKE,
            Task::PressAndSlide | Task::Tap | Task::LetGo => 0.0,
        };
        let reach = begin + roaming;
        let wall = reach + MOTION + 1.0 + round_trip;
        let slide = wall + 4.0;
        let work = match task {
            Task::PressAndSlide | Task::LetGo | Task::Roam => 2.0 * MOTION,
            Task::Tap => f64::from(TAPS) * TAP_PERIOD,
        };
        let watch_pressed = slide + work + 2.0 + 5.0 * round_trip;
        let retreat = watch_pressed + 1.0 + 2.0 * round_trip;
        let watch_free = retreat + MOTION + 3.0 + 3.0 * round_trip;
        Schedule {
            task,
            begin,
            reach,
            wall,
            slide,
            watch_pressed,
            retreat,
            watch_free,
            end: watch_free + 1.0 + 2.0 * round_trip,
        }
    }

    /// Where the hand wants to be \[m\] and how fast \[m/s\], along x and y.
    pub(super) fn target(&self, time: f64) -> ([f64; 2], [f64; 2]) {
        let (reach, reach_rate) = minimum_jerk((time - self.reach) / MOTION);
        let (back, back_rate) = minimum_jerk((time - self.retreat) / MOTION);
        let reached = match self.task {
            Task::Tap => LIFTED,
            Task::PressAndSlide | Task::LetGo | Task::Roam => PRESSED,
        };
        let (along, along_rate) = match self.task {
            Task::PressAndSlide => out_and_back(time - self.slide, MOTION),
            Task::Tap | Task::LetGo | Task::Roam => (0.0, 0.0),
        };
        let (tap, tap_rate) = self.tap(time);
        let (roam, roam_rate) = self.roam(time);
        let travel = reached - START;
        (
            [START + travel * (reach - back) + tap, SLIDE * along + roam],
            [
                travel * (reach_rate - back_rate) / MOTION + tap_rate,
                SLIDE * along_rate / MOTION + roam_rate,
            ],
        )
    }

    /// How far the hand is into a tap \[m\], and how fast \[m/s\].
    fn tap(&self, time: f64) -> (f64, f64) {
        let since = time - self.slide;
        if self.task != Task::Tap || !(0.0..f64::from(TAPS) * TAP_PERIOD).contains(&since) {
            return (0.0, 0.0);
        }
        let (way, rate) = out_and_back(since % TAP_PERIOD, STROKE);
        let depth = TAPPED - LIFTED;
        (depth * way, depth * rate / STROKE)
    }

    /// How far the hand is along the surface where it roams \[m\], and how fast \[m/s\].
    fn roam(&self, time: f64) -> (f64, f64) {
        if !(self.begin..self.reach).contains(&time) {
            return (0.0, 0.0);
        }
        let since = (time - self.begin) % (2.0 * ROAM_STROKE);
        let (way, rate) = out_and_back(since, ROAM_STROKE);
        (ROAM * way, ROAM * rate / ROAM_STROKE)
    }

    /// From when to when the hand is in the free, and what it feels there is its drag \[s\]: a hand
    /// that roams has got going by half of that.
    pub(super) fn free(&self) -> std::ops::Range<f64> {
        match self.task {
            Task::Roam => 0.5 * (self.begin + self.reach)..self.reach,
            Task::PressAndSlide | Task::Tap | Task::LetGo => 0.0..self.wall,
        }
    }

    /// What holds the handle, where `hand` does until it lets go.
    pub(super) fn grip(&self, time: f64, hand: ImpedanceParameters) -> ImpedanceParameters {
        match self.task {
            Task::LetGo if time >= self.retreat => LEFT_ALONE,
            _ => hand,
        }
    }

    /// Where every task begins and ends \[m\].
    pub(super) const START: [f64; 2] = [START, 0.0];

    /// Where the task begins and ends \[m\].
    pub(super) const fn start(&self) -> [f64; 2] {
        Self::START
    }
}

/// Way and speed of a motion from 0 to 1 within a unit of time: 10 s³ − 15 s⁴
/// + 6 s⁵ (Flash and Hogan 1985, "The coordination of arm movements").
fn minimum_jerk(time: f64) -> (f64, f64) {
    let s = time.clamp(0.0, 1.0);
    let way = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    (way, 30.0 * s * s * (1.0 - s) * (1.0 - s))
}

/// Way and speed of a motion from 0 to 1 and back, `since` \[s\] after it began; each way takes a
/// `stroke` \[s\], in which the speed is counted.
fn out_and_back(since: f64, stroke: f64) -> (f64, f64) {
    let (out, out_rate) = minimum_jerk(since / stroke);
    let (back, back_rate) = minimum_jerk((since - stroke) / stroke);
    (out - back, out_rate - back_rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_reaches_presses_slides_and_comes_back() {
        for round_trip in [0.0, 2.0] {
            let schedule = Schedule::new(Task::PressAndSlide, round_trip);
            assert_eq!(schedule.target(0.0).0, schedule.start());
            let at = |time| schedule.target(time).0;
            assert!((at(schedule.wall)[0] - PRESSED).abs() < 1e-12);
            assert!((at(schedule.slide + MOTION)[1] - SLIDE).abs() < 1e-12);
            assert!((at(schedule.watch_pressed)[1]).abs() < 1e-12);
            assert!((at(schedule.watch_free)[0] - START).abs() < 1e-12);
        }
    }

    #[test]
    fn it_taps_three_times_and_is_back_in_between() {
        let schedule = Schedule::new(Task::Tap, 0.1);
        let at = |time| schedule.target(time).0[0];
        for k in 0..TAPS {
            let begin = schedule.slide + TAP_PERIOD * f64::from(k);
            assert!((at(begin) - LIFTED).abs() < 1e-12);
            assert!((at(begin + STROKE) - TAPPED).abs() < 1e-12);
        }
        assert!((at(schedule.watch_pressed) - LIFTED).abs() < 1e-12);
    }

    #[test]
    fn who_roams_is_back_in_time_to_reach() {
        let schedule = Schedule::new(Task::Roam, 0.1);
        let at = |time| schedule.target(time).0;
        assert_eq!(at(schedule.begin), schedule.start());
        assert!((at(schedule.begin + ROAM_STROKE)[1] - ROAM).abs() < 1e-12);
        assert_eq!(at(schedule.reach), schedule.start());
        assert!((at(schedule.wall)[0] - PRESSED).abs() < 1e-12);
        assert_eq!(schedule.free(), 5.6..10.6);
        let other = Schedule::new(Task::PressAndSlide, 0.1);
        assert_eq!(other.begin, other.reach);
    }

    #[test]
    fn who_lets_go_lets_go_while_pressing() {
        let schedule = Schedule::new(Task::LetGo, 0.1);
        let hand = ImpedanceParameters::default();
        assert_eq!(schedule.grip(schedule.retreat - 1e-3, hand), hand);
        assert_eq!(schedule.grip(schedule.retreat, hand), LEFT_ALONE);
        assert!((schedule.target(schedule.retreat).0[0] - PRESSED).abs() < 1e-12);
    }

    #[test]
    fn speeds_are_the_rates_of_positions() {
        for task in Task::ALL {
            let schedule = Schedule::new(task, 0.3);
            for k in 0..600 {
                let time = 0.025 * f64::from(k);
                let (before, after) = (schedule.target(time - 1e-6), schedule.target(time + 1e-6));
                for axis in 0..2 {
                    let rate = (after.0[axis] - before.0[axis]) / 2e-6;
                    let told = schedule.target(time).1[axis];
                    assert!((rate - told).abs() < 1e-5, "{task:?} {time}");
                }
            }
        }
    }
}

//! What the operator does: reach, press, slide, come back, with pauses that are
//! long enough for the link to settle, and in which it is judged.

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

/// Times of the task [s since the start].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Schedule {
    /// The hand begins to move: by then both ends have heard of each other.
    pub reach: f64,
    /// The surface begins to move.
    pub wall: f64,
    /// Sliding begins.
    pub slide: f64,
    /// From here on the hand at the surface is watched.
    pub watch_pressed: f64,
    /// The way back begins.
    pub retreat: f64,
    /// From here on the hand back at the start is watched.
    pub watch_free: f64,
    /// The end.
    pub end: f64,
}

impl Schedule {
    /// For a link of `round_trip` \[s\]. An instability needs some round trips
    /// to show, a slow law some to arrive.
    pub(super) fn new(round_trip: f64) -> Self {
        let reach = WAIT + round_trip;
        let wall = reach + MOTION + 1.0 + round_trip;
        let slide = wall + 4.0;
        let watch_pressed = slide + 2.0 * MOTION + 2.0 + 5.0 * round_trip;
        let retreat = watch_pressed + 1.0 + 2.0 * round_trip;
        let watch_free = retreat + MOTION + 3.0 + 3.0 * round_trip;
        Schedule {
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
        let (out, out_rate) = minimum_jerk((time - self.slide) / MOTION);
        let (home, home_rate) = minimum_jerk((time - self.slide - MOTION) / MOTION);
        let travel = PRESSED - START;
        (
            [START + travel * (reach - back), SLIDE * (out - home)],
            [
                travel * (reach_rate - back_rate) / MOTION,
                SLIDE * (out_rate - home_rate) / MOTION,
            ],
        )
    }

    /// Where the task begins and ends \[m\].
    pub(super) const fn start(&self) -> [f64; 2] {
        [START, 0.0]
    }
}

/// Way and speed of a motion from 0 to 1 within a unit of time: 10 s³ − 15 s⁴
/// + 6 s⁵ (Flash and Hogan 1985, "The coordination of arm movements").
fn minimum_jerk(time: f64) -> (f64, f64) {
    let s = time.clamp(0.0, 1.0);
    let way = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    (way, 30.0 * s * s * (1.0 - s) * (1.0 - s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_reaches_presses_slides_and_comes_back() {
        for round_trip in [0.0, 2.0] {
            let schedule = Schedule::new(round_trip);
            assert_eq!(schedule.target(0.0).0, schedule.start());
            let at = |time| schedule.target(time).0;
            assert!((at(schedule.wall)[0] - PRESSED).abs() < 1e-12);
            assert!((at(schedule.slide + MOTION)[1] - SLIDE).abs() < 1e-12);
            assert!((at(schedule.watch_pressed)[1]).abs() < 1e-12);
            assert!((at(schedule.watch_free)[0] - START).abs() < 1e-12);
        }
    }

    #[test]
    fn speeds_are_the_rates_of_positions() {
        let schedule = Schedule::new(0.3);
        for k in 0..300 {
            let time = 0.05 * f64::from(k);
            let (before, after) = (schedule.target(time - 1e-6), schedule.target(time + 1e-6));
            for axis in 0..2 {
                let rate = (after.0[axis] - before.0[axis]) / 2e-6;
                assert!(
                    (rate - schedule.target(time).1[axis]).abs() < 1e-6,
                    "{time}"
                );
            }
        }
    }
}

//! What is measured in a trial.

use super::environment::Environment;
use super::task::{Schedule, Task};
use super::{Outcome, TICK};
use ferntast_control::codec::Traffic;

/// A hand or tip that moves to and fro by more than this while it is watched is
/// not at rest [m].
const REST: f64 = 2e-3;
/// The task is done when the tip is this near to where it began [m].
const ARRIVED: f64 = 2e-3;
/// A tip deeper than this counts as pressing [m].
const TOUCH: f64 = 1e-6;

/// One tick, in hand units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tick {
    /// [s since the start]
    pub time: f64,
    /// Hand [m].
    pub hand: [f64; 2],
    /// [m/s]
    pub hand_speed: [f64; 2],
    /// Tip [m].
    pub tip: [f64; 2],
    /// On the hand [N].
    pub felt: [f64; 2],
    /// Of the contact on the tip [N].
    pub touched: [f64; 2],
    /// Surface [m].
    pub place: f64,
    /// The arm does not obey.
    pub held: bool,
    /// True work of hand and surface since the start [J].
    pub energy: f64,
    /// How long ago that was which the ends act on: of the hand, of the tip [ticks].
    pub ago: [usize; 2],
}

/// What was, at every tick so far.
#[derive(Debug)]
struct Past<T> {
    first: T,
    all: Vec<T>,
}

impl<T: Copy> Past<T> {
    fn beginning_with(first: T) -> Past<T> {
        Past {
            first,
            all: Vec::new(),
        }
    }

    /// `now`, and then what was `ago` [ticks].
    fn add(&mut self, now: T, ago: usize) -> T {
        self.all.push(now);
        let place = self.all.len().checked_sub(ago + 1);
        place
            .and_then(|place| self.all.get(place))
            .map_or(self.first, |own| *own)
    }
}

/// To and fro of something that should rest. One way alone is no swing: it may
/// creep to where it belongs.
#[derive(Clone, Copy, Debug)]
struct Swing {
    low: f64,
    high: f64,
    rise: f64,
    fall: f64,
}

impl Swing {
    const NONE: Swing = Swing {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
        rise: 0.0,
        fall: 0.0,
    };

    fn add(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
        self.rise = self.rise.max(value - self.low);
        self.fall = self.fall.max(self.high - value);
    }

    fn width(&self) -> f64 {
        self.rise.min(self.fall)
    }
}

/// Root of the mean square.
#[derive(Clone, Copy, Debug, Default)]
struct Square {
    sum: f64,
    count: f64,
}

impl Square {
    fn add(&mut self, difference: [f64; 2]) {
        self.sum += difference[0] * difference[0] + difference[1] * difference[1];
        self.count += 1.0;
    }

    fn root(&self) -> f64 {
        if self.count > 0.0 {
            (self.sum / self.count).sqrt()
        } else {
            0.0
        }
    }
}

/// Gathers an [`Outcome`] tick by tick.
#[derive(Debug)]
pub(super) struct Watch {
    schedule: Schedule,
    hands: Past<[f64; 2]>,
    forces: Past<[f64; 2]>,
    places: Past<f64>,
    position: Square,
    force: Square,
    rest: [Swing; 6],
    margin: f64,
    peak: f64,
    peak_felt: f64,
    /// Sums while pressing: felt, hand's depth, touched, tip's depth.
    pressed: [f64; 4],
    /// Sums while pressing or while the surface moves: force by depth, depth by depth.
    stiffness: [f64; 2],
    environment: Environment,
    /// On the hand one tick ago [N].
    felt: [f64; 2],
    force_step: f64,
    held: f64,
    /// Sums on the free way: F·v and v².
    free: [f64; 2],
    away_until: Option<f64>,
    drift: f64,
    finite: bool,
}

impl Watch {
    /// Of what the tip meets.
    pub(super) fn new(schedule: Schedule, environment: Environment) -> Self {
        Watch {
            schedule,
            hands: Past::beginning_with(schedule.start()),
            forces: Past::beginning_with([0.0; 2]),
            places: Past::beginning_with(0.0),
            position: Square::default(),
            force: Square::default(),
            rest: [Swing::NONE; 6],
            margin: 0.0,
            peak: 0.0,
            peak_felt: 0.0,
            pressed: [0.0; 4],
            stiffness: [0.0; 2],
            environment,
            felt: [0.0; 2],
            force_step: 0.0,
            held: 0.0,
            free: [0.0; 2],
            away_until: None,
            drift: 0.0,
            finite: true,
        }
    }

    pub(super) fn add(&mut self, tick: &Tick) {
        let values = tick.hand.iter().chain(&tick.tip).chain(&tick.felt);
        self.finite &= values.chain(&tick.touched).all(|value| value.is_finite());
        let [forth, back] = tick.ago;
        let sent = self.hands.add(tick.hand, forth);
        let met = self.forces.add(tick.touched, back);
        let difference = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        let touching = tick.touched != [0.0; 2];
        if !touching {
            self.position.add(difference(sent, tick.tip));
        }
        self.force.add(difference(met, tick.felt));
        self.margin = self.margin.min(tick.energy);
        let step = difference(tick.felt, self.felt);
        self.force_step = self.force_step.max(step[0].hypot(step[1]));
        self.felt = tick.felt;
        self.held += if tick.held { TICK } else { 0.0 };
        self.feel(tick);
        self.peak = self.peak.max(tick.touched[0].hypot(tick.touched[1]));
        self.peak_felt = self.peak_felt.max(tick.felt[0].hypot(tick.felt[1]));
        let Schedule {
            watch_pressed,
            retreat,
            watch_free,
            ..
        } = self.schedule;
        let watched = if (watch_pressed..retreat).contains(&tick.time) {
            if tick.tip[0] > TOUCH {
                let depths = [-tick.felt[0], tick.hand[0], -tick.touched[0], tick.tip[0]];
                for (sum, value) in self.pressed.iter_mut().zip(depths) {
                    *sum += value;
                }
            }
            Some(0)
        } else if tick.time >= watch_free {
            Some(3)
        } else {
            None
        };
        if let Some(first) = watched {
            let values = [tick.hand[0], tick.tip[0], tick.hand[1]];
            for (range, value) in self.rest[first..].iter_mut().zip(values) {
                range.add(value);
            }
        }
        let free = self.schedule.free();
        if free.contains(&tick.time) && !touching && met == [0.0; 2] {
            let power = -(0..2)
                .map(|axis| tick.felt[axis] * tick.hand_speed[axis])
                .sum::<f64>();
            self.free[0] += power;
            self.free[1] += tick.hand_speed[0].powi(2) + tick.hand_speed[1].powi(2);
        }
        let start = self.schedule.start();
        if (tick.tip[0] - start[0]).hypot(tick.tip[1] - start[1]) > ARRIVED {
            self.away_until = Some(tick.time);
        }
        let apart = difference(sent, tick.tip);
        self.drift = apart[0].hypot(apart[1]);
    }

    /// The stiffness in the hand: of the surface where it was a way back ago, as the hand
    /// cannot know of it earlier.
    fn feel(&mut self, tick: &Tick) {
        let place = self.places.add(tick.place, tick.ago[1]);
        let window = match self.environment.moves() {
            true => self.schedule.wall..self.schedule.slide,
            false => self.schedule.watch_pressed..self.schedule.retreat,
        };
        let depth = tick.hand[0] - place;
        if window.contains(&tick.time) && depth > TOUCH {
            self.stiffness[0] -= tick.felt[0] * depth;
            self.stiffness[1] += depth * depth;
        }
    }

    /// After the last tick.
    pub(super) fn outcome(&self) -> Outcome {
        let swing = self.rest.iter().map(Swing::width).fold(0.0, f64::max);
        let [felt, hand, touched, tip] = self.pressed;
        let done = match self.schedule.task {
            // The handle is where it was left: there is no way back to be in time for.
            Task::LetGo => Some(self.schedule.retreat),
            Task::PressAndSlide | Task::Tap | Task::Roam => self
                .away_until
                .filter(|time| *time > self.schedule.retreat && *time < self.schedule.watch_free),
        };
        let done = done.filter(|_| self.peak > 0.0 || self.environment == Environment::Free);
        Outcome {
            stable: self.finite && swing < REST,
            swing,
            position_rmse: self.position.root(),
            force_rmse: self.force.root(),
            drift: self.drift,
            felt_stiffness: (self.stiffness[1] > 0.0)
                .then(|| self.stiffness[0] / self.stiffness[1]),
            force_step: self.force_step,
            held: self.held,
            peak_force: self.peak,
            peak_felt: self.peak_felt,
            energy_margin: self.margin,
            transparency: (hand > 0.0 && touched > 0.0 && tip > 0.0)
                .then(|| (felt / hand) / (touched / tip)),
            felt_damping: if self.free[1] > 0.0 {
                self.free[0] / self.free[1]
            } else {
                0.0
            },
            task_time: done,
            traffic: Traffic::default(),
        }
    }
}

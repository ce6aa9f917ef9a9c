//! What a robot tells of its joints, and whether it is believed. Pure.

use ferntast_model::{JointCount, Joints, joint::JointParameters};
use ferntast_msgs::{
    Time,
    sample::{JointNames, RobotJointsSample},
};

use super::{
    refusal::Refusal,
    settings::{Effort, Settings},
};

/// A joint that is told to be so many times faster than it can be is not believed \[-\].
const TOO_FAST: f64 = 2.0;
/// Beyond what the fastest joint moves from one state to the next \[rad\]: late stamps, noise.
const JUMP: f64 = 0.01;
/// After a jump a joint has to go on plausibly for so long \[s\].
const SETTLE: f64 = 1.0;
/// Memory of the mean interval \[s\].
const MEMORY: f64 = 0.5;
/// A longer interval counts as one of these \[s\]: it is a silence.
const LONGEST_INTERVAL: f64 = 0.1;
/// So many intervals until a rate is told.
const INTERVALS: u32 = 10;
/// States that come as seldom as this share of what is needed are too slow \[-\].
const SLOW: f64 = 0.9;
/// How fast the quickest way is forgotten \[s/s\]: more than two clocks drift apart.
const FORGETS: f64 = 1e-3;

/// One joint state, of the arm's joints in their order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState {
    /// When it came, by the clock here.
    pub arrived: Time,
    /// When it was measured, by the robot's clock.
    pub stamp: Time,
    /// The first joint that it lacks.
    pub missing: Option<usize>,
    /// Positions \[rad\] or \[m\]; NaN where not given, as all three.
    pub position: Joints<f64>,
    /// Velocities \[rad/s\] or \[m/s\].
    pub velocity: Joints<f64>,
    /// Torques \[Nm\] or \[N\]; what they are the settings say.
    pub effort: Joints<f64>,
}

impl JointState {
    /// The arm's part of what was told: joints are found by name, others ignored.
    pub fn of(
        told: &RobotJointsSample,
        joints: &JointNames,
        count: JointCount,
        arrived: Time,
    ) -> JointState {
        let nothing = Joints::filled(count, f64::NAN);
        let mut own = JointState {
            arrived,
            stamp: told.stamp,
            missing: None,
            position: nothing,
            velocity: nothing,
            effort: nothing,
        };
        for (joint, name) in joints.iter().enumerate().take(count.get()) {
            match told.index(name) {
                Some(place) => {
                    own.position[joint] = told.position[place];
                    own.velocity[joint] = told.velocity[place];
                    own.effort[joint] = told.effort[place];
                }
                None => own.missing = own.missing.or(Some(joint)),
            }
        }
        own
    }
}

/// What a joint can do.
#[derive(Clone, Copy, Debug)]
struct Possible {
    range: [f64; 2],
    speed: f64,
}

/// Looks at each joint state, and says whether it is believed.
pub struct StateWatch {
    joints: Joints<Possible>,
    settings: Settings,
    effort: Effort,
    /// The newest that came whole, believed or not.
    last: Option<JointState>,
    /// The newest that is believed.
    good: Option<JointState>,
    /// Why the newest is not.
    refused: Option<Refusal>,
    /// Stamp and arrival of the newest, however wrong.
    heard: Option<(Time, Time)>,
    /// The least that arrival was after the stamp \[s\]: the quickest way, and what the clocks
    /// are apart.
    quickest: Option<f64>,
    /// Mean time from one stamp to the next \[s\].
    interval: f64,
    intervals: u32,
    /// Until then nothing is believed.
    settles: Time,
}

impl StateWatch {
    /// For an arm of those joints.
    pub fn new(
        count: JointCount,
        joints: &[JointParameters],
        settings: &Settings,
        effort: Effort,
    ) -> StateWatch {
        let margin = settings.limit_margin;
        StateWatch {
            joints: Joints::from_fn(count, |joint| Possible {
                range: [
                    joints[joint].position_lower - margin,
                    joints[joint].position_upper + margin,
                ],
                speed: joints[joint].velocity_limit,
            }),
            settings: settings.clone(),
            effort,
            last: None,
            good: None,
            refused: None,
            heard: None,
            quickest: None,
            interval: 0.0,
            intervals: 0,
            settles: Time::INVALID,
        }
    }

    /// Takes in a joint state; gives whether it is believed.
    pub fn take(&mut self, state: JointState) -> bool {
        let judged = self.judge(&state);
        if judged.is_ok() {
            self.good = Some(state);
        }
        self.refused = judged.err();
        self.refused.is_none()
    }

    /// The newest joint state that is believed.
    pub fn good(&self) -> Option<&JointState> {
        self.good.as_ref()
    }

    /// Why there is nothing at `now` that can be believed.
    pub fn refusal(&self, now: Time) -> Option<Refusal> {
        let Some((_, arrived)) = self.heard else {
            return Some(Refusal::NothingYet);
        };
        let silent = now.seconds_since(arrived);
        match silent > self.settings.longest_silence {
            true => Some(Refusal::Silent(silent)),
            false => self.refused,
        }
    }

    fn judge(&mut self, state: &JointState) -> Result<(), Refusal> {
        let before = self.heard;
        if before.is_some_and(|(stamp, _)| state.stamp <= stamp) {
            return Err(Refusal::StampStands);
        }
        self.heard = Some((state.stamp, state.arrived));
        let passed = before.map(|(stamp, _)| state.stamp.seconds_since(stamp));
        let late = self.late(state, passed.unwrap_or(0.0));
        let rate = self.rate(passed);
        if let Some(joint) = state.missing {
            return Err(Refusal::Missing(joint));
        }
        self.plausible(state)?;
        if let Some(last) = self.last.replace(*state) {
            self.continuous(&last, state)?;
        }
        let needed = self.settings.least_rate;
        if late > self.settings.longest_delay {
            Err(Refusal::Late(late))
        } else if let Some(rate) = rate.filter(|&rate| rate < SLOW * needed) {
            Err(Refusal::Slow { rate, needed })
        } else if state.arrived < self.settles {
            Err(Refusal::Settling)
        } else {
            Ok(())
        }
    }

    /// How much longer than the quickest it was under way \[s\].
    fn late(&mut self, state: &JointState, passed: f64) -> f64 {
        let delay = state.arrived.seconds_since(state.stamp);
        let quickest = match self.quickest {
            Some(quickest) => (quickest + FORGETS * passed).min(delay),
            None => delay,
        };
        self.quickest = Some(quickest);
        delay - quickest
    }

    /// How often they come \[Hz\], once that can be told.
    fn rate(&mut self, passed: Option<f64>) -> Option<f64> {
        let passed = passed?.min(LONGEST_INTERVAL);
        self.interval = match self.intervals {
            0 => passed,
            _ => self.interval + (passed - self.interval) * (passed / MEMORY),
        };
        self.intervals = self.intervals.saturating_add(1);
        (self.intervals >= INTERVALS).then(|| 1.0 / self.interval)
    }

    fn plausible(&self, state: &JointState) -> Result<(), Refusal> {
        let needs_effort = self.effort != Effort::None;
        for (what, values, needed) in [
            ("position", &state.position, true),
            ("velocity", &state.velocity, true),
            ("effort", &state.effort, needs_effort),
        ] {
            let wrong = values.iter().position(|value| !value.is_finite());
            if let Some(joint) = wrong.filter(|_| needed) {
                return Err(Refusal::NotGiven { what, joint });
            }
        }
        for (joint, possible) in self.joints.iter().enumerate() {
            let (position, velocity) = (state.position[joint], state.velocity[joint]);
            let [lower, upper] = possible.range;
            if !(lower..=upper).contains(&position) {
                let range = possible.range;
                return Err(Refusal::OutOfRange {
                    joint,
                    position,
                    range,
                });
            }
            let limit = possible.speed;
            if velocity.abs() > TOO_FAST * limit {
                return Err(Refusal::TooFast {
                    joint,
                    velocity,
                    limit,
                });
            }
        }
        Ok(())
    }

    fn continuous(&mut self, last: &JointState, state: &JointState) -> Result<(), Refusal> {
        let passed = state.stamp.seconds_since(last.stamp);
        for (joint, possible) in self.joints.iter().enumerate() {
            let by = state.position[joint] - last.position[joint];
            if by.abs() > TOO_FAST * possible.speed * passed + JUMP {
                // Its zero may be lost: a person is to look before it goes on.
                self.settles = state.arrived.plus_seconds(SETTLE);
                return Err(Refusal::Jumped { joint, by });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;

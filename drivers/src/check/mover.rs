//! Moves an arm a little, joint by joint, for as long as a key is held. Pure.
//!
//! The servo of every session does it, with its limits and watchdogs: each joint in turn goes out
//! and back to both sides of where it is, by a few hundredths of a radian. Released, the arm is
//! paused and stands; held again, it goes on. A joint that goes elsewhere
//! than it is told, or another one that goes along, ends it at once, with the drives off.

use ferntast_config::Believed;
use ferntast_control::{
    operating::{OperatingState, StateCommand},
    servo::{Command, Measurement, Servo, ServoConfig, ServoInput, Target},
};
use ferntast_model::{JointCount, Joints, ParameterError, rigid_body::JointKind};
use ferntast_msgs::{Time, sample::JointNames};
use serde::Serialize;

use super::finding::{Finding, Severity};
use crate::driver::Reading;

/// How far a joint goes to each side: \[rad\], and \[m\].
const AMPLITUDE: f64 = 0.03;
const AMPLITUDE_LINEAR: f64 = 0.01;
/// To one side, back, to the other, and back \[s\].
const DURATION: f64 = 6.0;
/// From the ends of its range it stays away so far \[rad\] or \[m\].
const FROM_END: f64 = 0.02;
/// A joint that is so far from where it was told to be goes elsewhere \[rad\] or \[m\].
const ASTRAY: f64 = 0.03;
/// The key may be released for so long before it is over \[s\].
const PATIENCE: f64 = 10.0;
/// A joint that is slower stands \[rad/s\].
const STANDS: f64 = 0.02;
/// Of the way that it is told, a joint goes so much at least \[-\].
const FOLLOWS: f64 = 0.7;

/// What the drives are to do in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// The drives are on.
    pub enabled: bool,
    /// Torques \[Nm\] or \[N\].
    pub torque: Joints<f64>,
}

/// What is happening, for whoever holds the key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// It waits for the key to be held.
    Waits,
    /// It moves that joint.
    Moves(usize),
    /// The key was released: it stands.
    Stands(usize),
    /// It is over.
    Over,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Moved {
    /// The joints that went through their motion.
    pub joints: Vec<String>,
    /// How far each went for what it was told \[-\].
    pub followed: Vec<f64>,
    /// From each release until the arm stood \[ms\].
    pub stopped_ms: Vec<f64>,
    /// What was wrong.
    #[serde(skip)]
    pub findings: Vec<Finding>,
}

/// Moves an arm while a key is held.
pub struct Mover {
    names: JointNames,
    count: JointCount,
    servo: Servo,
    ranges: Joints<[f64; 2]>,
    amplitudes: Joints<f64>,
    measured: Option<Measurement>,
    joint: usize,
    /// Where the joints were when this one's motion began, and since when it goes on \[s\].
    motion: Option<(Joints<f64>, f64)>,
    /// Σ told · gone, Σ told².
    sums: [f64; 2],
    released: Option<Time>,
    stops: bool,
    progress: Progress,
    moved: Moved,
}

impl Mover {
    /// For an arm as it is believed.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds.
    pub fn new(
        believed: &Believed,
        names: JointNames,
        config: &ServoConfig,
    ) -> Result<Mover, ParameterError> {
        let joints = believed.joints();
        let count = JointCount::new(joints.len())?;
        let (servo, linear) = match believed {
            Believed::Planar(model) => (
                Servo::planar(&model.joint, &model.arm, config)?,
                Joints::filled(count, false),
            ),
            Believed::Serial(serial) => {
                let kinds = serial.arm.chain().kinds();
                let linear = |joint: usize| kinds[joint] == JointKind::Prismatic;
                (
                    Servo::serial(&serial.arm, config)?,
                    Joints::from_fn(count, linear),
                )
            }
        };
        Ok(Mover {
            names,
            count,
            servo,
            ranges: Joints::from_fn(count, |joint| {
                let own = &joints[joint];
                [own.position_lower + FROM_END, own.position_upper - FROM_END]
            }),
            amplitudes: linear.map(|linear| match linear {
                true => AMPLITUDE_LINEAR,
                false => AMPLITUDE,
            }),
            measured: None,
            joint: 0,
            motion: None,
            sums: [0.0; 2],
            released: None,
            stops: false,
            progress: Progress::Waits,
            moved: Moved::default(),
        })
    }

    /// What is happening.
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// What came of it.
    pub fn into_moved(self) -> Moved {
        self.moved
    }

    /// One step at `now`, `elapsed` \[s\] after the one before.
    pub fn step(
        &mut self,
        now: Time,
        elapsed: f64,
        reading: Option<&Reading>,
        held: bool,
    ) -> Drive {
        if let Some(reading) = reading {
            self.measured = Some(Measurement {
                stamp_ns: now.nanos(),
                position: reading.position,
                velocity: reading.velocity,
                torque: reading
                    .joint_torque
                    .unwrap_or(reading.position.map(|_| 0.0)),
            });
        }
        let off = Drive {
            enabled: false,
            torque: Joints::filled(self.count, 0.0),
        };
        let Some(measured) = self.measured.filter(|_| self.progress != Progress::Over) else {
            return off;
        };
        if self.progress == Progress::Waits && !held {
            return off;
        }
        let state_command = self.state_command(now, held);
        let command = (held && self.servo.state() == OperatingState::Enabled)
            .then(|| self.command(now, elapsed, &measured));
        let output = self.servo.step(
            now.nanos(),
            &ServoInput {
                measurement: Some(measured),
                command,
                state_command,
            },
        );
        if output.state == OperatingState::Fault {
            let words = format!("the servo stopped it: {}", output.reason);
            self.give_up(Finding::new(Severity::Wrong, "servo", words));
            return off;
        }
        self.watch_stop(now, &measured);
        if let Some(finding) = self.astray(&measured) {
            self.give_up(finding);
        }
        match self.progress {
            Progress::Over => off,
            _ => Drive {
                enabled: true,
                torque: output.torque,
            },
        }
    }

    /// Ends it.
    fn give_up(&mut self, finding: Finding) {
        self.moved.findings.push(finding);
        self.progress = Progress::Over;
    }

    /// The word that goes with the key.
    fn state_command(&mut self, now: Time, held: bool) -> Option<StateCommand> {
        if held {
            self.released = None;
            self.stops = false;
            let word = match self.servo.state() {
                OperatingState::Disabled => Some(StateCommand::Enable),
                OperatingState::Paused => Some(StateCommand::Resume),
                _ => None,
            };
            self.progress = Progress::Moves(self.joint);
            return word;
        }
        self.progress = Progress::Stands(self.joint);
        let released = *self.released.get_or_insert_with(|| {
            self.stops = self.motion.is_some();
            now
        });
        if now.seconds_since(released) > PATIENCE {
            let words = "the key was released for good: the joints from here on were not moved";
            let name = self.names.get(self.joint).unwrap_or_default();
            self.give_up(Finding::new(Severity::Wrong, "released", words).of(name));
        }
        (self.servo.state() == OperatingState::Enabled).then_some(StateCommand::Pause)
    }

    /// Where the joints are to be, and how far the motion is.
    fn command(&mut self, now: Time, elapsed: f64, measured: &Measurement) -> Command {
        let (start, mut passed) = match self.motion {
            Some(motion) => motion,
            None => {
                self.sums = [0.0; 2];
                (measured.position, 0.0)
            }
        };
        passed += elapsed;
        let joint = self.joint;
        let told = self.told(&start, passed);
        let gone = measured.position[joint] - start[joint];
        self.sums[0] += told * gone;
        self.sums[1] += told * told;
        self.motion = Some((start, passed));
        if passed >= DURATION {
            self.conclude();
        }
        let mut target = start;
        target[joint] += told;
        Command {
            stamp_ns: now.nanos(),
            target: Target::Joints(target),
        }
    }

    /// How far from its start the joint is told to be, after `passed` \[s\].
    fn told(&self, start: &Joints<f64>, passed: f64) -> f64 {
        let joint = self.joint;
        let [lower, upper] = self.ranges[joint];
        let most = self.amplitudes[joint];
        let share = (passed / DURATION).clamp(0.0, 1.0);
        // It begins and ends at rest.
        let turn = std::f64::consts::TAU
            * (share - (std::f64::consts::TAU * share).sin() / std::f64::consts::TAU);
        let wave = turn.sin();
        let room = match wave >= 0.0 {
            true => upper - start[joint],
            false => start[joint] - lower,
        };
        wave * most.min(room.max(0.0))
    }

    /// Says how the joint followed, and goes on to the next one.
    fn conclude(&mut self) {
        let name = self.names.get(self.joint).unwrap_or_default();
        let [product, square] = self.sums;
        let followed = product / square;
        self.moved.joints.push(name.to_owned());
        self.moved.followed.push(followed);
        if followed.is_nan() {
            let words = "it stands at an end of its range: there was no room to move it";
            let finding = Finding::new(Severity::Open, "motion", words);
            self.moved.findings.push(finding.of(name));
        } else if followed < FOLLOWS {
            let words = format!(
                "it went {followed:.2} of what it was told: is its drive on, its brake off? Is friction in the way?"
            );
            let finding = Finding::new(Severity::Wrong, "motion", words);
            self.moved.findings.push(finding.of(name));
        }
        self.motion = None;
        self.joint += 1;
        if self.joint == self.count.get() {
            self.progress = Progress::Over;
        }
    }

    /// Notes how long the arm takes to stand after the key was released.
    fn watch_stop(&mut self, now: Time, measured: &Measurement) {
        let stands = measured.velocity.iter().all(|own| own.abs() < STANDS);
        if let Some(released) = self.released.filter(|_| self.stops && stands) {
            self.stops = false;
            self.moved
                .stopped_ms
                .push(now.seconds_since(released) * 1e3);
        }
    }

    /// A joint that is elsewhere than it is told to be.
    fn astray(&self, measured: &Measurement) -> Option<Finding> {
        let (start, passed) = self.motion?;
        let told = self.told(&start, passed);
        let apart = |joint: usize| {
            let told = if joint == self.joint { told } else { 0.0 };
            measured.position[joint] - start[joint] - told
        };
        let joint = (0..self.count.get()).find(|&joint| apart(joint).abs() > ASTRAY)?;
        let name = |joint: usize| self.names.get(joint).unwrap_or_default();
        let gone = measured.position[joint] - start[joint];
        let words = match joint == self.joint {
            true => format!(
                "told to go {told:+.3} it went {gone:+.3}: the sign of its torque or of its position is wrong; the drives were taken off"
            ),
            false => format!(
                "it went {gone:+.3} while {} was moved: the order of the joints, or its sign, is wrong; the drives were taken off",
                name(self.joint)
            ),
        };
        Some(Finding::new(Severity::Wrong, "motion_sign", words).of(name(joint)))
    }
}

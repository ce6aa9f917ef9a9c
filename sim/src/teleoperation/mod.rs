//! Two ends of a delay law with everything that is around them: a hand, two
//! channels, an arm behind its servo, and something to touch.
//!
//! One trial is one [`Task`] of an operator; its [`Outcome`] says how law and link served.
//! The two ends are those that the nodes of a session run ([`ferntast_control::link`]), and
//! so are servo, contact-force estimator and limiter of the hand's force where the follower
//! is the [whole arm](FollowerModel::Arm). Energy is that of the simulated bodies at hand
//! and tip: what laws, estimator and limiter believe does not come into it. Time is counted
//! in ticks of 1 ms; the same trial gives the same outcome.
//!
//! Axes: x into the surface, y along it. Positions and forces of the outcome
//! are at the hand's scale.

mod draw;
mod environment;
mod follower;
mod follower_model;
mod servoed;
mod task;
mod tip;
mod watch;
mod whole_arm;

pub use draw::Draw;
pub use environment::Environment;
pub use follower::TrueTip;
pub use follower_model::FollowerModel;
pub use servoed::{Estimated, TrialArm};
pub use task::Task;
pub use tip::TipParameters;
pub use whole_arm::ArmUnderTrial;

use ferntast_control::codec::{Deadband, Traffic};
use ferntast_control::delay::Law;
use ferntast_control::frame::{FrameBytes, LONGEST_WIRE_LENGTH, SEAL_LENGTH, WIRE_LENGTH};
use ferntast_control::haptics::{ForceLimiter, MasterConfig};
use ferntast_control::link::{
    FollowerLink, FollowerReadings, FollowerStep, LeaderLink, LeaderReadings, LeaderStep,
    StampedPosition,
};
use ferntast_control::operating::OperatingState;
use ferntast_control::servo::Servo;
use ferntast_control::switching::Laws;
use ferntast_emulation::channel::{Channel, LinkConfig};
use ferntast_emulation::hand::{HandImpedance, ImpedanceParameters};
use ferntast_model::ParameterError;
use follower::{Follower, TipCommand};
use servoed::Servoed;
use task::Schedule;
use watch::{Tick, Watch};

/// One tick \[s\].
pub const TICK: f64 = 1e-3;
const TICK_NS: i64 = 1_000_000;
/// Time of the first tick [ns].
const START_NS: i64 = 1_000_000_000_000_000;

/// What is tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Which law, with its parameters.
    pub law: Law,
    /// Both directions of the link.
    pub link: LinkConfig,
    /// What the tip meets.
    pub environment: Environment,
    /// What the operator does.
    pub task: Task,
    /// The operator's hand.
    pub hand: ImpedanceParameters,
    /// The arm behind its servo.
    pub follower: FollowerModel,
    /// The master, which limits the force on the hand; without one it is as the law asks.
    pub master: Option<MasterConfig>,
    /// Jitter buffer at both ends \[s\]; none by default.
    pub buffer: f64,
    /// What is too small a change to be sent; without it every frame is.
    pub deadband: Option<Deadband>,
    /// Of all chance.
    pub seed: u64,
}

impl Trial {
    /// A trial with a hand of 0.5 kg, 20 N·s/m, 300 N/m and a stiff light arm.
    pub fn new(law: Law, link: LinkConfig, environment: Environment, seed: u64) -> Trial {
        Trial {
            law,
            link,
            environment,
            task: Task::PressAndSlide,
            hand: ImpedanceParameters {
                mass: 0.5,
                damping: 20.0,
                stiffness: 300.0,
            },
            follower: FollowerModel::default(),
            master: None,
            buffer: 0.0,
            deadband: None,
            seed,
        }
    }

    /// Runs it.
    ///
    /// # Errors
    ///
    /// The first value of law, link, hand or tip that is out of bounds.
    pub fn run(&self) -> Result<Outcome, ParameterError> {
        self.validate()?;
        self.run_with(self.own_arm()?)
    }

    /// Runs it with `arm` behind `servo` in place of its follower: at rest with its tip at
    /// [`start`](Self::start) before the surface, which goes through the law's offset.
    ///
    /// # Errors
    ///
    /// As [`run`](Self::run).
    pub fn run_on(&self, arm: &mut dyn TrialArm, servo: Servo) -> Result<Outcome, ParameterError> {
        self.validate()?;
        self.run_with(Box::new(Servoed::new(arm, servo)))
    }

    /// Where the tip begins, from the surface's origin on \[m\].
    pub fn start(&self) -> [f64; 2] {
        let scale = self.law.mapping().position_scale;
        Schedule::START.map(|own| scale * own)
    }

    /// How long it takes \[s\].
    pub fn duration(&self) -> f64 {
        let [forth, back] = self.delays();
        Schedule::new(self.task, forth + back).end
    }

    fn own_arm(&self) -> Result<Box<dyn Follower>, ParameterError> {
        let [x, y, _] = self.law.mapping().workspace_offset;
        self.follower
            .make(self.environment, [x, y], self.start(), self.seed)
    }

    /// Delays of both ways, with the buffers \[s\].
    fn delays(&self) -> [f64; 2] {
        [&self.link.up, &self.link.down].map(|way| way.nominal_delay(WIRE_LENGTH) + self.buffer)
    }

    fn validate(&self) -> Result<(), ParameterError> {
        self.law.validate()?;
        self.link.validate()?;
        self.hand.validate()?;
        self.follower.validate()?;
        if let Some(master) = &self.master {
            master.validate()?;
        }
        if let Some(deadband) = &self.deadband {
            deadband.validate()?;
        }
        Ok(())
    }

    fn run_with<'a>(&'a self, arm: Box<dyn Follower + 'a>) -> Result<Outcome, ParameterError> {
        let [forth, back] = self.delays();
        let schedule = Schedule::new(self.task, forth + back);
        let mut watch = Watch::new(schedule, self.environment);
        let mut run = Run::new(self, schedule, arm)?;
        for k in 0..ticks(schedule.end) {
            watch.add(&run.step(k as i64));
        }
        Ok(Outcome {
            traffic: run.traffic(schedule.end),
            ..watch.outcome()
        })
    }
}

/// How a trial went. Positions and forces are at the hand's scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The hand rests while it presses and after it came back, and the tip
    /// with it: neither moves to and fro by 2 mm when nobody moves it.
    pub stable: bool,
    /// By how much hand or tip moved to and fro while they should rest \[m\].
    pub swing: f64,
    /// Root mean square of tip less hand as it was one delay ago, while the
    /// tip is free \[m\].
    pub position_rmse: f64,
    /// Root mean square of the force on the hand less the contact's force as it
    /// was one delay ago \[N\].
    pub force_rmse: f64,
    /// Hand, as it was one delay ago, less tip at the end \[m\]: a handle that was let go may
    /// still move.
    pub drift: f64,
    /// Stiffness that the hand feels while it presses, on a surface that moves while that
    /// moves \[N/m\]: of the surface where it was one way back ago. `None` where the hand
    /// is nowhere behind it.
    pub felt_stiffness: Option<f64>,
    /// Largest change of the force on the hand in a tick \[N\].
    pub force_step: f64,
    /// For how long the arm did not obey, from the start on \[s\].
    pub held: f64,
    /// Largest force of the contact on the tip \[N\].
    pub peak_force: f64,
    /// Largest force on the hand \[N\].
    pub peak_felt: f64,
    /// Least of what entered less what left at hand and tip, at every moment, as the
    /// simulated bodies have it; never above zero \[J\].
    pub energy_margin: f64,
    /// Stiffness that the hand feels while it presses by that which the tip
    /// touches \[-\]; `None` where nothing is pressed.
    pub transparency: Option<f64>,
    /// Damping that the hand feels on the free way to the surface; of one that roams, in the
    /// second half of that \[N·s/m\].
    pub felt_damping: f64,
    /// When the tip is back where it began, or the hand let go \[s\]; `None` when it is not in
    /// time, or nothing was touched that there is.
    pub task_time: Option<f64>,
    /// What both ends sent.
    pub traffic: Traffic,
}

struct Run<'a> {
    law: &'a Law,
    environment: Environment,
    schedule: Schedule,
    leader: LeaderLink,
    follower: FollowerLink,
    up: Channel,
    down: Channel,
    hand: HandImpedance,
    grip: ImpedanceParameters,
    limiter: Option<ForceLimiter>,
    arm: Box<dyn Follower + 'a>,
    /// By the hand since the start [J].
    hand_work: f64,
    /// On the hand since the last tick [N].
    felt: [f64; 2],
    /// Where the tip is told to be.
    command: Option<TipCommand>,
    buffered: bool,
    /// Of both ways [s].
    delays: [f64; 2],
}

impl<'a> Run<'a> {
    fn new(
        trial: &'a Trial,
        schedule: Schedule,
        arm: Box<dyn Follower + 'a>,
    ) -> Result<Self, ParameterError> {
        let start = schedule.start();
        let laws = || Laws::new(trial.law.clone());
        let limiter = |own: &MasterConfig| ForceLimiter::new(own.force_limit, own.force_rate_limit);
        Ok(Run {
            law: &trial.law,
            environment: trial.environment,
            schedule,
            leader: LeaderLink::new(laws(), trial.buffer).coded(trial.deadband),
            follower: FollowerLink::new(laws(), trial.buffer).coded(trial.deadband),
            up: Channel::new(trial.link.up.clone(), trial.seed)?,
            down: Channel::new(trial.link.down.clone(), !trial.seed)?,
            hand: HandImpedance::new(trial.hand, start),
            grip: trial.hand,
            limiter: trial.master.as_ref().map(limiter),
            arm,
            hand_work: 0.0,
            felt: [0.0; 2],
            command: None,
            buffered: trial.buffer > 0.0,
            delays: trial.delays(),
        })
    }

    fn step(&mut self, k: i64) -> Tick {
        let time = k as f64 * TICK;
        let now_ns = START_NS + k * TICK_NS;
        let mapping = self.law.mapping();
        let (target, target_speed) = self.schedule.target(time);
        let before = self.hand.position();
        self.hand.hold(self.schedule.grip(time, self.grip));
        self.hand.step(TICK, target, target_speed, self.felt);
        let since = time - self.schedule.wall;
        self.arm.step(now_ns, since, self.command.take());

        let (hand, tip) = (self.hand.position(), self.arm.truth());
        let readings = self.arm.readings();
        // The force was the same all the way.
        self.hand_work -= (0..2)
            .map(|axis| self.felt[axis] * (hand[axis] - before[axis]))
            .sum::<f64>();

        let output = self.leader_step(now_ns, hand);
        let answer = self.follower_step(now_ns, &readings);
        if let Some(frame) = output.frame {
            send(&mut self.up, now_ns, &frame);
        }
        if let Some(frame) = answer.frame {
            send(&mut self.down, now_ns, &frame);
        }
        let force = match &mut self.limiter {
            Some(limiter) => limiter.step(TICK, output.force).force,
            None => output.force,
        };
        self.leader.rendered(force);
        self.felt = [force[0], force[1]];
        self.command = answer.command.map(|command| TipCommand {
            made_ns: answer.command_ns,
            position: command.position,
        });
        let scaled = |own: [f64; 2], scale: f64| [scale * own[0], scale * own[1]];
        Tick {
            time,
            hand,
            hand_speed: self.hand.velocity(),
            tip: scaled(tip.position, 1.0 / mapping.position_scale),
            felt: self.felt,
            touched: scaled(tip.force, mapping.force_scale),
            place: self.environment.place(since).0 / mapping.position_scale,
            held: readings.state != OperatingState::Enabled,
            energy: self.hand_work + mapping.power_scale() * tip.work,
            ago: self.ago(now_ns).map(ticks),
        }
    }

    /// Age of what the follower's end acts on, and of what the leader's does \[s\]: where frames
    /// wait to be played out as it is, else the delay of the link.
    fn ago(&self, now_ns: i64) -> [f64; 2] {
        match self.buffered {
            true => [
                self.follower.age(now_ns).unwrap_or(self.delays[0]),
                self.leader.age(now_ns).unwrap_or(self.delays[1]),
            ],
            false => self.delays,
        }
    }

    /// What both ends sent until `end` \[s\].
    fn traffic(&mut self, end: f64) -> Traffic {
        let now_ns = START_NS + (end / TICK) as i64 * TICK_NS;
        let [leader, follower] = [self.leader.state(now_ns), self.follower.state(now_ns)];
        leader.traffic.with(follower.traffic)
    }

    fn leader_step(&mut self, now_ns: i64, hand: [f64; 2]) -> LeaderStep {
        deliver(&mut self.down, now_ns, |bytes, at_ns| {
            self.leader.arrived(bytes, at_ns);
        });
        let readings = LeaderReadings {
            hand: Some(StampedPosition {
                stamp_ns: now_ns,
                position: [hand[0], hand[1], 0.0],
                silence: 0.0,
            }),
            orientation: None,
            state: OperatingState::Enabled,
        };
        self.leader.step(now_ns, &readings)
    }

    fn follower_step(&mut self, now_ns: i64, readings: &FollowerReadings) -> FollowerStep {
        deliver(&mut self.up, now_ns, |bytes, at_ns| {
            self.follower.arrived(bytes, at_ns);
        });
        self.follower.step(now_ns, readings)
    }
}

/// \[s\] in ticks.
fn ticks(time: f64) -> usize {
    (time / TICK).round() as usize
}

/// Sends a frame with what a seal adds to it: a channel of limited rate counts that too.
fn send(channel: &mut Channel, now_ns: i64, frame: &FrameBytes) {
    let mut bytes = [0; LONGEST_WIRE_LENGTH];
    bytes[..frame.len()].copy_from_slice(frame);
    channel.push(now_ns, &bytes[..frame.len() + SEAL_LENGTH]);
}

/// What is on its way through `channel` arrives.
fn deliver(channel: &mut Channel, now_ns: i64, mut arrived: impl FnMut(&[u8], i64)) {
    let mut bytes = [0; LONGEST_WIRE_LENGTH];
    while let Some((length, at_ns)) = channel.pop(now_ns, &mut bytes) {
        arrived(&bytes[..length.saturating_sub(SEAL_LENGTH)], at_ns);
    }
}

#[cfg(test)]
mod tests;

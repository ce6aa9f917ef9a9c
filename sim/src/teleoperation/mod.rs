//! Two ends of a delay law with everything that is around them: a hand, two
//! channels, a tip behind its servo, and something to touch.
//!
//! One trial is one task of an operator: reach, press, slide, come back
//! ([`Trial`]); its [`Outcome`] says how law and link served. The two ends are
//! those that the nodes of a session run ([`ferntast_control::link`]). Time is counted in ticks of 1 ms; the same trial gives
//! the same outcome.
//!
//! Axes: x into the surface, y along it. Positions and forces of the outcome
//! are at the hand's scale.

mod environment;
mod task;
mod tip;
mod watch;

pub use environment::Environment;
pub use tip::TipParameters;

use ferntast_control::delay::{Energy, EnergyMeter, Law};
use ferntast_control::frame::{FRAME_LENGTH, WIRE_LENGTH};
use ferntast_control::link::{
    FollowerLink, FollowerReadings, FollowerStep, LeaderLink, LeaderReadings, LeaderStep,
    StampedPosition,
};
use ferntast_control::operating::OperatingState;
use ferntast_control::switching::Laws;
use ferntast_emulation::channel::{Channel, LinkConfig};
use ferntast_emulation::hand::{HandImpedance, ImpedanceParameters};
use ferntast_model::ParameterError;
use task::Schedule;
use tip::Tip;
use watch::{Tick, Watch};

/// One tick \[s\].
pub const TICK: f64 = 1e-3;
const TICK_NS: i64 = 1_000_000;
/// Time of the first tick [ns].
const START_NS: i64 = 1_000_000_000_000_000;
/// Hand and tip reach no further from the surface than this [m].
const WORKSPACE: f64 = 0.5;

/// What is tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Which law, with its parameters.
    pub law: Law,
    /// Both directions of the link.
    pub link: LinkConfig,
    /// What the tip meets.
    pub environment: Environment,
    /// The operator's hand.
    pub hand: ImpedanceParameters,
    /// The arm behind its servo.
    pub tip: TipParameters,
    /// Jitter buffer at both ends \[s\]; none by default.
    pub buffer: f64,
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
            hand: ImpedanceParameters {
                mass: 0.5,
                damping: 20.0,
                stiffness: 300.0,
            },
            tip: TipParameters::default(),
            buffer: 0.0,
            seed,
        }
    }

    /// Runs it.
    ///
    /// # Errors
    ///
    /// The first value of law, link, hand or tip that is out of bounds.
    pub fn run(&self) -> Result<Outcome, ParameterError> {
        self.run_with(|_| {})
    }

    /// Runs it and shows each tick to `each`.
    ///
    /// # Errors
    ///
    /// As [`Trial::run`].
    pub fn run_with(&self, mut each: impl FnMut(&Moment)) -> Result<Outcome, ParameterError> {
        self.law.validate()?;
        self.link.validate()?;
        self.hand.validate()?;
        self.tip.validate()?;
        let (forth, back) = (
            self.link.up.nominal_delay(WIRE_LENGTH),
            self.link.down.nominal_delay(WIRE_LENGTH),
        );
        let schedule = Schedule::new(forth + back);
        let ticks = |delay: f64| (delay / TICK).round() as usize;
        let mut watch = Watch::new(schedule, ticks(forth), ticks(back));
        let mut run = Run::new(self, schedule)?;
        for k in 0..ticks(schedule.end) {
            let moment = run.step(k as i64);
            watch.add(&moment.tick);
            each(&moment);
        }
        Ok(watch.outcome())
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
    /// Hand less tip at the end \[m\].
    pub drift: f64,
    /// Largest force of the contact on the tip \[N\].
    pub peak_force: f64,
    /// Largest force on the hand \[N\].
    pub peak_felt: f64,
    /// Least of what entered less what left the two-port, over both ports and
    /// at every moment; never above zero \[J\].
    pub energy_margin: f64,
    /// Stiffness that the hand feels while it presses by that which the tip
    /// touches \[-\]; `None` where nothing is pressed.
    pub transparency: Option<f64>,
    /// Damping that the hand feels on the free way to the surface \[N·s/m\].
    pub felt_damping: f64,
    /// When the tip is back where it began \[s\]; `None` when it is not in time.
    pub task_time: Option<f64>,
}

/// One tick of a trial.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    tick: Tick,
    /// Energy at the leader's port \[J\].
    pub leader: Energy,
    /// Energy at the follower's port \[J\], at the tip's scale.
    pub follower: Energy,
}

impl Moment {
    /// Time since the start \[s\].
    pub fn time(&self) -> f64 {
        self.tick.time
    }

    /// Position of the hand along x and y \[m\].
    pub fn hand(&self) -> [f64; 2] {
        self.tick.hand
    }

    /// Position of the tip along x and y, at the hand's scale \[m\].
    pub fn tip(&self) -> [f64; 2] {
        self.tick.tip
    }

    /// Force on the hand \[N\].
    pub fn felt(&self) -> [f64; 2] {
        self.tick.felt
    }

    /// Force of the contact on the tip, at the hand's scale \[N\].
    pub fn touched(&self) -> [f64; 2] {
        self.tick.touched
    }

    /// Entered less left, over both ports, at the hand's scale \[J\].
    pub fn energy(&self) -> f64 {
        self.tick.energy
    }
}

struct Run<'a> {
    law: &'a Law,
    schedule: Schedule,
    leader: LeaderLink,
    follower: FollowerLink,
    up: Channel,
    down: Channel,
    hand: HandImpedance,
    tip: Tip,
    ports: Ports,
    /// On the hand since the last tick [N].
    felt: [f64; 2],
    /// Where the tip is told to be [m].
    command: [f64; 2],
}

impl<'a> Run<'a> {
    fn new(trial: &'a Trial, schedule: Schedule) -> Result<Self, ParameterError> {
        let start = schedule.start();
        let scale = trial.law.mapping().position_scale;
        let tip = [scale * start[0], scale * start[1]];
        let laws = || Laws::new(trial.law.clone());
        Ok(Run {
            law: &trial.law,
            schedule,
            leader: LeaderLink::new(laws(), trial.buffer),
            follower: FollowerLink::new(laws(), trial.buffer),
            up: Channel::new(trial.link.up.clone(), trial.seed)?,
            down: Channel::new(trial.link.down.clone(), !trial.seed)?,
            hand: HandImpedance::new(trial.hand, start),
            tip: Tip::new(trial.tip, trial.environment, tip),
            ports: Ports::default(),
            felt: [0.0; 2],
            command: tip,
        })
    }

    fn step(&mut self, k: i64) -> Moment {
        let time = k as f64 * TICK;
        let now_ns = START_NS + k * TICK_NS;
        let mapping = self.law.mapping();
        let offset = mapping.workspace_offset;
        let (target, target_speed) = self.schedule.target(time);
        self.hand.step(TICK, target, target_speed, self.felt);
        let since = time - self.schedule.wall;
        self.tip.step(TICK, since, self.command);

        let (hand, tip) = (self.hand.position(), self.tip.position);
        self.ports.step(hand, self.felt, tip, self.tip.force);

        let output = self.leader_step(now_ns, hand);
        let answer = self.follower_step(now_ns, tip);
        if let Some(frame) = output.frame {
            self.up.push(now_ns, &on_the_wire(&frame));
        }
        if let Some(frame) = answer.frame {
            self.down.push(now_ns, &on_the_wire(&frame));
        }
        self.felt = [output.force[0], output.force[1]];
        if let Some(command) = answer.command {
            self.command = [0, 1].map(|axis: usize| {
                (command.position[axis] - offset[axis]).clamp(-WORKSPACE, WORKSPACE)
            });
        }
        let scaled = |own: [f64; 2], scale: f64| [scale * own[0], scale * own[1]];
        let (leader, follower) = (self.ports.leader.energy(), self.ports.follower.energy());
        Moment {
            tick: Tick {
                time,
                hand,
                hand_speed: self.hand.velocity(),
                tip: scaled(tip, 1.0 / mapping.position_scale),
                felt: self.felt,
                touched: scaled(self.tip.force, mapping.force_scale),
                energy: leader.balance() + mapping.power_scale() * follower.balance(),
            },
            leader,
            follower,
        }
    }

    fn leader_step(&mut self, now_ns: i64, hand: [f64; 2]) -> LeaderStep {
        deliver(&mut self.down, now_ns, |bytes, at_ns| {
            self.leader.arrived(bytes, at_ns);
        });
        let readings = LeaderReadings {
            hand: Some(measured(now_ns, [hand[0], hand[1], 0.0])),
            state: OperatingState::Enabled,
        };
        self.leader.step(now_ns, &readings)
    }

    fn follower_step(&mut self, now_ns: i64, tip: [f64; 2]) -> FollowerStep {
        deliver(&mut self.up, now_ns, |bytes, at_ns| {
            self.follower.arrived(bytes, at_ns);
        });
        let offset = self.law.mapping().workspace_offset;
        let tip = [offset[0] + tip[0], offset[1] + tip[1], offset[2]];
        let readings = FollowerReadings {
            tip: Some(measured(now_ns, tip)),
            contact_force: Some([self.tip.force[0], self.tip.force[1], 0.0]),
            state: OperatingState::Enabled,
            told_to_stop: false,
        };
        self.follower.step(now_ns, &readings)
    }
}

/// A position as it was measured now.
fn measured(now_ns: i64, position: [f64; 3]) -> StampedPosition {
    StampedPosition {
        stamp_ns: now_ns,
        position,
        silence: 0.0,
    }
}

/// A frame with what a seal adds to it: a channel of limited rate counts that too.
fn on_the_wire(frame: &[u8; FRAME_LENGTH]) -> [u8; WIRE_LENGTH] {
    let mut bytes = [0; WIRE_LENGTH];
    bytes[..FRAME_LENGTH].copy_from_slice(frame);
    bytes
}

/// What is on its way through `channel` arrives.
fn deliver(channel: &mut Channel, now_ns: i64, mut arrived: impl FnMut(&[u8], i64)) {
    let mut bytes = [0; WIRE_LENGTH];
    while let Some((length, at_ns)) = channel.pop(now_ns, &mut bytes) {
        arrived(&bytes[..length.min(FRAME_LENGTH)], at_ns);
    }
}

/// Energy at both ports, measured from outside: the laws do not count for themselves.
#[derive(Debug, Default)]
struct Ports {
    leader: EnergyMeter,
    follower: EnergyMeter,
    /// Of the contact on the tip, one tick ago [N].
    touched: [f64; 2],
}

impl Ports {
    /// `felt` acted on the hand since the last tick, and the contact's force
    /// changed to `touched` on the way: its mean did the work.
    fn step(&mut self, hand: [f64; 2], felt: [f64; 2], tip: [f64; 2], touched: [f64; 2]) {
        let space = |own: [f64; 2]| [own[0], own[1], 0.0];
        let against = space(felt.map(|force| -force));
        self.leader.step(against, Some(space(hand)));
        let mean = [0, 1].map(|axis: usize| 0.5 * (touched[axis] + self.touched[axis]));
        self.follower.step(space(mean), Some(space(tip)));
        self.touched = touched;
    }
}

#[cfg(test)]
mod tests;

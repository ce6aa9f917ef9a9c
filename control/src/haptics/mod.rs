//! The haptic master: whose hand it is, whether to believe it, and what force
//! it gets.
//!
//! Hand commands of any number of sources are [offered](Master::offer) as they
//! come; one [step](Master::step) a period gives hand and force.
//!
//! A silent hand gets no force and is not passed on, but it does not latch the
//! master: the arm's servo latches. Force comes back no faster than the rate
//! limit allows.

mod authority;
mod clutch;
mod config;
mod force;
mod leader_arm;

pub use authority::{Authority, NotAuthorised};
pub use config::MasterConfig;
pub use force::{FORCE_LIFE, ForceLimiter, LimitedForce};
pub use leader_arm::{LeaderArm, LeaderHand, LeaderTorques};

use self::clutch::Clutch;
use crate::delay::Motion;
use crate::operating::{OperatingState, Reason, StateCommand, StateMachine, StateRefusal};
use crate::orientation::Orientation;
use crate::planted::{Planted, Rule};
use crate::{nanoseconds, seconds};
use ferntast_model::ParameterError;

/// Position of a hand, as one source says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandCommand {
    /// When it was measured \[ns since the UNIX epoch\]; zero is invalid.
    pub stamp_ns: i64,
    /// Who says so, as the middleware tells senders apart.
    pub source: u64,
    /// Position, leader base frame \[m\].
    pub position: [f64; 3],
    /// How it is turned, where it says so.
    pub orientation: Option<Orientation>,
}

/// Why a hand command was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HandRefusal {
    /// The master is not enabled.
    #[error("the master is {}; send enable or resume", .state.name())]
    NotEnabled {
        /// The state that it is in.
        state: OperatingState,
    },
    /// The stamp is zero or negative.
    #[error("the hand's stamp is zero; stamp poses with the time they were measured")]
    StampZero,
    /// Not newer than the last one.
    #[error("the hand's stamp is {back:.6} s behind the one before; send stamps that increase")]
    StampBackwards {
        /// How far back \[s\].
        back: f64,
    },
    /// Measured too long ago.
    #[error("the hand's pose is {age:.3} s old, {limit} s at most; check clocks and delays")]
    TooOld {
        /// Its age \[s\].
        age: f64,
        /// Largest age \[s\].
        limit: f64,
    },
    /// Measured in the future.
    #[error("the hand's pose is stamped {ahead:.3} s in the future; check the clocks")]
    FromFuture {
        /// How far ahead \[s\].
        ahead: f64,
    },
    /// NaN or infinite.
    #[error("the hand's position is not finite; send numbers")]
    NotFinite,
    /// Outside the workspace.
    #[error("the hand is at {value:.4} m on axis {axis}, outside ±{limit} m; stay inside")]
    OutOfRange {
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// Where it is \[m\].
        value: f64,
        /// Where the workspace ends \[m\].
        limit: f64,
    },
    /// Further from the last one than a hand can move.
    #[error(
        "the hand jumps {distance:.4} m, {speed:.2} m/s; come back to where it was, or pause and resume"
    )]
    Jump {
        /// Distance from the last position acted on \[m\].
        distance: f64,
        /// Speed that it implies \[m/s\].
        speed: f64,
    },
    /// Another source holds the authority.
    #[error(transparent)]
    NotAuthorised(#[from] NotAuthorised),
}

/// Hand commands refused since the start, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HandRefusalCounts {
    /// Not finite, or with a stamp that is zero or goes backwards.
    pub invalid: u64,
    /// Too old or from the future.
    pub time: u64,
    /// Outside the workspace.
    pub out_of_range: u64,
    /// Jumps.
    pub jump: u64,
    /// From a source without authority.
    pub unauthorised: u64,
    /// While the master was not enabled.
    pub not_enabled: u64,
}

/// What a step of the master gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterOutput {
    /// What the arm is led by: the hand, as far as it can be believed now, by way of the clutch;
    /// `None` while it is silent, or the master is not enabled.
    pub hand: Option<Motion>,
    /// How the hand is turned, where it says so and the clutch is closed.
    pub orientation: Option<Orientation>,
    /// The clutch is open: the arm stays, and the hand feels nothing.
    pub clutched: bool,
    /// The hand moved on since the last step: pass it on.
    pub fresh: bool,
    /// Force on the hand \[N\].
    pub force: [f64; 3],
    /// Magnitude or rate of the force was limited.
    pub force_limited: bool,
    /// The operating state.
    pub state: OperatingState,
    /// Why it is in this state.
    pub reason: Reason,
    /// Time since the last valid hand command \[s\]; NaN before the first.
    pub hand_age: f64,
}

#[derive(Clone, Copy, Debug)]
struct Hand {
    stamp_ns: i64,
    accepted_ns: i64,
    motion: Motion,
    /// What the arm is led by \[m\].
    led: [f64; 3],
    orientation: Option<Orientation>,
}

/// The haptic master.
#[derive(Clone, Debug)]
pub struct Master {
    config: MasterConfig,
    machine: StateMachine,
    authority: Authority,
    limiter: ForceLimiter,
    hand: Option<Hand>,
    clutch: Clutch,
    /// Whose the clutch is.
    clutched_by: Option<u64>,
    fresh: bool,
    refusals: HandRefusalCounts,
    planted: Planted,
}

/// Clocks may disagree by this much [s].
const CLOCK_TOLERANCE: f64 = 0.050;

impl Master {
    /// A master that is disabled.
    ///
    /// # Errors
    ///
    /// The first value of `config` that is out of bounds.
    pub fn new(config: &MasterConfig) -> Result<Master, ParameterError> {
        config.validate()?;
        Ok(Master {
            config: config.clone(),
            machine: StateMachine::default(),
            authority: Authority::new(config.release_after),
            limiter: ForceLimiter::new(config.force_limit, config.force_rate_limit),
            hand: None,
            clutch: Clutch::default(),
            clutched_by: None,
            fresh: false,
            refusals: HandRefusalCounts::default(),
            planted: Planted::NONE,
        })
    }

    /// The same with a planted bug.
    pub fn planted(mut self, planted: Planted) -> Master {
        self.machine = self.machine.planted(planted);
        self.authority.planted = planted;
        self.limiter.planted = planted;
        self.planted = planted;
        self
    }

    /// The operating state.
    pub fn state(&self) -> OperatingState {
        self.machine.state()
    }

    /// Who holds the authority, and who was refused.
    pub fn authority(&self) -> &Authority {
        &self.authority
    }

    /// Nobody holds the authority from now on: the next valid hand takes it.
    pub fn release_authority(&mut self) {
        self.authority.release();
    }

    /// Hand commands refused since the start.
    pub fn refusals(&self) -> HandRefusalCounts {
        self.refusals
    }

    /// Carries out a state command. `disable` releases the authority.
    ///
    /// # Errors
    ///
    /// [`StateRefusal`]; the state stays.
    pub fn command(&mut self, command: StateCommand) -> Result<(), StateRefusal> {
        self.machine.command(command, true)?;
        if command == StateCommand::Disable {
            self.authority.release();
            self.clutch = Clutch::default();
        }
        if self.state() != OperatingState::Enabled || command == StateCommand::Resume {
            self.hand = None;
        }
        Ok(())
    }

    /// Opens the clutch, so that the hand moves and the arm stays, or closes it again. It stays
    /// through holds; `disable` takes hand and arm together as they were first, and another hand
    /// leads the arm on from where it is.
    ///
    /// # Errors
    ///
    /// The master is disabled.
    pub fn set_clutch(&mut self, open: bool) -> Result<(), HandRefusal> {
        match self.state() {
            state @ (OperatingState::Disabled | OperatingState::Fault) => {
                Err(HandRefusal::NotEnabled { state })
            }
            OperatingState::Enabled | OperatingState::Paused => {
                self.clutch.set_open(open);
                Ok(())
            }
        }
    }

    /// Takes a hand command that was not offered before.
    ///
    /// # Errors
    ///
    /// [`HandRefusal`]; nothing is remembered of a refused command.
    pub fn offer(&mut self, now_ns: i64, command: &HandCommand) -> Result<(), HandRefusal> {
        let result = self.judge(now_ns, command);
        if let Err(refusal) = &result {
            let counts = &mut self.refusals;
            *match refusal {
                HandRefusal::NotEnabled { .. } => &mut counts.not_enabled,
                HandRefusal::StampZero
                | HandRefusal::StampBackwards { .. }
                | HandRefusal::NotFinite => &mut counts.invalid,
                HandRefusal::TooOld { .. } | HandRefusal::FromFuture { .. } => &mut counts.time,
                HandRefusal::OutOfRange { .. } => &mut counts.out_of_range,
                HandRefusal::Jump { .. } => &mut counts.jump,
                HandRefusal::NotAuthorised(_) => &mut counts.unauthorised,
            } += 1;
        }
        result
    }

    fn judge(&mut self, now_ns: i64, command: &HandCommand) -> Result<(), HandRefusal> {
        if command.stamp_ns <= 0 {
            return Err(HandRefusal::StampZero);
        }
        if !command.position.iter().all(|value| value.is_finite()) {
            return Err(HandRefusal::NotFinite);
        }
        let age = seconds(now_ns.saturating_sub(command.stamp_ns));
        if age > self.config.hand_age {
            let limit = self.config.hand_age;
            return Err(HandRefusal::TooOld { age, limit });
        }
        if age < -CLOCK_TOLERANCE {
            return Err(HandRefusal::FromFuture { ahead: -age });
        }
        for (axis, (&value, &limit)) in command
            .position
            .iter()
            .zip(&self.config.workspace)
            .enumerate()
        {
            if value.abs() > limit {
                let axis = axis as u8;
                return Err(HandRefusal::OutOfRange { axis, value, limit });
            }
        }
        let state = self.state();
        if state != OperatingState::Enabled {
            return Err(HandRefusal::NotEnabled { state });
        }
        self.authority.may(now_ns, command.source)?;
        // The hand of another source starts over.
        let last = self
            .hand
            .filter(|_| self.authority.holder() == Some(command.source));
        let velocity = match last {
            Some(last) => self.step_from(&last, command)?,
            None => [0.0; 3],
        };
        self.authority.take(now_ns, command.source);
        if self.clutched_by != Some(command.source) {
            self.clutch.hand_over();
            self.clutched_by = Some(command.source);
        }
        self.hand = Some(Hand {
            stamp_ns: command.stamp_ns,
            accepted_ns: now_ns,
            motion: Motion {
                position: command.position,
                velocity,
            },
            led: self.clutch.lead(command.position),
            orientation: command.orientation,
        });
        self.fresh = true;
        Ok(())
    }

    /// Filtered velocity [m/s] over the step from `last`.
    fn step_from(&self, last: &Hand, command: &HandCommand) -> Result<[f64; 3], HandRefusal> {
        if command.stamp_ns <= last.stamp_ns {
            let back = seconds(last.stamp_ns - command.stamp_ns);
            return Err(HandRefusal::StampBackwards { back });
        }
        let passed = seconds(command.stamp_ns.saturating_sub(last.stamp_ns));
        let way: [f64; 3] =
            std::array::from_fn(|axis| command.position[axis] - last.motion.position[axis]);
        let distance = way.iter().map(|value| value * value).sum::<f64>().sqrt();
        let counted = passed.min(self.config.silence);
        if distance > self.config.jump_speed * counted + self.config.jump_slack {
            let speed = distance / passed;
            return Err(HandRefusal::Jump { distance, speed });
        }
        // First-order low pass, exact for a sample that stays.
        let share = 1.0 - (-passed / self.config.velocity_filter).exp();
        Ok(std::array::from_fn(|axis| {
            let before = last.motion.velocity[axis];
            before + share * (way[axis] / passed - before)
        }))
    }

    /// One period of `dt` \[s\] at `now_ns`. `reflected` is the force that the
    /// link wants on the hand \[N\]; `None` while there is none.
    pub fn step(&mut self, now_ns: i64, dt: f64, reflected: Option<[f64; 3]>) -> MasterOutput {
        self.authority.age(now_ns);
        let enabled = self.state() == OperatingState::Enabled;
        let age_ns = self
            .hand
            .map(|hand| now_ns.saturating_sub(hand.accepted_ns));
        let live = enabled && age_ns.is_some_and(|age| age <= nanoseconds(self.config.silence));
        let force = if live || self.planted.lacks(Rule::HandLetGo) {
            let share = self.clutch.share(dt);
            let felt = reflected.unwrap_or([0.0; 3]).map(|own| share * own);
            self.limiter.step(dt, felt)
        } else {
            self.limiter.stop()
        };
        let hand = self.hand.filter(|_| live);
        let clutched = self.clutch.is_open();
        MasterOutput {
            hand: hand.map(|own| Motion {
                position: own.led,
                velocity: match clutched {
                    true => [0.0; 3],
                    false => own.motion.velocity,
                },
            }),
            orientation: hand.filter(|_| !clutched).and_then(|own| own.orientation),
            clutched,
            fresh: std::mem::take(&mut self.fresh) && live,
            force: force.force,
            force_limited: force.limited,
            state: self.machine.state(),
            reason: self.machine.reason(),
            hand_age: age_ns.map_or(f64::NAN, seconds),
        }
    }
}

#[cfg(test)]
mod tests;

//! Operating states after CRTK, shared by servo and haptic master.
//!
//! ```text
//!            enable               pause, event
//! DISABLED ─────────▶ ENABLED ◀───────────────▶ PAUSED
//!    ▲                   │          resume         │
//!    │ disable           │ fault event             │ fault event
//!    └──── any state     └────────▶ FAULT ◀────────┘
//! ```
//!
//! PAUSED is latched until `resume` (or `disable`), FAULT until `disable` and
//! `enable`. Source: Collaborative Robotics Toolkit (CRTK), operating state
//! and state commands.

use std::fmt;

use crate::planted::{Planted, Rule};

/// The operating states of CRTK.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OperatingState {
    /// Drives off.
    Disabled,
    /// Follows commands.
    Enabled,
    /// Holds passively; latched until resumed.
    Paused,
    /// Something is broken; drives off until disabled and enabled again.
    Fault,
}

impl OperatingState {
    /// The CRTK name.
    pub const fn name(self) -> &'static str {
        match self {
            OperatingState::Disabled => "DISABLED",
            OperatingState::Enabled => "ENABLED",
            OperatingState::Paused => "PAUSED",
            OperatingState::Fault => "FAULT",
        }
    }

    /// 0 DISABLED, 1 ENABLED, 2 PAUSED, 3 FAULT.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The state of that [`code`](Self::code).
    pub const fn from_code(code: u8) -> Option<OperatingState> {
        match code {
            0 => Some(OperatingState::Disabled),
            1 => Some(OperatingState::Enabled),
            2 => Some(OperatingState::Paused),
            3 => Some(OperatingState::Fault),
            _ => None,
        }
    }
}

/// What a person or another node may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StateCommand {
    /// DISABLED → ENABLED.
    Enable,
    /// Any state → DISABLED.
    Disable,
    /// ENABLED → PAUSED.
    Pause,
    /// PAUSED → ENABLED: arms again.
    Resume,
    /// PAUSED → ENABLED where it paused because commands fell silent, and for
    /// nothing else: the arm's end of the link says so after a gap that a scenario
    /// allows to be bridged. No person's word.
    ResumeAfterGap,
}

impl StateCommand {
    /// The CRTK name, lower case.
    pub const fn name(self) -> &'static str {
        match self {
            StateCommand::Enable => "enable",
            StateCommand::Disable => "disable",
            StateCommand::Pause => "pause",
            StateCommand::Resume => "resume",
            StateCommand::ResumeAfterGap => "resume_after_gap",
        }
    }

    /// The command called `name`.
    pub fn from_name(name: &str) -> Option<StateCommand> {
        [
            StateCommand::Enable,
            StateCommand::Disable,
            StateCommand::Pause,
            StateCommand::Resume,
            StateCommand::ResumeAfterGap,
        ]
        .into_iter()
        .find(|command| command.name() == name)
    }
}

/// What happens without being asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// No valid command for longer than the watchdog allows: pauses.
    CommandSilent,
    /// No measurement for longer than the watchdog allows: fault.
    MeasurementSilent,
    /// A measurement that is not finite, or not of as many joints: fault.
    MeasurementInvalid,
    /// A joint (counted from 1) is measured to stand still when it cannot: fault.
    MeasurementFrozen(u8),
    /// A joint (counted from 1) is measured where it cannot have got to: fault.
    MeasurementJumped(u8),
    /// A joint (counted from 1) left its position limits: fault.
    JointLimit(u8),
    /// A joint (counted from 1) is faster than allowed: fault.
    Overspeed(u8),
}

/// Why a device is in the state that it is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reason {
    /// It has just been started.
    Started,
    /// It was told to.
    Commanded(StateCommand),
    /// Something happened.
    Event(Event),
}

impl fmt::Display for Reason {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reason::Started => write!(formatter, "started; send enable"),
            Reason::Commanded(command) => write!(formatter, "{} was asked for", command.name()),
            Reason::Event(Event::CommandSilent) => {
                write!(formatter, "commands fell silent; send resume")
            }
            Reason::Event(Event::MeasurementSilent) => {
                write!(formatter, "measurements fell silent; disable, then enable")
            }
            Reason::Event(Event::MeasurementInvalid) => {
                write!(
                    formatter,
                    "a measurement is not finite; disable, then enable"
                )
            }
            Reason::Event(Event::MeasurementFrozen(joint)) => write!(
                formatter,
                "joint {joint} measures the same again and again; mend that, disable, then enable"
            ),
            Reason::Event(Event::MeasurementJumped(joint)) => write!(
                formatter,
                "joint {joint} was measured elsewhere at once; check its encoder and zero, disable, then enable"
            ),
            Reason::Event(Event::JointLimit(joint)) => {
                write!(
                    formatter,
                    "joint {joint} left its limits; disable, then enable"
                )
            }
            Reason::Event(Event::Overspeed(joint)) => {
                write!(formatter, "joint {joint} is too fast; disable, then enable")
            }
        }
    }
}

/// Why a state command was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateRefusal {
    /// The state does not allow it.
    #[error(
        "{} is not allowed in {}; {}",
        .command.name(),
        .state.name(),
        hint(*.command, *.state)
    )]
    NotAllowed {
        /// What was asked for.
        command: StateCommand,
        /// The state that it was asked in.
        state: OperatingState,
    },
    /// There is no valid measurement to start from.
    #[error("{} needs a valid, recent measurement of the arm; start the arm first", .command.name())]
    NotReady {
        /// What was asked for.
        command: StateCommand,
    },
}

fn hint(command: StateCommand, state: OperatingState) -> &'static str {
    match (command, state) {
        (_, OperatingState::Fault) => "send disable first, then enable",
        (StateCommand::ResumeAfterGap, _) => "it did not pause for silent commands",
        (StateCommand::Enable, OperatingState::Paused) => "send resume",
        (_, OperatingState::Disabled) => "send enable first",
        (StateCommand::Resume, _) => "it follows commands already",
        _ => "send disable first",
    }
}

/// The state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateMachine {
    state: OperatingState,
    reason: Reason,
    planted: Planted,
}

impl Default for StateMachine {
    fn default() -> Self {
        StateMachine {
            state: OperatingState::Disabled,
            reason: Reason::Started,
            planted: Planted::NONE,
        }
    }
}

impl StateMachine {
    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> StateMachine {
        StateMachine {
            state: match planted.lacks(Rule::StartsDisabled) {
                true => OperatingState::Enabled,
                false => self.state,
            },
            planted,
            ..self
        }
    }

    /// The state.
    pub fn state(&self) -> OperatingState {
        self.state
    }

    /// Why it is in this state.
    pub fn reason(&self) -> Reason {
        self.reason
    }

    /// Carries out `command`. `ready` says whether there is a valid
    /// measurement to start from; `enable` and `resume` need one.
    ///
    /// Asking for the state that already is changes it not and is no error; but from a `pause` or
    /// `disable` on the arm stands because that was asked for: the end of a silence is no reason
    /// to go on, and that it has only just been started none to arm it.
    /// Returns whether the state changed.
    ///
    /// # Errors
    ///
    /// [`StateRefusal`]; the state stays.
    pub fn command(&mut self, command: StateCommand, ready: bool) -> Result<bool, StateRefusal> {
        use OperatingState::{Disabled, Enabled, Paused};
        let next = match (command, self.state) {
            (StateCommand::Disable, state) if self.planted.lacks(Rule::DisableObeyed) => state,
            (StateCommand::Pause, state) if self.planted.lacks(Rule::PauseObeyed) => state,
            (StateCommand::Resume, OperatingState::Fault)
                if self.planted.lacks(Rule::FaultLatched) =>
            {
                Enabled
            }
            (StateCommand::Disable, _) => Disabled,
            (StateCommand::Enable, Disabled | Enabled) => Enabled,
            (StateCommand::Pause, Enabled | Paused) => Paused,
            (StateCommand::Resume, Paused | Enabled) => Enabled,
            (StateCommand::ResumeAfterGap, Paused)
                if self.reason == Reason::Event(Event::CommandSilent) =>
            {
                Enabled
            }
            (command, state) => return Err(StateRefusal::NotAllowed { command, state }),
        };
        if next == self.state {
            let obeys = match (command, next) {
                (StateCommand::Pause, Paused) => !self.planted.lacks(Rule::PauseObeyed),
                (StateCommand::Disable, Disabled) => !self.planted.lacks(Rule::DisableObeyed),
                _ => false,
            };
            if obeys {
                self.reason = Reason::Commanded(command);
            }
            return Ok(false);
        }
        if next == Enabled && !ready {
            return Err(StateRefusal::NotReady { command });
        }
        self.state = next;
        self.reason = Reason::Commanded(command);
        Ok(true)
    }

    /// Takes note of a valid command.
    pub(crate) fn heard(&mut self) {
        let silent = self.reason == Reason::Event(Event::CommandSilent);
        if self.planted.lacks(Rule::PauseLatched) && silent {
            self.state = OperatingState::Enabled;
            self.reason = Reason::Commanded(StateCommand::Resume);
        }
    }

    /// Takes note of `event`. In DISABLED nothing follows from it; in FAULT
    /// the first reason is kept. Returns whether the state changed.
    pub fn event(&mut self, event: Event) -> bool {
        let next = match (event, self.state) {
            (_, OperatingState::Disabled | OperatingState::Fault) => return false,
            (Event::CommandSilent, OperatingState::Paused) => return false,
            (Event::CommandSilent, OperatingState::Enabled) => OperatingState::Paused,
            _ => OperatingState::Fault,
        };
        self.state = next;
        self.reason = Reason::Event(event);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn silence_latches_until_resume() {
        let mut machine = StateMachine::default();
        assert_eq!(machine.command(StateCommand::Enable, true), Ok(true));
        assert!(machine.event(Event::CommandSilent));
        assert_eq!(machine.state(), OperatingState::Paused);
        assert!(matches!(
            machine.command(StateCommand::Enable, true),
            Err(StateRefusal::NotAllowed { .. })
        ));
        assert_eq!(machine.command(StateCommand::Resume, true), Ok(true));
        assert_eq!(machine.state(), OperatingState::Enabled);
    }

    #[test]
    fn who_pauses_an_arm_that_stands_for_silence_has_paused_it() {
        let mut machine = StateMachine::default();
        machine.command(StateCommand::Enable, true).unwrap();
        machine.event(Event::CommandSilent);
        assert_eq!(machine.command(StateCommand::Pause, true), Ok(false));
        assert_eq!(
            machine.reason(),
            Reason::Commanded(StateCommand::Pause),
            "{}",
            machine.reason()
        );
        assert!(machine.command(StateCommand::ResumeAfterGap, true).is_err());
        assert_eq!(machine.command(StateCommand::Resume, true), Ok(true));
    }

    #[test]
    fn who_stops_an_arm_before_it_was_armed_has_stopped_it() {
        let mut machine = StateMachine::default();
        assert_eq!(machine.reason(), Reason::Started);
        assert!(machine.command(StateCommand::Pause, true).is_err());
        assert_eq!(machine.reason(), Reason::Started);
        assert_eq!(machine.command(StateCommand::Disable, false), Ok(false));
        assert_eq!(machine.reason(), Reason::Commanded(StateCommand::Disable));
    }

    #[test]
    fn a_fault_needs_disable_then_enable() {
        let mut machine = StateMachine::default();
        machine.command(StateCommand::Enable, true).unwrap();
        machine.event(Event::Overspeed(1));
        machine.event(Event::MeasurementSilent);
        assert_eq!(machine.reason(), Reason::Event(Event::Overspeed(1)));
        for command in [
            StateCommand::Enable,
            StateCommand::Resume,
            StateCommand::Pause,
        ] {
            let refusal = machine.command(command, true).unwrap_err();
            assert!(refusal.to_string().contains("disable first"), "{refusal}");
        }
        machine.command(StateCommand::Disable, false).unwrap();
        assert_eq!(
            machine.command(StateCommand::Enable, false),
            Err(StateRefusal::NotReady {
                command: StateCommand::Enable
            })
        );
        machine.command(StateCommand::Enable, true).unwrap();
        assert_eq!(machine.state(), OperatingState::Enabled);
    }

    fn any_input() -> impl Strategy<Value = Result<StateCommand, Event>> {
        prop_oneof![
            Just(Ok(StateCommand::Enable)),
            Just(Ok(StateCommand::Disable)),
            Just(Ok(StateCommand::Pause)),
            Just(Ok(StateCommand::Resume)),
            Just(Ok(StateCommand::ResumeAfterGap)),
            Just(Err(Event::CommandSilent)),
            Just(Err(Event::MeasurementSilent)),
            Just(Err(Event::JointLimit(2))),
        ]
    }

    proptest! {
        /// Only a person gets the arm out of PAUSED and FAULT.
        #[test]
        fn events_never_enable(inputs in proptest::collection::vec(any_input(), 0..60)) {
            let mut machine = StateMachine::default();
            for input in inputs {
                let (before, reason) = (machine.state(), machine.reason());
                match input {
                    Ok(command) => { let _ = machine.command(command, true); }
                    Err(event) => { machine.event(event); }
                }
                if machine.state() == OperatingState::Enabled && before != OperatingState::Enabled {
                    let silent = reason == Reason::Event(Event::CommandSilent);
                    let allowed = match input {
                        Ok(StateCommand::Enable | StateCommand::Resume) => true,
                        Ok(StateCommand::ResumeAfterGap) => silent,
                        _ => false,
                    };
                    prop_assert!(allowed, "{input:?} from {before:?}, {reason:?}");
                }
                if before == OperatingState::Fault && machine.state() != OperatingState::Fault {
                    prop_assert_eq!(input, Ok(StateCommand::Disable));
                }
            }
        }
    }
}

//! `ferntast state`.

use std::{process::ExitCode, thread, time::Duration};

use clap::ValueEnum;
use ferntast_bus::{Bus, Depth};
use ferntast_msgs::sample::{
    OperatingState, OperatingStateSample, StateCommand, StateCommandSample,
};
use ferntast_msgs::topics::{self, Topic};
use ferntast_nodes::{process::Clock, session::Visit};
use serde_json::json;

use super::{Failure, output::print_json};

/// Tell the operating state of a running session, or change it.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "After a hold (the master or the link fell silent) the arm stays where it is until it is re-armed:\n  \
    ferntast state follower          # tells the state\n  \
    ferntast state follower resume"
)]
pub struct Arguments {
    /// Who is to obey.
    #[arg(value_enum)]
    device: Device,

    /// What to do; without it the state is only told.
    #[arg(value_enum)]
    command: Option<StateChange>,

    /// Name of the session.
    #[arg(long, default_value = "default", value_name = "NAME")]
    session: String,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Device {
    /// The arm's servo.
    Follower,
    /// The haptic master.
    Leader,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StateChange {
    /// Drives on.
    Enable,
    /// Drives off.
    Disable,
    /// Hold.
    Pause,
    /// Leave the hold: re-arm.
    Resume,
}

/// How long an answer is waited for.
const PATIENCE: Duration = Duration::from_millis(1500);

/// Gives the command and waits for the state that follows.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let visit = Visit::open(&arguments.session).map_err(Failure::refused)?;
    let (command_topic, state_topic) = match arguments.device {
        Device::Follower => (
            topics::FOLLOWER_STATE_COMMAND,
            topics::FOLLOWER_OPERATING_STATE,
        ),
        Device::Leader => (topics::LEADER_STATE_COMMAND, topics::LEADER_OPERATING_STATE),
    };
    let wish = arguments.command.map(|word| match word {
        StateChange::Enable => (StateCommand::ENABLE, OperatingState::ENABLED),
        StateChange::Disable => (StateCommand::DISABLE, OperatingState::DISABLED),
        StateChange::Pause => (StateCommand::PAUSE, OperatingState::PAUSED),
        StateChange::Resume => (StateCommand::RESUME, OperatingState::ENABLED),
    });
    let state = match visit.as_ref().and_then(Visit::bus) {
        Some(bus) => ask(bus, command_topic, state_topic, wish)?,
        None => None,
    };
    drop(visit);
    let Some((state, reason)) = state else {
        return Err(Failure::failed(format!(
            "nobody answered in session {:?}: is it running? (ferntast session, or --session NAME)",
            arguments.session
        )));
    };
    let name = state.name().unwrap_or("UNKNOWN");
    if json {
        print_json(&json!({"state": name, "reason": reason}))?;
    } else {
        println!("{name}: {reason}");
    }
    if wish.is_none_or(|(_, wanted)| state == wanted) {
        Ok(ExitCode::SUCCESS)
    } else {
        Err(Failure::failed(format!(
            "the command was not followed: {name}, {reason}"
        )))
    }
}

/// Gives the command, if there is one, and waits for the state that it leads
/// to, at most for [`PATIENCE`]. Gives the last state that was heard of, if any.
fn ask(
    bus: &Bus,
    command_topic: Topic<StateCommandSample>,
    state_topic: Topic<OperatingStateSample>,
    wish: Option<(StateCommand, OperatingState)>,
) -> Result<Option<(OperatingState, String)>, Failure> {
    let clock = Clock::start();
    let mut publisher = bus.publisher(command_topic).map_err(Failure::failed)?;
    let mut states = bus
        .subscriber(state_topic, Depth::Newest)
        .map_err(Failure::failed)?;
    if let Some((command, _)) = wish {
        // It waits in shared memory until its reader, the servo or the master, has
        // found this publisher, with one of its next steps.
        let now = clock.now();
        publisher
            .publish(now, &StateCommandSample::new(now, command))
            .map_err(Failure::failed)?;
    }
    let begun = clock.now();
    let mut last = None;
    while clock.now().seconds_since(begun) < PATIENCE.as_secs_f64() {
        if let Some(received) = states.newest(clock.now()) {
            let message = received.message;
            last = Some((message.state, message.reason.to_string()));
            let after = clock.now().seconds_since(begun) > 0.02;
            match wish {
                Some((_, wanted)) if message.state == wanted && after => break,
                None => break,
                _ => {}
            }
        }
        thread::sleep(Duration::from_millis(5));
    }
    Ok(last)
}

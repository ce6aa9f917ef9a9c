//! `ferntast state`.

use std::{process::ExitCode, thread, time::Duration};

use clap::ValueEnum;
use ferntast_bus::{Bus, Depth, SharedMemoryBus, SharedMemoryConfig};
use ferntast_msgs::sample::{OperatingState, StateCommand, StateCommandSample};
use ferntast_msgs::topics::{self, Topic};
use serde_json::json;

use super::{Failure, output::print_json};
use crate::clock::Clock;

/// Give a state command to a running session.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "After a hold (the master or the link fell silent) the arm stays where it is until it is re-armed:\n  \
    ferntast state follower resume"
)]
pub struct Arguments {
    /// Who is to obey.
    #[arg(value_enum)]
    device: Device,

    /// What to do.
    #[arg(value_enum)]
    command: Word,

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
enum Word {
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
    let bus = Bus::SharedMemory(
        SharedMemoryBus::open(&SharedMemoryConfig {
            session: arguments.session.clone(),
        })
        .map_err(Failure::refused)?,
    );
    let (command_topic, state_topic) = match arguments.device {
        Device::Follower => (
            topics::FOLLOWER_STATE_COMMAND,
            topics::FOLLOWER_OPERATING_STATE,
        ),
        Device::Leader => (topics::LEADER_STATE_COMMAND, topics::LEADER_OPERATING_STATE),
    };
    let (command, wanted) = match arguments.command {
        Word::Enable => (StateCommand::ENABLE, OperatingState::ENABLED),
        Word::Disable => (StateCommand::DISABLE, OperatingState::DISABLED),
        Word::Pause => (StateCommand::PAUSE, OperatingState::PAUSED),
        Word::Resume => (StateCommand::RESUME, OperatingState::ENABLED),
    };
    let state = give(&bus, command_topic, state_topic, command, wanted)?;
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
    if state == wanted {
        Ok(ExitCode::SUCCESS)
    } else {
        Err(Failure::failed(format!(
            "the command was not followed: {name}, {reason}"
        )))
    }
}

fn give(
    bus: &Bus,
    command_topic: Topic<StateCommandSample>,
    state_topic: Topic<ferntast_msgs::sample::OperatingStateSample>,
    command: StateCommand,
    wanted: OperatingState,
) -> Result<Option<(OperatingState, String)>, Failure> {
    let clock = Clock::start();
    let mut publisher = bus.publisher(command_topic).map_err(Failure::failed)?;
    let mut states = bus
        .subscriber(state_topic, Depth::Newest)
        .map_err(Failure::failed)?;
    // The reader of the command has to find this publisher first.
    thread::sleep(Duration::from_millis(50));
    let begun = clock.now();
    let sample = StateCommandSample {
        stamp: begun,
        command,
        reserved: [0; 7],
    };
    publisher.publish(begun, &sample).map_err(Failure::failed)?;
    let mut last = None;
    while clock.now().seconds_since(begun) < PATIENCE.as_secs_f64() {
        if let Some(received) = states.newest(clock.now()) {
            let message = received.message;
            last = Some((message.state, message.reason.to_string()));
            if message.state == wanted && clock.now().seconds_since(begun) > 0.02 {
                break;
            }
        }
        thread::sleep(Duration::from_millis(5));
    }
    Ok(last)
}

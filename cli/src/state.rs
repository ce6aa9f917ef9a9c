//! `ferntast state`.

use std::{process::ExitCode, sync::atomic::Ordering, thread, time::Duration};

use clap::ValueEnum;
use ferntast_bus::{Bus, Depth};
use ferntast_control::operating::Reason;
use ferntast_msgs::sample::{
    OperatingState, OperatingStateSample, StateCommand, StateCommandSample,
};
use ferntast_msgs::topics::{self, Topic};
use ferntast_nodes::{
    events::Event,
    node::{is_because, to_law},
    process::{Clock, stop_on_signals},
    session::Visit,
};
use serde_json::json;

use super::{
    Failure,
    output::{print_json, print_json_line},
};

/// Tell the operating state of a running session, or change it.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "After a hold (the master or the link fell silent) the arm stays where it is until it is re-armed:\n  \
    ferntast state follower          # tells the state\n  \
    ferntast state follower resume\n  \
    ferntast state leader clutch     # the hand moves, the arm stays ...\n  \
    ferntast state leader engage     # ... until it leads the arm again, from where both are\n  \
    ferntast state --follow          # what happens, with times and reasons, until Ctrl-C"
)]
pub struct Arguments {
    /// Who is to obey.
    #[arg(value_enum, required_unless_present = "follow")]
    device: Option<Device>,

    /// Tell what happens in the session as it happens: states, crashes, hands, the link, recordings.
    /// With --json, one JSON object a line.
    #[arg(long, conflicts_with_all = ["device", "command"])]
    follow: bool,

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
    /// Of the leader: the hand moves, the arm stays where it is.
    Clutch,
    /// Of the leader: the hand leads the arm again, from where both are.
    Engage,
}

impl StateChange {
    fn wish(self) -> Wish {
        let (command, state) = match self {
            StateChange::Enable => (StateCommand::ENABLE, OperatingState::ENABLED),
            StateChange::Disable => (StateCommand::DISABLE, OperatingState::DISABLED),
            StateChange::Pause => (StateCommand::PAUSE, OperatingState::PAUSED),
            StateChange::Resume => (StateCommand::RESUME, OperatingState::ENABLED),
            StateChange::Clutch => (StateCommand::CLUTCH, OperatingState::ENABLED),
            StateChange::Engage => (StateCommand::ENGAGE, OperatingState::ENABLED),
        };
        Wish { command, state }
    }
}

/// How long an answer is waited for.
const PATIENCE: Duration = Duration::from_millis(1500);

/// Gives the command and waits for the state that follows.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let visit = Visit::open(&arguments.session).map_err(Failure::refused)?;
    let Some(device) = arguments.device else {
        return follow(
            visit.as_ref().and_then(Visit::bus),
            &arguments.session,
            json,
        );
    };
    let clutches = matches!(
        arguments.command,
        Some(StateChange::Clutch | StateChange::Engage)
    );
    if clutches && matches!(device, Device::Follower) {
        return Err(Failure::refused(
            "the clutch is the hand's: ferntast state leader clutch, or engage",
        ));
    }
    let (command_topic, state_topic) = match device {
        Device::Follower => (
            topics::FOLLOWER_STATE_COMMAND,
            topics::FOLLOWER_OPERATING_STATE,
        ),
        Device::Leader => (topics::LEADER_STATE_COMMAND, topics::LEADER_OPERATING_STATE),
    };
    let wish = arguments.command.map(StateChange::wish);
    let told = match visit.as_ref().and_then(Visit::bus) {
        Some(bus) => ask(bus, command_topic, state_topic, wish)?,
        None => None,
    };
    drop(visit);
    let Some(told) = told else {
        return Err(Failure::failed(format!(
            "nobody answered in session {:?}: is it running? (ferntast session, or --session NAME)",
            arguments.session
        )));
    };
    let (name, reason) = (told.state.name().unwrap_or("UNKNOWN"), told.reason);
    if json {
        print_json(&json!({"state": name, "reason": reason.as_str()}))?;
    } else {
        println!("{name}: {reason}");
    }
    if wish.is_none_or(|wish| wish.is_met_by(&told)) {
        Ok(ExitCode::SUCCESS)
    } else {
        Err(Failure::failed(format!(
            "the command was not followed: {name}, {reason}"
        )))
    }
}

/// How long a session may say nothing until it counts as ended: it says its newest event
/// again every second.
const ENDED: f64 = 5.0;

/// Tells the session's events until Ctrl-C, or until it ends.
fn follow(bus: Option<&Bus>, session: &str, json: bool) -> Result<ExitCode, Failure> {
    let nobody = || {
        Failure::failed(format!(
            "nothing is heard of session {session:?}: is it running? (ferntast session, or --session NAME)"
        ))
    };
    let mut told = bus
        .ok_or_else(nobody)?
        .subscriber(topics::DIAGNOSTICS, Depth::Queue(topics::EVENT_QUEUE))
        .map_err(Failure::failed)?;
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let clock = Clock::start();
    let (mut heard, mut newest) = (clock.now(), None);
    while !stop.load(Ordering::Relaxed) {
        while let Some(received) = told.next(clock.now()) {
            let Some(event) = Event::of(&received.message) else {
                continue;
            };
            heard = clock.now();
            if newest.is_none_or(|newest| event.at > newest) {
                newest = Some(event.at);
                tell(&event, json)?;
            }
        }
        if clock.now().seconds_since(heard) > ENDED {
            return newest.map(|_| ExitCode::SUCCESS).ok_or_else(nobody);
        }
        thread::sleep(Duration::from_millis(20));
    }
    Ok(ExitCode::SUCCESS)
}

fn tell(event: &Event, json: bool) -> Result<(), Failure> {
    let seconds = event.at.nanos() as f64 * 1e-9;
    let level = event.level.name().unwrap_or("error");
    if json {
        return print_json_line(
            &json!({"time": seconds, "level": level, "event": event.text.as_str()}),
        );
    }
    let of_day = event
        .at
        .nanos()
        .div_euclid(1_000_000)
        .rem_euclid(86_400_000);
    println!(
        "{:02}:{:02}:{:02}.{:03} UTC  {level:7}  {}",
        of_day / 3_600_000,
        of_day / 60_000 % 60,
        of_day / 1000 % 60,
        of_day % 1000,
        event.text
    );
    Ok(())
}

/// For so long a stop has to last \[s\]: a word that arms the arm may cross it, and a session
/// that is starting looks around every 0.02 s.
const HOLD: f64 = 0.1;

/// For so long the state of another word has to last \[s\]: it may have been there before, and the
/// word is heard within that time.
const REACTION: f64 = 0.02;

/// A word, and the state that it leads to.
#[derive(Clone, Copy)]
struct Wish {
    command: StateCommand,
    state: OperatingState,
}

impl Wish {
    /// Whether `told` is what follows from the word. A device that stood already tells by the
    /// reason that it has heard it.
    fn is_met_by(self, told: &OperatingStateSample) -> bool {
        let heard = match to_law(self.command).filter(|_| self.command.is_stop()) {
            Some(command) => is_because(told, Reason::Commanded(command)),
            None => true,
        };
        told.state == self.state && heard
    }

    /// For how long it is met until that is believed \[s\].
    fn lasting(self) -> f64 {
        if self.command.is_stop() {
            HOLD
        } else {
            REACTION
        }
    }
}

/// Gives the command, if there is one, and waits for the state that it leads to, at most for
/// [`PATIENCE`]; a stop that does not last is said again. Gives the last state that was heard of,
/// if any.
fn ask(
    bus: &Bus,
    command_topic: Topic<StateCommandSample>,
    state_topic: Topic<OperatingStateSample>,
    wish: Option<Wish>,
) -> Result<Option<OperatingStateSample>, Failure> {
    let clock = Clock::start();
    let mut publisher = bus.publisher(command_topic).map_err(Failure::failed)?;
    let mut states = bus
        .subscriber(state_topic, Depth::Newest)
        .map_err(Failure::failed)?;
    // It waits in shared memory until its reader, the servo or the master, has
    // found this publisher, with one of its next steps.
    let mut say = |command| {
        let now = clock.now();
        let sample = StateCommandSample::new(now, command);
        publisher.publish(now, &sample).map_err(Failure::failed)
    };
    let begun = clock.now();
    if let Some(wish) = wish {
        say(wish.command)?;
    }
    let mut last = None;
    let mut met_since = None;
    while clock.now().seconds_since(begun) < PATIENCE.as_secs_f64() {
        let now = clock.now();
        if let Some(received) = states.newest(now) {
            let told = received.message;
            last = Some(told);
            let Some(wish) = wish else { break };
            if wish.is_met_by(&told) {
                met_since = met_since.or(Some(now));
            } else if met_since.take().is_some() && wish.command.is_stop() {
                say(wish.command)?;
            }
        }
        let lasted =
            |wish: Wish| met_since.is_some_and(|since| now.seconds_since(since) >= wish.lasting());
        if wish.is_some_and(lasted) {
            break;
        }
        thread::sleep(Duration::from_millis(5));
    }
    Ok(last)
}

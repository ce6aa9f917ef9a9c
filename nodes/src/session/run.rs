//! A session from start to end.

use std::{
    process::ExitStatus,
    sync::atomic::{AtomicBool, Ordering},
};

use ferntast_bus::{Bus, Publisher, SharedMemoryBus, SharedMemoryConfig};
use ferntast_control::operating::{self, Reason};
use ferntast_msgs::{
    Time,
    sample::{
        HealthSample, Level, OperatingState, OperatingStateSample, StateCommand, StateCommandSample,
    },
    topics,
};

use super::{
    ArmSummary, Monitor, SessionError, Summary, Supervisor,
    host_resources::HostResources,
    live::LiveLine,
    preflight, recording,
    scripted_operator::{ScriptedOperator, Seen, is_silence},
    supervisor::Unclean,
};
use crate::{
    bridge::recorder,
    events::{Event, EventWatch, name_of},
    graph::Graph,
    master::THIS_HOST,
    node::is_because,
    process::{Clock, End, Priority, SessionContext},
};

/// How often the supervisor looks \[ns\].
pub(crate) const ROUND_NANOS: i64 = 20_000_000;
/// How often the newest event is said again \[ns\].
const REPETITION_NANOS: i64 = 1_000_000_000;
/// How long nothing may change until all nodes are alive and the arm is armed
/// \[s\]: on a computer that is busy they come one after the other.
const START_PATIENCE: f64 = 20.0;

/// What is not obeyed on the way to an armed arm is said again after this time \[s\].
const COMMAND_PERIOD: f64 = 0.25;

/// What is said where the arm is not armed at the start.
const STOPPED_BEFORE: &str = "somebody stopped the arm before it was armed: it is yours to arm it";

/// What is said where the operator's end is ready before the arm's.
const WAITS: &str = "all is ready here, and waits for the arm's host";

/// What the operator of a script says when it does not arm the arm again.
const LEFT_TO_YOU: &str =
    "from now on it is yours to arm the arm again, not the script's operator's";

/// What can be chosen about a session beside its scenario.
#[derive(Clone, Debug)]
pub struct SessionOptions {
    /// End after that many seconds armed \[s\].
    pub duration: Option<f64>,
    /// Arm at the start.
    pub enable: bool,
    /// Where the hand is a script or a recorded motion, its operator arms the arm again
    /// after a silence.
    pub rearm: bool,
}

/// Runs a session of the nodes of `graph` until `stop` is set, its duration is over, or it fails.
/// Gives the summary, and what went wrong while it ran.
///
/// # Errors
///
/// What kept it from starting.
pub fn run(
    graph: &Graph,
    context: SessionContext,
    options: &SessionOptions,
    stop: &AtomicBool,
) -> Result<(Summary, Result<(), SessionError>), SessionError> {
    // A stop, a restart and the nodes' start are not to wait for a computer that
    // is busy. Where that is not allowed the session goes on without.
    let _ = Priority::Supervision.take();
    preflight::check(&context)?;
    let resources = HostResources::acquire(&context)?;
    let session_file = resources.session_file.clone();
    let executable = std::env::current_exe().map_err(SessionError::Executable)?;
    let rows = graph.rows().filter(|row| row.takes_part(&context));
    let nodes: Vec<&str> = rows.map(|row| row.name).collect();

    let mut session = Running {
        supervisor: Supervisor::new(executable, session_file, &nodes),
        live: LiveLine::new(options.duration),
        armed_at: None,
        commanded_at: None,
        died: Vec::new(),
        operator: (options.enable
            && options.rearm
            && context.end.is_none()
            && !context.loaded.scenario.hand.source.is_a_person())
        .then(ScriptedOperator::default),
        own_stop: None,
        is_stopped: false,
        is_waiting: false,
        rearmed: 0,
        context,
    };
    let clock = session.context.clock();
    let bus = Bus::SharedMemory(SharedMemoryBus::open(&SharedMemoryConfig {
        session: session.context.session.clone(),
    })?);
    let mapping = session.context.loaded.scenario.law.mapping();
    let mut monitor = Monitor::new(&bus, &session.context.joints(), session.context.end)?
        .comparing(&bus, mapping)?;
    let mut arming = Arming {
        follower: bus.publisher(topics::FOLLOWER_STATE_COMMAND)?,
        leader: bus.publisher(topics::LEADER_STATE_COMMAND)?,
    };
    let mut teller = Teller {
        diagnostics: bus.publisher(topics::DIAGNOSTICS)?,
        newest: None,
        due: Time::INVALID,
    };
    session.supervisor.start()?;
    let outcome = session.supervise(clock, &mut monitor, &mut arming, &mut teller, options, stop);
    let ended = clock.now();
    monitor.update(ended);
    // As they were before the nodes were told to stop.
    let states = monitor.states();
    let armed_s = monitor.armed();
    let mut node_summaries = monitor.node_summaries(ended);
    for (node, process, restarts) in session.supervisor.nodes() {
        let summary = node_summaries.entry(node.to_string()).or_default();
        summary.restarts = restarts;
        summary.alive &= process.is_some();
    }
    let unclean = session.supervisor.stop();
    session.live.finish();
    for (node, how) in &unclean {
        match how {
            Unclean::Killed => eprintln!("node {node} did not stop in time and was killed"),
            Unclean::Failed(status) => eprintln!("node {node} failed as it stopped ({status})"),
        }
    }
    monitor.update(clock.now());
    // The recorder's last word comes after that of the others.
    if let (Some(told), Some(view)) = (
        node_summaries.get_mut(recorder::NAME),
        monitor.nodes.get(recorder::NAME),
    ) {
        told.lost = view.lost();
    }
    let recorder = recording::summarize(
        &session.context,
        &node_summaries,
        &monitor.recordings,
        unclean.iter().any(|(node, _)| *node == recorder::NAME),
    );
    let recording_faults = recorder.as_ref().map(|recorder| recorder.faults.clone());
    let summary = Summary {
        scenario: session.context.loaded.scenario.name.clone(),
        end: session.context.end,
        session: session.context.session.clone(),
        duration_s: session
            .armed_at
            .map_or(0.0, |armed| ended.seconds_since(armed)),
        armed_s,
        rearmed: session.rearmed,
        arm: ArmSummary::of(&session.context),
        servo: monitor.servo(),
        link: monitor.link(),
        contact: monitor.contact(),
        tip: monitor.tip(),
        felt_stiffness: monitor.felt_stiffness(),
        leader: monitor.leader(),
        twins: monitor.twins(),
        recording: session
            .context
            .bag
            .as_ref()
            .map(|bag| bag.display().to_string()),
        recorder,
        states,
        nodes: node_summaries,
    };
    drop((monitor, arming, teller, bus));
    let freed = resources.release();
    let mut outcome = match (session.armed_at, outcome) {
        // There is nothing to sum up.
        (None, Err(error)) => return Err(error),
        (_, outcome) => outcome,
    };
    if outcome.is_ok() {
        outcome = match recording_faults {
            Some(faults) if !faults.is_empty() => Err(SessionError::Recording { faults }),
            _ => freed,
        };
    }
    Ok((summary, outcome))
}

struct Running {
    context: SessionContext,
    supervisor: Supervisor,
    live: LiveLine,
    armed_at: Option<Time>,
    commanded_at: Option<Time>,
    died: Vec<&'static str>,
    /// Whose hand is the script, where there is one.
    operator: Option<ScriptedOperator>,
    /// The stamp of the session's own last word that takes the drives off.
    own_stop: Option<Time>,
    /// Somebody stopped the arm before it was armed.
    is_stopped: bool,
    /// It was said that all waits for the other host.
    is_waiting: bool,
    /// How often the operator armed the arm again.
    rearmed: u32,
}

struct Arming {
    follower: Publisher<StateCommandSample>,
    leader: Publisher<StateCommandSample>,
}

impl Arming {
    /// Tells the devices at `end`, or both.
    fn tell(&mut self, now: Time, command: StateCommand, end: Option<End>) {
        // If a command is not sent the arm is not armed, which is noticed.
        if End::Arm.is_at(end) {
            self.tell_arm(now, command);
        }
        if End::Operator.is_at(end) {
            let _ = self
                .leader
                .publish(now, &StateCommandSample::new(now, command));
        }
    }

    /// Tells the arm alone.
    fn tell_arm(&mut self, now: Time, command: StateCommand) {
        // What is not sent is not obeyed, and said again.
        let _ = self
            .follower
            .publish(now, &StateCommandSample::new(now, command));
    }
}

/// Says events on `/diagnostics`.
struct Teller {
    diagnostics: Publisher<HealthSample>,
    newest: Option<Event>,
    due: Time,
}

impl Teller {
    fn tell(&mut self, now: Time, event: &Event) {
        // What cannot be said now is said with the next repetition, if it is the newest.
        let _ = self.diagnostics.publish(now, &event.sample());
        self.newest = Some(*event);
        self.due = now.plus_nanos(REPETITION_NANOS);
    }

    /// Says the newest event again now and then, for those who came later.
    fn repeat(&mut self, now: Time) {
        if let Some(event) = self.newest
            && now >= self.due
        {
            self.tell(now, &event);
        }
    }
}

impl Running {
    fn supervise(
        &mut self,
        clock: Clock,
        monitor: &mut Monitor,
        arming: &mut Arming,
        teller: &mut Teller,
        options: &SessionOptions,
        stop: &AtomicBool,
    ) -> Result<(), SessionError> {
        let started = clock.now();
        let mut due = started;
        let mut progress = (0, started);
        while !stop.load(Ordering::Relaxed) {
            due = due.plus_nanos(ROUND_NANOS).max(clock.now());
            clock.sleep_until(due);
            let now = clock.now();
            for (node, status) in self.supervisor.watch()? {
                self.note_death(now, node, status, &mut monitor.events);
            }
            monitor.update(now);
            if self.armed_at.is_none() {
                self.arm(now, monitor, arming, options);
                let reached = self.reached(now, monitor);
                if reached > progress.0 {
                    progress = (reached, now);
                }
                if self.waits_for_the_other_host(now, monitor) {
                    progress.1 = now;
                    if !std::mem::replace(&mut self.is_waiting, true) {
                        monitor.events.note(now, Level::OK, WAITS);
                    }
                }
                let idle = now.seconds_since(progress.1);
                if self.armed_at.is_none() && idle > START_PATIENCE {
                    return Err(SessionError::NotReady {
                        waited: now.seconds_since(started),
                        seconds: START_PATIENCE,
                        waiting: self.waiting_for(now, monitor),
                    });
                }
                if self.armed_at.is_some() {
                    monitor.begin(now);
                }
            } else {
                self.operate(now, monitor, arming);
            }
            let elapsed = self.armed_at.map_or(0.0, |armed| now.seconds_since(armed));
            for event in monitor.events.take() {
                self.live.tell(elapsed, &event);
                teller.tell(now, &event);
            }
            teller.repeat(now);
            self.live.show(now, elapsed, monitor, &self.supervisor);
            if options.duration.is_some_and(|duration| elapsed >= duration) {
                break;
            }
        }
        Ok(())
    }

    /// Gives the command to arm once every node is alive, unless somebody has said that it is
    /// not to be; notes when it is.
    fn arm(
        &mut self,
        now: Time,
        monitor: &mut Monitor,
        arming: &mut Arming,
        options: &SessionOptions,
    ) {
        if options.enable && !self.is_stopped && self.is_stopped_by_others(monitor) {
            self.is_stopped = true;
            if let Some(operator) = &mut self.operator {
                operator.leave();
            }
            monitor.events.note(now, Level::WARN, STOPPED_BEFORE);
        }
        let all_alive = self
            .supervisor
            .nodes()
            .all(|(node, process, _)| process.is_some() && monitor.is_alive(node, now));
        if !all_alive {
            return;
        }
        if !options.enable || self.is_stopped {
            self.armed_at = Some(now);
            return;
        }
        if self.waits_for_the_other_host(now, monitor) {
            return;
        }
        let device = monitor.state_of(self.device());
        let is = |state| device.is_some_and(|device| device.state == state);
        let said = |since: Time| now.seconds_since(since) <= COMMAND_PERIOD;
        // An arm by itself is enabled, and pauses until the other host commands it.
        let is_paused = self.context.end == Some(End::Arm) && is(OperatingState::PAUSED);
        if is(OperatingState::ENABLED) || is_paused {
            self.armed_at = Some(now);
        } else if !self.commanded_at.is_some_and(said) {
            let word = match is(OperatingState::FAULT) {
                false => StateCommand::ENABLE,
                // As from the moments in which the nodes were being started.
                true if device.is_some_and(|device| is_silence(&device)) => StateCommand::DISABLE,
                true => return,
            };
            self.commanded_at = Some(now);
            self.note_own(now, word);
            arming.tell(now, word, self.context.end);
        }
    }

    /// The device whose state says that the session is armed.
    fn device(&self) -> &'static str {
        self.context.end.unwrap_or(End::Arm).device()
    }

    /// Whether the operator's end is all there, and not heard of by the arm's: its word to arm would
    /// be lost.
    fn waits_for_the_other_host(&self, now: Time, monitor: &Monitor) -> bool {
        let mut nodes = self.supervisor.nodes();
        self.context.end == Some(End::Operator)
            && !monitor.is_connected()
            && nodes.all(|(node, _, _)| monitor.is_alive(node, now))
    }

    /// Whether somebody else said that the arm is to stop, since the last round, or at any time
    /// since it was started: it knows why it stands, whatever of what is said was missed here.
    fn is_stopped_by_others(&self, monitor: &mut Monitor) -> bool {
        let asked_for = Reason::Commanded(operating::StateCommand::Disable);
        let stands = |told: OperatingStateSample| is_because(&told, asked_for);
        let knows = monitor.state_of(self.device()).is_some_and(stands);
        self.others_stop(monitor) || (knows && self.own_stop.is_none())
    }

    /// Whether somebody else said since the last round that the arm is to stop.
    fn others_stop(&self, monitor: &mut Monitor) -> bool {
        let mut stops = std::mem::take(&mut monitor.stops).into_iter();
        stops.any(|stamp| Some(stamp) != self.own_stop)
    }

    /// Remembers a word of its own that stops the arm.
    fn note_own(&mut self, now: Time, word: StateCommand) {
        if word == StateCommand::DISABLE {
            self.own_stop = Some(now);
        }
    }

    /// What the operator does whose hand is the script.
    fn operate(&mut self, now: Time, monitor: &mut Monitor, arming: &mut Arming) {
        let foreign = self.others_stop(monitor);
        let Some(operator) = &mut self.operator else {
            return;
        };
        let taken = monitor.holder > THIS_HOST;
        if (foreign || taken) && operator.leave() {
            monitor.events.note(now, Level::OK, LEFT_TO_YOU);
        }
        let is_alive = |(node, process, _): (&str, Option<u32>, u32)| {
            process.is_some() && monitor.is_alive(node, now)
        };
        let alive = self.supervisor.nodes().all(is_alive);
        let seen = Seen {
            arm: monitor.state_of("follower"),
            well: alive && monitor.is_connected(),
        };
        let Some((word, arm)) = operator.step(now, &seen) else {
            return;
        };
        self.note_own(now, word);
        self.rearmed += u32::from(word != StateCommand::DISABLE);
        arming.tell_arm(now, word);
        let cause = arm
            .reason
            .as_str()
            .split([';', ','])
            .next()
            .unwrap_or_default();
        let told = format_args!(
            "the script's operator: {} (the arm was {}: {cause})",
            word.name().unwrap_or("?"),
            arm.state.name().unwrap_or("?"),
        );
        monitor.events.note(now, Level::OK, told);
    }

    /// How far the session has come on its way to an armed arm: the nodes that
    /// were heard of lately, and the operating states that were told.
    fn reached(&self, now: Time, monitor: &Monitor) -> usize {
        let alive = self.supervisor.nodes();
        let alive = alive.filter(|(node, _, _)| monitor.is_alive(node, now));
        alive.count() + monitor.operating.len()
    }

    fn waiting_for(&self, now: Time, monitor: &Monitor) -> String {
        let silent: Vec<&str> = self
            .supervisor
            .nodes()
            .filter(|(node, _, _)| !monitor.is_alive(node, now))
            .map(|(node, _, _)| node)
            .collect();
        if !silent.is_empty() {
            return format!("nothing was heard of {}", silent.join(", "));
        }
        let device = self.device();
        let named = name_of(device);
        match monitor.state_of(device) {
            Some(last) => format!(
                "the {named} is {} and was not armed: {}",
                last.state.name().unwrap_or("in an unknown state"),
                last.reason
            ),
            None => format!("the {named} has not told its operating state"),
        }
    }

    fn note_death(
        &mut self,
        now: Time,
        node: &'static str,
        status: ExitStatus,
        events: &mut EventWatch,
    ) {
        let left = self.operator.as_mut().is_some_and(ScriptedOperator::leave);
        let told = format_args!("node {node} died ({status}); it is started again");
        events.note(now, Level::ERROR, told);
        if left {
            events.note(now, Level::OK, LEFT_TO_YOU);
        }
        if node == recorder::NAME
            && !self.died.contains(&node)
            && let Some(bag) = &self.context.bag
        {
            self.live.note(&format!(
                "the recording goes on in another file; what {} held is mended at the end",
                bag.display()
            ));
        }
        self.died.push(node);
    }
}

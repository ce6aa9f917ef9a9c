//! A scenario in virtual time, from its start to what came of it.

use std::{collections::BTreeMap, time::Instant};

use ferntast_config::UnknownLaw;
use ferntast_control::delay::Law;
use ferntast_msgs::sample::FrictionCommand;
use ferntast_nodes::{
    graph::Graph,
    lockstep::{LockstepSession, RunError},
    process::SessionContext,
    servo::FrictionSummary,
    session::{ArmSummary, ContactSummary, LeaderSummary, LinkSummary, StateSummary, TipSummary},
    twin::TwinSummary,
};
use serde::Serialize;

/// What happens while it runs; times in seconds after the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LockstepPlan {
    /// Virtual time to run, else that of the scenario \[s\].
    pub duration: Option<f64>,
    /// When the delay law is switched to which.
    pub switches: Vec<(f64, String)>,
    /// When the servo takes over the friction that the twin found.
    pub take_over: Option<f64>,
    /// When it feeds the configured friction forward again.
    pub give_back: Option<f64>,
}

/// What came of it.
#[derive(Debug, Serialize)]
pub struct LockstepOutcome {
    /// Name of the scenario.
    pub scenario: String,
    /// Of all chance.
    pub seed: u64,
    /// Virtual time \[s\].
    pub duration_s: f64,
    /// Time that it took \[s\].
    pub wall_s: f64,
    /// The first by the second.
    pub real_time_factor: f64,
    /// The arm.
    #[serde(flatten)]
    pub arm: ArmSummary,
    /// The link.
    pub link: LinkSummary,
    /// The contact.
    pub contact: ContactSummary,
    /// The tip.
    pub tip: TipSummary,
    /// As in a session's summary.
    #[serde(rename = "felt_stiffness_N_per_m")]
    pub felt_stiffness: Option<f64>,
    /// The hand.
    pub leader: LeaderSummary,
    /// Twins of joints.
    pub twins: Vec<TwinSummary>,
    /// What the servo feeds forward.
    pub friction: Vec<FrictionSummary>,
    /// Operating states.
    pub states: BTreeMap<String, StateSummary>,
    /// Where it was recorded.
    pub recording: Option<String>,
    /// Why the recording is not whole; `null` where it is, or without one.
    pub recording_fault: Option<String>,
}

/// Why nothing came of it.
#[derive(Debug, thiserror::Error)]
pub enum LockstepError {
    /// A time that is none.
    #[error("{what} {seconds}: give a {positive} of seconds")]
    Seconds {
        /// The option.
        what: &'static str,
        /// What was given.
        seconds: f64,
        /// What it has to be.
        positive: &'static str,
    },
    /// A hand that virtual time does not reach.
    #[error(
        "lockstep has no hand on ROS 2, nor a Haply, in its virtual time: give --hand scripted, leader or FILE.csv, or run \
         ferntast session --hand crtk"
    )]
    NoHand,
    /// No law has that name.
    #[error(transparent)]
    Law(#[from] UnknownLaw),
    /// It cannot run.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl LockstepPlan {
    /// How long it runs in that session \[s\].
    ///
    /// # Errors
    ///
    /// [`LockstepError::Seconds`].
    pub fn duration_in(&self, context: &SessionContext) -> Result<f64, LockstepError> {
        let scenario = &context.loaded.scenario;
        let duration = self.duration.unwrap_or(scenario.duration);
        match duration.is_finite() && duration > 0.0 {
            true => Ok(duration),
            false => Err(LockstepError::Seconds {
                what: "--duration",
                seconds: duration,
                positive: "positive number",
            }),
        }
    }

    fn check(&self) -> Result<(), LockstepError> {
        let switches = self.switches.iter().map(|(at, _)| ("--switch", *at));
        let takes = self.take_over.map(|at| ("--take-over", at));
        let gives = self.give_back.map(|at| ("--give-back", at));
        for (what, seconds) in switches.chain(takes).chain(gives) {
            if !(seconds.is_finite() && seconds >= 0.0) {
                return Err(LockstepError::Seconds {
                    what,
                    seconds,
                    positive: "number, counted from the start,",
                });
            }
        }
        match self
            .switches
            .iter()
            .find(|(_, law)| !Law::NAMES.contains(&law.as_str()))
        {
            Some((_, law)) => Err(UnknownLaw::new(law).into()),
            None => Ok(()),
        }
    }
}

/// Runs the nodes of `graph` in the session `context` as `plan` says. `done` is called
/// with the virtual time that has passed \[s\], and says whether to go on: if not, the
/// recording is closed, and the outcome is that of the time until then.
///
/// # Errors
///
/// [`LockstepError`]: nothing was run then. That the recording is not whole is told in
/// the outcome.
pub fn run(
    graph: &Graph,
    context: &SessionContext,
    plan: &LockstepPlan,
    done: &mut dyn FnMut(f64) -> bool,
) -> Result<LockstepOutcome, LockstepError> {
    let duration = plan.duration_in(context)?;
    plan.check()?;
    if context.loaded.scenario.hand.source.has_its_own_time() {
        return Err(LockstepError::NoHand);
    }
    let mut session = LockstepSession::new(graph, context)?;
    for (seconds, law) in &plan.switches {
        session.switch_law_at(*seconds, law)?;
    }
    let commands = [
        (plan.take_over, FrictionCommand::TAKE_OVER),
        (plan.give_back, FrictionCommand::GIVE_BACK),
    ];
    for (seconds, command) in commands {
        if let Some(seconds) = seconds {
            session.command_friction_at(seconds, command)?;
        }
    }
    let begun = Instant::now();
    let mut passed = 0.0;
    while passed < duration {
        let slice = (duration - passed).min(1.0);
        session.run(slice);
        passed += slice;
        if !done(passed) {
            break;
        }
    }
    let wall = begun.elapsed().as_secs_f64();
    let monitor = session.monitor();
    let mut outcome = LockstepOutcome {
        scenario: context.loaded.scenario.name.clone(),
        seed: context.loaded.scenario.seed,
        duration_s: passed,
        wall_s: wall,
        real_time_factor: passed / wall,
        arm: ArmSummary::of(context),
        link: monitor.link(),
        contact: monitor.contact(),
        tip: monitor.tip(),
        felt_stiffness: monitor.felt_stiffness(),
        leader: monitor.leader(),
        twins: monitor.twins(),
        friction: monitor.friction(),
        states: monitor.states(),
        recording: context.bag.as_ref().map(|path| path.display().to_string()),
        recording_fault: None,
    };
    outcome.recording_fault = session.finish().err().map(|error| error.to_string());
    Ok(outcome)
}

//! `ferntast session`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_nodes::{
    graph::Graph,
    process::{
        End, SessionContext,
        link_end::{self, LinkAccess},
        stop_on_signals,
    },
    session::{self, SessionOptions},
};

use super::{
    Failure,
    foxglove_option::FoxgloveOption,
    output::print_json,
    page_options::PageOptions,
    scenario_options::{ScenarioOptions, check_twins},
};

/// Run a session.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    ferntast session --duration 20 --record recordings/first\n  \
    ferntast session --hand crtk               # your own CRTK master on ROS 2 drives it\n  \
    ferntast session --hand hand.csv --link relay_600ms\n  \
    ferntast session --scenario relay --law tdpa\n  \
    ferntast session --twin joint.toml         # and see where the lab's model fails while it moves\n  \
    ferntast session --middleware zenoh        # rmw_zenoh instead of DDS\n  \
    ferntast session --foxglove                # watch in Foxglove or Lichtblick, ws://127.0.0.1:8765\n  \
    ferntast session --end arm --link-endpoint quic/ARM:7448   # the arm here, the hand elsewhere (docs/two_hosts.md)\n\n\
    While it runs: the page that it names, `ros2 topic list`, `ferntast state follower resume`
(re-arm after a hold), `ferntast link law wave` (another delay law). Ctrl-C ends it cleanly; a second one, while it \
    ends, kills it at once, with exit code 130.")]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioOptions,

    /// End after that many seconds in which the arm was armed (else at Ctrl-C).
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration: Option<f64>,

    /// Record into this folder (a rosbag2 directory; must not exist yet).
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,

    /// Hold the model of this experiment of the lab against a joint while it moves; topics /twin/*.
    /// Give it again for another joint.
    #[arg(long, value_name = "EXPERIMENT.toml")]
    twin: Vec<PathBuf>,

    /// Name of the session; two at once on one host need two names.
    #[arg(long, default_value = "default", value_name = "NAME")]
    session: String,

    /// Serve no page.
    #[arg(long)]
    no_console: bool,

    #[command(flatten)]
    page: PageOptions,

    #[command(flatten)]
    foxglove: FoxgloveOption,

    /// Run one end of the link, the other end on another host (docs/two_hosts.md): `arm` has the arm, its
    /// servo and its twins, `operator` the hand. Both take the same --session, --scenario, --arm and
    /// --link-endpoint quic/HOST:PORT, HOST being the arm's.
    #[arg(long, value_enum, value_name = "operator|arm")]
    end: Option<EndOption>,

    /// Do not arm at the start: wait for `ferntast state follower enable` or a CRTK client.
    #[arg(long)]
    no_enable: bool,

    /// Where the hand is a script or a recorded motion: after a silence that paused the arm, wait
    /// for `ferntast state follower resume`. Without this the script's operator says so itself,
    /// after a second, as long as nobody else stopped the arm or took the master and no node died.
    #[arg(long)]
    no_rearm: bool,
}

/// An end of the link, on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum EndOption {
    /// With the hand
    Operator,
    /// With the arm
    Arm,
}

impl EndOption {
    fn end(self) -> End {
        match self {
            EndOption::Operator => End::Operator,
            EndOption::Arm => End::Arm,
        }
    }
}

/// Refuses what only the other end has a use for.
fn refuse_what_is_elsewhere(arguments: &Arguments) -> Result<(), Failure> {
    let scenario = &arguments.scenario;
    let first = |options: &[(&'static str, bool)]| {
        let given = options.iter().find(|(_, given)| *given);
        given.map(|(option, _)| *option)
    };
    let of_arm = first(&[
        ("--driver", scenario.driver.is_some()),
        ("--twin", !arguments.twin.is_empty()),
    ]);
    let of_hand = first(&[
        ("--hand", scenario.hand.is_some()),
        ("--arm-leader", scenario.arm_leader.is_some()),
        ("--driver-leader", scenario.driver_leader.is_some()),
    ]);
    let of_one_end = first(&[("--link-peer", scenario.link_peer.is_some())]);
    let (elsewhere, why) = match arguments.end {
        Some(EndOption::Operator) => (
            of_arm,
            "is of the arm's host: give it to 'session --end arm' there",
        ),
        Some(EndOption::Arm) => (
            of_hand.or(of_one_end),
            "is of the operator's host: give it to 'session --end operator' there",
        ),
        None => (
            of_one_end,
            "is of an end that runs alone: add --end operator, or leave it out",
        ),
    };
    elsewhere.map_or(Ok(()), |option| {
        Err(Failure::refused(format!("{option} {why}")))
    })
}

/// Runs it.
pub fn run(graph: &Graph, arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    if let Some(duration) = arguments.duration
        && !(duration.is_finite() && duration > 0.0)
    {
        return Err(Failure::refused(format!(
            "--duration {duration}: give a positive number of seconds"
        )));
    }
    let driver = arguments.scenario.driver();
    refuse_what_is_elsewhere(&arguments)?;
    let loaded = arguments.scenario.load()?;
    let mut context = SessionContext::new(&arguments.session, loaded).map_err(Failure::refused)?;
    context.driver = driver;
    context.end = arguments.end.map(EndOption::end);
    context.link_access = LinkAccess {
        // Both ends are here: what one of them knows the other does.
        secret: match context.end {
            None => Some(link_end::draw_secret().map_err(Failure::failed)?),
            Some(_) => None,
        },
        peer: arguments.scenario.link_peer,
    };
    context.bag = arguments.record;
    let page = arguments.page.console()?;
    context.console = (!arguments.no_console).then_some(page);
    context.foxglove = arguments.foxglove.address()?;
    check_twins(&arguments.twin, context.joints())?;
    context.twins = arguments.twin;
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let options = SessionOptions {
        duration: arguments.duration,
        enable: !arguments.no_enable,
        rearm: !arguments.no_rearm,
    };
    let (summary, outcome) =
        session::run(graph, context, &options, &stop).map_err(Failure::of_session)?;
    if json {
        print_json(&summary)?;
    } else {
        println!("{summary}");
    }
    match outcome {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(error) => Err(Failure::failed(error)),
    }
}

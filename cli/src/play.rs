//! `ferntast play`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_nodes::{
    graph::Graph,
    process::{PlayOptions, SessionContext, stop_on_signals},
    session,
};

use super::{
    Failure,
    foxglove_option::FoxgloveOption,
    output::print_json,
    scenario_options::{ScenarioOptions, check_twins},
};

/// Put a recording back on the topics of ROS 2, with its timing.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Recordings of other people, too: a topic that is not one of ours goes onto ROS 2 under its own name, of whatever \
    type, byte for byte, with the quality of service that it was recorded with. What cannot go is told with the reason (JSON: left_out). \
    Those topics do not reach --foxglove; open the file itself there.\n\n  \
    ferntast play rosbag2_2026_11_25              # rosbag2 directories and .mcap files, of schemas ros2msg or ros2idl\n  \
    ferntast play other.mcap --rate 0.5 --loop --domain 7"
)]
pub struct Arguments {
    /// A rosbag2 directory or an .mcap file.
    recording: PathBuf,

    /// Speed relative to the recording.
    #[arg(
        long,
        default_value_t = 1.0,
        value_name = "FACTOR",
        allow_negative_numbers = true
    )]
    rate: f64,

    /// Begin again at the end, until Ctrl-C.
    #[arg(long = "loop")]
    repeat: bool,

    /// Play into a live estimator: its forces are computed again.
    #[arg(long)]
    estimate: bool,

    /// Hold the model of this experiment of the lab against a joint that is played; topics /twin/*.
    /// Give it again for another joint.
    #[arg(long, value_name = "EXPERIMENT.toml")]
    twin: Vec<PathBuf>,

    #[command(flatten)]
    foxglove: FoxgloveOption,

    /// Name of the session.
    #[arg(long, default_value = "play", value_name = "NAME")]
    session: String,

    #[command(flatten)]
    scenario: ScenarioOptions,
}

/// Runs it.
pub fn run(graph: &Graph, arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    if !(arguments.rate.is_finite() && (0.01..=100.0).contains(&arguments.rate)) {
        return Err(Failure::refused(format!(
            "--rate {}: give a factor of 0.01 to 100",
            arguments.rate
        )));
    }
    let info = ferntast_bag::info(&arguments.recording).map_err(Failure::refused)?;
    let loaded = arguments.scenario.load()?;
    let mut context = SessionContext::new(&arguments.session, loaded).map_err(Failure::refused)?;
    context.play = PlayOptions {
        rate: arguments.rate,
        repeat: arguments.repeat,
        estimate: arguments.estimate,
        except: Vec::new(),
        joints: session::recorded_joints(&arguments.recording),
    };
    context.bag = Some(arguments.recording);
    context.foxglove = arguments.foxglove.address()?;
    check_twins(&arguments.twin, context.joints())?;
    context.twins = arguments.twin;
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let played = session::play(graph, context, &info, &stop).map_err(Failure::of_session)?;
    if json {
        print_json(&played)?;
    } else {
        println!("played {:.1} s", played.played_s);
        if !played.as_recorded.is_empty() {
            println!("as recorded: {}", played.as_recorded.join(", "));
        }
        for own in &played.left_out {
            println!(
                "left out: {} ({}): {}",
                own.topic, own.interface, own.reason
            );
        }
        played.twins.iter().for_each(|own| println!("{own}"));
    }
    match played.fault() {
        None => Ok(ExitCode::SUCCESS),
        Some(fault) => Err(Failure::failed(fault)),
    }
}

//! `ferntast bag`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_bag::BagInfo;
use ferntast_export::{self as export, lerobot};
use ferntast_msgs::{Time, counted};

use super::{Failure, output::print_json};

/// Look into recordings, mend them, write them for other programs.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// What a recording holds: topics, types, counts, rates, gaps.
    Info {
        /// A rosbag2 directory or an .mcap file.
        recording: PathBuf,
    },
    /// Recover what a recording that was cut off holds.
    Repair {
        /// A rosbag2 directory or an .mcap file.
        recording: PathBuf,
        /// Write the mended recording there (else in its place; what was broken is kept beside it).
        #[arg(short, long, value_name = "FILE|DIR")]
        output: Option<PathBuf>,
    },
    /// Write a recording for other programs: tables, or a dataset of LeRobot.
    #[command(subcommand)]
    Export(Export),
}

#[derive(Debug, clap::Subcommand)]
enum Export {
    /// CSV: one table a topic, or with --rate one of all.
    Csv(Tables),
    /// Apache Parquet: one table a topic, or with --rate one of all.
    Parquet(Tables),
    /// A dataset of LeRobot (layout v3.0, without pictures), an episode a recording.
    #[command(
        after_help = "Of sessions, observation.state is position, velocity and torque of the joints and the contact force, \
        action the commanded place of the tip. An episode begins where all of these have been heard; what is no number after \
        that (NaN) is as in the frame before, which is told for each signal. Of other recordings:\n  \
        ferntast bag export lerobot run_1 run_2 -o dataset --task 'pick up the cube' \\\n    \
        --state '/joint_states.position[0]' --state '/joint_states.position[1]' --action '/joint_commands.position[0]'\n\n\
        In Python: LeRobotDataset('local/dataset', root='dataset')"
    )]
    Lerobot {
        /// Rosbag2 directories or .mcap files.
        #[arg(required = true)]
        recordings: Vec<PathBuf>,
        /// The dataset's folder, which must not exist yet.
        #[arg(short, long, value_name = "DIR")]
        output: PathBuf,
        /// Frames in a second.
        #[arg(long, value_name = "HZ", default_value_t = 50.0)]
        rate: f64,
        /// Message path of an element of observation.state (may be given again).
        #[arg(long, value_name = "PATH")]
        state: Vec<String>,
        /// Message path of an element of action (may be given again).
        #[arg(long, value_name = "PATH")]
        action: Vec<String>,
        /// What was done, in words.
        #[arg(long, value_name = "TEXT", default_value = "teleoperate")]
        task: String,
    },
}

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Columns are the numbers of messages with their units, as far as the types say them (position[0]_rad); t_s is the \
    log time since the recording's start, stamp_s the stamp of the header since then. Texts are left out, of arrays all \
    but the first eight elements. With --rate a row has what was heard last, at its time."
)]
struct Tables {
    /// A rosbag2 directory or an .mcap file.
    recording: PathBuf,
    /// Folder for the tables, which must not exist yet.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Only these topics.
    #[arg(long, value_name = "TOPIC,…", value_delimiter = ',')]
    topics: Vec<String>,
    /// All topics in one table, with so many rows in a second.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
}

/// What a recording holds, with its date.
#[derive(serde::Serialize)]
struct Dated {
    start_date: Option<String>,
    #[serde(flatten)]
    info: BagInfo,
}

/// A time as people read it.
fn date(time: Time) -> String {
    let date = chrono::DateTime::from_timestamp_nanos(time.nanos());
    date.format("%Y-%m-%d %H:%M:%S%.3f UTC").to_string()
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.action {
        Action::Info { recording } => {
            let info = ferntast_bag::info(&recording).map_err(Failure::refused)?;
            let start_date = info.start.map(date);
            match (json, &start_date) {
                (true, _) => print_json(&Dated { start_date, info })?,
                (false, Some(date)) => println!("{info}  began {date}"),
                (false, None) => print!("{info}"),
            }
        }
        Action::Repair { recording, output } => {
            let report =
                ferntast_bag::repair(&recording, output.as_deref()).map_err(Failure::refused)?;
            if json {
                print_json(&report)?;
            } else {
                print!("{report}");
            }
        }
        Action::Export(Export::Csv(arguments)) => tables(arguments, export::Format::Csv, json)?,
        Action::Export(Export::Parquet(arguments)) => {
            tables(arguments, export::Format::Parquet, json)?;
        }
        Action::Export(Export::Lerobot {
            recordings,
            output,
            rate,
            state,
            action,
            task,
        }) => dataset(
            &lerobot::Request {
                recordings,
                output,
                rate_hz: rate,
                state,
                action,
                task,
            },
            json,
        )?,
    }
    Ok(ExitCode::SUCCESS)
}

fn tables(arguments: Tables, format: export::Format, json: bool) -> Result<(), Failure> {
    let request = export::Request {
        recording: arguments.recording,
        output: arguments.output,
        format,
        topics: arguments.topics,
        rate_hz: arguments.rate,
    };
    let written = export::tables(&request).map_err(Failure::refused)?;
    if json {
        return print_json(&written);
    }
    for table in written {
        println!(
            "{}: {} of {}",
            table.file.display(),
            counted(table.rows, "row"),
            counted(table.columns.len(), "column")
        );
    }
    Ok(())
}

fn dataset(request: &lerobot::Request, json: bool) -> Result<(), Failure> {
    let dataset = lerobot::export(request).map_err(Failure::refused)?;
    for held in &dataset.held {
        eprintln!(
            "note: {}: {} is no number in {} frames, first at {:.3} s; they have that of the frame before",
            held.recording.display(),
            held.signal,
            held.frames,
            held.first_s
        );
    }
    if json {
        return print_json(&dataset);
    }
    println!(
        "{}: {}, {}, {} a second",
        dataset.folder.display(),
        counted(dataset.episodes, "episode"),
        counted(dataset.frames, "frame"),
        dataset.fps
    );
    println!("observation.state: {}", dataset.state.join(", "));
    println!("action: {}", dataset.action.join(", "));
    Ok(())
}

//! `ferntast lab new`.

use std::{
    io::{self, BufRead, IsTerminal, Write},
    path::PathBuf,
    process::ExitCode,
};

use clap::ValueEnum;
use ferntast_identification::JointType;
use ferntast_lab::{
    experiment::Join,
    guess::Role,
    work::{Made, NewError, Request, Said, make},
};

use super::{
    super::{Failure, output::print_json},
    table::significant,
};

/// Make an experiment file on recordings of your own: tables, MCAP files, folders.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Signals and units are guessed from the columns' names and numbers; what is not certain \
    is asked, or said by options. Examples:\n  \
    ferntast lab new run.csv                                   # t_ms, q_deg, current_A: all is said\n  \
    ferntast lab new run.csv --position q:deg --motor-torque u:V\n  \
    ferntast lab new bare.txt --columns t,q,i --motor-torque i:A    # no line of names\n  \
    ferntast lab new bare.csv --rate 500                       # no column that is time\n  \
    ferntast lab new position.csv current.csv                  # two files of one run, joined by their times\n  \
    ferntast lab new rosbag --position '/joint_states.position[0]' --motor-torque '/joint_states.effort[0]'\n\n\
    Read are text with , ; tab or blanks, decimal comma, comments (# or %), with or without names; arrays of NumPy and MATLAB (up to v7). Files \
    with the same columns are runs of one joint; files with others are parts of one run.\n\
    Units: s ms us ns · rad deg rev · m mm · rad/s deg/s rpm · Nm mNm · N kN · degC K; A mA V % counts stay as \
    they are: no torque is made of them, and results are in them."
)]
pub struct Arguments {
    /// Tables (.csv, .tsv, .txt, .dat, .npz, .npy, .mat), .mcap files, or folders.
    #[arg(required = true)]
    files: Vec<PathBuf>,

    /// The column that is the joint's position, and its unit.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    position: Option<String>,

    /// The column that is the motor's torque, force, current or voltage.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    motor_torque: Option<String>,

    /// The column that is the torque that a joint torque sensor feels.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    joint_torque: Option<String>,

    /// The column that is the temperature.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    temperature: Option<String>,

    /// The column that is time.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    time: Option<String>,

    /// Rows in a second, where no column is time.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// Names of the columns, where the file has none.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    columns: Vec<String>,

    /// How files are joined that were recorded together (else found).
    #[arg(long)]
    join: Option<How>,

    /// Kind of joint (else as the units say).
    #[arg(long)]
    joint: Option<Kind>,

    /// The experiment file (else beside the recording, ending in .toml).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write over a file that is there.
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum How {
    /// By their times.
    Time,
    /// Row by row.
    Row,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// rad, Nm.
    Revolute,
    /// m, N.
    Prismatic,
}

impl Arguments {
    fn request(self) -> Request {
        let said = [
            (Role::Position, self.position),
            (Role::MotorTorque, self.motor_torque),
            (Role::JointTorque, self.joint_torque),
            (Role::Temperature, self.temperature),
            (Role::Time, self.time),
        ];
        let said = said.into_iter();
        Request {
            files: self.files,
            said: said
                .filter_map(|(role, text)| Some((role, Said::parse(&text?))))
                .collect(),
            columns: self.columns,
            rate_hz: self.rate,
            join: self.join.map(|how| match how {
                How::Time => Join::Time,
                How::Row => Join::Row,
            }),
            joint: self.joint.map(|kind| match kind {
                Kind::Revolute => JointType::Revolute,
                Kind::Prismatic => JointType::Prismatic,
            }),
            output: self.output,
            force: self.force,
        }
    }
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let mut request = arguments.request();
    let asks = !json && io::stdin().is_terminal() && io::stderr().is_terminal();
    let made = loop {
        match make(&request) {
            Ok(made) => break made,
            Err(NewError::Unsure {
                role,
                why,
                choices,
                columns,
            }) if asks => {
                let answer = ask(role, &why, &choices, &columns)?;
                request.said.push((role, Said::parse(&answer)));
            }
            Err(error) => return Err(Failure::refused(error)),
        }
    };
    if json {
        print_json(&made)?;
    } else {
        tell(&made);
    }
    Ok(ExitCode::SUCCESS)
}

/// Asks which column a signal is; an empty line takes the first choice.
fn ask(role: Role, why: &str, choices: &[String], columns: &[String]) -> Result<String, Failure> {
    eprintln!("{}: {why}", role.key());
    if role == Role::Time {
        eprintln!("  where there is none, end this and say --rate HZ");
    }
    eprintln!("  columns: {}", columns.join(", "));
    let default = choices.first().map(String::as_str).unwrap_or_default();
    loop {
        eprint!("  COLUMN or COLUMN:UNIT [{default}]: ");
        io::stderr().flush().map_err(Failure::failed)?;
        let mut line = String::new();
        let count = io::stdin().lock().read_line(&mut line);
        if count.map_err(Failure::failed)? == 0 {
            return Err(Failure::refused("nothing was answered"));
        }
        match (line.trim(), default) {
            ("", "") => {}
            ("", default) => return Ok(default.to_owned()),
            (answer, _) => return Ok(answer.to_owned()),
        }
    }
}

fn tell(made: &Made) {
    for recording in &made.recordings {
        println!(
            "{}: {} rows, {:.1} % of them used in {} stretches",
            recording.file.display(),
            recording.samples,
            100.0 * recording.share_used(),
            recording.stretches
        );
        for (reason, count) in recording.left_out() {
            println!("  {count} {}", reason.text());
        }
        if recording.bridged > 0 {
            println!("  {} bridged by a straight line", recording.bridged);
        }
    }
    println!("{} Hz", significant(made.rate_hz));
    for signal in &made.signals {
        let range = signal.range.map_or(String::new(), |[least, greatest]| {
            format!("{} … {} ", significant(least), significant(greatest))
        });
        println!(
            "  {:<14} {:<20} {range}{}{}",
            signal.signal,
            signal.column,
            signal.unit,
            if signal.guessed { "  (guessed)" } else { "" }
        );
    }
    for warning in &made.warnings {
        eprintln!("warning: {warning}");
    }
    println!("written to {}", made.experiment.display());
    println!("next: ferntast lab compare {}", made.experiment.display());
}

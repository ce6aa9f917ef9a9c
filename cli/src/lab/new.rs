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
    work::{Made, NewError, OfArm, Request, Said, in_runs, make},
};
use ferntast_msgs::counted;

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
    ferntast lab new rosbag --position '/joint_states.position[0]' --motor-torque '/joint_states.effort[0]'\n  \
    ferntast lab new run.csv --extra supply=u_V:V              # one more signal, for effects of your own\n  \
    ferntast lab new edge.csv --joint contact                  # place, tangential and normal force\n  \
    ferntast lab new edge.csv --tip x:mm,y:mm --contour '0.2 -0.03, 0.4 -0.03'\n  \
    ferntast lab new run.csv --urdf arm.urdf                   # every joint: q_elbow, tau_elbow, … or q1, tau1, …\n  \
    ferntast lab new run.csv --urdf arm.urdf --joints shoulder,elbow --position 'q_{joint}:deg' --motor-torque tau_a,tau_b\n  \
    ferntast lab new run.csv --urdf arm.urdf --motor-torque 'i_{joint}:A' --drive-gain 14.9,13.3   # currents\n\n\
    Read are text with , ; tab or blanks, decimal comma, comments (# or %), with or without names; arrays of NumPy and MATLAB (up to v7). Files \
    with the same columns are runs of one joint; files with others are parts of one run.\n\
    Units: s ms us ns · rad deg rev · m mm · rad/s deg/s rpm · Nm mNm · N kN · degC K; A mA V % counts stay as \
    they are: no torque is made of them, and results are in them; of an arm --drive-gain says what torque they make."
)]
pub struct Arguments {
    /// Tables (.csv, .tsv, .txt, .dat, .npz, .npy, .mat), .mcap files, or folders.
    #[arg(required = true)]
    files: Vec<PathBuf>,

    /// The column that is the joint's position, or the place along a contour, and its unit. Of an
    /// arm a name with {joint} in it, an array of messages, or a column for each joint.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    position: Option<String>,

    /// The column that is the motor's torque, force, current or voltage; of an arm as --position.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    motor_torque: Option<String>,

    /// The column that is the torque that a joint torque sensor feels.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    joint_torque: Option<String>,

    /// The column that is the force along a contour, which opposes motion to larger places.
    #[arg(long, value_name = "COLUMN[:UNIT]", conflicts_with = "urdf")]
    tangential_force: Option<String>,

    /// The column that is the force that pushes the tip out.
    #[arg(long, value_name = "COLUMN[:UNIT]", conflicts_with = "urdf")]
    normal_force: Option<String>,

    /// The columns that are x and y of a contact's tip, which is laid on --contour.
    #[arg(long, value_name = "X[:UNIT],Y[:UNIT]", value_parser = tip, requires = "contour", conflicts_with_all = ["position", "urdf"])]
    tip: Option<Tip>,

    /// Corners in m of what the tip slides along, in order: '0.2 -0.03, 0.4 -0.03'.
    #[arg(long, value_name = "X Y, X Y …", value_parser = corners, conflicts_with_all = ["position", "urdf"])]
    contour: Option<Contour>,

    /// The URDF of the arm, if it is about a whole one.
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,

    /// The arm's joints from the base on (else all).
    #[arg(long, value_name = "JOINT,…", value_delimiter = ',', requires = "urdf")]
    joints: Vec<String>,

    /// Torque at each joint of the arm for 1 A (V, %, …) of its motor, gear included: the drive
    /// gains, in Nm/A, where currents are recorded.
    #[arg(
        long,
        value_name = "NM_PER_A,…",
        value_delimiter = ',',
        requires = "urdf"
    )]
    drive_gain: Vec<f64>,

    /// One more signal, by a name of yours; may be said again.
    #[arg(long, value_name = "NAME=COLUMN[:UNIT]", value_parser = extra)]
    extra: Vec<(String, String)>,

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

    /// Kind of joint, or a contact (else as the units say).
    #[arg(long, conflicts_with = "urdf")]
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
    /// No joint: a tip that slides along something; m, N.
    Contact,
}

/// The columns that are x and y.
#[derive(Clone, Debug)]
struct Tip([String; 2]);

fn tip(text: &str) -> Result<Tip, String> {
    let (x, y) = text.split_once(',').ok_or("say two columns, X,Y")?;
    Ok(Tip([x, y].map(|own| own.trim().to_owned())))
}

/// Corners, in order.
#[derive(Clone, Debug)]
struct Contour(Vec<[f64; 2]>);

fn corners(text: &str) -> Result<Contour, String> {
    let corner = |own: &str| -> Option<[f64; 2]> {
        let numbers: Result<Vec<f64>, _> = own.split_whitespace().map(str::parse).collect();
        numbers.ok()?.try_into().ok()
    };
    let all: Option<Vec<[f64; 2]>> = text.split([',', ';']).map(corner).collect();
    let all = all.ok_or("x and y of each corner in m, with commas between corners");
    Ok(Contour(all?))
}

fn extra(text: &str) -> Result<(String, String), String> {
    let (name, column) = text.split_once('=').ok_or("say NAME=COLUMN")?;
    Ok((name.to_owned(), column.to_owned()))
}

impl Arguments {
    fn request(self) -> Request {
        let by_tip = self.tip.is_some() || self.contour.is_some();
        let [x, y] = self.tip.map_or([None, None], |own| own.0.map(Some));
        let is_contact = by_tip || self.tangential_force.is_some() || self.normal_force.is_some();
        let said = [
            (Role::TipX, x),
            (Role::TipY, y),
            (Role::TangentialForce, self.tangential_force),
            (Role::NormalForce, self.normal_force),
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
            of_joint: Vec::new(),
            extra: self
                .extra
                .into_iter()
                .map(|(name, text)| (name, Said::parse(&text)))
                .collect(),
            columns: self.columns,
            rate_hz: self.rate,
            join: self.join.map(|how| match how {
                How::Time => Join::Time,
                How::Row => Join::Row,
            }),
            joint: match self.joint {
                Some(Kind::Revolute) => Some(JointType::Revolute),
                Some(Kind::Prismatic) => Some(JointType::Prismatic),
                Some(Kind::Contact) => Some(JointType::Contact),
                None => is_contact.then_some(JointType::Contact),
            },
            arm: self.urdf.map(|urdf| OfArm {
                urdf,
                joints: self.joints,
                drive_gain: Some(self.drive_gain).filter(|own| !own.is_empty()),
            }),
            by_tip,
            contour: self.contour.map(|own| own.0),
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
                joint,
                why,
                choices,
                columns,
            }) if asks => {
                let key = match &joint {
                    Some(joint) => format!("{} of {joint}", role.key()),
                    None => role.key().to_owned(),
                };
                let answer = Said::parse(&ask((role, &key), &why, &choices, &columns)?);
                match joint {
                    Some(joint) => request.of_joint.push((role, joint, answer)),
                    None => request.said.push((role, answer)),
                }
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
fn ask(
    (role, key): (Role, &str),
    why: &str,
    choices: &[String],
    columns: &[String],
) -> Result<String, Failure> {
    eprintln!("{key}: {why}");
    if role == Role::Time {
        eprintln!("  where there is none, end this and say --rate HZ");
    }
    eprintln!("  columns: {}", in_runs(columns).join(", "));
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
            "{}: {}, {:.1} % of them used in {}",
            recording.file.display(),
            counted(recording.samples, "row"),
            100.0 * recording.share_used(),
            counted(recording.stretches, "stretch")
        );
        for (reason, count) in recording.left_out() {
            println!("  {count} {}", reason.text());
        }
        if recording.bridged > 0 {
            println!("  {} bridged by a straight line", recording.bridged);
        }
    }
    println!("{} Hz", significant(made.rate_hz));
    let widths = made.signals.iter().map(|own| own.signal.chars().count());
    let width = widths.max().unwrap_or(0).max(14);
    for signal in &made.signals {
        let range = signal.range.map_or(String::new(), |[least, greatest]| {
            format!("{} … {} ", significant(least), significant(greatest))
        });
        println!(
            "  {:<width$} {:<20} {range}{}{}",
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

//! `ferntast arm check`.

use std::process::ExitCode;

use ferntast_drivers::check::{self, Expected, HeldKey, Moved, Progress, Report};
use ferntast_nodes::{
    process::{SessionContext, stop_on_signals},
    session::ArmSummary,
};
use serde::Serialize;

use super::terminal::RawTerminal;
use crate::{Failure, output::print_json, scenario_options::ScenarioOptions};

/// Read everything of an arm for some seconds and say what is implausible.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Nothing is moved without --move: the drives stay off. Looked at are the rate and age of readings, \
jitter of stamps,
positions against the limits, velocity against the change of position, torque against the weight by the
model, sensors that stand still, units that look like degrees, torques that are missing. Move the arm by
hand meanwhile, where that can be done: more is told then. Exit code 1 where something is wrong.

With --move each joint goes out and back by 0.03 rad (or 10 mm) to both sides of where it is, slowly, one
after the other, as long as you hold the space bar. Released, the arm stands within 100 ms, and goes on
when you hold it again; a joint that goes elsewhere than it is told ends it, with the drives off. Keep the
emergency stop at hand, and the arm's surroundings free. A terminal tells no release of a key, only that
it no longer repeats: it has to repeat at least every 60 ms (xset r rate 250 30; kbdrate -r 30 -d 250).

Examples:
  ferntast arm check --arm panda --driver ros2
  ferntast arm check --arm my_arm.toml --driver ros2:joint_states=/left/joint_states --seconds 10
  ferntast arm check --arm panda --move          # on the simulated arm, to see what it does"
)]
pub struct Arguments {
    /// How long to look [s].
    #[arg(
        long,
        default_value_t = 5.0,
        value_name = "S",
        allow_negative_numbers = true
    )]
    seconds: f64,

    /// Move the joints one after the other, a little and slowly, while the space bar is held.
    #[arg(long = "move")]
    moves: bool,

    #[command(flatten)]
    scenario: ScenarioOptions,
}

/// The result, with what came of moving.
#[derive(Serialize)]
struct Checked {
    #[serde(flatten)]
    report: Report,
    #[serde(skip_serializing_if = "Option::is_none")]
    moved: Option<Moved>,
}

/// Runs it; exit code 1 where something is wrong.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let seconds = arguments.seconds;
    if !(0.2..=3600.0).contains(&seconds) {
        return Err(Failure::refused(format!(
            "--seconds {seconds}: give a number from 0.2 to 3600"
        )));
    }
    let loaded = arguments.scenario.load()?;
    let mut session = SessionContext::new("arm-check", loaded).map_err(Failure::refused)?;
    session.driver = arguments.scenario.driver();
    let expected = Expected::of(&session).map_err(Failure::refused)?;
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let (record, moved) = if arguments.moves {
        let (record, moved) = drive(&session, &stop)?;
        (record, Some(moved))
    } else {
        eprintln!("looking at the arm for {seconds} s; nothing is moved …");
        let record = check::look(&session, seconds, &stop).map_err(Failure::refused)?;
        (record, None)
    };
    let of = ArmSummary::of(&session);
    let mut report = check::judge(&expected, &record, &of.arm, &of.driver);
    if let Some(moved) = &moved {
        report = report.with(moved.findings.clone());
    }
    let ok = report.ok;
    let checked = Checked { report, moved };
    if json {
        print_json(&checked)?;
    } else {
        print(&checked);
    }
    Ok(ExitCode::from(u8::from(!ok)))
}

fn print(checked: &Checked) {
    println!("{}", checked.report);
    let Some(moved) = &checked.moved else { return };
    for (joint, followed) in moved.joints.iter().zip(&moved.followed) {
        println!("moved  {joint}: it went {followed:.3} of what it was told");
    }
    let stops = moved.stopped_ms.iter().copied().reduce(f64::max);
    if let Some(longest) = stops {
        println!("released, it stood after {longest:.0} ms at most");
    }
}

/// Moves the arm while the space bar is held.
fn drive(
    session: &SessionContext,
    stop: &std::sync::atomic::AtomicBool,
) -> Result<(check::Record, Moved), Failure> {
    let mut terminal = RawTerminal::open()?;
    eprintln!(
        "The arm will MOVE: each joint by 0.03 rad (10 mm) to both sides, one after the other.\r\n\
         Hold the SPACE BAR to let it; released, it stands. Ctrl-C takes the drives off and ends it."
    );
    let joints = session.joints();
    let mut key = HeldKey::default();
    let held = |now| {
        if terminal.holds_space() {
            key.character(now);
        }
        key.is_held(now)
    };
    let tell = |progress: Progress| {
        let name = |joint: usize| joints.get(joint).unwrap_or_default();
        match progress {
            Progress::Waits => eprint!("waiting for the space bar\r\n"),
            Progress::Moves(joint) => eprint!("moving {}\r\n", name(joint)),
            Progress::Stands(joint) => {
                eprint!(
                    "released: it stands; hold again to move {}\r\n",
                    name(joint)
                );
            }
            Progress::Over => eprint!("over: the drives are off\r\n"),
        }
    };
    check::drive(session, stop, held, tell).map_err(Failure::refused)
}

//! `ferntast experiment`.

use std::{
    path::PathBuf,
    process::ExitCode,
    sync::atomic::{AtomicU64, Ordering},
};

use ferntast_drivers::simulated;
use ferntast_model::contour::Surface;
use ferntast_studies::experiment::{
    self, Conditions, ExperimentError, Plan,
    campaign::{self, Mission},
    identify,
};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json};

/// Run an identification experiment on the simulated arm in virtual time.
#[derive(Debug, clap::Args)]
#[command(after_help = "A recording comes out, sampled every 12 ms:\n  \
    ferntast experiment spring --joint 2 -o recordings/spring\n  \
    ferntast lab compare recordings/spring")]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Pull a spring of the contour at constant velocities (Fig. 3): friction.
    Spring(Spring),
    /// Swing joint 2 freely (Fig. 9): friction without load.
    Sine(Sine),
    /// Saw-tooth torque of joint 2 against the fixed tip (Fig. 15): stiffness.
    Stiffness(Stiffness),
    /// Slide along an edge at constant normal force (Figs. 16, 17): contact friction.
    Contact(Contact),
    /// The experiments of a file on all its dates, at the temperatures of the day.
    Campaign(Campaign),
}

#[derive(Debug, clap::Args)]
struct Campaign {
    /// A shipped campaign or a file.
    #[arg(default_value = "mission", value_name = "NAME|FILE")]
    file: String,

    /// Folder of the recordings, which does not exist yet.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// What all experiments take.
#[derive(Debug, clap::Args)]
struct Common {
    /// Arm: a shipped one or a file.
    #[arg(long, default_value = "rokviss", value_name = "NAME|FILE")]
    arm: String,

    /// On the ground, before the launch: the section [ground] of the arm's file.
    #[arg(long)]
    ground: bool,

    /// Temperature that joints and surroundings are held at [degC]; else sun and heaters make it.
    #[arg(long, value_name = "DEGC", allow_negative_numbers = true)]
    temperature: Option<f64>,

    /// Day of the mission, counted from 2005-01-26 [d]; else as the arm's file says.
    #[arg(long, value_name = "DAYS", allow_negative_numbers = true)]
    day: Option<f64>,

    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// The recording: a rosbag2 directory that does not exist yet.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
struct Spring {
    /// Speeds, separated by commas [deg/s].
    #[arg(long, value_delimiter = ',', default_value = "1,5,10,20,40")]
    speeds: Vec<f64>,

    /// Joint 1 or 2.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=2))]
    joint: u8,

    /// Time for each speed [s].
    #[arg(long, default_value_t = 12.0, value_name = "S")]
    time_per_speed: f64,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Sine {
    /// Frequencies, separated by commas [Hz].
    #[arg(long, value_delimiter = ',', default_value = "0.05,0.1,0.2,0.3,0.38")]
    frequencies: Vec<f64>,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Stiffness {
    /// Saw-teeth.
    #[arg(long, default_value_t = 4)]
    teeth: u32,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Contact {
    /// Which edge.
    #[arg(long, value_enum, default_value_t = Edge::Unlubricated)]
    surface: Edge,

    /// Normal forces, separated by commas [N].
    #[arg(long, value_delimiter = ',', default_value = "10,20,30")]
    forces: Vec<f64>,

    /// Frequencies, separated by commas [Hz].
    #[arg(long, value_delimiter = ',', default_value = "0.2,0.4")]
    frequencies: Vec<f64>,

    #[command(flatten)]
    common: Common,
}

/// An edge of the contour.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Edge {
    Lubricated,
    Unlubricated,
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let (plan, common) = match arguments.what {
        What::Campaign(own) => return campaign(&own, json),
        What::Spring(own) => (
            Plan::Spring {
                joint: usize::from(own.joint),
                speeds: own.speeds,
                time_per_speed: own.time_per_speed,
            },
            own.common,
        ),
        What::Sine(own) => (
            Plan::Sine {
                frequencies: own.frequencies,
                time_per_frequency: 12.0,
            },
            own.common,
        ),
        What::Stiffness(own) => (Plan::Stiffness { teeth: own.teeth }, own.common),
        What::Contact(own) => (
            Plan::Contact {
                surface: match own.surface {
                    Edge::Lubricated => Surface::Lubricated,
                    Edge::Unlubricated => Surface::Unlubricated,
                },
                forces: own.forces,
                frequencies: own.frequencies,
                time_per_press: 5.0,
            },
            own.common,
        ),
    };
    one(&plan, &common, json)
}

fn one(plan: &Plan, common: &Common, json: bool) -> Result<ExitCode, Failure> {
    let arm = simulated::load_config(&common.arm).map_err(Failure::refused)?;
    let conditions = Conditions {
        ground: common.ground,
        day: common.day,
        temperature: common.temperature,
    };
    let folder = common
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from("recordings").join(plan.folder()));
    let duration = plan.program(&arm).map_err(Failure::refused)?.duration();
    let bar = bar(duration);
    let done = std::cell::Cell::new(0.0);
    let took = experiment::run(plan, &arm, &conditions, common.seed, &folder, &|slice| {
        done.set(done.get() + slice);
        bar.set_position(done.get() as u64);
    });
    bar.finish_and_clear();
    let took = took.map_err(|error| match error {
        ExperimentError::Stopped { .. } => Failure::failed(error),
        _ => Failure::refused(error),
    })?;
    let contact = match plan {
        Plan::Contact { surface, .. } => {
            Some(identify::Contact::read(&folder, *surface).map_err(Failure::failed)?)
        }
        _ => None,
    };
    let friction = contact.as_ref().and_then(identify::Contact::friction);
    let calibration = contact.as_ref().and_then(|own| own.calibration);
    if json {
        print_json(&serde_json::json!({
            "experiment": plan.kind(), "recording": folder, "duration_s": took,
            "friction": friction, "calibration": calibration,
        }))?;
        return Ok(ExitCode::SUCCESS);
    }
    println!(
        "{}: {took:.1} s of virtual time in {}",
        plan.kind(),
        folder.display()
    );
    if let Some(own) = friction {
        println!(
            "b_0T {:.4} ± {:.4} (± {:.4} by noise alone)",
            own.coefficient, own.std_error, own.random_error
        );
    }
    if let Some(own) = calibration {
        println!(
            "gain of torque sensor 1 less that of 2: {:+.4} ± {:.4}; edge turned by {:+.3} ± {:.3} deg \
             (a gain of both sensors alike does not show)",
            own.gain_ratio,
            own.gain_ratio_error,
            own.turn.to_degrees(),
            own.turn_error.to_degrees()
        );
    }
    Ok(ExitCode::SUCCESS)
}

fn campaign(own: &Campaign, json: bool) -> Result<ExitCode, Failure> {
    if own.output.exists() {
        return Err(Failure::refused(format!(
            "{} exists; remove it or choose another folder",
            own.output.display()
        )));
    }
    let mission = Mission::load(&own.file).map_err(Failure::refused)?;
    let arm = simulated::load_config(&mission.arm).map_err(Failure::refused)?;
    let duration = campaign::duration(&mission, &arm).map_err(Failure::refused)?;
    let bar = bar(duration);
    let done = AtomicU64::new(0);
    let results = campaign::run_all(&mission, &arm, &own.output, &|slice| {
        let passed = (slice * 1e3) as u64;
        let total = done.fetch_add(passed, Ordering::Relaxed) + passed;
        bar.set_position(total / 1000);
    });
    bar.finish_and_clear();
    let results = results.map_err(Failure::failed)?;
    if json {
        print_json(&results)?;
        return Ok(ExitCode::SUCCESS);
    }
    println!("{:>8}  {:<22} {:>6}  found", "day", "experiment", "degC");
    for one in &results {
        if let Some(joint) = &one.joint {
            let low = joint.friction.torque(1.0_f64.to_radians(), 0.0);
            println!(
                "{:>8.2}  {:<22} {:>6.1}  {low:.2} Nm at 1 deg/s, b_0T {:.3}",
                one.day,
                format!("spring, joint {}", joint.joint),
                joint.temperature,
                joint.friction.value("b0T")
            );
        }
        if let Some(contact) = &one.contact {
            println!(
                "{:>8.2}  {:<22} {:>6}  b_0T {:.4} ± {:.4}",
                one.day,
                format!("contact, {:?}", contact.surface).to_lowercase(),
                "",
                contact.friction.coefficient,
                contact.friction.std_error
            );
        }
    }
    println!(
        "{} recordings below {}",
        results.len(),
        own.output.display()
    );
    Ok(ExitCode::SUCCESS)
}

fn bar(seconds: f64) -> ProgressBar {
    let bar = ProgressBar::new(seconds.ceil() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:30} {pos}/{len} s of virtual time, {eta} left")
    {
        bar.set_style(style);
    }
    bar
}

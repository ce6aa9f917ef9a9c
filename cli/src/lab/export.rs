//! `ferntast lab export`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_export::identified::{Program, Request, Told, identified};

use super::{
    super::{Failure, output::print_json},
    table::significant,
};

/// Write what was identified for a simulator, a driver, or this project's servo and estimator.
#[derive(Debug, clap::Args)]
#[command(after_help = "What is written:\n  \
    urdf      <dynamics> of each joint and <inertial> of links that were corrected, in the arm's URDF, all else as it was\n  \
    sdf       a model for Gazebo: damping, friction, springs, links\n  \
    mujoco    a model: frictionloss, damping (with quadratic and cubic viscous friction as MuJoCo's polynomial), armature,\n            \
    stiffness, links, gravity, torque motors; with --servo-hz position servos with gains by the inertia\n  \
    ur        the request of the ROS 2 driver's ~/set_friction_model_parameters. It takes shares of the robot's own model of\n            \
    friction: give a second recording of the motion, under compensation with the driver's defaults: --compensated\n  \
    ferntast  an arm's file (--arm of ferntast session), and its URDF: what servo and estimator believe\n\n\
    Standard errors stand beside the values, as comments. An effect that the form has no words for (Stribeck, temperature,\n\
    load …) is told as a warning: its RMS torque, and what the model errs by without it. Values are those of the whole model;\n\
    --approximate fits what can be said anew without the rest, which is better for a program that knows nothing else.\n\
    Payload, base tilt and corrected links go into masses and gravity; what is written is always a body that can exist.\n\n  \
    ferntast lab export arm.toml --to mujoco -o arm.xml\n  \
    ferntast lab export joint.toml --to urdf --into robot.urdf --joint elbow -o identified.urdf")]
pub struct Arguments {
    /// Experiment file, of a joint or an arm.
    experiment: PathBuf,
    /// Who it goes to.
    #[arg(long, value_name = "urdf|sdf|mujoco|ur|ferntast")]
    to: Program,
    /// The file (else beside the experiment).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Fit what can be said anew, without the rest.
    #[arg(long)]
    approximate: bool,
    /// URDF: put the friction into this file in place of the experiment's own.
    #[arg(long, value_name = "FILE")]
    into: Option<PathBuf>,
    /// What the joint is called there, where the experiment is about one.
    #[arg(long, value_name = "NAME")]
    joint: Option<String>,
    /// MuJoCo: position servos of this bandwidth in place of torque motors.
    #[arg(long, value_name = "HZ")]
    servo_hz: Option<f64>,
    /// Universal Robots: the experiment on a recording under compensation with the driver's defaults.
    #[arg(long, value_name = "E.toml")]
    compensated: Option<PathBuf>,
    /// Write over files that are there.
    #[arg(long)]
    force: bool,
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let output = arguments.output;
    let request = Request {
        output: output.unwrap_or_else(|| arguments.to.beside(&arguments.experiment)),
        experiment: arguments.experiment,
        to: arguments.to,
        approximate: arguments.approximate,
        into: arguments.into,
        joint: arguments.joint,
        servo_hz: arguments.servo_hz,
        compensated: arguments.compensated,
        force: arguments.force,
    };
    let told = identified(&request).map_err(Failure::refused)?;
    match json {
        true => print_json(&told)?,
        false => print(&told),
    }
    Ok(ExitCode::SUCCESS)
}

fn print(told: &Told) {
    println!(
        "{:<26} {:>14} {:>14} {:>14}",
        "error on the rows fitted", "whole model", "what is said", "fitted anew"
    );
    for (name, own) in &told.joints {
        let anew = own
            .said_refitted
            .map_or_else(|| "-".to_owned(), significant);
        println!(
            "{name:<26} {:>14} {:>14} {anew:>14}",
            significant(own.train),
            significant(own.said_alone)
        );
    }
    for own in &told.unsaid {
        eprintln!("warning: {}", own.text);
    }
    for note in &told.notes {
        eprintln!("note: {note}");
    }
    for file in &told.files {
        println!("{}", file.display());
    }
}

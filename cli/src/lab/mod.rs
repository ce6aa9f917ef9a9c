//! `ferntast lab`: recordings against models.

mod add;
mod arm;
mod auto;
mod compare;
mod diagnose;
mod discover;
mod export;
mod history;
mod new;
mod open;
mod report;
mod serve;
mod table;
mod trend;

use std::process::ExitCode;

use clap::Subcommand;
use ferntast_identification::{Subject, arm::ArmEffect};

use super::Failure;

pub use auto::tell_folder;

/// Hold a model against a recording, find which effect is missing, add it.
#[derive(Debug, clap::Args)]
#[command(after_help = "Five minutes, from \"my model is off\" to proof:\n  \
    ferntast lab compare E.toml              # how far off, and where\n  \
    ferntast lab diagnose E.toml             # which effect is missing\n  \
    ferntast lab add E.toml stribeck -o E2.toml\n  \
    ferntast lab discover E.toml             # where the catalogue ends: a formula\n  \
    ferntast lab history E2.toml             # the error falling\n  \
    ferntast lab report E2.toml -o report.html\n  \
    ferntast lab trend E.toml later.toml     # what changed\n  \
    ferntast lab export E.toml --to mujoco   # on to a simulator, a driver, the servo\n\n  All of it in the browser: ferntast lab serve\n\n\
    With recordings of your own begin with:  ferntast lab new my.csv\n\n\
    An experiment file names recording, signals and model:\n  \
    recording = \"bench.mcap\"                 # or a rosbag2 directory, a table (.csv, …), a list\n  \
    [signals]                                # message paths; in tables columns: { column = \"q\", unit = \"deg\" }\n  \
    position     = \"/follower/measured_js.position[0]\"\n  \
    motor_torque = \"/follower/motor_js.effort[0]\"\n  \
    joint_torque = \"/follower/measured_js.effort[0]\"   # optional\n  \
    [model]\n  \
    inertia = { fit = true }                 # or a number [kg m2]\n  \
    effects = [\"coulomb\", \"viscous\", { name = \"cogging\", expression = \"a*sin(6*q) + b*cos(6*q)\" }]\n\n\
    A contact in place of a joint (equation 6):\n  \
    [contact]\n  \
    [signals]\n  \
    tangential_force = \"/follower/contact_cf.wrench.force.x.@negative\" # opposes motion to larger places\n  \
    normal_force = \"/follower/contact_cf.wrench.force.z\"               # pushes the tip out\n  \
    position = \"/follower/measured_cp.pose.position.x\"                 # along the contour; or tip = [x, y]\n  \
    [model]                                  # with tip: contour = [[x, y], ...] in [contact]\n  \
    effects = [\"contact_coulomb\"]\n\n\
    A whole arm in place of a joint, every joint in one run:\n  \
    [arm]\n  \
    urdf = \"arm.urdf\"\n  \
    joints = [\"joint_1\", \"joint_2\"]         # from the base on\n  \
    armature = [0.6, 0.4]                    # kg m2, motor and gear; left out: fitted\n  \
    drive_gain = [14.9, 13.3]                # Nm/A at the joint, where motor_torque is a current\n  \
    [signals]\n  \
    position = \"/joint_states.position\"     # arrays by joint name; in tables \"q_{joint}\" or a list\n  \
    motor_torque = \"/joint_states.effort\"\n  \
    [model]                                  # of every joint, of one, of the arm\n  \
    effects = [\"coulomb\", \"viscous\", \"stribeck@joint_2\", \"payload\"]\n\n\
    A message path may end in functions: .@negative turns the sign, .@deg2rad and .@rad2deg angles, .@mul(X), .@div(X), \
    .@add(X), .@sub(X) reckon, .@abs takes the size.\n\n\
    A recording of a session can be given in place of an experiment file.")]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Make an experiment file on recordings of your own.
    New(Box<new::Arguments>),
    /// Fit the model on one part of the recordings, tell its error on the rest, and where it fails.
    Compare(compare::Arguments),
    /// Tell which effect is missing, if any.
    Diagnose(diagnose::Arguments),
    /// Propose formulas for what no effect of the catalogue explains.
    Discover(discover::Arguments),
    /// Add an effect, refit, and write the new experiment file.
    Add(add::Arguments),
    /// Diagnose and add until the model is complete or what is left has no name.
    Auto(auto::Arguments),
    /// Show how the error fell, step by step.
    History(history::Arguments),
    /// Tell what changed between recordings or dates.
    Trend(trend::Arguments),
    /// Write what was identified as URDF, SDF, MuJoCo, for Universal Robots, or as an arm's file.
    Export(export::Arguments),
    /// Write one page with charts.
    Report(report::Arguments),
    /// Work in the browser.
    Serve(serve::Arguments),
    /// List the effects of the catalogue, of joints and of contacts.
    Effects,
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.action {
        Action::New(arguments) => new::run(*arguments, json),
        Action::Compare(arguments) => compare::run(&arguments, json),
        Action::Diagnose(arguments) => diagnose::run(&arguments, json),
        Action::Discover(arguments) => discover::run(&arguments, json),
        Action::Add(arguments) => add::run(&arguments, json),
        Action::Auto(arguments) => auto::run(arguments, json),
        Action::History(arguments) => history::run(&arguments, json),
        Action::Trend(arguments) => trend::run(&arguments, json),
        Action::Export(arguments) => export::run(arguments, json),
        Action::Report(arguments) => report::run(&arguments, json),
        Action::Serve(arguments) => serve::run(arguments, json),
        Action::Effects => effects(json),
    }
}

fn effects(json: bool) -> Result<ExitCode, Failure> {
    let catalogue = ferntast_identification::catalogue();
    if json {
        super::output::print_json(&catalogue)?;
        return Ok(ExitCode::SUCCESS);
    }
    let ids = catalogue.iter().map(|effect| effect.id.len());
    let width = ids.max().unwrap_or(0);
    for subject in [Subject::Joint, Subject::Contact] {
        println!("of {}", subject.name());
        for effect in catalogue.iter().filter(|effect| effect.of == subject) {
            println!("  {:width$} {}", effect.id, effect.equation);
        }
    }
    println!("of an arm");
    for effect in ArmEffect::all(1) {
        println!("  {:width$} {}", effect.id(), effect.equation());
    }
    Ok(ExitCode::SUCCESS)
}

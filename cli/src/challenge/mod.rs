//! `ferntast challenge`.

pub mod blind;
pub mod discover;
mod reveal;

use std::{
    path::PathBuf,
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
};

use clap::Subcommand;
use ferntast_nodes::process::stop_on_signals;
use ferntast_studies::challenge::{self, Asked, LawPlan, Plan};
use indicatif::ProgressBar;
use serde_json::json;

use super::{Failure, output::print_json, shard_options::ShardOptions};

/// Recordings with a hidden effect: to learn on, and to test the lab with.
#[derive(Debug, clap::Args)]
#[command(after_help = "Learn on one:\n  \
    ferntast challenge new recordings/riddle\n  \
    ferntast lab diagnose recordings/riddle/experiment.toml\n  \
    ferntast challenge reveal recordings/riddle stribeck\n\n\
    The same of a tip on an edge: ferntast challenge new recordings/riddle --contact")]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Make a recording with one effect hidden, and seal the answer.
    New {
        /// Folder, which must not exist yet.
        folder: PathBuf,

        /// A tip that slides along an edge instead of a joint.
        #[arg(long)]
        contact: bool,

        /// Decides joint or edge, sessions, noise, and what is hidden.
        #[arg(long, default_value_t = 1)]
        seed: u64,

        /// Size of the hidden effect: 1 is plain to see, 0.25 is hard.
        #[arg(long, default_value_t = 1.0)]
        strength: f64,

        /// Hide this effect (can be given twice), or "none", instead of what the seed says.
        #[arg(long, value_name = "EFFECT")]
        hide: Vec<String>,

        /// Sessions, each at another date and temperature [default: 6, of a contact 8].
        #[arg(long)]
        sessions: Option<usize>,
    },
    /// Open the sealed answer.
    Reveal {
        /// The challenge's folder.
        folder: PathBuf,
        /// Your answer: an effect, "complete" or "unexplained".
        answer: String,
    },
    /// Put many recordings to the diagnosis and print how it did, with the misses.
    Blind {
        /// Contacts instead of joints.
        #[arg(long)]
        contact: bool,

        /// Recordings of each effect at each strength.
        #[arg(long, default_value_t = 3)]
        repeats: usize,

        /// Strengths of the hidden effects, with commas between.
        #[arg(
            long,
            value_name = "NUMBER,…",
            value_delimiter = ',',
            default_value = "1,0.5,0.25"
        )]
        strengths: Vec<f64>,

        /// Only the recordings that hide this effect (can be given several times),
        /// with the seeds that they have among all.
        #[arg(long, value_name = "EFFECT")]
        hide: Vec<String>,

        /// Recordings that hide nothing [default: 400; 0 with --hide].
        #[arg(long)]
        nothing: Option<usize>,

        /// Recordings that hide two effects at once [default: 40; 0 with --hide].
        #[arg(long)]
        two: Option<usize>,

        /// Recordings of each kind that is like real ones: no torque sensor but a load by a
        /// model that is off (uncertain_load), a few moves over and over (little_excitation),
        /// one_session, a drive that ends within the motion or not (limited_drive),
        /// coarse_encoder, 100 to 1000 Hz (other_rate), friction that no catalogue has
        /// (unnamed_friction), position and torque of the motor alone (motor_only), a joint that
        /// warms up unmeasured (cold_start); half of each hide an effect
        /// [default: 10; 0 with --hide, --contact, --intervals-only].
        #[arg(long, value_name = "COUNT")]
        real_like: Option<usize>,

        /// Only this kind of those (can be given several times).
        #[arg(long, value_name = "KIND")]
        kind: Vec<String>,

        /// Diagnose nothing: fit the true models, and print how often their 95 % intervals
        /// hold the true values, parameter by parameter.
        #[arg(long)]
        intervals_only: bool,

        /// Seed of the first recording.
        #[arg(long, default_value_t = 1)]
        seed: u64,

        #[command(flatten)]
        parts: ShardOptions,
    },
    /// Put laws that no catalogue has to `ferntast lab discover`, and print how it did.
    Discover {
        /// Laws at each strength.
        #[arg(long, default_value_t = 10)]
        laws: usize,

        /// Strengths of the laws, with commas between.
        #[arg(
            long,
            value_name = "NUMBER,…",
            value_delimiter = ',',
            default_value = "1,0.5,0.25"
        )]
        strengths: Vec<f64>,

        /// Recordings that hide nothing.
        #[arg(long, default_value_t = 100)]
        nothing: usize,

        /// Seed of the first recording.
        #[arg(long, default_value_t = 1)]
        seed: u64,

        #[command(flatten)]
        parts: ShardOptions,
    },
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.action {
        Action::New {
            folder,
            contact,
            seed,
            strength,
            hide,
            sessions,
        } => {
            let asked = Asked {
                seed,
                strength,
                hide,
                sessions,
            };
            let experiment = challenge::make(&folder, contact, &asked).map_err(Failure::refused)?;
            if json {
                print_json(&json!({"experiment": experiment}))?;
            } else {
                println!(
                    "a recording with something hidden, and the answer sealed, in {}",
                    folder.display()
                );
                println!(
                    "find it:        ferntast lab diagnose {}",
                    experiment.display()
                );
                println!(
                    "open the seal:  ferntast challenge reveal {} YOUR_ANSWER",
                    folder.display()
                );
            }
            Ok(ExitCode::SUCCESS)
        }
        Action::Reveal { folder, answer } => reveal::run(&folder, &answer, json),
        Action::Blind {
            contact,
            repeats,
            strengths,
            hide,
            nothing,
            two,
            real_like,
            kind,
            intervals_only,
            seed,
            parts,
        } => {
            let of_all = |count: usize| if hide.is_empty() { count } else { 0 };
            let plan = Plan {
                contact,
                seed,
                repeats,
                strengths,
                nothing: nothing.unwrap_or(of_all(400)),
                two: two.unwrap_or(if intervals_only { 0 } else { of_all(40) }),
                real_like: match (contact, intervals_only) {
                    (false, false) => real_like.unwrap_or(of_all(10)),
                    _ => 0,
                },
                kinds: kind,
                only: hide,
                intervals_only,
            };
            let (answers, stopped) =
                with_bar(|stop, progress| plan.run(parts.shard(), stop, progress))?;
            match parts.keep(plan, answers, stopped)? {
                Some((plan, answers)) => blind::tell(&plan, answers, json),
                None => Ok(ExitCode::SUCCESS),
            }
        }
        Action::Discover {
            laws,
            strengths,
            nothing,
            seed,
            parts,
        } => {
            let plan = LawPlan {
                seed,
                laws,
                strengths,
                nothing,
            };
            let (answers, stopped) =
                with_bar(|stop, progress| plan.run(parts.shard(), stop, progress))?;
            match parts.keep(plan, answers, stopped)? {
                Some((plan, answers)) => discover::tell(&plan, answers, json),
                None => Ok(ExitCode::SUCCESS),
            }
        }
    }
}

/// Does long work beside a bar, until Ctrl-C; gives what was found, and whether it was
/// stopped.
fn with_bar<T>(
    work: impl FnOnce(&AtomicBool, &(dyn Fn(usize, usize) + Sync)) -> Result<T, String>,
) -> Result<(T, bool), Failure> {
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let bar = ProgressBar::new(0);
    let found = work(&stop, &|done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    let stopped = stop.load(Ordering::Relaxed);
    if stopped {
        eprintln!("stopped: what follows is of the recordings that were done");
    }
    Ok((found.map_err(Failure::refused)?, stopped))
}

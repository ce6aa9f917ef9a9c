//! `ferntast link`.

mod keys;

use std::{process::ExitCode, thread, time::Duration};

use clap::Subcommand;
use ferntast_bus::{Bus, Depth, Subscriber};
use ferntast_config::UnknownLaw;
use ferntast_control::delay::Law;
use ferntast_msgs::{
    Text,
    sample::{LawCommandSample, LinkStatusSample},
    topics,
};
use ferntast_nodes::{process::Clock, session::Visit};
use serde_json::json;

use super::{Failure, output::print_json};

/// Tell how the link of a running session does, change its delay law; keys of hosts.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Both ends change over together, without a jump in force:\n  \
    ferntast link law            # tells the law\n  \
    ferntast link law wave\n\n\
    Two hosts that are to meet, each with its key:\n  \
    ferntast link keys new       # once on each host; shows its public key\n  \
    ferntast link keys add arm m+P1…A==   # on each, the key that the other shows"
)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,

    /// Name of the session (of `law`).
    #[arg(long, default_value = "default", value_name = "NAME", global = true)]
    session: String,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Tell the delay law, or change it.
    Law {
        /// The law: position_force, position_position, four_channel, wave, tdpa, model_mediated, two_layer, auto.
        name: Option<String>,
    },
    /// Make, show and exchange the keys without which two hosts do not meet.
    Keys(keys::Arguments),
}

/// How long an answer is waited for: a round trip of two seconds, and the switch.
const PATIENCE: f64 = 5.0;
/// How long a session may take to say anything \[s\].
const FIRST_WORD: f64 = 1.5;

struct Ends {
    leader: Subscriber<LinkStatusSample>,
    follower: Subscriber<LinkStatusSample>,
    clock: Clock,
    laws: [Option<Text<24>>; 2],
}

impl Ends {
    fn look(&mut self) {
        let now = self.clock.now();
        let ends = [&mut self.leader, &mut self.follower];
        for (end, law) in ends.into_iter().zip(&mut self.laws) {
            if let Some(received) = end.newest(now) {
                *law = Some(received.message.law);
            }
        }
    }

    /// Looks until `enough`, at most for `patience` \[s\].
    fn look_until(&mut self, patience: f64, enough: impl Fn(&Ends) -> bool) -> bool {
        let begun = self.clock.now();
        loop {
            self.look();
            if enough(self) {
                return true;
            }
            if self.clock.now().seconds_since(begun) > patience {
                return false;
            }
            thread::sleep(Duration::from_millis(5));
        }
    }

    fn law(&self, end: usize) -> Option<&str> {
        self.laws.get(end)?.as_ref().map(Text::as_str)
    }
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let name = match arguments.what {
        What::Law { name } => name,
        What::Keys(keys) => return keys::run(keys, json),
    };
    if let Some(name) = &name
        && !Law::NAMES.contains(&name.as_str())
    {
        return Err(Failure::refused(UnknownLaw::new(name)));
    }
    let visit = Visit::open(&arguments.session).map_err(Failure::refused)?;
    let told = match visit.as_ref().and_then(Visit::bus) {
        Some(bus) => switch(bus, name.as_deref(), &arguments.session),
        None => Err(silent(&arguments.session)),
    };
    drop(visit);
    let (law, switched) = told?;
    if json {
        print_json(&json!({"law": law}))?;
    } else {
        println!("{law}");
    }
    if switched {
        Ok(ExitCode::SUCCESS)
    } else {
        Err(Failure::failed(format!(
            "the link did not change over within {PATIENCE} s: it runs {law}; do frames get through? (/link/status)"
        )))
    }
}

fn silent(session: &str) -> Failure {
    Failure::failed(format!(
        "the operator's end of session {session:?} does not answer: is it running on this host? (ferntast session, or --session NAME)"
    ))
}

/// The law in the end, and whether it is the one that was asked for at both ends.
fn switch(bus: &Bus, name: Option<&str>, session: &str) -> Result<(String, bool), Failure> {
    let mut ends = Ends {
        leader: bus
            .subscriber(topics::LINK_STATUS, Depth::Newest)
            .map_err(Failure::failed)?,
        follower: bus
            .subscriber(topics::LINK_FOLLOWER_STATUS, Depth::Newest)
            .map_err(Failure::failed)?,
        clock: Clock::start(),
        laws: [None; 2],
    };
    let mut publisher = bus
        .publisher(topics::LINK_LAW_COMMAND)
        .map_err(Failure::failed)?;
    // Also gives the reader of the command time to find this publisher.
    thread::sleep(Duration::from_millis(50));
    if !ends.look_until(FIRST_WORD, |ends| ends.law(0).is_some()) {
        return Err(silent(session));
    }
    let Some(name) = name else {
        return Ok((ends.law(0).unwrap_or_default().to_owned(), true));
    };
    let now = ends.clock.now();
    let command = LawCommandSample {
        stamp: now,
        law: Text::new(name),
    };
    publisher.publish(now, &command).map_err(Failure::failed)?;
    // On two hosts only the operator's end is heard here; it changes over when
    // the other end has answered in the new law.
    let switched = ends.look_until(PATIENCE, |ends| {
        ends.law(0) == Some(name) && ends.law(1).is_none_or(|law| law == name)
    });
    Ok((ends.law(0).unwrap_or_default().to_owned(), switched))
}

//! The fleet as it is heard.

use std::{
    collections::BTreeMap, fs::OpenOptions, io::Write, path::Path, process::ExitCode,
    sync::atomic::Ordering, time::Duration,
};

use ferntast_bus::{ZenohBus, ZenohConfig, ZenohMode};
use ferntast_fleet::{Aggregate, DaySummary, Fleet, Listener, ageing::WatchSettings, days};
use ferntast_msgs::Time;
use ferntast_nodes::process::{Clock, stop_on_signals};
use serde_json::json;

use super::{
    super::{Failure, output::print_json_line, scenario_options::domain_of_environment},
    terminal,
};

/// How often what was said is taken \[s\].
const EVERY: Duration = Duration::from_millis(50);
/// How often new sessions are looked for \[s\].
const LOOK_EVERY: f64 = 1.0;
const SECONDS_A_DAY: i64 = 86_400;

/// What is listened to, and how it is judged.
pub struct Live<'a> {
    pub routers: &'a [String],
    pub listen: Option<&'a str>,
    pub domain: Option<u32>,
    pub journal: Option<&'a Path>,
    pub settings: WatchSettings,
}

impl Live<'_> {
    /// Listens until Ctrl-C, after the days that are `known`.
    pub fn run(&self, mut known: Vec<DaySummary>, json: bool) -> Result<ExitCode, Failure> {
        let stop = stop_on_signals().map_err(Failure::failed)?;
        let mut listeners = self.listeners()?;
        let clock = Clock::start();
        let mut fleet = Fleet::new(self.settings);
        // The day that is going on is judged when it is over.
        let begun = today(clock.now());
        judge(&mut fleet, &known, begun, json, true)?;
        if self.journal.is_none() {
            eprintln!("note: without --journal FILE.jsonl a restart forgets all days");
        }
        eprintln!("listening; Ctrl-C ends it");
        let (mut heard, mut looked) = (Aggregate::default(), None::<Time>);
        while !stop.load(Ordering::Relaxed) {
            let now = clock.now();
            if looked.is_none_or(|at| now.seconds_since(at) >= LOOK_EVERY) {
                looked = Some(now);
                let wrong = listeners.iter_mut().flat_map(Listener::look);
                wrong.for_each(|error| eprintln!("not heard: {error}"));
            }
            for listener in &mut listeners {
                let (new, wrong) = listener.take(now, &mut heard);
                wrong
                    .iter()
                    .for_each(|error| eprintln!("not heard: {error}"));
                for (robot, joint) in new {
                    match json {
                        true => print_json_line(
                            &json!({"event": "heard", "robot": robot, "joint": joint}),
                        )?,
                        false => println!("heard {robot} {joint}"),
                    }
                }
            }
            // A twin is some tenths of a second behind the clock.
            let over = heard.take_before(now.plus_seconds(-2.0));
            if !over.is_empty() {
                self.keep(&over)?;
                known.extend(over);
                judge(&mut fleet, &known, today(now), json, false)?;
            }
            std::thread::sleep(EVERY);
        }
        let rest = heard.take();
        self.keep(&rest)?;
        match json {
            true => print_json_line(&json!({"event": "end", "days": rest}))?,
            false => terminal::tell(&fleet.told(terminal::STANDING)),
        }
        Ok(ExitCode::SUCCESS)
    }

    fn listeners(&self) -> Result<Vec<Listener>, Failure> {
        let domain_id = match self.domain {
            Some(domain) => domain,
            None => domain_of_environment()?.unwrap_or(0),
        };
        let connect = self.routers.iter().map(|endpoint| ZenohMode::Connect {
            endpoint: endpoint.clone(),
        });
        let listen = self.listen.map(|listen| ZenohMode::Router {
            listen: listen.to_owned(),
        });
        let open = |mode: ZenohMode| {
            let config = ZenohConfig {
                mode,
                domain_id,
                node_name: "ferntast_fleet".to_owned(),
                namespace: "/".to_owned(),
            };
            let bus = ZenohBus::open(&config).map_err(Failure::failed)?;
            Ok(Listener::new(bus))
        };
        connect.chain(listen).map(open).collect()
    }

    /// Writes lines into the journal.
    fn keep(&self, lines: &[DaySummary]) -> Result<(), Failure> {
        let Some(path) = self.journal else {
            return Ok(());
        };
        let bad =
            |error: &dyn std::fmt::Display| Failure::failed(format!("{}: {error}", path.display()));
        let mut text = String::new();
        for own in lines {
            text += &serde_json::to_string(own).map_err(|error| bad(&error))?;
            text.push('\n');
        }
        let file = OpenOptions::new().create(true).append(true).open(path);
        let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
        written.map_err(|error| bad(&error))
    }
}

fn today(now: Time) -> i64 {
    now.nanos().div_euclid(SECONDS_A_DAY * 1_000_000_000)
}

/// Judges the days before `before` that were not judged yet. At the `start` they are history,
/// of which only what was named is told.
fn judge(
    fleet: &mut Fleet,
    known: &[DaySummary],
    before: i64,
    json: bool,
    start: bool,
) -> Result<(), Failure> {
    let all: BTreeMap<i64, Vec<DaySummary>> = days(known);
    let first = fleet.newest().map_or(i64::MIN, |newest| newest + 1);
    let new = all.range(first..).filter(|(day, _)| **day < before);
    for (day, own) in new {
        let named = fleet.day(*day, own).map_err(Failure::failed)?.to_vec();
        for one in &named {
            match json {
                true => print_json_line(&json!({"event": "named", "named": one}))?,
                false => terminal::tell_named(one),
            }
        }
        if start {
            continue;
        }
        match json {
            true => {
                print_json_line(&json!({"event": "day", "fleet": fleet.told(terminal::STANDING)}))?
            }
            false => println!(
                "a day of {} joints was judged, {} named",
                own.len(),
                named.len()
            ),
        }
    }
    Ok(())
}

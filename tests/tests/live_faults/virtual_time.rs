//! The time to hold in virtual time: the same silences, the same judge, no computer that stalls.

use ferntast_control::delay::Law;
use ferntast_msgs::{Time, sample::OperatingState};
use ferntast_nodes::session_graph;
use ferntast_studies::faults::{self, Event, Fault, Kits, Node, Schedule, Way};

use super::{judge::Hold, recorded::Recorded, run::SCENARIO};

/// A fault that is longer than the arm takes to hold \[ms\].
const LASTS: i64 = 120;
/// When it begins at the earliest, and over how long it is spread \[ms\].
const BEGINS: i64 = 500;
const SPREAD: i64 = 397;

/// Those who fall silent, as in [`silences`](super::rows::silences).
pub fn parties() -> Vec<(&'static str, Vec<Fault>)> {
    let stall = |node| vec![Fault::Stall { node, ms: LASTS }];
    let cut = |way| Fault::Blackout { way, ms: LASTS };
    vec![
        ("master stopped", stall(Node::Master)),
        ("link_leader stopped", stall(Node::LinkLeader)),
        ("link_follower stopped", stall(Node::LinkFollower)),
        ("link cut both ways", vec![cut(Way::Forth), cut(Way::Back)]),
        ("return link cut", vec![cut(Way::Back)]),
    ]
}

/// The holds of `times` seeds under every law; an error says what is violated.
pub fn holds(faults: &[Fault], times: u64) -> Result<Vec<Hold>, String> {
    let mut loaded = faults::load(SCENARIO).map_err(|error| error.to_string())?;
    loaded
        .set_round_trip(0.0)
        .map_err(|error| error.to_string())?;
    let start = Time::from_nanos(loaded.scenario.start.saturating_mul(1_000_000_000));
    let graph = session_graph(ferntast_drivers::rows());
    let kits = Kits::new(&graph, &loaded, SCENARIO).map_err(|error| error.to_string())?;
    let mut holds = Vec::new();
    for law in Law::NAMES {
        for seed in 0..times {
            let at_ms = BEGINS + (seed as i64 * 131) % SPREAD;
            let event = |fault: &Fault| Event {
                at_ms,
                fault: fault.clone(),
            };
            let schedule = Schedule {
                scenario: SCENARIO.to_owned(),
                seed,
                law: (*law).to_owned(),
                length_ms: at_ms + LASTS,
                planted: None,
                event: faults.iter().map(event).collect(),
            };
            let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
            let path = folder.path().join("run");
            let outcome =
                faults::replay(&kits, &schedule, &path).map_err(|error| error.to_string())?;
            if let Some(own) = outcome.violations.first() {
                return Err(format!(
                    "{law}, seed {seed}: {}: {}",
                    own.invariant, own.told
                ));
            }
            let begun = start.plus_nanos(at_ms * 1_000_000);
            let recorded = Recorded::read(&[], &[path], 0.0);
            let hold = hold(&recorded, law, begun);
            holds.push(hold.ok_or_else(|| format!("{law}, seed {seed}: the arm went on"))?);
        }
    }
    Ok(holds)
}

fn hold(recorded: &Recorded, law: &'static str, begun: Time) -> Option<Hold> {
    let (at, _) = recorded
        .states
        .iter()
        .find(|own| own.0 >= begun && own.1 != OperatingState::ENABLED)?;
    let last = recorded.commands.iter().rev().find(|own| *own <= at)?;
    Some(Hold {
        law,
        after_command: at.seconds_since(*last),
        after_fault: at.seconds_since(begun),
        around: 0.0,
    })
}

//! A table of faults on real processes between two hosts in network namespaces.
//!
//! `rows` says what goes wrong, `fault` how that is done, `run` does it, `recorded` and
//! `contact` are what was recorded of it, `judge` is what has to hold of that, `special` the
//! rows that are something else, `virtual_time` the same silences in virtual time, `table`
//! what people read. `./tests/run --faults` runs all and writes `docs/live_faults.md`; the
//! usual tests run some repetitions of what tells most.

mod contact;
mod fault;
mod judge;
mod recorded;
mod rows;
mod run;
mod special;
mod table;
mod virtual_time;

use std::{
    env, fs,
    panic::{self, AssertUnwindSafe},
    time::Instant,
};

use ferntast_tests::root;

use judge::Outcome;
use rows::Row;
use table::{Line, Times};

/// Largest force on the tip, whatever happens \[N\]: the bound of `ferntast faults`.
const MOST_FORCE: f64 = 160.0;
/// By how much the largest force of a few repetitions differs from that of others.
const SPREAD: f64 = 1.05;
/// Repetitions of each silence, under each law.
const TIMES: usize = 50;

/// The whole of it: what is asked for by name, and what came of it.
struct Table {
    filter: String,
    /// Whether `docs/live_faults.md` is written.
    document: bool,
    begun: Instant,
    faults: Vec<Line>,
    live: Vec<Times>,
    in_virtual_time: Vec<Times>,
    failed: Vec<String>,
}

impl Table {
    fn wants(&self, name: &str) -> bool {
        name.contains(&self.filter)
    }

    /// Runs one row; a panic in it is a failure of it.
    fn outcome(&mut self, name: &str, run: impl FnOnce() -> Outcome) -> Outcome {
        eprintln!("{:5.0} s  {name}", self.begun.elapsed().as_secs_f64());
        let outcome = panic::catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or(panic.downcast_ref::<&str>().copied());
            let line = text.unwrap_or("it panicked").lines().next();
            let mut outcome = Outcome::default();
            outcome.fail(line.unwrap_or_default().chars().take(200).collect());
            outcome
        });
        for failure in &outcome.failures {
            eprintln!("         {failure}");
            self.failed.push(format!("{name}: {failure}"));
        }
        outcome
    }

    fn line(&mut self, fault: &str, party: &str, must: &str, outcome: Outcome) {
        let line = Line {
            fault: fault.to_owned(),
            party: party.to_owned(),
            must: must.to_owned(),
            outcome,
        };
        eprint!(
            "{}",
            table::faults(std::slice::from_ref(&line))
                .lines()
                .nth(2)
                .unwrap_or_default()
        );
        eprintln!();
        self.faults.push(line);
        self.write();
    }

    fn row(&mut self, row: &Row, most_force: f64) -> Option<Outcome> {
        let name = row.name();
        if !self.wants(&name) {
            return None;
        }
        let outcome = self.outcome(&name, || run::run(row, most_force));
        self.line(
            row.fault_words,
            &row.party,
            row.must.words(),
            outcome.clone(),
        );
        Some(outcome)
    }

    /// The force that a row may reach: what the session reaches by itself, in calm strokes and
    /// where the operator arms it again while it presses, and what maxima of a few repetitions
    /// spread.
    fn calm(&mut self) -> f64 {
        let rows = rows::calm();
        let calm: Vec<Outcome> = rows
            .iter()
            .filter_map(|row| self.row(row, MOST_FORCE))
            .collect();
        if calm.len() < rows.len() {
            return MOST_FORCE;
        }
        let forces = calm.iter().map(|own| own.force.max(own.force_again));
        SPREAD * forces.fold(0.0, f64::max)
    }

    fn all(&mut self) {
        let most = self.calm();
        for row in rows::rows() {
            self.row(&row, most);
        }
        if self.wants("a crash arms nothing") {
            let outcome = self.outcome("a crash arms nothing", || special::crash_arms_nothing(50));
            let must = "stays PAUSED until an operator says otherwise";
            self.line(
                "killed after words of the operator",
                "link_leader",
                must,
                outcome,
            );
        }
        if self.wants("release") {
            self.release(3);
        }
        if self.wants("supervisor killed") {
            let outcome = self.outcome("supervisor killed", || special::supervisor(5));
            let must = "its nodes end, the arm with them";
            self.line(
                "killed (SIGKILL)",
                "supervisor, both ends on one host",
                must,
                outcome,
            );
        }
        for row in rows::silences(TIMES) {
            self.times(&row);
        }
        for (party, faults) in virtual_time::parties() {
            if self.wants(&format!("virtual time: {party}")) {
                self.times_in_virtual_time(party, &faults, TIMES as u64);
            }
        }
    }

    fn release(&mut self, times: usize) {
        let mut laws = Vec::new();
        let whole = self.outcome("release by law", || {
            laws = special::release(times);
            let mut whole = Outcome::default();
            for (law, own) in &laws {
                for failure in &own.failures {
                    whole.fail(format!("{law}: {failure}"));
                }
            }
            whole
        });
        let must = "lets go: ≤ 5 N after 200 ms, told";
        if laws.is_empty() {
            self.line("return link cut while the arm presses", "–", must, whole);
        }
        for (law, outcome) in laws {
            self.line("return link cut while the arm presses", law, must, outcome);
        }
    }

    fn times(&mut self, row: &Row) {
        let name = row.name();
        if !self.wants(&name) {
            return;
        }
        let outcome = self.outcome(&name, || run::run(row, MOST_FORCE));
        for law in row.laws {
            let holds = outcome.holds.iter().filter(|own| own.law == *law);
            self.live.push(Times {
                party: row.party.clone(),
                law,
                holds: holds.copied().collect(),
            });
        }
        eprint!("{}", table::times(&self.live, true));
        self.write();
    }

    fn times_in_virtual_time(
        &mut self,
        party: &str,
        faults: &[ferntast_studies::faults::Fault],
        times: u64,
    ) {
        let name = format!("virtual time: {party}");
        let outcome = self.outcome(&name, || {
            let mut outcome = Outcome::default();
            match virtual_time::holds(faults, times) {
                Ok(holds) => outcome.holds = holds,
                Err(told) => outcome.fail(told),
            }
            let late = outcome.holds.iter().filter(|own| own.after_command > 0.030);
            let late = late.count();
            if late > 0 {
                outcome.fail(format!("{late} holds later than 30 ms"));
            }
            outcome
        });
        for law in ferntast_control::delay::Law::NAMES {
            let holds = outcome.holds.iter().filter(|own| own.law == *law);
            self.in_virtual_time.push(Times {
                party: party.to_owned(),
                law,
                holds: holds.copied().collect(),
            });
        }
        eprint!("{}", table::times(&self.in_virtual_time, false));
        self.write();
    }

    /// Writes the document, where all is run: after every row, so that one that is ended early
    /// has what was found.
    fn write(&self) {
        if self.document {
            let path = root().join("docs/live_faults.md");
            fs::write(&path, self.text())
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        }
    }

    /// What stands in the document.
    fn text(&self) -> String {
        let (faults, live, calculated) = (
            table::faults(&self.faults),
            table::times(&self.live, true),
            table::times(&self.in_virtual_time, false),
        );
        let verdict = match self.failed.len() {
            0 => "Everything held.".to_owned(),
            failed => format!("{failed} things did not hold; they are in words at the end."),
        };
        let failed: Vec<String> = self.failed.iter().map(|own| format!("* {own}")).collect();
        let failed = match failed.is_empty() {
            true => "Nothing.".to_owned(),
            false => failed.join("\n"),
        };
        format!(
            include_str!("head.md"),
            verdict = verdict,
            faults = faults,
            live = live,
            calculated = calculated,
            failed = failed
        )
    }
}

fn table(filter: String) -> Table {
    Table {
        filter,
        document: false,
        begun: Instant::now(),
        faults: Vec::new(),
        live: Vec::new(),
        in_virtual_time: Vec::new(),
        failed: Vec::new(),
    }
}

/// With `./tests/run --faults [FILTER]` the whole table, or the rows whose names have `FILTER`
/// in them; without, nothing: what the usual tests run of it is below.
#[test]
fn the_table_of_faults() {
    let Ok(filter) = env::var("FERNTAST_FAULTS") else {
        return;
    };
    let mut table = Table {
        document: filter.is_empty(),
        ..table(filter)
    };
    table.all();
    table.write();
    assert!(table.failed.is_empty(), "{:#?}", table.failed);
}

/// In virtual time nothing stalls: every hold is in time by itself.
#[test]
fn the_time_to_hold_in_virtual_time() {
    for (party, faults) in virtual_time::parties() {
        let holds =
            virtual_time::holds(&faults, 2).unwrap_or_else(|told| panic!("{party}: {told}"));
        let longest = holds.iter().map(|own| own.after_command);
        let longest = longest.fold(0.0, f64::max);
        assert!(longest <= 0.030, "{party}: {longest} s");
    }
}

mod two_hosts {
    use super::*;

    /// What tells most, once or twice.
    #[test]
    fn some_of_the_table_holds() {
        let mut table = table(String::new());
        let telling = [
            "killed (SIGKILL): servo",
            "killed (SIGKILL): link_leader",
            "stopped (SIGSTOP): master",
            "device down: veth of the arm's host",
            "all packets lost: to the operator",
        ];
        let rows = rows::rows().into_iter();
        for row in rows.filter(|row| telling.contains(&row.name().as_str())) {
            table.row(&Row { times: 2, ..row }, MOST_FORCE);
        }
        assert_eq!(table.faults.len(), telling.len());
        table.outcome("a crash arms nothing", || special::crash_arms_nothing(2));
        assert!(table.failed.is_empty(), "{:#?}", table.failed);
    }
}

//! What has to hold of a row, looked for in what was recorded.

use std::collections::BTreeMap;

use ferntast_msgs::{Time, sample::OperatingState};
use ferntast_tests::{Host, Machine, Window, Word};

use super::{
    contact::peak,
    fault::Fault,
    recorded::{Recorded, between},
    rows::{Must, Row},
};

/// From the last command to the hold at most \[s\].
const HOLD: f64 = 0.030;
/// For so long after it was held up itself, the servo waits for others \[s\].
const RECOVERY: f64 = 0.006;
/// A word is fresh for so long \[s\].
const FRESH: f64 = 1.0;
/// A word may be under way when the arm comes to hold \[s\].
const UNDER_WAY: f64 = 0.1;
/// Distance of the setpoint from the measured position at the start \[rad\].
const POSITION: f64 = 2e-3;
/// Largest change of a motor torque in a step after the start \[Nm\].
const TORQUE: f64 = 8.0;
/// For so long after the start torques are watched \[s\].
const WATCHED: f64 = 0.030;
/// Steps that are further apart are none: what lies between was not recorded \[s\].
const STEP: f64 = 0.0025;
/// A servo that says nothing for so long does not run \[s\].
const SILENT: f64 = 0.040;

/// A repetition: when what was done.
#[derive(Clone, Copy, Debug)]
pub struct Repetition {
    /// Under which law.
    pub law: &'static str,
    /// Just before the fault.
    pub before: Time,
    /// When somebody was about to arm again.
    pub end: Time,
}

/// A hold, and how soon it came.
#[derive(Clone, Copy, Debug)]
pub struct Hold {
    /// Under which law.
    pub law: &'static str,
    /// After the last command \[s\].
    pub after_command: f64,
    /// After the fault \[s\], up to what it took to make it.
    pub after_fault: f64,
    /// The bare timer's longest stall from shortly before the fault to shortly after the hold \[s\].
    pub around: f64,
}

/// What a row comes to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Repetitions.
    pub times: usize,
    /// Every hold.
    pub holds: Vec<Hold>,
    /// Largest normal force before the arm is enabled again \[N\].
    pub force: f64,
    /// Largest normal force after that, until the next fault \[N\].
    pub force_again: f64,
    /// Largest distance of the setpoint from the arm at an enabling \[rad\].
    pub jump: f64,
    /// Largest step of a torque after an enabling \[Nm\].
    pub torque_step: f64,
    /// Nodes that were started again.
    pub restarts: u32,
    /// What was said, and in how many repetitions.
    pub told: BTreeMap<String, usize>,
    /// What does not hold.
    pub failures: Vec<String>,
    /// Remarks for the table.
    pub remarks: Vec<String>,
}

impl Outcome {
    pub fn fail(&mut self, told: String) {
        // A row that fails in every repetition says so a few times.
        if self.failures.len() < 5 {
            self.failures.push(told);
        }
    }
}

/// What a row is judged with.
pub struct Judged<'a> {
    pub row: &'a Row,
    pub machine: &'a Machine,
    pub recorded: &'a Recorded,
    pub words: &'a [Word],
    pub repetitions: &'a [Repetition],
    /// Normal force of the contact at its times \[N\].
    pub forces: &'a [(Time, f64)],
    /// The largest force that is allowed \[N\].
    pub most_force: f64,
}

impl Judged<'_> {
    /// Judges all of it.
    pub fn outcome(&self) -> Outcome {
        let mut outcome = Outcome {
            times: self.repetitions.len(),
            ..Outcome::default()
        };
        let enablings = self.recorded.enablings().into_iter().map(|own| own.1);
        let enablings: Vec<Time> = enablings.collect();
        for (number, own) in self.repetitions.iter().enumerate() {
            self.hold(number + 1, own, &mut outcome);
            self.told(number + 1, own, &mut outcome);
            // Until the next fault: an arm that is armed again hits then.
            let next = self.repetitions.get(number + 1);
            let until = next.map_or(own.end.plus_seconds(1.0), |next| next.before);
            let again = enablings
                .iter()
                .find(|at| **at > own.before && **at < until);
            let again = again.copied().unwrap_or(until);
            outcome.force = outcome.force.max(peak(self.forces, own.before, again));
            outcome.force_again = outcome.force_again.max(peak(self.forces, again, until));
        }
        self.words(&mut outcome);
        self.starts(&mut outcome);
        for force in [outcome.force, outcome.force_again] {
            if force > self.most_force {
                outcome.fail(self.hardest(force));
            }
        }
        outcome
    }

    /// How a force that is too large came about.
    fn hardest(&self, force: f64) -> String {
        let hit = self.forces.iter().find(|own| own.1 >= force);
        let at = hit.map_or(Time::INVALID, |own| own.0);
        let since = |times: &mut dyn Iterator<Item = Time>| {
            let last = times.filter(|own| *own <= at).last();
            last.map_or(f64::NAN, |last| at.seconds_since(last))
        };
        let enabled = since(&mut self.recorded.enablings().into_iter().map(|own| own.1));
        let fault = since(&mut self.repetitions.iter().map(|own| own.before));
        format!(
            "{force:.1} N on the tip, {:.1} N are allowed; {fault:.3} s after a fault, {enabled:.3} s after an enabling",
            self.most_force
        )
    }

    /// When commanded motion ended after the fault: the servo says that it does not follow
    /// any more, or says nothing.
    fn held_at(&self, own: &Repetition) -> Option<Time> {
        let states = &self.recorded.states;
        let first = states.partition_point(|one| one.0 <= own.before);
        let left = states[first..]
            .iter()
            .take_while(|one| one.0 <= own.end)
            .find(|one| one.1 != OperatingState::ENABLED)
            .map(|one| one.0);
        let silent = match self.row.fault.silences_servo() {
            true => self.silent_since(own),
            false => None,
        };
        match (left, silent) {
            (Some(left), Some(silent)) => Some(left.min(silent)),
            (left, silent) => left.or(silent),
        }
    }

    /// The last torque before the servo fell silent.
    fn silent_since(&self, own: &Repetition) -> Option<Time> {
        let from = own.before.plus_seconds(-STEP);
        let torques = between(&self.recorded.torques, from, own.end);
        let silent = torques
            .windows(2)
            .find(|pair| pair[1].at.seconds_since(pair[0].at) > SILENT)
            .map(|pair| pair[0].at);
        let ended = torques.last().map(|last| last.at);
        let ended = ended.filter(|last| own.end.seconds_since(*last) > SILENT);
        silent.or(ended)
    }

    fn hold(&self, number: usize, own: &Repetition, outcome: &mut Outcome) {
        if self.row.fault == Fault::LoseHost(Host::Arm) {
            // What was recorded of the end died with the recorder.
            return;
        }
        let state = self.recorded.state_at(own.before);
        if state != Some(OperatingState::ENABLED) {
            outcome.fail(format!(
                "repetition {number}: the arm was {state:?} before the fault"
            ));
            return;
        }
        let Some(at) = self.held_at(own) else {
            if self.row.must == Must::Hold {
                outcome.fail(format!("repetition {number}: the arm went on"));
            }
            return;
        };
        let commands = &self.recorded.commands;
        let after = commands.partition_point(|stamp| *stamp <= at);
        let Some(&last) = after.checked_sub(1).and_then(|place| commands.get(place)) else {
            outcome.fail(format!(
                "repetition {number}: nothing was commanded before the hold"
            ));
            return;
        };
        let window = |from, to| Window { from, to };
        let stalled = self.machine.stalled(window(last, at));
        let around = window(own.before.plus_seconds(-0.02), at.plus_seconds(0.02));
        let hold = Hold {
            law: own.law,
            after_command: at.seconds_since(last),
            after_fault: at.seconds_since(own.before),
            around: self.machine.longest_stall(around),
        };
        let recovery = if stalled > 0.0 { RECOVERY } else { 0.0 };
        if hold.after_command > HOLD + stalled + recovery {
            outcome.fail(format!(
                "repetition {number} ({}): held {:.1} ms after the last command, of which the machine stalled for {:.1} ms",
                own.law,
                1e3 * hold.after_command,
                1e3 * stalled
            ));
        }
        let in_all = self.machine.stalled(window(own.before, at));
        if let Some(most) = self.row.by_fault
            && hold.after_fault > most + in_all + if in_all > 0.0 { RECOVERY } else { 0.0 }
        {
            outcome.fail(format!(
                "repetition {number}: held {:.1} ms after the fault, {:.1} ms are allowed",
                1e3 * hold.after_fault,
                1e3 * most
            ));
        }
        let disturbed = !self.machine.is_quiet(around);
        if self.row.must == Must::GoOn && !disturbed {
            outcome.fail(format!(
                "repetition {number}: the arm held, and the machine was quiet"
            ));
        }
        outcome.holds.push(hold);
    }

    /// What nodes said from the fault until it was over for a moment.
    fn told(&self, number: usize, own: &Repetition, outcome: &mut Outcome) {
        let told = &self.recorded.told;
        let first = told.partition_point(|one| one.0 < own.before);
        let mut said: Vec<&str> = told[first..]
            .iter()
            .take_while(|one| one.0 <= own.end.plus_seconds(0.2))
            .map(|one| one.1.as_str())
            .collect();
        said.sort_unstable();
        said.dedup();
        if said.is_empty() && self.row.must == Must::Hold {
            outcome.fail(format!("repetition {number}: nobody said a word"));
        }
        for one in said {
            *outcome.told.entry(one.to_owned()).or_default() += 1;
        }
    }

    /// That every enabling had a word of its own.
    fn words(&self, outcome: &mut Outcome) {
        let enablings = self.recorded.enablings();
        for at in without_word(&enablings, self.words) {
            let first = self.words.first().map_or(at, |own| own.at);
            outcome.fail(format!(
                "ENABLED {:.3} s after the first word without a fresh word",
                at.seconds_since(first)
            ));
        }
    }

    /// That every enabling begins where the arm is, and with the torque that it had.
    fn starts(&self, outcome: &mut Outcome) {
        for (_, at) in self.recorded.enablings() {
            let watched = at.plus_seconds(WATCHED);
            let setpoint = between(&self.recorded.setpoints, at, watched).first();
            let measured = between(&self.recorded.measured, at.plus_seconds(-STEP), at).last();
            if let (Some(setpoint), Some(measured)) = (setpoint, measured) {
                for joint in 0..2 {
                    let far = (setpoint.position[joint] - measured.position[joint]).abs();
                    outcome.jump = outcome.jump.max(far);
                }
            }
            let torques = between(&self.recorded.torques, at.plus_seconds(-STEP), watched);
            for pair in torques.windows(2) {
                if pair[1].at.seconds_since(pair[0].at) > STEP {
                    continue;
                }
                for joint in 0..2 {
                    let step = (pair[1].effort[joint] - pair[0].effort[joint]).abs();
                    outcome.torque_step = outcome.torque_step.max(step);
                }
            }
        }
        if outcome.jump > POSITION {
            let jump = outcome.jump;
            outcome.fail(format!("the setpoint began {jump:.4} rad from the arm"));
        }
        if outcome.torque_step > TORQUE {
            let step = outcome.torque_step;
            outcome.fail(format!(
                "the torque changed by {step:.1} Nm in a step after an enabling"
            ));
        }
    }
}

/// The enablings, each with since when it was not enabled, that have no fresh word of their own.
fn without_word(enablings: &[(Time, Time)], words: &[Word]) -> Vec<Time> {
    let mut used = Time::INVALID;
    let mut found = Vec::new();
    for &(left, at) in enablings {
        let from = left
            .plus_seconds(-UNDER_WAY)
            .max(at.plus_seconds(-FRESH))
            .max(used.plus_nanos(1));
        let counts = |own: &&Word| own.arms && (from..=at).contains(&own.at);
        match words.iter().rev().find(counts) {
            Some(word) => used = word.at,
            None => found.push(at),
        }
    }
    found
}

#[test]
fn a_word_counts_once_and_while_it_is_fresh() {
    let at = |ms: i64| Time::from_nanos(1_000_000_000_000 + ms * 1_000_000);
    let word = |ms, arms| Word { at: at(ms), arms };
    let enabling = |left, now| (at(left), at(now));
    let none: [Time; 0] = [];
    let words = [word(100, true), word(3000, false), word(5000, true)];
    assert_eq!(without_word(&[enabling(0, 102)], &words), none);
    // Said before the arm ceased to be enabled; said long ago; a word that arms nothing; said
    // once, for two.
    assert_eq!(without_word(&[enabling(400, 500)], &words), [at(500)]);
    assert_eq!(without_word(&[enabling(0, 1200)], &words), [at(1200)]);
    assert_eq!(without_word(&[enabling(2900, 3001)], &words), [at(3001)]);
    let twice = [enabling(4900, 5001), enabling(5050, 5060)];
    assert_eq!(without_word(&twice, &words), [at(5060)]);
}

//! Rows that are no repetition of one fault: the word of a crash, letting go, a supervisor.

use std::{thread, time::Duration};

use ferntast_control::delay::Law;
use ferntast_msgs::{Time, sample::OperatingState};
use ferntast_tests::{
    Host, Machine, PATIENCE, Pair, Process, Session, await_enabled, now, recording, start,
    wait_until,
};

use super::{
    contact::forces,
    fault::Fault,
    judge::Outcome,
    recorded::{Recorded, between},
    rows::member,
    run::{options, pressing_hand, sliding_hand},
};

/// After the silence of the return link the arm may press so long with more than
/// [`LEFT`] \[s\].
const RELEASE: f64 = 0.200;
/// What may be left of the force then \[N\].
const LEFT: f64 = 5.0;
/// By every law the arm presses with more than this before \[N\].
const PRESSES: f64 = 3.0;
/// A word of the operator counts when the operator's end has heard of the stop before.
const HEARD: Duration = Duration::from_millis(100);
/// After its restart an end of the link has shaken hands, and would have armed.
const SETTLED: Duration = Duration::from_millis(900);

/// The operator says pause, after words that were counted, and the end of the link that
/// counted them dies: the arm stays PAUSED.
pub fn crash_arms_nothing(times: usize) -> Outcome {
    let _machine = Machine::alone();
    let session = Session::new();
    let options = options("position_force", sliding_hand(&session));
    let mut pair = Pair::start(session, options);
    pair.ready();
    let mut outcome = Outcome {
        times,
        ..Outcome::default()
    };
    let state = |pair: &mut Pair| {
        let arguments = ["state", "follower", "--json"];
        let told = pair.command(Host::Arm, &arguments).success().json();
        told["state"].as_str().unwrap_or("").to_owned()
    };
    pair.word(Host::Arm, "pause");
    let paused = wait_until(PATIENCE, || state(&mut pair) == "PAUSED");
    assert!(paused, "the word beside the arm is not obeyed");
    thread::sleep(HEARD);
    pair.word(Host::Operator, "resume");
    let resumed = wait_until(PATIENCE, || state(&mut pair) == "ENABLED");
    assert!(resumed, "the operator's word is not heard");
    pair.word(Host::Arm, "pause");
    for number in 1..=times {
        pair.kill(member(Host::Operator, "link_leader"));
        pair.revive();
        thread::sleep(SETTLED);
        let found = state(&mut pair);
        if found != "PAUSED" {
            outcome.fail(format!(
                "crash {number}: `ferntast state follower` says {found}"
            ));
            pair.word(Host::Arm, "pause");
        }
    }
    let stayed = times - outcome.failures.len();
    outcome.remarks.push(format!(
        "`ferntast state follower` says PAUSED, {stayed} of {times}"
    ));
    // And an operator's word arms it.
    pair.ready();
    outcome.restarts = pair.restarts();
    pair.finish();
    outcome
}

/// The return link is lost while the arm presses, under every law: the arm lets go, and it is
/// told in words. Gives an outcome a law.
pub fn release(times: usize) -> Vec<(&'static str, Outcome)> {
    let machine = Machine::alone();
    let session = Session::new();
    let options = options(Law::NAMES[0], pressing_hand(&session));
    let mut pair = Pair::start(session, options);
    let cut = Fault::Lose(&[Host::Operator], 1000);
    let mut cuts: Vec<(&'static str, Time, Time)> = Vec::new();
    let mut unmoved = Vec::new();
    for law in Law::NAMES {
        pair.ready();
        pair.rule(law);
        for _ in 0..times {
            pair.ready();
            let presses = || pair.look(Host::Arm).force > PRESSES;
            if !wait_until(Duration::from_secs(8), presses) {
                unmoved.push(*law);
                continue;
            }
            thread::sleep(Duration::from_millis(300));
            let lasting = cut.begin(&mut pair);
            let there = now();
            thread::sleep(Duration::from_millis(600));
            cuts.push((law, there, now()));
            cut.end(&mut pair, lasting);
            thread::sleep(Duration::from_millis(60));
        }
    }
    let (_session, [operator, arm]) = pair.finish();
    let recorded = Recorded::read(&operator, &arm, 0.0);
    let forces = forces(&recorded.measured);
    let of_law = |law: &'static str| {
        let mut outcome = Outcome::default();
        for _ in unmoved.iter().filter(|own| **own == law) {
            outcome.fail("the arm does not press".to_owned());
        }
        let mut longest: f64 = 0.0;
        let mut left: f64 = 0.0;
        for &(_, there, over) in cuts.iter().filter(|own| own.0 == law) {
            outcome.times += 1;
            let from = forces.partition_point(|own| own.0 < there);
            let during = forces[from..].iter().take_while(|own| own.0 <= over);
            let since = |at: Time| at.seconds_since(there);
            let late = |own: &&(Time, f64)| since(own.0) >= RELEASE;
            let pressing = during.clone().filter(|own| own.1 > LEFT).last();
            longest = longest.max(pressing.map_or(0.0, |own| since(own.0)));
            let late = during.clone().filter(late);
            let own_left = late.map(|own| own.1).fold(0.0, f64::max);
            left = left.max(own_left);
            let before = forces[..from].last().map_or(0.0, |own| own.1);
            outcome.force = outcome.force.max(before);
            let stalled = machine.stalled(ferntast_tests::Window {
                from: there,
                to: over,
            });
            if own_left > LEFT && stalled < 0.015 {
                outcome.fail(format!("{own_left:.1} N are left after 200 ms"));
            }
            let told = recorded
                .told
                .iter()
                .filter(|own| own.0 >= there && own.0 <= over);
            let mut said: Vec<&String> = told.map(|own| &own.1).collect();
            said.sort_unstable();
            said.dedup();
            if !said.iter().any(|own| own.contains("hears nothing")) {
                outcome.fail("it is not told that the other end hears nothing".to_owned());
            }
            for own in said {
                *outcome.told.entry(own.clone()).or_default() += 1;
            }
        }
        outcome.remarks.push(format!(
            "≤ 5 N after {:.0} ms at most; {left:.1} N left after 200 ms",
            1e3 * longest
        ));
        (law, outcome)
    };
    Law::NAMES.iter().map(|law| of_law(law)).collect()
}

/// A supervisor is killed, on one host, since half a session has none: its nodes go along,
/// and the arm with them.
pub fn supervisor(times: usize) -> Outcome {
    let machine = Machine::alone();
    let mut outcome = Outcome::default();
    let mut longest: f64 = 0.0;
    for number in 1..=times {
        let session = Session::new();
        let mut process: Process = start(&session, &["--no-console", "--rtt", "0"]);
        await_enabled(&session, &mut process);
        thread::sleep(Duration::from_secs(1));
        let killed = now();
        process.crash();
        if !wait_until(PATIENCE, || session.processes().is_empty()) {
            outcome.fail(format!("{number}: nodes outlived their supervisor"));
        }
        // The next session clears up what a killed supervisor left in shared memory.
        let next = session.ferntast_here(&["session", "--no-console", "--duration", "0.1"]);
        Process::spawn(next).wait(PATIENCE).success();
        outcome.times += 1;
        let closed = || ferntast_bag::info(&recording(&session)).is_ok_and(|info| info.closed);
        if !wait_until(Duration::from_secs(5), closed) {
            outcome.fail(format!("{number}: the recording is not closed"));
            continue;
        }
        let part = [recording(&session)];
        let recorded = Recorded::read(&[], &part, 0.0);
        let state = recorded.state_at(killed);
        if state != Some(OperatingState::ENABLED) {
            outcome.fail(format!("{number}: the arm was {state:?} before"));
        }
        let torques = between(&recorded.torques, killed, now());
        let driven = torques.iter().rev().find(|own| own.effort != [0.0; 2]);
        let lasted = driven.map_or(0.0, |own| own.at.seconds_since(killed));
        longest = longest.max(lasted);
        let stalled = machine.stalled(ferntast_tests::Window {
            from: killed,
            to: now(),
        });
        // The servo is told by the system that its parent has died, and ends.
        if lasted > 0.050 + stalled {
            outcome.fail(format!("{number}: driven {:.1} ms after it", 1e3 * lasted));
        }
        let again = recorded
            .enablings()
            .iter()
            .filter(|own| own.1 > killed)
            .count();
        if again > 0 {
            outcome.fail(format!("{number}: ENABLED after it"));
        }
    }
    outcome.remarks.push(format!(
        "last torque {:.1} ms after it at most",
        1e3 * longest
    ));
    outcome
}

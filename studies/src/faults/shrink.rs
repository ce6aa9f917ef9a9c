//! A schedule that violates an invariant, made small.

use super::{
    run::{Kits, Look, RunError},
    schedule::{Event, Schedule},
};

/// The least that still violates `invariant`.
///
/// # Errors
///
/// A schedule that cannot be run.
pub fn shrink(kits: &Kits, schedule: &Schedule, invariant: &str) -> Result<Schedule, RunError> {
    shrink_where(schedule, |schedule| violates(kits, schedule, invariant))
}

/// When the schedule violates `invariant` \[ms\], if it does.
///
/// # Errors
///
/// A schedule that cannot be run.
pub fn violates(
    kits: &Kits,
    schedule: &Schedule,
    invariant: &str,
) -> Result<Option<i64>, RunError> {
    let look = Look {
        only: Some(invariant),
        ..Look::default()
    };
    let outcome = kits.run(schedule, look)?;
    let mut found = outcome.violations.iter();
    let found = found.find(|own| own.invariant == invariant);
    Ok(found.map(|own| own.at_ms))
}

/// The least that still fails by `fails`, which tells when \[ms\]: first as few
/// faults as possible (delta debugging; Zeller and Hildebrandt 2002, "Simplifying
/// and isolating failure-inducing input"), then short ones, then an early end.
///
/// # Errors
///
/// A schedule that cannot be run.
pub fn shrink_where(
    schedule: &Schedule,
    fails: impl Fn(&Schedule) -> Result<Option<i64>, RunError>,
) -> Result<Schedule, RunError> {
    let mut least = schedule.clone();
    let Some(mut at_ms) = fails(&least)? else {
        return Ok(least);
    };
    // What comes after the violation has no part in it.
    least.event.retain(|event| event.at_ms <= at_ms);
    least.event = fewest(&least, &fails)?;
    for index in 0..least.event.len() {
        loop {
            let mut shorter = least.clone();
            let Some(ms) = shorter.event[index].fault.length_ms().filter(|ms| **ms > 1) else {
                break;
            };
            *ms /= 2;
            match fails(&shorter)? {
                Some(_) => least = shorter,
                None => break,
            }
        }
    }
    if let Some(at) = fails(&least)? {
        at_ms = at;
    }
    let mut early = least.clone();
    early.length_ms = (at_ms + 1).min(least.length_ms);
    match fails(&early)? {
        Some(_) => Ok(early),
        None => Ok(least),
    }
}

/// The fewest events that still fail: none of them can be left out.
fn fewest(
    schedule: &Schedule,
    fails: &impl Fn(&Schedule) -> Result<Option<i64>, RunError>,
) -> Result<Vec<Event>, RunError> {
    let mut events = schedule.event.clone();
    let mut parts = 2;
    while !events.is_empty() {
        let size = events.len().div_ceil(parts);
        let mut smaller = None;
        for begin in (0..events.len()).step_by(size) {
            let end = (begin + size).min(events.len());
            let rest = [&events[..begin], &events[end..]].concat();
            let candidate = Schedule {
                event: rest,
                ..schedule.clone()
            };
            if fails(&candidate)?.is_some() {
                smaller = Some(candidate.event);
                break;
            }
        }
        match smaller {
            Some(rest) => {
                events = rest;
                parts = parts.saturating_sub(1).max(2);
            }
            None if size == 1 => break,
            None => parts = (2 * parts).min(events.len()),
        }
    }
    Ok(events)
}

#[cfg(test)]
mod tests {
    use super::super::fault::{Fault, Node};
    use super::*;

    fn schedule(faults: impl IntoIterator<Item = Fault>) -> Schedule {
        let event = (0..).zip(faults);
        let event = event.map(|(at_ms, fault)| Event { at_ms, fault });
        Schedule {
            scenario: "rokviss".to_owned(),
            seed: 1,
            law: "wave".to_owned(),
            length_ms: 2500,
            planted: None,
            event: event.collect(),
        }
    }

    #[test]
    fn what_has_no_part_in_it_is_left_out_and_the_rest_is_short() {
        let crash = |node| Fault::Crash { node };
        let stall = |ms| Fault::Stall {
            node: Node::Servo,
            ms,
        };
        let others = (0..12).map(|_| crash(Node::Estimator));
        let faults = others.chain([crash(Node::Arm), stall(400), crash(Node::Estimator)]);
        let full = schedule(faults);
        // Fails with the arm's crash and a stall of 60 ms or longer, at 700 ms.
        let fails = |own: &Schedule| {
            let has = |wanted: &dyn Fn(&Fault) -> bool| {
                own.event.iter().any(|event| wanted(&event.fault))
            };
            let crashed = has(&|fault| *fault == crash(Node::Arm));
            let stalled = has(&|fault| matches!(fault, Fault::Stall { ms, .. } if *ms >= 60));
            let fails = crashed && stalled && own.length_ms > 700;
            Ok(fails.then_some(700))
        };
        let least = shrink_where(&full, fails).unwrap();
        let left: Vec<Fault> = least.event.iter().map(|own| own.fault.clone()).collect();
        assert_eq!(left, [crash(Node::Arm), stall(100)]);
        assert_eq!(least.length_ms, 701);
    }

    #[test]
    fn what_does_not_fail_stays() {
        let full = schedule([Fault::DiskFull { ms: 10 }]);
        assert_eq!(shrink_where(&full, |_| Ok(None)).unwrap(), full);
    }
}

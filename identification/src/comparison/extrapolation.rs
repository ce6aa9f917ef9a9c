//! Held-out data beyond the range in which the model was fitted.

use serde::Serialize;

use crate::design::PreparedModel;
use crate::signals::Signals;

/// Share of the fitted range by which a value beyond it is tolerated.
const MARGIN: f64 = 0.05;

/// A held-out session that leaves the fitted range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extrapolation {
    /// Name of the session.
    pub session: String,
    /// `velocity`, `load` or `temperature`; of a contact `tip_velocity`, `normal_force`.
    pub signal: String,
    /// Lowest and highest value fitted.
    pub fitted: [f64; 2],
    /// Lowest and highest value in this session.
    pub reached: [f64; 2],
    /// Share of its rows beyond.
    pub share: f64,
}

type Value = fn(&Signals, usize) -> f64;

/// Every session held out (each in turn, where none is named) against the others.
#[must_use]
pub fn find(prepared: &PreparedModel) -> Vec<Extrapolation> {
    let mut signals: Vec<(&str, Value)> = vec![("velocity", |s, at| s.points[at].velocity)];
    if prepared.facts.loaded {
        signals.push(("load", |s, at| s.points[at].load));
    }
    if prepared.facts.temperature {
        signals.push(("temperature", |s, at| s.points[at].temperature));
    }
    let mut found = Vec::new();
    for (name, value) in signals {
        let offset = if name == "temperature" {
            prepared.facts.reference_temperature
        } else {
            0.0
        };
        let range = |s: &Signals| span(s.rows.iter().map(|at| value(s, *at) + offset));
        let own: Vec<Option<[f64; 2]>> = prepared.sessions.iter().map(range).collect();
        let mut check = |session: &Signals, fitted: Option<[f64; 2]>| {
            let (Some(fitted), Some(reached)) = (fitted, range(session)) else {
                return;
            };
            let margin = MARGIN * (fitted[1] - fitted[0]);
            let beyond = session
                .rows
                .iter()
                .filter(|at| {
                    let x = value(session, **at) + offset;
                    x < fitted[0] - margin || x > fitted[1] + margin
                })
                .count();
            if beyond > 0 {
                found.push(Extrapolation {
                    session: session.name.clone(),
                    signal: prepared.facts.joint.signal(name).to_owned(),
                    fitted,
                    reached,
                    share: beyond as f64 / session.rows.len().max(1) as f64,
                });
            }
        };
        if prepared.held_out.is_empty() {
            for (i, session) in prepared.sessions.iter().enumerate() {
                let others = own
                    .iter()
                    .enumerate()
                    .filter(|(j, _)| *j != i)
                    .filter_map(|(_, r)| *r);
                check(session, span(others.flatten()));
            }
        } else {
            let all = span(own.iter().filter_map(|r| *r).flatten());
            for session in &prepared.held_out {
                check(session, all);
            }
        }
    }
    found
}

fn span(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
        (l.min(x), h.max(x))
    });
    (low <= high).then_some([low, high])
}

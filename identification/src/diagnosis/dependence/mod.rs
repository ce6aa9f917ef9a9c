//! On which signals, and on which pairs of them, the residual still depends.
//!
//! Maps with free shape: piecewise linear over one signal or over two, the same
//! in both directions of motion or opposite; of two that change within a session, times one
//! that changes from session to session, too. A map shows that something is left
//! and where, but names no effect.

mod basis;
mod oscillation;
mod own_past;

use basis::{Channel, Ground, KNOTS_PAIR, KNOTS_PRODUCT, Slow};
use serde::Serialize;

use crate::design::{Design, PreparedModel};
use crate::effects::{Direction, EffectHandle, LOAD_OF, POSITION_OF, VELOCITY_OF};
use crate::numerics::statistics::{f_tail, quantile_or_zero};
use crate::validation::{Score, between, gain_within};

/// Smallest share of the mean square that an oscillation explains: of a motion that repeats
/// itself, what other maps leave is one, too.
const MIN_SHARE_OF_OSCILLATION: f64 = 0.1;

/// Smallest share of the mean square that the residual's own past explains: noise that the filters
/// pass, and steps of an encoder, leave less than half of it.
const MIN_SHARE_OF_OWN_PAST: f64 = 0.15;
/// What a residual depends on that goes on from moment to moment, and with no signal.
const OWN_PAST: &str = "own_past";

/// A dependence of the residual on one signal or two.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// One to three signals: `position`, `velocity`, `load`, `acceleration`,
    /// `load_rate`, `temperature`, `date`, `time`, or the name of an extra signal; or
    /// `own_past`, the residual's own some moments before;
    /// of a contact as [`JointType::signal`](crate::JointType::signal) calls them.
    pub signals: Vec<String>,
    /// Share of the residual's mean square that a map over them explains on
    /// data left out.
    pub strength: f64,
    /// The same as mean square \[Nm²\].
    pub gain: f64,
    /// p-value, corrected for the number of maps.
    pub p_value: f64,
    /// See [`Score::certainty`].
    pub certainty: f64,
    /// Of a residual that swings, in step with time or anew after each stroke: its period \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Mean residual over the signals; empty where there are three.
    pub map: Map,
}

impl Dependence {
    /// On what, in words.
    #[must_use]
    pub fn on(&self) -> String {
        let signals = self.signals.join(" and ");
        match (signals == OWN_PAST, self.period_s) {
            (false, Some(period)) => format!("{signals}, with a period of {period:.4} s"),
            (false, None) => signals,
            (true, Some(period)) => format!(
                "its own past, which swings with about {:.2} Hz",
                1.0 / period
            ),
            (true, None) => "its own past, which goes on from moment to moment".to_owned(),
        }
    }
}

/// Mean residual in bins of one or two signals.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Map {
    /// Middle of the bins of each signal.
    pub axes: Vec<Vec<f64>>,
    /// Mean residual \[Nm\] moving forward, row by row of the first signal; `None` where there are no data.
    pub forward: Vec<Option<f64>>,
    /// The same moving backward.
    pub backward: Vec<Option<f64>>,
}

/// All dependences that pass the tests, strongest first.
#[must_use]
pub fn find(prepared: &PreparedModel, design: &Design) -> Vec<Dependence> {
    let ground = Ground::new(prepared, design);
    let channels = &ground.channels;
    let mut choices: Vec<Vec<usize>> = (0..channels.len()).map(|i| vec![i]).collect();
    for i in 0..channels.len() {
        for j in 0..i {
            // Two slow signals have as many values together as sessions.
            // Other joints' motions go with this joint's own, not with each other.
            let slow = channels[i].slow && channels[j].slow;
            if !slow && goes_with(&channels[j], &channels[i]) {
                choices.push(vec![j, i]);
            }
        }
    }
    // What turns round with temperature is nothing in the mean over sessions.
    let pairs: Vec<Vec<usize>> = (choices.iter())
        .filter(|pair| pair.len() == 2 && pair.iter().all(|i| is_own_motion(&channels[*i])))
        .cloned()
        .collect();
    for slow in (0..channels.len()).filter(|i| channels[*i].slow) {
        choices.extend(pairs.iter().map(|pair| [pair.as_slice(), &[slow]].concat()));
    }
    let tried = choices.len() as f64;
    let mut found: Vec<Dependence> = Vec::new();
    for choice in choices {
        let chosen: Vec<&Channel> = choice.iter().map(|i| &channels[*i]).collect();
        let map = |knots, slow| ground.grams(&chosen, Direction::Either, knots, slow);
        let all = map(KNOTS_PAIR, Slow::Times);
        // The model's own parameters, one set a session, can absorb what changes
        // with temperature or date only; shared ones cannot, but the variation of
        // all parameters between sessions masks it.
        let mut scores = Vec::new();
        let is_of_three = chosen.len() > 2;
        let has_slow = chosen.iter().any(|c| c.slow);
        let has_fast = chosen.iter().any(|c| !c.slow);
        // Over three what changes with temperature alone would count again, without its names.
        if has_slow && !is_of_three {
            scores.push(between(design, &all));
        }
        if has_fast {
            scores.push(gain_within(design, &all));
        }
        let motions = |c: &&&Channel| Origin::of(&c.name) == Origin::Motion;
        if is_of_three || (chosen.len() > 1 && chosen.iter().any(|c| motions(&c))) {
            scores.push(gain_within(design, &map(KNOTS_PRODUCT, Slow::Times)));
        }
        if has_slow && has_fast {
            let knots = if is_of_three {
                KNOTS_PRODUCT
            } else {
                KNOTS_PAIR
            };
            scores.push(gain_within(design, &map(knots, Slow::AndWithout)));
        }
        let names: Vec<String> = chosen.iter().map(|c| c.name.clone()).collect();
        let best = scores
            .iter()
            .filter_map(|score| dependence(&names, score, tried))
            .max_by(|a, b| a.gain.total_cmp(&b.gain));
        found.extend(best);
    }
    if found.is_empty() {
        // Nothing repeats with the state; the rest may still vary slowly with time.
        found.extend(dependence(
            &["time".to_owned()],
            &slow_variation(prepared, design),
            tried,
        ));
    }
    if found.is_empty() {
        found.extend(oscillating(prepared, design, tried));
    }
    rank(&mut found);
    let residuals: Vec<Vec<f64>> = design.sessions.iter().map(|s| s.own_residual()).collect();
    for dependence in found.iter_mut().take(3) {
        let chosen: Vec<&Channel> = dependence
            .signals
            .iter()
            .filter_map(|name| channels.iter().find(|c| &c.name == name))
            .collect();
        if chosen.len() < 3 {
            dependence.map = draw(prepared, &chosen, &residuals);
        }
    }
    found
}

/// Whether a map over both is tried: with another joint's position or velocity another
/// such, or this joint's; its torque alone.
fn goes_with(a: &Channel, b: &Channel) -> bool {
    let [of_a, of_b] = [a, b].map(|channel| Origin::of(&channel.name));
    let counts = |origin: Origin, channel: &Channel| match origin {
        Origin::Motion => true,
        Origin::Torque => false,
        Origin::Own => is_own_motion(channel),
    };
    (of_a == Origin::Own && of_b == Origin::Own) || (counts(of_a, a) && counts(of_b, b))
}

/// Whether it is this joint's position, velocity or load.
fn is_own_motion(channel: &Channel) -> bool {
    ["position", "velocity", "load"].contains(&channel.name.as_str())
}

/// Whose a signal is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// This joint's, or an extra signal.
    Own,
    /// Another joint's position or velocity.
    Motion,
    /// Another joint's torque.
    Torque,
}

impl Origin {
    fn of(name: &str) -> Self {
        match name {
            name if name.starts_with(LOAD_OF) => Self::Torque,
            name if name.starts_with(POSITION_OF) || name.starts_with(VELOCITY_OF) => Self::Motion,
            _ => Self::Own,
        }
    }
}

/// Mean square \[Nm²\] that a free map over an effect's own signals, with the
/// effect's own symmetry, still explains; 0 if no map is significant.
#[must_use]
pub fn on_own_signals(prepared: &PreparedModel, design: &Design, effect: &EffectHandle) -> f64 {
    let own = effect.row().own_signals;
    let ground = Ground::new(prepared, design);
    let channels = &ground.channels;
    let is_own = |c: &Channel| own.names.contains(&c.name.as_str());
    let mut choices: Vec<Vec<&Channel>> = channels
        .iter()
        .filter(|c| is_own(c))
        .map(|c| vec![c])
        .collect();
    if own.any_pair {
        for c in channels.iter().filter(|c| is_own(c)) {
            choices.extend(channels.iter().filter(|o| !o.slow).map(|o| vec![c, o]));
        }
    }
    let tried = choices.len() as f64;
    choices
        .iter()
        .filter_map(|chosen| {
            let grams = ground.grams(chosen, own.direction, KNOTS_PAIR, Slow::Times);
            let slow = chosen.iter().any(|c| c.slow);
            let score = if slow {
                between(design, &grams)
            } else {
                gain_within(design, &grams)
            };
            dependence(&[], &score, tried).map(|d| d.gain)
        })
        .fold(0.0, f64::max)
}

/// A dependence, if it passes the tests.
fn dependence(names: &[String], score: &Score, tried: f64) -> Option<Dependence> {
    let p_value = one_sided(score.certainty, score.gains.len()) * tried;
    (score.share() > 0.01 && score.certainty > 3.0 && p_value < 0.01).then(|| Dependence {
        signals: names.to_vec(),
        strength: score.share(),
        gain: score.gain,
        p_value,
        certainty: score.certainty,
        period_s: None,
        map: Map::default(),
    })
}

/// A residual that swings with time.
fn oscillating(prepared: &PreparedModel, design: &Design, tried: f64) -> Option<Dependence> {
    let found = oscillation::find(prepared, design, MIN_SHARE_OF_OSCILLATION)?;
    let tried = tried + found.tried as f64;
    let own = dependence(&["time".to_owned()], &found.score, tried)?;
    (own.strength > MIN_SHARE_OF_OSCILLATION).then_some(Dependence {
        period_s: Some(found.period),
        ..own
    })
}

/// What the residual's own past tells of it, if that is much: no noise does that.
#[must_use]
pub fn on_own_past(prepared: &PreparedModel, design: &Design) -> Option<Dependence> {
    let found = own_past::find(prepared, design);
    let own = dependence(&[OWN_PAST.to_owned()], &found.score, 1.0)?;
    (own.strength > MIN_SHARE_OF_OWN_PAST).then_some(Dependence {
        period_s: found.period,
        ..own
    })
}

/// Score of a slow variation with time: the residual of each second, predicted by
/// the mean residual of the seconds before and after it.
fn slow_variation(prepared: &PreparedModel, design: &Design) -> Score {
    let columns: Vec<Vec<Vec<f64>>> = design
        .sessions
        .iter()
        .zip(&prepared.sessions)
        .map(|(session, signals)| {
            let residual = session.own_residual();
            let second = |at: usize| signals.time(at) as usize;
            let mut sums: Vec<[(f64, f64); 2]> = Vec::new();
            for (r, at) in residual.iter().zip(&signals.rows) {
                if sums.len() <= second(*at) {
                    sums.resize(second(*at) + 1, [(0.0, 0.0); 2]);
                }
                let signs = [1.0, signals.points[*at].sign()];
                for (sum, sign) in sums[second(*at)].iter_mut().zip(signs) {
                    *sum = (sum.0 + sign * r, sum.1 + 1.0);
                }
            }
            (0..2)
                .map(|kind| {
                    signals
                        .rows
                        .iter()
                        .map(|at| {
                            let now = second(*at);
                            let near = [now.checked_sub(1), Some(now + 1)];
                            let (sum, count) = near
                                .into_iter()
                                .flatten()
                                .filter_map(|i| sums.get(i))
                                .fold((0.0, 0.0), |(s, n), x| (s + x[kind].0, n + x[kind].1));
                            let sign = if kind == 0 {
                                1.0
                            } else {
                                signals.points[*at].sign()
                            };
                            sign * sum / f64::max(count, 1.0)
                        })
                        .collect()
                })
                .collect()
        })
        .collect();
    gain_within(design, &design.with(&columns))
}

/// Sorts by gain; keeps what is over several signals only where it explains clearly more than
/// its parts, or leaves clearly less.
fn rank(found: &mut Vec<Dependence>) {
    let all = found.clone();
    found.retain(|d| {
        // Of three signals a map has four times the functions, some of which suit any shape.
        let most = if d.signals.len() > 2 { 0.7 } else { 0.9 };
        !all.iter().any(|part| {
            part.signals.len() < d.signals.len()
                && part.signals.iter().all(|own| d.signals.contains(own))
                && part.gain > most * d.gain
                && 1.0 - d.strength > 0.5 * (1.0 - part.strength)
        })
    });
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
}

/// p-value of a one-sided t-test.
#[must_use]
pub fn one_sided(t: f64, clusters: usize) -> f64 {
    if t <= 0.0 {
        return 1.0;
    }
    0.5 * f_tail(t * t, 1.0, clusters.saturating_sub(1) as f64)
}

/// Mean residual in bins, for drawing.
fn draw(prepared: &PreparedModel, chosen: &[&Channel], residuals: &[Vec<f64>]) -> Map {
    const BINS: usize = 12;
    let edges: Vec<(f64, f64)> = chosen
        .iter()
        .map(|c| {
            let mut all: Vec<f64> = c.values.iter().flatten().copied().collect();
            (
                quantile_or_zero(&mut all, 0.005),
                quantile_or_zero(&mut all, 0.995),
            )
        })
        .collect();
    let cells = BINS.pow(chosen.len() as u32);
    let mut sums = vec![[(0.0, 0_usize); 2]; cells];
    for (s, signals) in prepared.sessions.iter().enumerate() {
        for (row, at) in signals.rows.iter().enumerate() {
            let mut cell = 0;
            for (channel, (low, high)) in chosen.iter().zip(&edges) {
                let share = (channel.values[s][row] - low) / (high - low).max(1e-300);
                cell = cell * BINS + ((share * BINS as f64) as usize).min(BINS - 1);
            }
            let direction = usize::from(signals.points[*at].velocity < 0.0);
            let (sum, count) = &mut sums[cell][direction];
            *sum += residuals[s].get(row).copied().unwrap_or(0.0);
            *count += 1;
        }
    }
    let mean = |direction: usize| {
        sums.iter()
            .map(|cell| {
                let (sum, count) = cell[direction];
                (count >= 5).then(|| sum / count as f64)
            })
            .collect()
    };
    Map {
        axes: edges
            .iter()
            .map(|(low, high)| {
                (0..BINS)
                    .map(|i| low + (high - low) * (i as f64 + 0.5) / BINS as f64)
                    .collect()
            })
            .collect(),
        forward: mean(0),
        backward: mean(1),
    }
}

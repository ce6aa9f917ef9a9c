//! Forward simulation: the recorded motor torque drives the fitted model.
//!
//! Motion is integrated in windows of [`WINDOW`] seconds; each starts from the
//! measured position and velocity, because the error of a double integration
//! grows without limit whatever the model. The measured joint torque, where
//! there is a sensor, is an input like the motor torque; without one the load
//! is inertia, weight and spring of the model. Load-dependent friction takes
//! the load at the measured moment.

use nalgebra::DVector;
use serde::Serialize;

use crate::design::PreparedModel;
use crate::effects::{MAX_COLUMNS, Memory, Point, with_columns};
use crate::signals::Signals;

/// Length of a window \[s\].
pub const WINDOW: f64 = 1.0;
/// Longest step of the integration \[s\].
const STEP: f64 = 0.002;

/// Predicted against measured motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// RMS of the position error over all windows \[rad\] (\[m\] for a prismatic joint).
    pub position_rms_rad: f64,
    /// RMS of the velocity error \[rad/s\].
    pub velocity_rms_rad_s: f64,
    /// RMS of the measured motion within its window, to compare with: position
    /// against the window's start \[rad\].
    pub motion_rms_rad: f64,
    /// Length of a window \[s\].
    pub window_s: f64,
    /// Number of windows.
    pub windows: usize,
}

/// Simulates sessions; `None` without a positive inertia.
#[must_use]
pub fn simulate(
    prepared: &PreparedModel,
    sessions: &[Signals],
    coefficients: &DVector<f64>,
) -> Option<Simulation> {
    let (mut position, mut velocity, mut motion, mut count, mut windows) =
        (0.0, 0.0, 0.0, 0_usize, 0);
    for signals in sessions {
        let mut memories: Vec<Memory> = vec![[0.0; 4]; prepared.terms.len()];
        let length = ((WINDOW / signals.period) as usize).max(2);
        let mut at = 0;
        while at + 2 < signals.points.len() {
            let end = (at + length).min(signals.points.len());
            let start = signals.points[at];
            let mut state = (start.position, start.velocity);
            // Effects with a state enter the window with the state that the
            // measured motion has given them.
            let mut inside = memories.clone();
            for now in at..end - 1 {
                state = step(prepared, coefficients, signals, now, state, &mut inside)?;
                let next = &signals.points[now + 1];
                let (dq, dv) = (state.0 - next.position, state.1 - next.velocity);
                position += dq * dq;
                velocity += dv * dv;
                motion += (next.position - start.position).powi(2);
                count += 1;
            }
            for point in &signals.points[at..end] {
                let mut columns = [0.0; MAX_COLUMNS];
                for (term, memory) in prepared.terms.iter().zip(&mut memories) {
                    let width = term.effect.columns();
                    term.effect
                        .evaluate(&term.shape, point, memory, &mut columns[..width]);
                }
            }
            windows += 1;
            at = end;
        }
    }
    let n = count.max(1) as f64;
    let simulation = Simulation {
        position_rms_rad: (position / n).sqrt(),
        velocity_rms_rad_s: (velocity / n).sqrt(),
        motion_rms_rad: (motion / n).sqrt(),
        window_s: WINDOW,
        windows,
    };
    (windows > 0 && simulation.position_rms_rad.is_finite()).then_some(simulation)
}

/// Torque that the model takes at a state, as A + B q̈: every effect is at most
/// linear in q̈ given the measured load.
fn torque(
    prepared: &PreparedModel,
    coefficients: &DVector<f64>,
    point: &Point,
    extra: &[Vec<f64>],
    memories: &mut [Memory],
) -> (f64, f64) {
    let (mut still, mut moving) = (0.0, prepared.facts.inertia.unwrap_or(0.0));
    if prepared.facts.joint_torque {
        still += point.load;
    }
    let mut columns = [0.0; MAX_COLUMNS];
    for (((term, places), memory), extra) in with_columns(&prepared.terms).zip(memories).zip(extra)
    {
        let width = places.len();
        // The channels are already without it.
        if !term.compensated.is_empty() {
            continue;
        }
        let mut sum = |acceleration: f64, memory: &mut Memory| {
            let point = Point {
                acceleration,
                ..*point
            };
            term.effect
                .evaluate_with(&term.shape, &point, extra, memory, &mut columns[..width]);
            columns[..width]
                .iter()
                .zip(places.clone())
                .map(|(c, k)| c * coefficients.get(k).copied().unwrap_or(0.0))
                .sum::<f64>()
        };
        let mut copy = *memory;
        let at_one = sum(1.0, &mut copy);
        let at_zero = sum(0.0, memory);
        still += at_zero;
        moving += at_one - at_zero;
    }
    (still, moving)
}

/// One working sample of motion.
fn step(
    prepared: &PreparedModel,
    coefficients: &DVector<f64>,
    signals: &Signals,
    now: usize,
    (mut position, mut velocity): (f64, f64),
    memories: &mut [Memory],
) -> Option<(f64, f64)> {
    let (this, next) = (&signals.points[now], signals.points.get(now + 1)?);
    let count = (signals.period / STEP).ceil().max(1.0);
    let dt = signals.period / count;
    let extra: Vec<Vec<f64>> = prepared
        .terms
        .iter()
        .map(|term| {
            let value = |name: &String| {
                signals
                    .extra
                    .get(name)
                    .and_then(|s| s.get(now))
                    .copied()
                    .unwrap_or(0.0)
            };
            term.effect.extra().iter().map(value).collect()
        })
        .collect();
    for i in 0..count as usize {
        let share = (i as f64 + 0.5) / count;
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let drive = mix(this.motor_torque, next.motor_torque);
        let at = |velocity: f64| Point {
            period: dt,
            position,
            velocity,
            motor_torque: drive,
            load: mix(this.load, next.load),
            load_rate: this.load_rate,
            load_jerk: this.load_jerk,
            ..*this
        };
        let small = 1e-3 * prepared.facts.speed[1].max(1e-9);
        // At rest friction holds against what is less than breakaway in either direction.
        let direction = if velocity.abs() > small {
            velocity.signum()
        } else {
            0.0
        };
        let trial = |velocity: f64, memories: &mut [Memory]| {
            torque(prepared, coefficients, &at(velocity), &extra, memories)
        };
        let probe = if direction == 0.0 {
            let forward = drive - trial(small, &mut memories.to_vec()).0;
            let backward = drive - trial(-small, &mut memories.to_vec()).0;
            if forward > 0.0 {
                small
            } else if backward < 0.0 {
                -small
            } else {
                velocity = 0.0;
                continue;
            }
        } else {
            velocity
        };
        // Implicit in velocity to first order: friction is stiff.
        let ahead = trial(probe + probe.signum() * small, &mut memories.to_vec()).0;
        let (still, mass) = trial(probe, memories);
        if mass.is_nan() || mass <= 0.0 {
            return None;
        }
        let damping = ((ahead - still) / (probe.signum() * small)).max(0.0);
        let before = velocity;
        velocity += dt * (drive - still) / (mass + dt * damping);
        // Friction stops a motion, it does not turn it round.
        if before != 0.0 && velocity * before < 0.0 {
            velocity = 0.0;
        }
        position += dt * velocity;
    }
    Some((position, velocity))
}

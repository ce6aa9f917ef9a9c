//! Checks recordings and models before anything is computed.

use super::error::PrepareError;
use super::{Dataset, Inertia, JointType, ModelSpec, RecordedSession};

/// Smallest number of samples of a session.
pub const MIN_SAMPLES: usize = 100;
/// Largest ratio of two sampling periods that the same filter, so many samples wide, fits.
pub(crate) const ALIKE: f64 = 1.5;

/// Checks recordings and the model's numbers.
///
/// # Errors
///
/// The first fault found.
pub fn check(dataset: &Dataset, spec: &ModelSpec) -> Result<(), PrepareError> {
    if dataset.sessions.is_empty() {
        return Err(PrepareError::NoSession);
    }
    for session in dataset.sessions.iter().chain(&dataset.held_out) {
        check_session(session, dataset.joint)?;
    }
    let sessions: Vec<&RecordedSession> =
        dataset.sessions.iter().chain(&dataset.held_out).collect();
    mixed(&sessions, "joint_torque", |s| s.joint_torque.is_some())?;
    mixed(&sessions, "normal_force", |s| s.normal_force.is_some())?;
    mixed(&sessions, "temperature", |s| s.temperature.is_some())?;
    if let Some(first) = sessions.first() {
        for session in &sessions {
            for name in session.extra.keys().chain(first.extra.keys()) {
                mixed(&sessions, name, |s| s.extra.contains_key(name))?;
            }
        }
    }
    if dataset.filter.is_some() {
        check_rates(&sessions)?;
    }
    if dataset.sessions.iter().all(|s| constant(&s.position)) {
        return Err(PrepareError::ConstantPosition(dataset.joint));
    }
    if dataset.sessions.iter().all(|s| constant(&s.motor_torque)) {
        return Err(PrepareError::ConstantForce(dataset.joint));
    }
    if dataset.joint.is_contact() {
        check_contact(&sessions, spec)?;
    }
    if let Inertia::Given(inertia) = spec.inertia
        && !(inertia.is_finite() && inertia >= 0.0)
    {
        return Err(PrepareError::Inertia(inertia));
    }
    if let Some(ratio) = spec.gear_ratio
        && !(ratio.is_finite() && ratio > 0.0)
    {
        return Err(PrepareError::GearRatio(ratio));
    }
    Ok(())
}

/// A stated filter counts in samples, which therefore have to mean the same time, about.
fn check_rates(sessions: &[&RecordedSession]) -> Result<(), PrepareError> {
    let by_period = |a: &&&RecordedSession, b: &&&RecordedSession| a.period.total_cmp(&b.period);
    let (fastest, slowest) = (
        sessions.iter().min_by(by_period),
        sessions.iter().max_by(by_period),
    );
    match (fastest, slowest) {
        (Some(fastest), Some(slowest)) if slowest.period > ALIKE * fastest.period => {
            Err(PrepareError::RatesWithFilter {
                slowest: slowest.name.clone(),
                slow: 1.0 / slowest.period,
                fastest: fastest.name.clone(),
                fast: 1.0 / fastest.period,
            })
        }
        _ => Ok(()),
    }
}

fn check_contact(sessions: &[&RecordedSession], spec: &ModelSpec) -> Result<(), PrepareError> {
    let mut forces = sessions.iter().map(|s| s.normal_force.as_ref());
    if forces.any(|force| force.is_none()) {
        return Err(PrepareError::NoNormalForce);
    }
    let mut all = sessions.iter().filter_map(|s| s.normal_force.as_ref());
    if !all.any(|force| force.iter().any(|f| *f > 0.0)) {
        return Err(PrepareError::NeverTouched);
    }
    match spec.inertia {
        Inertia::Given(0.0) => Ok(()),
        _ => Err(PrepareError::InertiaOfContact),
    }
}

fn constant(signal: &[f64]) -> bool {
    signal.windows(2).all(|w| w[0] == w[1])
}

fn mixed(
    sessions: &[&RecordedSession],
    channel: &str,
    has: impl Fn(&RecordedSession) -> bool,
) -> Result<(), PrepareError> {
    let with = sessions.iter().filter(|s| has(s)).count();
    if with == 0 || with == sessions.len() {
        return Ok(());
    }
    Err(PrepareError::Mixed {
        channel: channel.to_owned(),
        with,
        all: sessions.len(),
    })
}

fn check_session(session: &RecordedSession, joint: JointType) -> Result<(), PrepareError> {
    let name = || session.name.clone();
    if !(session.period.is_finite() && session.period > 0.0) {
        return Err(PrepareError::Period {
            session: name(),
            period: session.period,
        });
    }
    if session.len() < MIN_SAMPLES {
        return Err(PrepareError::TooFewSamples {
            session: name(),
            samples: session.len(),
            needed: MIN_SAMPLES,
        });
    }
    let channels = [
        ("position", Some(&session.position)),
        (joint.signal("motor_torque"), Some(&session.motor_torque)),
        ("normal_force", session.normal_force.as_ref()),
    ]
    .into_iter()
    .chain([
        ("joint_torque", session.joint_torque.as_ref()),
        ("temperature", session.temperature.as_ref()),
    ])
    .filter_map(|(n, c)| c.map(|c| (n, c)))
    .chain(session.extra.iter().map(|(n, c)| (n.as_str(), c)));
    for (channel, signal) in channels {
        if signal.len() != session.len() {
            return Err(PrepareError::Length {
                session: name(),
                channel: channel.to_owned(),
                samples: signal.len(),
                expected: session.len(),
            });
        }
        if let Some(sample) = signal.iter().position(|x| !x.is_finite()) {
            return Err(PrepareError::NotFinite {
                session: name(),
                channel: channel.to_owned(),
                sample,
            });
        }
    }
    Ok(())
}

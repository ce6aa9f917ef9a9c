//! A recording without what it hides is that of equation (4).

use super::*;
use crate::bench::rms;

/// Log entries on either side of one that counts, over which it slides one way:
/// the low-pass reaches as far.
const SLIDES: usize = 12;
/// Slower than this it may rest \[rad/s\].
const REST: f64 = 0.01;

/// Two motions without noise; parameters scatter, `own_part` takes that away.
///
/// Half strength: at full strength, friction that goes with the load's rate
/// (`unknown_torque_rate`) trembles between one millisecond and the next, which a
/// log of 12 ms takes for a constant.
fn noiseless(hidden: &[HiddenEffect]) -> BenchRecording {
    record(BenchConfig {
        seed: 3,
        hidden: hidden.to_vec(),
        strength: 0.5,
        sessions: 4,
        motions: vec![Motion::Standard, Motion::SlowReversals],
        noise: 0.0,
        ..BenchConfig::default()
    })
}

fn is_in_equation_4(effect: HiddenEffect) -> bool {
    hidden::believed_effects(&[effect]).len() < hidden::believed_effects(&[]).len()
}

/// rms \[Nm\] of what the believed model leaves besides scatter, where friction
/// has acted one way for long enough.
fn left(recording: &BenchRecording) -> f64 {
    rms(recording.sessions.iter().flat_map(|session| {
        let own = recording.own_part(session).torque;
        // Where friction acts, not where position is measured.
        let velocity = &session.without_hidden.velocity;
        let slides = |index: usize| {
            let near = &velocity[index - SLIDES..=index + SLIDES];
            near.iter().all(|v| v * velocity[index].signum() > REST)
        };
        let counts = (SLIDES..velocity.len() - SLIDES).filter(move |&index| slides(index));
        counts.map(move |index| own[index])
    }))
}

/// The largest difference between two channels.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let pairs = one.iter().zip(other);
    pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

#[test]
fn what_an_effect_adds_is_taken_out_and_nothing_else() {
    let nothing = left(&noiseless(&[]));
    assert!(nothing < 0.05, "{nothing}");
    let beyond = HiddenEffect::ALL.iter().copied();
    for effect in beyond.filter(|&effect| !is_in_equation_4(effect)) {
        let recording = noiseless(&[effect]);
        let (hidden, without) = (left(&recording), left(&recording.without_hidden()));
        println!("{effect:30} {hidden:.3} Nm, without {without:.4}, {nothing:.4}");
        assert!(hidden > 3.0 * nothing, "{effect}: {hidden}");
        let most = match effect {
            // Faster than a log shows: teeth that meet, a ripple at high speed.
            HiddenEffect::Backlash | HiddenEffect::Ripple | HiddenEffect::LoadRipple => 1.5,
            // What is clipped does not scatter.
            HiddenEffect::CurrentSaturation => 1.4,
            _ => 1.05,
        };
        assert!(
            (0.95..most).contains(&(without / nothing)),
            "{effect}: {without} {nothing}"
        );
    }
}

#[test]
fn two_effects_are_taken_out_together() {
    use HiddenEffect::{Backlash, ChannelDelay, Elasticity, Inertia, MotorConstant, Stribeck};
    let nothing = left(&noiseless(&[]));
    for pair in [
        [MotorConstant, Stribeck],
        [Inertia, Backlash],
        [Elasticity, ChannelDelay],
    ] {
        let without = left(&noiseless(&pair).without_hidden());
        println!("{pair:?} {without:.4} {nothing:.4}");
        assert!((0.95..1.4).contains(&(without / nothing)), "{pair:?}");
    }
}

/// A term of equation (4) that was hidden is believed, and its log stays.
#[test]
fn equation_4_stays_and_is_believed() {
    for &effect in HiddenEffect::ALL {
        let recording = record(BenchConfig {
            hidden: vec![effect],
            strength: 0.5,
            sessions: 1,
            ..BenchConfig::default()
        });
        let without = recording.without_hidden();
        assert!(without.hidden.is_empty() && without.believed.effects.len() == 5);
        let (before, after) = (&recording.sessions[0], &without.sessions[0]);
        let same = apart(&before.position, &after.position) < 1e-12
            && apart(&before.motor_torque, &after.motor_torque) < 1e-9
            && apart(&before.joint_torque, &after.joint_torque) < 1e-9;
        assert_eq!(same, is_in_equation_4(effect), "{effect}");
    }
}

/// What the true model leaves, noise and scatter, is left without the effect.
#[test]
fn noise_and_scatter_stay() {
    let nothing = record(BenchConfig::default());
    let beside = nothing.believed_rms().powi(2) - nothing.reference_rms().powi(2);
    for effect in [
        HiddenEffect::TorqueSensorGain,
        HiddenEffect::ChannelDelay,
        HiddenEffect::WearDrift,
        HiddenEffect::Gravity,
    ] {
        let recording = record(BenchConfig {
            hidden: vec![effect],
            ..BenchConfig::default()
        });
        let without = recording.without_hidden();
        // Reversals leave something besides.
        let left = (without.believed_rms().powi(2) - beside).sqrt();
        let ratio = left / recording.reference_rms();
        println!("{effect}: {ratio}");
        assert!((0.97..1.03).contains(&ratio), "{effect}: {ratio}");
    }
}

/// The true model multiplies all that it predicts by the gain: what scatters is
/// left with the gain on it.
#[test]
fn scatter_is_left_as_it_is_read() {
    let recording = record(BenchConfig {
        hidden: vec![HiddenEffect::MotorConstant],
        sessions: 1,
        ..BenchConfig::default()
    });
    let gain = recording.truth.last().unwrap().value;
    let session = &recording.sessions[0];
    let torques = session
        .truth
        .motor_torque
        .iter()
        .zip(&session.truth.scatter);
    let expected: Vec<f64> = torques
        .map(|(read, scatter)| read / (1.0 + gain) + gain * scatter)
        .collect();
    let (off, size) = (
        apart(&session.without_hidden.motor_torque, &expected),
        rms(session.truth.scatter.iter().map(|s| gain * s)),
    );
    assert!(off < 1e-9 && size > 1e-3, "{off} {size}");
}

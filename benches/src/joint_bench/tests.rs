pub(super) mod signatures;
mod without_hidden;

use super::*;

fn record(config: BenchConfig) -> BenchRecording {
    Bench::new(&config).unwrap().record().unwrap()
}

/// Same configuration, same bytes; another seed, other bytes.
#[test]
fn a_seed_decides_everything() {
    let config = BenchConfig {
        hidden: vec![HiddenEffect::UnknownWorkHeating, HiddenEffect::ChannelDelay],
        sessions: 2,
        ..BenchConfig::default()
    };
    let first = record(config.clone());
    let bits = |recording: &BenchRecording| -> Vec<u64> {
        let sessions = recording.sessions.iter();
        sessions
            .flat_map(|s| {
                [
                    &s.position,
                    &s.motor_torque,
                    &s.joint_torque,
                    &s.temperature,
                ]
            })
            .flatten()
            .map(|value| value.to_bits())
            .collect()
    };
    assert_eq!(bits(&first), bits(&record(config.clone())));
    // One bench recorded twice keeps no memory either.
    let bench = Bench::new(&config).unwrap();
    assert_eq!(bench.record().unwrap(), bench.record().unwrap());
    let other = record(BenchConfig { seed: 2, ..config });
    assert_ne!(bits(&first), bits(&other));
}

/// More sessions leave the first ones as they are but for dates and temperatures.
#[test]
fn motion_does_not_depend_on_the_number_of_sessions() {
    let of = |sessions| {
        record(BenchConfig {
            sessions,
            ..BenchConfig::default()
        })
    };
    let (few, many) = (of(2), of(3));
    assert_eq!(few.sessions[1].position, many.sessions[1].position);
}

#[test]
fn a_log_is_every_12_ms_and_all_channels_are_as_long() {
    let recording = record(BenchConfig {
        sessions: 3,
        ..BenchConfig::default()
    });
    assert_eq!(recording.sessions.len(), 3);
    assert_eq!(recording.sessions[0].start, 0.0);
    for session in &recording.sessions {
        let count = session.time.len();
        let seconds = count as f64 * LOG_PERIOD;
        assert!((45.0..100.0).contains(&seconds), "{seconds}");
        for channel in [
            &session.position,
            &session.motor_torque,
            &session.joint_torque,
            &session.temperature,
            &session.truth.position,
            &session.truth.friction,
            &session.truth.scatter,
        ] {
            assert_eq!(channel.len(), count);
            assert!(channel.iter().all(|value| value.is_finite()));
        }
        for (index, time) in session.time.iter().enumerate() {
            assert!((time - index as f64 * LOG_PERIOD).abs() < 1e-9);
        }
        let warmer = session.truth.temperature[count - 1] - session.truth.temperature[0];
        assert!((0.4..0.9).contains(&warmer), "{warmer}");
    }
}

/// Fig. 3 and the speeds named with it: the spring is pulled up to 40 °/s.
#[test]
fn the_standard_motion_covers_the_papers_range() {
    let recording = record(BenchConfig::default());
    for session in &recording.sessions {
        let largest = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
        let speed = largest(&session.truth.velocity).to_degrees();
        assert!((38.0..46.0).contains(&speed), "{speed}");
        let load = largest(&session.joint_torque);
        assert!((9.0..28.0).contains(&load), "{load}");
        let motor = largest(&session.motor_torque);
        assert!((30.0..70.0).contains(&motor), "{motor}");
    }
}

/// Over a session the motor's work is what friction took, but for the little
/// that is stored in the end.
#[test]
fn friction_takes_the_motors_work() {
    let recording = record(BenchConfig {
        sessions: 1,
        noise: 0.0,
        ..BenchConfig::default()
    });
    let truth = &recording.sessions[0].truth;
    let work = |torque: &[f64]| -> f64 {
        let power = torque.iter().zip(&truth.velocity);
        power
            .map(|(torque, velocity)| torque * velocity * LOG_PERIOD)
            .sum()
    };
    let (motor, friction) = (work(&truth.motor_torque), work(&truth.friction));
    assert!(friction > 50.0, "{friction}");
    assert!(
        (0.98..1.03).contains(&(motor / friction)),
        "{motor} {friction}"
    );
}

#[test]
fn with_nothing_hidden_only_noise_and_scatter_are_left() {
    let recording = record(BenchConfig::default());
    let (believed, reference) = (recording.believed_rms(), recording.reference_rms());
    assert!(
        (0.9..1.35).contains(&(believed / reference)),
        "{believed} {reference}"
    );
    assert!((0.2..0.27).contains(&recording.noise_rms()));
    assert!((0.25..0.5).contains(&reference), "{reference}");
    assert!(recording.visibility() < 1.0);
    let still = record(BenchConfig {
        scatter: 0.0,
        ..BenchConfig::default()
    });
    let reference = still.reference_rms();
    assert!((0.97..1.03).contains(&(reference / still.noise_rms())));
}

/// Every effect shows, the more the stronger it is.
#[test]
fn full_strength_is_clearly_visible() {
    for &effect in HiddenEffect::ALL {
        let visibility = |strength| {
            record(BenchConfig {
                seed: 7,
                hidden: vec![effect],
                strength,
                ..BenchConfig::default()
            })
            .visibility()
        };
        let (quarter, half, full) = (visibility(0.25), visibility(0.5), visibility(1.0));
        println!("{effect:30} {quarter:7.2} {half:7.2} {full:7.2}");
        assert!(full > 2.0, "{effect}: {full}");
        assert!(
            quarter < half && half < full,
            "{effect}: {quarter} {half} {full}"
        );
    }
}

/// No effect makes the joint run away in any motion, not even at twice its full strength.
#[test]
fn every_effect_runs_in_every_motion() {
    for &effect in HiddenEffect::ALL {
        let recording = record(BenchConfig {
            seed: 11,
            hidden: vec![effect],
            strength: 2.0,
            sessions: Motion::ALL.len(),
            motions: Motion::ALL.to_vec(),
            ..BenchConfig::default()
        });
        for session in &recording.sessions {
            let fastest = session
                .truth
                .velocity
                .iter()
                .fold(0.0, |a: f64, v| a.max(v.abs()));
            let motion = session.motion.unwrap();
            assert!(
                (0.05..4.0).contains(&fastest),
                "{effect} {motion}: {fastest}"
            );
        }
    }
}

#[test]
fn two_effects_act_at_once() {
    let of = |hidden| {
        record(BenchConfig {
            sessions: 2,
            noise: 0.0,
            scatter: 0.0,
            hidden,
            ..BenchConfig::default()
        })
    };
    let (stribeck, gravity) = (HiddenEffect::Stribeck, HiddenEffect::Gravity);
    let both = of(vec![stribeck, gravity]);
    let value = |recording: &BenchRecording, effect| -> Vec<f64> {
        let own = recording.truth.iter().filter(|p| p.effect == Some(effect));
        own.map(|p| p.value).collect()
    };
    // Each is drawn as if it were alone.
    assert_eq!(value(&both, stribeck), value(&of(vec![stribeck]), stribeck));
    assert_eq!(value(&both, gravity), value(&of(vec![gravity]), gravity));
    assert!(both.believed_rms() > of(vec![stribeck]).believed_rms());
    assert_eq!(both.believed.effects.len(), 5);
}

/// Each motion shows what it is for.
#[test]
fn motions_are_what_they_say() {
    let of = |motion| {
        record(BenchConfig {
            sessions: 8,
            motions: vec![motion],
            noise: 0.0,
            ..BenchConfig::default()
        })
    };
    let load = |recording: &BenchRecording| {
        let all = recording.sessions.iter().flat_map(|s| &s.joint_torque);
        all.fold(0.0, |a: f64, t| a.max(t.abs()))
    };
    assert!(load(&of(Motion::FastUnloaded)) < 2.0);
    assert!(load(&of(Motion::WideSpeedRange)) < 2.0);
    assert!(load(&of(Motion::LoadSteps)) > 12.0);
    let wide = of(Motion::WidePosition);
    let farthest = wide.sessions[0]
        .position
        .iter()
        .fold(0.0, |a: f64, q| a.max(*q));
    assert!((1.4..1.6).contains(&farthest));
    let reversals = |recording: &BenchRecording| {
        let v = &recording.sessions[0].truth.velocity;
        v.windows(2).filter(|w| w[0] * w[1] < 0.0).count()
    };
    assert!(reversals(&of(Motion::SlowReversals)) > 55);
    let sweep = of(Motion::TemperatureSweep);
    assert!(sweep.sessions[7].start < 86_400.0);
    let first = &sweep.sessions[0].truth.temperature;
    assert!((first[first.len() - 1] - first[0] - 8.0).abs() < 0.01);
    let dates = of(Motion::DateSweep);
    assert!(dates.sessions[7].start > 20.0 * 86_400.0);
    let warmth = dates.sessions.iter().flat_map(|s| &s.truth.temperature);
    assert!(warmth.into_iter().all(|t| (8.0..10.0).contains(t)));
}

#[test]
fn motions_are_read_by_their_ids() {
    for &motion in Motion::ALL {
        assert_eq!(motion.id().parse::<Motion>().unwrap(), motion);
    }
    let error = "spring".parse::<Motion>().unwrap_err().to_string();
    assert!(error.contains("spring") && error.contains("load_steps"));
}

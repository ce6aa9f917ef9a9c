use super::*;
use crate::bench::Hideable;

fn record(config: &ContactConfig) -> ContactRecording {
    ContactBench::new(config).unwrap().record()
}

fn hiding(hidden: HiddenEffect, strength: f64, seed: u64) -> ContactConfig {
    ContactConfig {
        seed,
        hidden: vec![hidden],
        strength,
        ..ContactConfig::default()
    }
}

/// Same configuration, same bytes; another seed, other bytes.
#[test]
fn a_seed_decides_everything() {
    let config = hiding(HiddenEffect::ContactSpot, 1.0, 4);
    let first = record(&config);
    assert_eq!(first, record(&config));
    assert_ne!(first, record(&ContactConfig { seed: 5, ..config }));
}

#[test]
fn logs_are_every_12_ms_and_dates_rise() {
    let recording = record(&ContactConfig::default());
    assert_eq!(recording.sessions.len(), 6);
    let starts = recording.sessions.windows(2);
    assert!(starts.into_iter().all(|pair| pair[0].start < pair[1].start));
    for session in &recording.sessions {
        let length = session.time.len();
        assert!((4000..20_000).contains(&length), "{length}");
        for channel in [&session.place, &session.tangential, &session.normal] {
            assert_eq!(channel.len(), length);
            assert!(channel.iter().all(|value| value.is_finite()));
        }
        assert!((session.time[1] - crate::bench::LOG_PERIOD).abs() < 1e-12);
        assert!(session.normal.iter().any(|force| *force > 20.0));
    }
}

#[test]
fn what_is_hidden_stands_out_and_nothing_hidden_does_not() {
    for &hidden in HiddenEffect::ALL {
        let full = record(&hiding(hidden, 1.0, 7)).visibility();
        let quarter = record(&hiding(hidden, 0.25, 7)).visibility();
        println!("{hidden}: {full:.1} {quarter:.1}");
        assert!(
            full > 2.0 && quarter < 0.7 * full,
            "{hidden}: {full} {quarter}"
        );
    }
    let nothing = record(&ContactConfig::default()).visibility();
    assert!(nothing < 0.7, "{nothing}");
}

#[test]
fn what_does_not_go_together_is_refused() {
    let config = ContactConfig {
        hidden: vec![
            HiddenEffect::ContactCoulomb,
            HiddenEffect::ContactCompliance,
        ],
        ..ContactConfig::default()
    };
    let error = ContactBench::new(&config).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("contact_compliance"), "{error}");
}

#[test]
fn every_id_reads_back() {
    for &effect in HiddenEffect::ALL {
        assert_eq!(effect.id().parse::<HiddenEffect>().unwrap(), effect);
        assert_eq!(effect.in_catalogue(), !effect.accepted().is_empty());
    }
    let error = "contact_magic".parse::<HiddenEffect>().unwrap_err();
    assert!(error.to_string().contains("contact_spot"), "{error}");
}

#[test]
fn more_sessions_come_later() {
    let bench = ContactBench::new(&ContactConfig::default()).unwrap();
    let recorded = bench.record();
    let last = recorded.sessions.last().unwrap().start;
    for &motion in Motion::ALL {
        let more = bench.follow_up(&recorded, motion, 2);
        assert!(
            more.iter()
                .all(|session| session.start > last && session.time.len() > 1000)
        );
        assert_eq!(motion.id().parse::<Motion>().unwrap(), motion);
    }
}

/// The largest difference between two channels.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let pairs = one.iter().zip(other);
    pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

fn less(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(a, b)| a - b).collect()
}

/// The way is given, so that the same bench with nothing hidden is what is left:
/// noise and nominal friction, and beside them the scatter of the recording.
#[test]
fn without_what_is_hidden_the_edge_is_the_plain_one() {
    for &hidden in HiddenEffect::ALL {
        let config = hiding(hidden, 0.5, 7);
        let recording = record(&config);
        let without = recording.without_hidden();
        assert!(without.hidden.is_empty() && without.believed.len() == 2);
        let nothing = match hidden {
            // Believed again, of the size that it has.
            HiddenEffect::ContactCoulomb | HiddenEffect::ContactViscous => recording.clone(),
            _ => record(&ContactConfig {
                hidden: vec![],
                ..config
            }),
        };
        let sessions = without.sessions.iter().zip(&recording.sessions);
        for ((after, before), plain) in sessions.zip(&nothing.sessions) {
            assert_eq!(after.truth.scatter, before.truth.scatter);
            assert_eq!((&after.place, &after.normal), (&plain.place, &plain.normal));
            let nominal = |own: &ContactSession| less(&own.truth.tangential, &own.truth.scatter);
            let noise = |own: &ContactSession| less(&own.tangential, &own.truth.tangential);
            assert!(apart(&nominal(after), &nominal(plain)) < 1e-9, "{hidden}");
            assert!(apart(&noise(after), &noise(plain)) < 1e-9, "{hidden}");
        }
        let (before, after) = (&recording.sessions, &without.sessions);
        let most = before.iter().zip(after).fold(0.0, |most, (before, after)| {
            f64::max(most, apart(&before.tangential, &after.tangential))
        });
        let is_believed = recording.believed.len() < 2;
        assert_eq!(most < 1e-9, is_believed, "{hidden}: {most}");
        assert!(is_believed || most > 0.3, "{hidden}: {most}");
    }
}

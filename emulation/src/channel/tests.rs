use super::*;
use proptest::prelude::*;

const MS: i64 = 1_000_000;
const NOW: i64 = 1_700_000_000_000_000_000;

fn channel(config: ChannelConfig, seed: u64) -> Channel {
    Channel::new(config, seed).unwrap()
}

/// Sends `count` numbered frames, one a `period` [ns]; what arrives, as
/// (number, sent, arrived), in order of arrival.
fn send(channel: &mut Channel, count: u32, period: i64) -> Vec<(u32, i64, i64)> {
    let mut arrived = Vec::new();
    let mut frame = [0; 64];
    let mut buffer = [0; LONGEST_FRAME];
    for k in 0..count {
        let now = NOW + i64::from(k) * period;
        frame[..4].copy_from_slice(&k.to_le_bytes());
        channel.push(now, &frame);
        while let Some((length, at)) = channel.pop(now, &mut buffer) {
            assert_eq!(length, 64);
            let number = u32::from_le_bytes(buffer[..4].try_into().unwrap());
            arrived.push((number, NOW + i64::from(number) * period, at));
        }
    }
    while let Some((_, at)) = channel.pop(i64::MAX, &mut buffer) {
        let number = u32::from_le_bytes(buffer[..4].try_into().unwrap());
        arrived.push((number, NOW + i64::from(number) * period, at));
    }
    arrived
}

fn delays(arrived: &[(u32, i64, i64)]) -> Vec<f64> {
    arrived
        .iter()
        .map(|(_, sent, at)| (at - sent) as f64 * 1e-9)
        .collect()
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    (mean, square.sqrt())
}

#[test]
fn a_direct_channel_is_transparent() {
    let arrived = send(&mut channel(ChannelConfig::default(), 1), 100, 2 * MS);
    assert_eq!(arrived.len(), 100);
    assert!(arrived.iter().all(|(_, sent, at)| sent == at));
}

#[test]
fn a_fixed_delay_is_exact_and_waits() {
    let mut channel = channel(ChannelConfig::with_delay(0.01), 1);
    let mut buffer = [0; 8];
    assert_eq!(channel.push(NOW, &[1, 2, 3]), Pushed::Accepted);
    assert_eq!(channel.pop(NOW + 10 * MS - 1, &mut buffer), None);
    assert_eq!(channel.next_ns(), Some(NOW + 10 * MS));
    assert_eq!(
        channel.pop(NOW + 12 * MS, &mut buffer),
        Some((3, NOW + 10 * MS))
    );
    assert_eq!(buffer[..3], [1, 2, 3]);
    assert_eq!(channel.in_flight(), 0);
}

#[test]
fn jitter_has_the_moments_of_its_distribution() {
    // Uniform ±w: deviation w/√3. Exponential: mean and deviation m.
    let cases = [
        (
            Jitter::Uniform { half_width: 3e-3 },
            0.02,
            3e-3 / 3f64.sqrt(),
        ),
        (Jitter::Normal { deviation: 2e-3 }, 0.02, 2e-3),
        (Jitter::Exponential { mean: 2e-3 }, 0.022, 2e-3),
    ];
    for (jitter, mean, deviation) in cases {
        let config = ChannelConfig {
            jitter: Some(jitter),
            overtaking: true,
            ..ChannelConfig::with_delay(0.02)
        };
        let count = 40_000;
        let arrived = send(&mut channel(config, 7), count, 2 * MS);
        assert_eq!(arrived.len(), count as usize);
        let found = mean_and_deviation(&delays(&arrived));
        // Five standard errors of the mean.
        let error = 5.0 * deviation / f64::from(count).sqrt();
        assert!((found.0 - mean).abs() < error, "{jitter:?}: {found:?}");
        assert!(
            (found.1 / deviation - 1.0).abs() < 0.04,
            "{jitter:?}: {found:?}"
        );
        // This much jitter does overtake.
        assert!(arrived.windows(2).any(|pair| pair[0].0 > pair[1].0));
    }
}

#[test]
fn without_overtaking_the_order_is_kept() {
    let config = ChannelConfig {
        jitter: Some(Jitter::Normal { deviation: 5e-3 }),
        ..ChannelConfig::with_delay(0.02)
    };
    let arrived = send(&mut channel(config, 3), 20_000, 2 * MS);
    assert!(arrived.windows(2).all(|pair| pair[0].0 < pair[1].0));
    assert!(delays(&arrived).iter().all(|delay| *delay >= 0.0));
}

#[test]
fn independent_loss_has_its_rate_and_no_memory() {
    let config = ChannelConfig {
        loss: Some(Loss::Independent { probability: 0.1 }),
        ..ChannelConfig::default()
    };
    let count = 50_000;
    let mut channel = channel(config, 11);
    let arrived = send(&mut channel, count, 2 * MS);
    let rate = 1.0 - arrived.len() as f64 / f64::from(count);
    // Five standard deviations of a binomial.
    let tolerance = 5.0 * (0.1 * 0.9 / f64::from(count)).sqrt();
    assert!((rate - 0.1).abs() < tolerance, "{rate}");
    let (bursts, lost) = bursts(&arrived, count);
    // Mean burst 1/(1 − p).
    assert!(
        (lost / bursts - 1.0 / 0.9).abs() < 0.03,
        "{}",
        lost / bursts
    );
    assert_eq!(channel.counts().lost, lost as u64);
}

#[test]
fn burst_loss_has_its_rate_and_length() {
    let loss = Loss::GilbertElliott {
        good_to_bad: 0.01,
        bad_to_good: 0.2,
        loss_in_good: 0.0,
        loss_in_bad: 1.0,
    };
    // 0.01 / 0.21 of the time, bursts of 1/0.2 frames.
    assert!((loss.mean() - 0.047619).abs() < 1e-6);
    let config = ChannelConfig {
        loss: Some(loss),
        ..ChannelConfig::default()
    };
    let count = 200_000;
    let arrived = send(&mut channel(config, 5), count, 2 * MS);
    let (bursts, lost) = bursts(&arrived, count);
    assert!(
        (lost / f64::from(count) / loss.mean() - 1.0).abs() < 0.12,
        "{lost}"
    );
    assert!((lost / bursts - 5.0).abs() < 0.5, "{}", lost / bursts);
}

/// Number of runs of lost frames, and of lost frames.
fn bursts(arrived: &[(u32, i64, i64)], count: u32) -> (f64, f64) {
    let mut here = vec![false; count as usize];
    for (number, _, _) in arrived {
        here[*number as usize] = true;
    }
    let starts = (0..here.len()).filter(|&k| !here[k] && (k == 0 || here[k - 1]));
    let lost = here.iter().filter(|own| !**own).count();
    (starts.count() as f64, lost as f64)
}

#[test]
fn reordering_and_duplication_have_their_rates() {
    let config = ChannelConfig {
        reordering: Some(Reordering {
            probability: 0.05,
            hold_back: 0.005,
        }),
        duplication: 0.02,
        ..ChannelConfig::with_delay(0.01)
    };
    let count = 50_000;
    let mut channel = channel(config, 23);
    let arrived = send(&mut channel, count, 2 * MS);
    let counts = channel.counts();
    let rate = |number: u64| number as f64 / f64::from(count);
    assert!((rate(counts.reordered) - 0.05).abs() < 0.005, "{counts:?}");
    assert!((rate(counts.duplicated) - 0.02).abs() < 0.004, "{counts:?}");
    assert_eq!(arrived.len() as u64, u64::from(count) + counts.duplicated);
    let held = delays(&arrived)
        .iter()
        .filter(|delay| **delay > 0.014)
        .count() as f64;
    assert!((held / arrived.len() as f64 - 0.05).abs() < 0.005);
    assert!(arrived.windows(2).any(|pair| pair[0].0 > pair[1].0));
}

#[test]
fn bandwidth_limits_rate_and_queue() {
    // 64 B at 128 kbit/s take 4 ms; one comes every 2 ms.
    let config = ChannelConfig {
        bandwidth: Some(Bandwidth {
            rate: 128e3,
            queue: 640,
            overhead: 0,
        }),
        ..ChannelConfig::with_delay(0.01)
    };
    let mut channel = channel(config, 1);
    let arrived = send(&mut channel, 5_000, 2 * MS);
    let span = (arrived[arrived.len() - 1].2 - arrived[0].2) as f64 * 1e-9;
    let rate = (arrived.len() - 1) as f64 * 64.0 * 8.0 / span;
    assert!((rate / 128e3 - 1.0).abs() < 1e-3, "{rate} bit/s");
    // Half is dropped; nothing waits longer than the queue (640 B, 40 ms) and itself.
    assert!((channel.counts().dropped as f64 / 5000.0 - 0.5).abs() < 0.01);
    let longest = delays(&arrived).into_iter().fold(0.0, f64::max);
    assert!((0.050..=0.0541).contains(&longest), "{longest} s");
}

#[test]
fn rokviss_uplink_just_carries_500_frames_a_second() {
    let config = ChannelConfig {
        bandwidth: Some(Bandwidth {
            rate: 256e3,
            queue: 640,
            overhead: 0,
        }),
        ..ChannelConfig::with_delay(0.008)
    };
    assert!((config.nominal_delay(64) - 0.010).abs() < 1e-15);
    let arrived = send(&mut channel(config, 1), 5_000, 2 * MS);
    assert!(arrived.iter().all(|(_, sent, at)| at - sent == 10 * MS));
}

#[test]
fn blackouts_come_when_they_are_due() {
    let config = ChannelConfig {
        blackout: vec![
            Blackout {
                start: 0.1,
                duration: 0.05,
                period: 0.0,
            },
            Blackout {
                start: 1.0,
                duration: 0.02,
                period: 0.5,
            },
        ],
        ..ChannelConfig::default()
    };
    let mut channel = channel(config, 1);
    let arrived = send(&mut channel, 3000, MS);
    let here: std::collections::HashSet<u32> = arrived.iter().map(|own| own.0).collect();
    let missing: Vec<u32> = (0..3000).filter(|k| !here.contains(k)).collect();
    let expected: Vec<u32> = (100..150)
        .chain(1000..1020)
        .chain(1500..1520)
        .chain(2000..2020)
        .chain(2500..2520)
        .collect();
    assert_eq!(missing, expected);
    assert_eq!(channel.counts().blackout, 130);
}

#[test]
fn what_does_not_fit_is_dropped_and_counted() {
    let mut channel = channel(ChannelConfig::with_delay(5.0), 1);
    assert_eq!(channel.push(NOW, &[0; 257]), Pushed::TooLong);
    for k in 0..CAPACITY {
        assert_eq!(channel.push(NOW + k as i64, &[0; 256]), Pushed::Accepted);
    }
    assert_eq!(channel.push(NOW + 5000, &[0; 256]), Pushed::Full);
    let mut short = [0; 10];
    assert_eq!(
        channel.pop(i64::MAX, &mut short),
        Some((10, NOW + 5000 * MS))
    );
    assert_eq!(channel.push(NOW + 5000, &[0; 256]), Pushed::Accepted);
    assert_eq!(channel.counts().dropped, 2);
}

#[test]
fn presets_are_what_they_say() {
    let presets = [
        (
            "direct",
            include_str!("../../../config/links/direct.toml"),
            0.0,
        ),
        (
            "rokviss_20ms",
            include_str!("../../../config/links/rokviss_20ms.toml"),
            0.020,
        ),
        (
            "rokviss_30ms",
            include_str!("../../../config/links/rokviss_30ms.toml"),
            0.030,
        ),
        (
            "kontur_2",
            include_str!("../../../config/links/kontur_2.toml"),
            0.025,
        ),
        (
            "relay_600ms",
            include_str!("../../../config/links/relay_600ms.toml"),
            0.600,
        ),
        (
            "ku_band_800ms",
            include_str!("../../../config/links/ku_band_800ms.toml"),
            0.800,
        ),
    ];
    for (name, text, round_trip) in presets {
        let link: LinkConfig =
            toml::from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        link.validate().unwrap();
        assert!(!link.description.is_empty(), "{name}");
        let nominal = link.nominal_round_trip(60);
        assert!((nominal - round_trip).abs() < 1e-9, "{name}: {nominal} s");
        // What comes through it, both ways, is that.
        let count = 20_000;
        let up = send(&mut channel(link.up.clone(), 1), count, 2 * MS);
        let down = send(&mut channel(link.down.clone(), 2), count, 2 * MS);
        let mean = mean_and_deviation(&delays(&up)).0 + mean_and_deviation(&delays(&down)).0;
        assert!((mean - round_trip).abs() < 2e-3, "{name}: {mean} s");
        let lost = 1.0 - up.len() as f64 / f64::from(count);
        assert!((lost - link.up.mean_loss()).abs() < 0.01, "{name}: {lost}");
    }
}

#[test]
fn wrong_configurations_are_named() {
    let wrong = [
        ("[up]\ndelay = -1.0\n[down]", "up.delay = -1 s"),
        (
            "[up]\n[down]\nloss = { kind = \"independent\", probability = 1.5 }",
            "down.loss.probability = 1.5",
        ),
        (
            "[up]\n[down]\nbandwidth = { rate = 1.0, queue = 640 }",
            "down.bandwidth.rate = 1 bit/s",
        ),
        (
            "[up]\n[[up.blackout]]\nstart = nan\nduration = 1\n[down]",
            "up.blackout[0].start",
        ),
    ];
    for (text, expected) in wrong {
        let link: LinkConfig = toml::from_str(text).unwrap();
        let error = link.validate().unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
        assert!(error.contains('…'), "{error}");
    }
    let unknown = toml::from_str::<LinkConfig>("[up]\ndely = 1.0\n[down]").unwrap_err();
    assert!(unknown.to_string().contains("dely"), "{unknown}");
    let nested = "[up]\nloss = { kind = \"independent\", probability = 0.1, brust = 2 }\n[down]";
    let unknown = toml::from_str::<LinkConfig>(nested).unwrap_err();
    assert!(unknown.to_string().contains("brust"), "{unknown}");
}

fn any_config() -> impl Strategy<Value = ChannelConfig> {
    let jitter = prop_oneof![
        (0.0..0.02f64).prop_map(|half_width| Jitter::Uniform { half_width }),
        (0.0..0.02f64).prop_map(|deviation| Jitter::Normal { deviation }),
        (0.0..0.02f64).prop_map(|mean| Jitter::Exponential { mean }),
    ];
    let jitter = proptest::option::of(jitter);
    let loss = (0.0..1.0f64).prop_map(|probability| Loss::Independent { probability });
    let loss = proptest::option::of(loss);
    let reordering = proptest::option::of((0.0..0.5f64).prop_map(|probability| Reordering {
        probability,
        hold_back: 0.004,
    }));
    let bandwidth = proptest::option::of((1e5..1e7f64).prop_map(|rate| Bandwidth {
        rate,
        queue: 640,
        overhead: 0,
    }));
    (
        0.0..0.1f64,
        jitter,
        any::<bool>(),
        loss,
        reordering,
        0.0..0.5f64,
        bandwidth,
    )
        .prop_map(
            |(delay, jitter, overtaking, loss, reordering, duplication, bandwidth)| ChannelConfig {
                delay,
                jitter,
                overtaking,
                loss,
                reordering,
                duplication,
                bandwidth,
                blackout: Vec::new(),
            },
        )
}

proptest! {
    /// Nothing is made up, nothing arrives before it was sent or out of turn,
    /// and everything is accounted for.
    #[test]
    fn every_frame_is_accounted_for(config in any_config(), seed: u64) {
        let mut own = channel(config.clone(), seed);
        let arrived = send(&mut own, 300, 2 * MS);
        prop_assert!(arrived.iter().all(|(_, sent, at)| at >= sent));
        prop_assert!(arrived.windows(2).all(|pair| pair[0].2 <= pair[1].2));
        let counts = own.counts();
        prop_assert_eq!(counts.pushed + counts.duplicated, counts.popped + counts.lost + counts.dropped);
        prop_assert_eq!(counts.popped, arrived.len() as u64);
        // Same seed, same bytes at the same times.
        prop_assert_eq!(send(&mut channel(config, seed), 300, 2 * MS), arrived);
    }
}

#[test]
fn a_delay_set_anew_is_reached_without_a_silence() {
    let mut channel = Channel::new(ChannelConfig::with_delay(0.010), 1).unwrap();
    let mut buffer = [0; LONGEST_FRAME];
    let (mut arrivals, mut ways) = (Vec::new(), Vec::new());
    for step in 0..2000_i64 {
        let now = step * 1_000_000;
        if step == 200 {
            channel.retune(0.300, 0.0, 0.0).unwrap();
        }
        if step % 2 == 0 {
            channel.push(now, &now.to_le_bytes());
        }
        while let Some((length, at)) = channel.pop(now, &mut buffer) {
            let sent = i64::from_le_bytes(buffer[..length].try_into().unwrap());
            arrivals.push(at);
            ways.push((at - sent) as f64 * 1e-9);
        }
    }
    let silence = arrivals.windows(2).map(|pair| pair[1] - pair[0]).max();
    // Frames every 2 ms, the way longer by half of that each.
    assert!(
        silence.is_some_and(|ns| (2_900_000..=3_100_000).contains(&ns)),
        "{silence:?}"
    );
    assert!((ways[0] - 0.010).abs() < 1e-9);
    assert!((ways.last().unwrap() - 0.300).abs() < 1e-9);
}

#[test]
fn jitter_and_loss_can_be_set_anew_and_bounds_hold() {
    let mut channel = Channel::new(ChannelConfig::with_delay(0.020), 7).unwrap();
    assert!(channel.retune(-0.001, 0.0, 0.0).is_err());
    assert!(channel.retune(f64::NAN, 0.0, 0.0).is_err());
    assert!(channel.retune(0.020, 0.0, 1.5).is_err());
    channel.retune(0.020, 0.005, 0.2).unwrap();
    let mut buffer = [0; LONGEST_FRAME];
    let mut ways = Vec::new();
    for step in 0..50_000_i64 {
        let now = step * 20_000_000;
        channel.push(now, &now.to_le_bytes());
        while let Some((_, at)) = channel.pop(now + 40_000_000, &mut buffer) {
            ways.push((at - now) as f64 * 1e-9);
        }
    }
    let loss = 1.0 - ways.len() as f64 / 50_000.0;
    // Four standard deviations of 50 000 draws: 4 √(0.2·0.8/50 000) = 0.0072.
    assert!((loss - 0.2).abs() < 0.0072, "{loss}");
    let (low, high) = ways
        .iter()
        .fold((1.0_f64, 0.0_f64), |(l, h), w| (l.min(*w), h.max(*w)));
    assert!(
        (0.015..0.0151).contains(&low) && (0.0249..=0.025).contains(&high),
        "{low} {high}"
    );
}

use super::*;
use crate::delay::Packet;
use crate::operating::OperatingState;
use proptest::prelude::*;

const NOW: i64 = 1_700_000_000_000_000_000;
const MS: i64 = 1_000_000;

fn frame(sequence: u32, sent_ns: i64) -> LinkFrame {
    LinkFrame {
        sequence,
        stamp_ns: sent_ns,
        sent_ns,
        echo: None,
        hold: false,
        state: OperatingState::Enabled,
        arming: 0,
        law: 0,
        pace: 0,
        since_content: 0,
        packet: Packet::default(),
        orientation: None,
    }
}

#[test]
fn round_trip_is_exact_whatever_the_clocks() {
    // Here sends at 0; there (clock 5 s ahead) it arrives after 13.000001 ms,
    // is held for 1.5 ms, and comes back after 7 ms.
    let (mut here, mut there) = (LinkMeter::new(), LinkMeter::new());
    let ahead = 5_000 * MS;
    there.synchronise(&mut frame(0, NOW), NOW + ahead + 13 * MS + 1);
    let back_at = NOW + ahead + 14 * MS + 500_001;
    let answer = LinkFrame {
        echo: there.echo(back_at),
        ..frame(0, back_at)
    };
    let arrived = back_at - ahead + 7 * MS;
    assert_eq!(here.received(&answer, arrived), Arrival::Newest);
    let measured = here.measure(arrived);
    assert_eq!(measured.round_trip, 0.020_000_001);
    // One way is only as good as the clocks.
    assert!((measured.delay - (0.007 - 5.0)).abs() < 1e-12);
}

#[test]
fn jitter_is_that_of_rfc_3550() {
    // Transits 10, 14, 10, 12 ms: |D| = 4, 4, 2 ms.
    let mut meter = LinkMeter::new();
    for (k, transit) in [10, 14, 10, 12].into_iter().enumerate() {
        let sent = NOW + 20 * MS * k as i64;
        meter.received(&frame(k as u32, sent), sent + transit * MS);
    }
    let mut expected = 0.0;
    for difference in [4.0, 4.0, 2.0] {
        expected += (difference - expected) / 16.0;
    }
    let jitter = meter.measure(NOW).jitter * 1e3;
    assert!(
        (jitter - expected).abs() < 1e-12,
        "{jitter} ms, not {expected} ms"
    );
}

#[test]
fn late_and_replayed_frames_are_told_apart_and_not_acted_on() {
    let mut meter = LinkMeter::new();
    let order = [0, 1, 4, 3, 3, 4, 5];
    let fates = order.map(|k| meter.received(&frame(k, NOW + i64::from(k)), NOW + 10 * MS));
    use Arrival::{Late, Newest, Replayed};
    assert_eq!(
        fates,
        [Newest, Newest, Newest, Late, Replayed, Replayed, Newest]
    );
    let measured = meter.measure(NOW + 10 * MS);
    assert_eq!(measured.lost, 1);
    assert_eq!(measured.loss, 1.0 / 6.0);
    assert_eq!((measured.refused.late, measured.refused.replayed), (1, 2));
    assert_eq!(measured.received, 4);
}

#[test]
fn a_sender_that_was_started_anew_is_heard() {
    let mut meter = LinkMeter::new();
    for k in 0..100 {
        let at = NOW + i64::from(k) * MS;
        meter.received(&frame(1000 + k, at), at);
    }
    let later = NOW + 2000 * MS;
    assert_eq!(meter.received(&frame(0, later), later), Arrival::Late);
    meter.restart(later, 0, MS);
    assert_eq!(meter.received(&frame(0, later), later), Arrival::Newest);
    assert_eq!(meter.measure(later).lost, 0);
}

#[test]
fn sequence_numbers_wrap() {
    let mut meter = LinkMeter::new();
    for k in 0..10u32 {
        let sequence = (u32::MAX - 4).wrapping_add(k);
        let arrival = meter.received(&frame(sequence, NOW + i64::from(k)), NOW + 1000);
        assert_eq!(arrival, Arrival::Newest);
    }
    assert_eq!(meter.measure(NOW + 1000).lost, 0);
}

#[test]
fn loss_slides_and_silence_is_total_loss() {
    let mut meter = LinkMeter::new();
    assert!(meter.measure(NOW).loss.is_nan());
    // Two seconds at 500 Hz: every tenth lost in the first, none in the second.
    for k in 0..1000u32 {
        if k % 10 != 5 || k >= 500 {
            let at = NOW + i64::from(k) * 2 * MS;
            meter.received(&frame(k, at), at);
        }
        if k == 499 {
            assert_eq!(meter.measure(NOW + 998 * MS).loss, 0.1);
        }
    }
    assert_eq!(meter.measure(NOW + 1998 * MS).loss, 0.0);
    assert_eq!(meter.measure(NOW + 1998 * MS).lost, 50);
    assert_eq!(meter.measure(NOW + 4000 * MS).loss, 1.0);
    assert!((meter.measure(NOW + 4000 * MS).silence - 2.002).abs() < 1e-9);
}

#[test]
fn a_gap_longer_than_the_memory_is_counted() {
    let mut meter = LinkMeter::new();
    meter.received(&frame(0, NOW), NOW);
    meter.received(&frame(1_000_000, NOW + MS), NOW + MS);
    assert_eq!(meter.measure(NOW + MS).lost, 999_999);
    meter.received(&frame(1_000_001, NOW + 2 * MS), NOW + 2 * MS);
    assert_eq!(meter.measure(NOW + 2 * MS).lost, 999_999);
}

proptest! {
    /// Against counting everything: any order, any loss, any repetition.
    #[test]
    fn counts_agree_with_plain_bookkeeping(order in proptest::collection::vec((0..300u32, 0..5i64), 1..400)) {
        let mut meter = LinkMeter::new();
        let mut seen = std::collections::BTreeMap::new();
        let (mut newest, mut now) = (None, NOW);
        let first = order[0].0;
        for (sequence, pause) in order {
            now += pause * MS;
            // All sent at one instant: no restart.
            let arrival = meter.received(&frame(sequence, NOW), now);
            let expected = match newest {
                Some(last) if seen.contains_key(&sequence) && sequence <= last => Arrival::Replayed,
                Some(last) if sequence < last => Arrival::Late,
                _ => Arrival::Newest,
            };
            prop_assert_eq!(arrival, expected);
            newest = newest.max(Some(sequence));
            if sequence >= first || arrival == Arrival::Newest {
                seen.insert(sequence, ());
            }
        }
        let last = newest.unwrap();
        let expected = (first..=last).filter(|k| !seen.contains_key(k)).count() as u64;
        let measured = meter.measure(now);
        prop_assert_eq!(measured.lost, expected);
        prop_assert!((0.0..=1.0).contains(&measured.loss));
    }
}

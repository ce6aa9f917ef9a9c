use super::*;
use proptest::prelude::*;

const NOW: i64 = 1_700_000_000_000_000_000;
const MS: i64 = 1_000_000;
const A: u64 = 0xa;
const B: u64 = 0xb;

fn enabled() -> Master {
    let mut master = Master::new(&MasterConfig::default()).unwrap();
    master.command(StateCommand::Enable).unwrap();
    master
}

fn hand(stamp_ns: i64, source: u64, x: f64) -> HandCommand {
    HandCommand {
        stamp_ns,
        source,
        position: [x, 0.0, 0.0],
        orientation: None,
    }
}

#[test]
fn each_fault_has_its_own_reason() {
    let mut master = enabled();
    master.offer(NOW, &hand(NOW, A, 0.0)).unwrap();
    let now = NOW + 2 * MS;
    for (command, expected) in [
        (hand(0, A, 0.0), "StampZero"),
        (hand(NOW, A, 0.0), "StampBackwards"),
        (hand(NOW - 200 * MS, A, 0.0), "TooOld"),
        (hand(NOW + 100 * MS, A, 0.0), "FromFuture"),
        (hand(now, A, f64::NAN), "NotFinite"),
        (hand(now, A, 0.13), "OutOfRange"),
        (hand(now, A, 0.05), "Jump"),
        (hand(now, B, 0.0), "NotAuthorised"),
    ] {
        let refusal = master.offer(now, &command).unwrap_err();
        assert!(format!("{refusal:?}").starts_with(expected), "{refusal:?}");
    }
    let counts = master.refusals();
    assert_eq!((counts.invalid, counts.time), (3, 2));
    assert_eq!(
        (counts.out_of_range, counts.jump, counts.unauthorised),
        (1, 1, 1)
    );
    master.command(StateCommand::Pause).unwrap();
    assert!(matches!(
        master.offer(now, &hand(now, A, 0.0)),
        Err(HandRefusal::NotEnabled { .. })
    ));
}

#[test]
fn bursts_of_real_hands_pass() {
    // 3 m/s, as recorded, with 1 ms between samples.
    let mut master = enabled();
    for k in 0..20 {
        let now = NOW + k * MS;
        master.offer(now, &hand(now, A, 0.003 * k as f64)).unwrap();
    }
    let output = master.step(NOW + 19 * MS, 1e-3, None);
    let speed = output.hand.unwrap().velocity[0];
    // 1 − exp(−19/10) of 3 m/s.
    assert!(
        (speed - 3.0 * (1.0 - (-1.9_f64).exp())).abs() < 1e-9,
        "{speed}"
    );
}

#[test]
fn one_source_holds_until_it_is_silent_or_disabled() {
    let mut master = enabled();
    // A broken first command takes no authority.
    assert!(master.offer(NOW, &hand(NOW, B, f64::NAN)).is_err());
    assert_eq!(master.authority().holder(), None);
    master.offer(NOW, &hand(NOW, A, 0.0)).unwrap();
    for k in 1..=1000 {
        let now = NOW + k * MS;
        let refusal = master.offer(now, &hand(now, B, 0.0)).unwrap_err();
        assert!(matches!(refusal, HandRefusal::NotAuthorised(_)));
        master.step(now, 1e-3, None);
    }
    assert_eq!(master.authority().refused_count(), 1000);
    assert_eq!(master.authority().refused(), Some(B));
    let now = NOW + 1001 * MS;
    master.offer(now, &hand(now, B, 0.1)).unwrap();
    assert_eq!(master.authority().holder(), Some(B));
    master.command(StateCommand::Disable).unwrap();
    assert_eq!(master.authority().holder(), None);
    master.command(StateCommand::Enable).unwrap();
    master.offer(now, &hand(now, A, -0.1)).unwrap();
    assert_eq!(master.authority().holder(), Some(A));
}

#[test]
fn a_silent_or_paused_hand_gets_no_force() {
    let mut master = enabled();
    let reflected = Some([5.0, 0.0, 0.0]);
    assert_eq!(master.step(NOW, 1e-3, reflected).force, [0.0; 3]);
    for k in 0..=50 {
        let now = NOW + k * MS;
        master.offer(now, &hand(now, A, 0.0)).unwrap();
        let output = master.step(now, 1e-3, reflected);
        assert!(output.fresh);
        if k > 10 {
            assert!((output.force[0] - 5.0).abs() < 1e-9);
        }
    }
    let last = NOW + 50 * MS;
    let output = master.step(last + 25 * MS, 1e-3, reflected);
    assert!(output.hand.is_some() && !output.fresh);
    let output = master.step(last + 26 * MS, 1e-3, reflected);
    assert_eq!((output.force, output.hand), ([0.0; 3], None));
    // It comes back no faster than 1000 N/s.
    let now = last + 30 * MS;
    master.offer(now, &hand(now, A, 0.0)).unwrap();
    let output = master.step(now, 1e-3, reflected);
    assert!((output.force[0] - 1.0).abs() < 1e-9 && output.force_limited);
    master.command(StateCommand::Pause).unwrap();
    let output = master.step(now, 1e-3, reflected);
    assert_eq!(
        (output.force, output.state),
        ([0.0; 3], OperatingState::Paused)
    );
}

proptest! {
    #[test]
    fn whatever_is_offered_the_hand_is_finite_and_inside(
        offers in proptest::collection::vec((any::<i64>(), 0..3u64, proptest::array::uniform3(any::<f64>())), 0..50),
        near in proptest::collection::vec((0..90i64, 0..3u64, proptest::array::uniform3(-0.2..0.2f64)), 0..50),
    ) {
        let mut master = enabled();
        let near = near.into_iter().map(|(age, source, position)| (NOW - age * MS, source, position));
        for (stamp_ns, source, position) in offers.into_iter().chain(near) {
            let _ = master.offer(NOW, &HandCommand { stamp_ns, source, position, orientation: None });
            if let Some(hand) = master.step(NOW, 1e-3, None).hand {
                prop_assert!(hand.position.iter().all(|value| value.abs() <= 0.12));
                prop_assert!(hand.velocity.iter().all(|value| value.is_finite()));
            }
        }
    }
}

/// A hand that goes on while the clutch is open: the arm stays, the force is gone, and it goes on
/// from there.
#[test]
fn the_clutch_takes_hand_and_arm_apart_and_together_without_a_step() {
    let mut master = enabled();
    let (mut led, mut force) = (None, [0.0; 3]);
    for ms in 0..600_i64 {
        let now = NOW + ms * 1_000_000;
        match ms {
            200 => master.set_clutch(true).unwrap(),
            // A hold in between does not close it.
            300 => master.command(StateCommand::Pause).unwrap(),
            301 => master.command(StateCommand::Resume).unwrap(),
            400 => master.set_clutch(false).unwrap(),
            _ => {}
        }
        // 0.1 m/s.
        let _ = master.offer(now, &hand(now, A, 1e-4 * ms as f64));
        let step = master.step(now, 1e-3, Some([2.0, 0.0, 0.0]));
        let Some(now) = step.hand.map(|own| own.position[0]) else {
            assert_eq!(ms, 300);
            continue;
        };
        let before = led.replace(now).unwrap_or(now);
        let open = (200..400).contains(&ms);
        assert_eq!(step.clutched, open, "{ms}");
        let wanted = match open || ms == 400 {
            true if ms > 200 => 0.0,
            _ => 1e-4,
        };
        assert!(ms == 0 || (now - before - wanted).abs() < 1e-12, "{ms} ms");
        if open {
            assert_eq!(step.force[0], 0.0_f64.max(force[0] - 1.0), "{ms} ms");
        }
        force = step.force;
    }
    // All of the force in the end, and the hand 20 mm ahead.
    assert!((force[0] - 2.0).abs() < 1e-9);
    assert!((led.unwrap() - 0.0399).abs() < 1e-9);
    // Until it is disabled.
    master.command(StateCommand::Disable).unwrap();
    assert!(master.set_clutch(true).is_err());
}

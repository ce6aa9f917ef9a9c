use super::*;
use crate::delay::{Motion, Parameters, Received};

const DT: f64 = 1e-3;

fn received(age: f64, round_trip: f64) -> Option<Received> {
    Some(Received {
        packet: Packet::new([0.0; 3], [0.0; 3], Energy::default()),
        fresh: true,
        silence: 0.0,
        age,
        round_trip,
    })
}

/// Each second packet is too old, and the tip is measured 5 mm ahead of where it was told
/// to be, as with a wrong torque sensor.
#[test]
fn packets_that_are_now_and_then_too_old_lead_nothing_astray() {
    let law = PositionPosition {
        longest_round_trip: 0.1,
        ..PositionPosition::default()
    };
    let mut follower = law.follower();
    let offset = Vector3::from(law.workspace_offset);
    let mut at = offset;
    for step in 0..2000 {
        let age = if step % 2 == 0 { 0.01 } else { 0.1 };
        let input = FollowerInput {
            tip: Some(Motion {
                position: (at + Vector3::new(0.0, 0.005, 0.0)).into(),
                velocity: [0.0; 3],
            }),
            contact_force: None,
            received: received(age, 0.02),
            connected: true,
        };
        let output = follower.step(DT, &input, Energy::default());
        assert_eq!(output.command.is_some(), step % 2 == 0);
        at = output.command.map_or(at, |own| Vector3::from(own.position));
    }
    // It began at the measured tip, and has gone where the hand is.
    assert!((at - offset).norm() < 1e-4, "{at}");
}

/// Force on a hand at 0.1 m/s that is where the tip is, by its speed: B \[N·s/m\].
fn damping(leader: &mut PositionPositionLeader, age: f64, round_trip: f64) -> f64 {
    let hand = Motion {
        position: [0.0; 3],
        velocity: [0.1, 0.0, 0.0],
    };
    let mut received = received(age, round_trip);
    if let Some(own) = &mut received {
        own.packet.position = leader.parameters.workspace_offset.map(|part| part as f32);
    }
    let input = LeaderInput {
        hand: Some(hand),
        received,
        connected: true,
    };
    -leader.step(DT, &input, Energy::default()).force[0] / 0.1
}

#[test]
fn the_damping_is_that_of_the_round_trip_that_was_measured() {
    let law = PositionPosition::default();
    for round_trip in [0.002, 0.1, 0.6, 1.0] {
        let mut leader = law.leader();
        let found = damping(&mut leader, 0.5 * round_trip, round_trip);
        // ½ K (T₁ + T₂) + b, and 2 N·s/m for frames that are lost.
        let needed = 0.5 * law.stiffness * round_trip + law.damping;
        assert!(
            (0.0..=2.01).contains(&(found - needed)),
            "{round_trip} s: {found}"
        );
    }
}

#[test]
fn it_follows_a_longer_delay_at_once_and_a_shorter_one_slowly() {
    let law = PositionPosition::default();
    let mut leader = law.leader();
    let near = damping(&mut leader, 0.01, 0.02);
    // The way back has become longer; the other end does not know yet.
    let far = damping(&mut leader, 0.3, 0.02);
    assert!(
        (far - near - 0.5 * law.stiffness * 0.58).abs() < 1e-6,
        "{near} {far}"
    );
    let mut last = far;
    for _ in 0..5000 {
        let now = damping(&mut leader, 0.01, 0.02);
        assert!(now <= last);
        last = now;
    }
    let left = (last - near) / (far - near);
    assert!((0.3..0.45).contains(&left), "{left}");
}

#[test]
fn what_the_other_end_cannot_know_of_yet_is_not_acted_on() {
    let law = PositionPosition::default();
    let mut delay = law.delay();
    assert!(delay.step(DT, received(0.2, 0.4)).is_some());
    // 0.3 s longer, forth or back: known there at the earliest when it was measured here.
    let waited = (0..1000)
        .find(|_| delay.step(DT, received(0.5, 0.7)).is_some())
        .expect("followed");
    assert!((550..700).contains(&waited), "{waited} ms");
    // Beyond what the law is for.
    assert!((0..5000).all(|_| delay.step(DT, received(2.0, 4.0)).is_none()));
}

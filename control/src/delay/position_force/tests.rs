//! The law between a hand with an impedance and a contact with a stiffness.

use super::*;
use crate::delay::POSITION_LIMIT;
use crate::delay::{Law, Motion, Received, bounded};
use std::collections::VecDeque;

const DT: f64 = 1e-3;

/// A hand of 1 kg, 20 N·s/m, 300 N/m about a target, an ideal arm, a contact of
/// `stiffness` \[N/m\] at x = 0, `delay` steps each way. Returns the amplitude of
/// the hand's motion in the last of `seconds`, and both ends.
struct Loop {
    amplitude: f64,
    end: f64,
    leader: crate::delay::LeaderEnd,
    follower: crate::delay::FollowerEnd,
}

fn run(stiffness: f64, delay: usize, seconds: usize) -> Loop {
    let law = Law::PositionForce(PositionForce {
        force_scale: 1.0,
        workspace_offset: [0.0; 3],
        force_ramp: 0.001,
        ..PositionForce::default()
    });
    let (mut leader, mut follower) = (law.leader(), law.follower());
    let mut up: VecDeque<Packet> = std::iter::repeat_n(Packet::default(), delay).collect();
    let mut down = up.clone();
    let (mut x, mut v, mut tip) = (-0.01_f64, 0.0, -0.01_f64);
    let target = 0.02;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let arrived = |packet: Packet| {
        Some(Received {
            packet,
            fresh: true,
            silence: 0.0,
            age: 0.0,
            round_trip: 0.0,
        })
    };
    let steps = seconds * 1000;
    for k in 0..steps {
        let hand = Some(Motion {
            position: [x, 0.0, 0.0],
            velocity: [v, 0.0, 0.0],
        });
        let output = leader.step(
            DT,
            &LeaderInput {
                hand,
                received: down.pop_front().and_then(arrived),
                connected: true,
            },
        );
        up.push_back(output.packet);
        let contact = [-stiffness * tip.max(0.0), 0.0, 0.0];
        let back = follower.step(
            DT,
            &FollowerInput {
                tip: Some(Motion {
                    position: [tip, 0.0, 0.0],
                    ..Motion::default()
                }),
                contact_force: Some(contact),
                received: up.pop_front().and_then(arrived),
                connected: true,
            },
        );
        down.push_back(back.packet);
        if let Some(command) = back.command {
            tip = command.position[0];
        }
        let acceleration = 300.0 * (target - x) - 20.0 * v + output.force[0];
        v += acceleration * DT;
        // A hand reaches no further than its workspace.
        x = (x + v * DT).clamp(-0.5, 0.5);
        if k >= steps - 1000 {
            (low, high) = (low.min(x), high.max(x));
        }
    }
    Loop {
        amplitude: high - low,
        end: x,
        leader,
        follower,
    }
}

#[test]
fn a_soft_spring_without_delay_settles_where_forces_balance() {
    let result = run(100.0, 1, 5);
    assert!(result.amplitude < 1e-5, "{}", result.amplitude);
    // 300 (0.02 − x) = 100 x.
    assert!((result.end - 0.015).abs() < 1e-4, "{}", result.end);
}

#[test]
fn a_stiff_wall_beyond_a_long_delay_is_unstable() {
    let result = run(2000.0, 50, 5);
    assert!(result.amplitude > 0.02, "{}", result.amplitude);
    // The two-port made energy: more came out than went in.
    let made = -(result.leader.energy().balance() + result.follower.energy().balance());
    assert!(made > 0.1, "{made} J");
}

#[test]
fn a_soft_spring_is_stable_at_any_delay_by_small_gain() {
    // min |k − mω² + jbω| for m = 1, b = 20, k = 300 is b √(k/m − b²/4m²) = 283 N/m.
    let limit = 20.0 * (300.0_f64 - 100.0).sqrt();
    for delay in [10, 50, 150, 300] {
        let result = run(0.8 * limit, delay, 30);
        assert!(result.amplitude < 1e-3, "{delay} ms: {}", result.amplitude);
    }
    // Just above it some delay is not.
    let worst = [100, 130, 160, 200, 250]
        .map(|delay| run(2.0 * limit, delay, 30).amplitude)
        .into_iter()
        .fold(0.0, f64::max);
    assert!(worst > 5e-3, "{worst}");
}

fn received(silence: f64, fresh: bool, force: f32) -> Option<Received> {
    Some(Received {
        packet: Packet {
            valid: true,
            position: [0.01, 0.02, 0.0],
            vector: [force, 0.0, 0.0],
            ..Packet::default()
        },
        fresh,
        silence,
        age: silence + 0.3,
        round_trip: 0.6,
    })
}

#[test]
fn the_force_ramps_to_zero_on_loss_and_back() {
    let law = PositionForce {
        force_scale: 0.2,
        ..PositionForce::default()
    };
    let mut leader = PositionForceLeader::new(&law);
    let mut step = |silence: f64, connected: bool| {
        leader
            .step(
                DT,
                &LeaderInput {
                    hand: None,
                    received: received(silence, false, 10.0),
                    connected,
                },
                Energy::default(),
            )
            .force[0]
    };
    for _ in 0..300 {
        step(0.001, true);
    }
    // A scale of 0.2, whatever the age since it was sent.
    assert!((step(0.025, true) - 2.0).abs() < 1e-9);
    let mut before = 2.0;
    for k in 0..200 {
        let force = step(0.026 + f64::from(k) * DT, true);
        assert!(force < before && before - force < 0.0101, "{force}");
        before = force;
    }
    assert!(before.abs() < 1e-9);
    for _ in 0..100 {
        step(0.001, true);
    }
    assert!((step(0.001, true) - 1.01).abs() < 1e-9);
    assert!(step(0.001, false) < 1.01);
}

#[test]
fn the_follower_commands_once_a_packet_and_never_an_old_one() {
    let mut follower = PositionForceFollower::new(&PositionForce::default());
    let mut step = |received, connected| {
        follower
            .step(
                DT,
                &FollowerInput {
                    received,
                    connected,
                    ..FollowerInput::default()
                },
                Energy::default(),
            )
            .command
    };
    let command = step(received(0.0, true, 0.1), true).unwrap();
    assert!((command.position[0] - 0.36355).abs() < 1e-7);
    assert!((command.velocity[0] - 0.1).abs() < 1e-7);
    assert_eq!(step(received(0.001, false, 0.1), true), None);
    assert_eq!(step(received(0.026, true, 0.1), true), None);
    assert_eq!(step(received(0.0, true, 0.1), false), None);
    assert_eq!(step(None, true), None);
    let mut invalid = received(0.0, true, 0.1);
    invalid.as_mut().unwrap().packet.valid = false;
    assert_eq!(step(invalid, true), None);
}

#[test]
fn nothing_leaves_that_a_frame_would_refuse() {
    let values = bounded([f64::NAN, f64::INFINITY, -1e300], POSITION_LIMIT);
    assert_eq!(values, [0.0, POSITION_LIMIT, -POSITION_LIMIT]);
}

#[test]
fn parameters_out_of_bounds_are_named() {
    let law = PositionForce {
        deadline: 0.5,
        ..PositionForce::default()
    };
    let error = law.validate().unwrap_err();
    assert_eq!(error.key(), "deadline");
    assert!(error.to_string().contains("0.03"), "{error}");
}

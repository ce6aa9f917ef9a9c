use ferntast_control::delay::PositionForce;
use ferntast_emulation::channel::ChannelConfig;

use super::*;

fn link(round_trip: f64) -> LinkConfig {
    let one_way = ChannelConfig::with_delay(0.5 * round_trip);
    LinkConfig {
        up: one_way.clone(),
        down: one_way,
        ..LinkConfig::default()
    }
}

fn position_force() -> Law {
    Law::PositionForce(PositionForce {
        force_scale: 1.0,
        ..PositionForce::default()
    })
}

fn run(round_trip: f64, environment: Environment) -> Outcome {
    Trial::new(position_force(), link(round_trip), environment, 1)
        .run()
        .unwrap()
}

#[test]
fn a_free_tip_follows_without_force_whatever_the_delay() {
    for round_trip in [0.0, 0.6] {
        let outcome = run(round_trip, Environment::Free);
        assert!(outcome.stable, "{outcome:?}");
        assert_eq!(outcome.peak_force, 0.0);
        assert!(outcome.drift < 1e-4, "{outcome:?}");
        // The servo lags by 2 ζ/ω = 13 ms, the hand reaches 0.11 m/s.
        assert!((1e-5..1e-3).contains(&outcome.position_rmse), "{outcome:?}");
        assert_eq!(outcome.transparency, None);
    }
}

#[test]
fn a_soft_spring_is_felt_as_it_is() {
    // 100 N/m behind 6750 N/m of the servo, by a hand of 300 N/m: small gain.
    for round_trip in [0.0, 0.3] {
        let outcome = run(round_trip, Environment::SoftSpring);
        assert!(outcome.stable, "{outcome:?}");
        let transparency = outcome.transparency.unwrap();
        // Force is passed as it is, the tip's depth is less by the servo's give.
        assert!(
            (transparency - 6750.0 / 6850.0).abs() < 0.005,
            "{outcome:?}"
        );
        assert!(outcome.task_time.is_some(), "{outcome:?}");
    }
}

#[test]
fn a_hard_wall_behind_a_delay_is_unstable_with_position_force() {
    let outcome = run(0.1, Environment::HardWall);
    assert!(!outcome.stable, "{outcome:?}");
    assert!(outcome.energy_margin < -0.1, "{outcome:?}");
}

#[test]
fn the_same_trial_gives_the_same_outcome() {
    let mut link = link(0.05);
    link.up.loss = Some(ferntast_emulation::channel::Loss::Independent { probability: 0.2 });
    let run = |seed| {
        Trial::new(
            position_force(),
            link.clone(),
            Environment::SoftSpring,
            seed,
        )
        .run()
        .unwrap()
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
}

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

/// Balance of the leader's port less the work that the hand did \[J\]: the largest at any
/// moment, with a force that changes by `rate` \[N/s\] at most; and by how much at most that
/// changed the force \[N\].
fn error_of_the_meter(law: Law, rate: f64) -> (f64, f64) {
    let name = law.name();
    let trial = Trial {
        master: Some(MasterConfig {
            force_rate_limit: rate,
            ..MasterConfig::default()
        }),
        ..Trial::new(law, link(0.1), Environment::HardWall, 1)
    };
    let free = Trial {
        master: None,
        ..trial.clone()
    };
    let schedule = Schedule::new(Task::PressAndSlide, 0.1);
    let mut run = Run::new(&trial, schedule, trial.own_arm().expect(name)).expect(name);
    let mut unlimited = Run::new(&free, schedule, free.own_arm().expect(name)).expect(name);
    let (mut worst, mut bit) = (0.0_f64, 0.0_f64);
    for k in 0..5000 {
        let (own, other) = (run.step(k), unlimited.step(k));
        bit = bit.max((own.felt[0] - other.felt[0]).abs());
        let balance = run.leader.state(START_NS + k * TICK_NS).energy.balance();
        worst = worst.max((balance - run.hand_work).abs());
    }
    (worst, bit)
}

#[test]
fn the_meter_counts_the_force_that_the_limiter_left() {
    let mut limited = 0;
    for law in Law::all() {
        let name = law.name();
        let keys = format!("kind = \"{name}\"\nforce_scale = 1.0");
        let law = toml::from_str(&keys).expect("keys of the law");
        let (error, bit) = error_of_the_meter(law, 100.0);
        println!("{name}: the limit takes {bit:.2} N, the meter is off by {error:.1e} J");
        limited += usize::from(bit > 1.0);
        // The meter's sums are those of the hand's work: rounding alone.
        assert!(error < 1e-9, "{name}: the meter is off by {error:.3} J");
    }
    assert!(limited >= 4, "the limit bit with {limited} laws only");
}

/// On the whole arm at s_F = 0.05 over 20 ms, with and without a deadband: force on the hand tick
/// by tick, and what was sent.
fn felt(law: &Law, environment: Environment, deadband: Option<Deadband>) -> (Vec<f64>, Traffic) {
    let text = include_str!("../../../config/arms/rokviss.toml");
    let arm = ArmUnderTrial {
        arm: toml::from_str(text).expect("the shipped arm"),
        servo: ferntast_control::servo::ServoConfig::default(),
    };
    let trial = Trial {
        follower: FollowerModel::Arm(Box::new(arm)),
        master: Some(MasterConfig::default()),
        deadband,
        ..Trial::new(law.clone(), link(0.02), environment, 1)
    };
    let schedule = Schedule::new(trial.task, 0.02);
    let mut run = Run::new(&trial, schedule, trial.own_arm().unwrap()).unwrap();
    let ticks = (schedule.end / TICK) as i64;
    let felt = (0..ticks).map(|k| {
        let [x, y] = run.step(k).felt;
        x.hypot(y)
    });
    (felt.collect(), run.traffic(schedule.end))
}

/// The goal: a tenth of the frames have content, and for 95 % of the time the force is within a
/// just noticeable difference, 10 %, of what it is without; what is below 0.05 N is not felt at all.
/// Where energies are told some more has to be sent; what tanks let through on a soft spring goes by
/// so little that a tenth less of the time is alike.
#[test]
fn the_deadband_is_not_felt() {
    let mut all_told = Vec::new();
    let mut fine = true;
    // On a hard wall the others bounce, with every frame: nothing to compare with.
    for (name, environment, least, most) in [
        ("position_force", Environment::SoftSpring, 0.95, 0.1),
        ("position_position", Environment::SoftSpring, 0.95, 0.1),
        ("tdpa", Environment::SoftSpring, 0.95, 0.1),
        ("model_mediated", Environment::SoftSpring, 0.95, 0.1),
        ("model_mediated", Environment::HardWall, 0.95, 0.1),
        ("two_layer", Environment::SoftSpring, 0.9, 0.15),
        ("two_layer", Environment::HardWall, 0.95, 0.1),
    ] {
        let law = Law::by_name(name).unwrap();
        let (before, all) = felt(&law, environment, None);
        let (after, few) = felt(&law, environment, Some(Deadband::default()));
        let alike = |(a, b): &(&f64, &f64)| (*a - *b).abs() <= (0.1 * *a).max(0.05);
        let count = before.iter().zip(&after).filter(alike).count();
        let share = count as f64 / before.len() as f64;
        assert_eq!((all.frame_share(), all.byte_share()), (1.0, 1.0));
        assert!(
            before.iter().any(|own| *own > 0.1),
            "{name}: nothing to feel"
        );
        fine &= share >= least && few.content_share() <= most;
        all_told.push(format!(
            "{name} {}: {:.1} % alike, content {:.1} %, frames {:.1} %, bytes {:.1} %",
            environment.name(),
            1e2 * share,
            1e2 * few.content_share(),
            1e2 * few.frame_share(),
            1e2 * few.byte_share()
        ));
    }
    println!("{all_told:#?}");
    assert!(fine, "{all_told:#?}");
}

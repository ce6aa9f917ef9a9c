use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use ferntast_control::delay::Law;
use ferntast_sim::teleoperation::{Environment, Task};

use super::*;
use crate::shard::{Shard, values};

fn small() -> SweepConfig {
    let mut config = SweepConfig::load("delay_sweep").unwrap();
    config.laws.retain(|law| law.name() == "position_force");
    config.environments = vec![Environment::SoftSpring, Environment::HardWall];
    config.rtt_ms = vec![0.0, 300.0];
    config.tasks = vec![Task::PressAndSlide];
    config.arm = None;
    config
}

#[test]
fn the_shipped_sweep_holds_every_law_and_what_it_has_to() {
    let config = SweepConfig::load("delay_sweep").unwrap();
    let laws: Vec<&str> = config.laws.iter().map(Law::name).collect();
    assert_eq!(laws, Law::NAMES);
    for rtt in [0.0, 20.0, 100.0, 300.0, 600.0, 700.0, 800.0, 1000.0, 2000.0] {
        assert!(config.rtt_ms.contains(&rtt), "{rtt}");
    }
    assert_eq!(config.environments, Environment::ALL);
    assert_eq!(config.tasks, Task::ALL);
    assert_eq!(config.arm.as_deref(), Some("rokviss"));
    // Compared at the same scales.
    let scales = config.laws.iter().map(|law| law.mapping().force_scale);
    assert!(scales.into_iter().all(|scale| scale == 1.0));
}

#[test]
fn conditions_without_chance_need_one_seed() {
    let config = small();
    let conditions = config.conditions();
    // 2 environments × 2 delays × (1 without chance + 3 with, of two seeds).
    assert_eq!(conditions.len(), 2 * 2 * (1 + 3 * 2));
    for own in &conditions {
        let link = own.link();
        assert_eq!(link.up, link.down);
        assert!((2e3 * link.up.delay - own.rtt_ms).abs() < 1e-9);
        assert_eq!(link.up.mean_loss(), own.loss);
    }
}

#[test]
fn rows_are_the_same_again_and_tell_where_position_force_fails() {
    let config = small();
    let done = AtomicUsize::new(0);
    let count = || {
        done.fetch_add(1, Ordering::Relaxed);
    };
    let rows = values(run(&config, Shard::WHOLE, &go_on(), count).unwrap());
    assert_eq!(rows.len(), done.into_inner());
    assert_eq!(rows, all_of(&config));
    let found = largest_stable(&rows);
    let of = |environment| found.iter().find(|own| own.environment == environment);
    let (spring, wall) = (of("soft_spring").unwrap(), of("hard_wall").unwrap());
    // 100 N/m by a hand of 300 N/m: small gain, stable whatever the delay. A wall
    // of 20 kN/m behind the servo's 6.75 kN/m is far beyond it.
    assert_eq!(spring.ideal_ms, Some(300.0));
    assert_eq!(wall.ideal_ms.filter(|rtt| *rtt >= 300.0), None);
    let told = table(&rows);
    assert!(
        told.contains("hard_wall") && told.contains("position_force"),
        "{told}"
    );
}

fn go_on() -> AtomicBool {
    AtomicBool::new(false)
}

fn all_of(config: &SweepConfig) -> Vec<Row> {
    values(run(config, Shard::WHOLE, &go_on(), || {}).unwrap())
}

fn row(rtt_ms: f64, loss: f64, stable: bool) -> Row {
    let config = small();
    let condition = Condition {
        rtt_ms,
        loss,
        ..config.conditions().remove(0)
    };
    let outcome = Bench::new(&config).unwrap().run(&condition).unwrap();
    Row {
        stable,
        ..Row::new(&condition, &outcome)
    }
}

#[test]
fn stable_beyond_an_unstable_delay_does_not_count() {
    let rows = [
        row(0.0, 0.0, true),
        row(0.0, 0.5, true),
        row(20.0, 0.0, true),
        row(20.0, 0.5, false),
        row(100.0, 0.0, false),
        row(300.0, 0.0, true),
    ];
    let found = largest_stable(&rows);
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].ideal_ms, found[0].worst_ms),
        (Some(20.0), Some(0.0))
    );
    assert_eq!(largest_stable(&rows[4..])[0].ideal_ms, None);
}

#[test]
fn json_has_the_keys_and_the_page_is_whole_in_itself() {
    let rows = [row(20.0, 0.0, true)];
    let value = serde_json::to_value(&rows).unwrap();
    for key in [
        "law",
        "rtt_ms",
        "environment",
        "stable",
        "position_rmse_m",
        "force_rmse_N",
        "drift_mm",
        "peak_force_N",
        "true_energy_J",
        "jitter_ms",
        "buffer_ms",
        "loss",
        "seed",
        "transparency",
        "task_time_s",
        "task",
        "done",
        "felt_stiffness_N_per_m",
        "true_stiffness_N_per_m",
        "force_step_N_per_ms",
        "drag_N_s_per_m",
        "held_s",
    ] {
        assert!(value[0].get(key).is_some(), "{key}");
    }
    let mut config = small();
    config.description = "</script><b>".to_owned();
    let page = render(&config, &rows).unwrap();
    assert!(!page.contains("@DATA@") && !page.contains("@STYLE@"));
    assert!(!page.contains("</script><b>"));
    assert!(!page.contains("http"), "an address");
}

#[test]
fn values_out_of_bounds_are_refused() {
    let mut config = small();
    config.loss = vec![1.5];
    assert!(run(&config, Shard::WHOLE, &go_on(), || {}).is_err());
    config.loss = Vec::new();
    assert!(config.validate().is_err());
}

#[test]
fn random_cases_are_the_same_again_and_a_law_without_books_makes_energy() {
    let mut config = SweepConfig::load("delay_sweep").unwrap();
    config
        .laws
        .retain(|law| ["position_force", "tdpa"].contains(&law.name()));
    config.arm = None;
    let study = RandomSweep {
        seed: 7,
        cases: 40,
        sweep: config,
    };
    let stop = go_on();
    let cases = |shard: &str| study.run(shard.parse().unwrap(), &stop, || {}).unwrap();
    let found = study.total(&cases("1/1"));
    let mut parts: Vec<_> = ["1/3", "2/3", "3/3"].into_iter().flat_map(cases).collect();
    parts.sort_by_key(|own| own.place);
    assert_eq!(found, study.total(&parts));
    let of = |name| found.iter().find(|own| own.law == name).unwrap();
    let (without, with) = (of("position_force"), of("tdpa"));
    assert_eq!((without.cases, with.cases), (40, 40));
    assert!(
        without.beyond > 5 && without.worst_energy < -0.1,
        "{without:?}"
    );
    assert_eq!(without.worst[0].energy, without.worst_energy);
    assert_eq!((with.beyond, with.worst.len()), (0, 0), "{with:?}");
    assert!(with.share_done > 0.2, "{with:?}");
    // Stopped, there is what was done: here nothing.
    stop.store(true, Ordering::Relaxed);
    let stopped = study.total(&cases("1/1"));
    assert!(stopped.iter().all(|own| own.cases == 0));
}

#[test]
fn the_deadband_is_told_in_shares_of_what_is_sent() {
    let mut config = small();
    config.rtt_ms = vec![0.0];
    config.jitter_ms = vec![0.0];
    config.loss = vec![0.0];
    config.environments = vec![Environment::SoftSpring];
    let all = all_of(&config);
    assert!(
        all.iter()
            .all(|row| row.frame_share == 1.0 && row.byte_share == 1.0)
    );
    config.codec = ferntast_control::codec::Codec::Deadband;
    let few = all_of(&config);
    for row in &few {
        assert!(row.stable && row.true_energy > -0.02, "{row:?}");
        assert!(row.content_share < 0.3 && row.frame_share < 0.45, "{row:?}");
        assert!(
            row.content_share < row.byte_share && row.byte_share < row.frame_share,
            "{row:?}"
        );
    }
}

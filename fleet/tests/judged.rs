//! The detector, judged by fleets that an independent generator makes. What was tuned was
//! tuned on seeds below 1000; these are others.

mod generator;
#[path = "../../tests/shared/thorough.rs"]
mod thorough;

use std::thread;

use ferntast_fleet::ageing::{Finding, Reading, Watch, WatchSettings};
use generator::{Ageing, Days, Draws, Fleet, JOINTS};

const YEAR: usize = 365;
/// The first seed that nothing was tuned on.
const JUDGING: u64 = 770_000;

/// How many fleet-years are watched: `FERNTAST_FLEET_YEARS`, else ten in a thorough run, and two.
fn years() -> u64 {
    let told = std::env::var("FERNTAST_FLEET_YEARS").ok();
    let told = told.and_then(|text| text.parse().ok());
    told.unwrap_or(if thorough::is_thorough() { 10 } else { 2 })
}

/// What is found of a fleet in so many days.
fn watched(fleet: Fleet, seed: u64, ageing: Option<Ageing>, days: usize) -> Vec<Finding> {
    let names: Vec<String> = (0..fleet.robots)
        .map(|own| format!("robot_{own}"))
        .collect();
    let mut watch = Watch::new(WatchSettings::default());
    let mut found = Vec::new();
    for (day, values) in Days::new(fleet, seed, ageing).take(days) {
        let readings: Vec<Reading> = values
            .iter()
            .map(|own| Reading {
                robot: &names[own.robot],
                joint: JOINTS[own.joint],
                parameter: own.parameter,
                value: own.value,
                std_error: own.std_error,
                temperature: Some(own.temperature),
            })
            .collect();
        found.extend(watch.day(day, &readings).expect("days in their order"));
    }
    found
}

/// `of` for each of `0..count`, on two threads.
fn shared<T: Send>(count: u64, of: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let of = &of;
    let half = |odd: u64| {
        (0..count)
            .filter(move |i| i % 2 == odd)
            .map(of)
            .collect::<Vec<T>>()
    };
    thread::scope(|scope| {
        let other = scope.spawn(move || half(1));
        let mut all = half(0);
        all.extend(other.join().expect("no panic"));
        all
    })
}

/// One false alarm a fleet-year at most, in fleets of 100 robots, 600 series each, with seasons,
/// slopes of their own, correlated noise of heavy tails, loads that change.
#[test]
fn it_names_nobody_where_all_age_alike() {
    let years = years();
    let alarms = shared(years, |year| {
        let found = watched(Fleet::default(), JUDGING + year, None, YEAR);
        for own in &found {
            let first = &own.parameters[0];
            println!(
                "year {year}, day {}: {first:?}, threshold {}",
                own.day, own.threshold
            );
        }
        found.len()
    });
    let sum: usize = alarms.iter().sum();
    println!("{sum} false alarms in {years} fleet-years");
    assert!(
        sum <= years as usize,
        "{sum} false alarms in {years} fleet-years"
    );
}

/// 1.5 % a day is named within 10 days of its beginning, and nobody else is.
#[test]
fn it_names_the_one_that_ages() {
    let trials = 2 * years();
    let days = shared(trials, |trial| {
        let seed = JUDGING + 1000 + trial;
        let mut draws = Draws::new(seed ^ 0xFFFF);
        let mut of = |count: usize| (draws.uniform() * count as f64) as usize;
        let ageing = Ageing {
            robot: of(100),
            joint: of(2),
            from: of(120) as i64,
            per_day: 0.015,
        };
        let found = watched(
            Fleet::default(),
            seed,
            Some(ageing),
            ageing.from as usize + 11,
        );
        let name = format!("robot_{}", ageing.robot);
        let is_it = |own: &Finding| {
            own.parameters[0].robot == name && own.parameters[0].joint == JOINTS[ageing.joint]
        };
        let first = found.iter().find(|own| is_it(own) && own.day > ageing.from);
        let others = found.iter().filter(|own| !is_it(own)).count();
        println!(
            "{ageing:?}: {:?}, {others} others",
            first.map(|own| own.day - ageing.from)
        );
        (
            first.map(|own| own.day - ageing.from),
            others,
            ageing.from + 11,
        )
    });
    let missed = days.iter().filter(|(day, ..)| day.is_none()).count();
    let mut found: Vec<i64> = days.iter().filter_map(|(day, ..)| *day).collect();
    found.sort_unstable();
    println!("days until it is named: {found:?}, {missed} of {trials} missed");
    assert_eq!(missed, 0, "{found:?}");
    // Not by luck, either: before three days of ageing nothing can be told from one odd day.
    assert!(found[0] >= 3, "{found:?}");
    // The others at the rate that the whole fleet may have.
    let others: usize = days.iter().map(|(_, others, _)| others).sum();
    let years = days.iter().map(|(.., days)| days).sum::<i64>() as f64 / YEAR as f64;
    println!("{others} others in {years:.1} fleet-years");
    assert!(others as f64 <= years, "{others} in {years} fleet-years");
}

//! A fleet of lockstep arms, day after day: the one that ages is named, by its journal.

use std::{
    fmt::Write,
    fs,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use ferntast_bag::{BagOptions, BagReader, BagWriter};
use ferntast_drivers::simulated;
use ferntast_msgs::{Message, topics};
use ferntast_nodes::{graph::Graph, process::SessionContext, session_graph};
use ferntast_studies::lockstep::{self, LockstepPlan};
use ferntast_tests::{
    JOINT_2, Session, experiment_on_joint_2, is_thorough, number, refused, root, run,
};
use serde_json::{Value, json};
use toml::Table;

/// Arms of the fleet; a hundred in a thorough run.
fn arms() -> usize {
    if is_thorough() { 100 } else { 20 }
}

/// Days of the fleet; the ageing one ages from the first on.
const DAYS: i64 = 10;
/// Which one ages, and by which share a day.
const AGEING: (usize, f64) = (17, 0.015);
const ROBOT: &str = "arm_17";
/// How long an arm moves on a day \[s\]: over both edges once.
const MOVES: f64 = 12.0;

/// A number from 0 to 1 for an arm and a day (splitmix64), the same on every run.
fn drawn(arm: usize, day: i64, what: u64) -> f64 {
    let mut state = (arm as u64) << 40 ^ (day as u64) << 20 ^ what;
    state = state.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    for shift in [30, 27, 31] {
        state = (state ^ (state >> shift)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    }
    (state >> 11) as f64 / (1_u64 << 53) as f64
}

fn between(low: f64, high: f64, share: f64) -> f64 {
    low + (high - low) * share
}

/// Temperature of an arm's joints on a day \[degC\]: a cold front passes over all of them.
fn temperature(arm: usize, day: i64) -> f64 {
    let common = 12.0 - 4.0 * (day as f64 / 6.0).sin();
    common + between(-3.0, 3.0, drawn(arm, day, 1)) + between(-2.0, 2.0, drawn(arm, 0, 2))
}

/// The file of an arm as it is on a day: of the same make as the others, and like none of them.
fn arm_file(shipped: &Table, arm: usize, day: i64) -> String {
    let mut file = shipped.clone();
    let truth = file["truth"].as_table_mut().expect("[truth]");
    let environment = truth["environment"]
        .as_table_mut()
        .expect("[truth.environment]");
    environment.insert("day".to_owned(), (57.0 + day as f64).into());
    let degrees = temperature(arm, day);
    environment.insert("temperature".to_owned(), vec![degrees; 2].into());
    let aged = match AGEING {
        (own, per_day) if own == arm => 1.0 + per_day * day as f64,
        _ => 1.0,
    };
    for (joint, own) in truth["joint"]
        .as_array_mut()
        .expect("joints")
        .iter_mut()
        .enumerate()
    {
        let joint = joint as u64;
        let friction = own["friction"].as_table_mut().expect("friction");
        let level = between(0.93, 1.07, drawn(arm, 0, 10 + joint)) * aged;
        for name in ["b_0", "b_0T", "b_1", "b_2", "b_3"] {
            let value = friction[name].as_float().expect("a number");
            friction.insert(name.to_owned(), (value * level).into());
        }
        let heat = friction["temperature"].as_table_mut().expect("temperature");
        for name in ["slow", "fast"] {
            let value = heat[name].as_float().expect("a number");
            let slope = between(0.85, 1.15, drawn(arm, 0, 20 + joint));
            heat.insert(name.to_owned(), (value * slope).into());
        }
        let wear = friction["wear"].as_table_mut().expect("wear");
        let per_year = between(0.06, 0.22, drawn(arm, 0, 30 + joint));
        wear.insert("per_year".to_owned(), per_year.into());
    }
    toml::to_string(&file).expect("TOML")
}

/// A day of an arm: its line of the journal.
fn day_of(graph: &Graph, folder: &Path, shipped: &Table, arm: usize, day: i64) -> String {
    let file = folder.join(format!("arm_{arm}_{day}.toml"));
    fs::write(&file, arm_file(shipped, arm, day)).expect("scratch folder");
    let mut loaded =
        ferntast_config::load_scenario("rokviss", simulated::load_arm).expect("a scenario");
    let name = file.to_str().expect("UTF-8");
    loaded.set_arm(name, simulated::load_arm).expect("an arm");
    loaded.scenario.seed = 1000 * arm as u64 + day as u64;
    let mut context = SessionContext::in_virtual_time(loaded);
    context.twins = vec![folder.join("joint.toml")];
    let plan = LockstepPlan {
        duration: Some(MOVES),
        ..LockstepPlan::default()
    };
    let outcome = lockstep::run(graph, &context, &plan, &mut |_| true).expect("a session");
    fs::remove_file(&file).expect("scratch folder");
    let parameters = outcome.twins[0].parameters.iter();
    let told = parameters.filter(|own| own.std_error > 0.0 && own.excitation >= 0.5);
    let told = told.map(|own| {
        (
            own.name.clone(),
            json!({"value": own.value, "std_error": own.std_error}),
        )
    });
    let parameters: serde_json::Map<String, Value> = told.collect();
    let line = json!({
        "day": format!("2005-04-{:02}", day + 1),
        "robot": format!("arm_{arm}"),
        "joint": outcome.twins[0].joint,
        "temperature_degC": temperature(arm, day),
        "parameters": parameters,
    });
    line.to_string()
}

/// The recording `from` with what [`JOINT_2`] reads of it and no more: it is read a thousand times.
fn thinned(from: &Path, to: &Path) {
    let bag = BagReader::open(from).expect("a recording");
    let options = BagOptions {
        custom: bag.metadata(),
        ..BagOptions::default()
    };
    let mut writer = BagWriter::create(to, options).expect("a new recording");
    let temperature = topics::FOLLOWER_JOINT_TEMPERATURE.of("joint_2");
    let temperature = temperature.expect("a name");
    copied(&bag, &mut writer, topics::FOLLOWER_MEASURED_JS);
    copied(&bag, &mut writer, topics::FOLLOWER_MOTOR_JS);
    copied(&bag, &mut writer, temperature);
    writer.finish().expect("a whole recording");
}

fn copied<M: Message>(bag: &BagReader, writer: &mut BagWriter, topic: topics::Topic<M>) {
    let name = topic.name;
    let channel = writer.topic(topic).expect("a topic");
    for own in bag.messages::<M>(&name).expect("it was recorded") {
        let own = own.expect("it can be read");
        let written = writer.write(channel, own.log_time, own.publish_time, &own.message);
        written.expect("it can be written");
    }
}

/// Every arm's every day, on all processors.
fn journal(folder: &Path) -> String {
    let shipped = root().join("config/arms/rokviss.toml");
    let shipped: Table = fs::read_to_string(shipped)
        .expect("an arm")
        .parse()
        .expect("TOML");
    let arms = arms();
    let next = AtomicUsize::new(0);
    let threads = thread::available_parallelism().map_or(2, |own| own.get());
    let work = || {
        let graph = session_graph(ferntast_drivers::rows());
        let mut text = String::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= arms * DAYS as usize {
                return text;
            }
            let line = day_of(&graph, folder, &shipped, i % arms, (i / arms) as i64);
            writeln!(text, "{line}").expect("memory");
        }
    };
    thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let parts = workers.into_iter().map(|own| own.join().expect("no panic"));
        parts.collect()
    })
}

/// Shown by issue 19: 100 lockstep arms, one ageing, named within 10 simulated days, and
/// nobody else.
#[test]
fn of_many_arms_the_one_that_ages_is_named_within_ten_days() {
    let session = Session::new();
    let arguments = ["lockstep", "--duration", "20", "--seed", "3"];
    run(&session, &[&arguments[..], &["--record", "whole"]].concat()).success();
    thinned(
        &session.folder().join("whole"),
        &session.folder().join("first"),
    );
    fs::write(session.folder().join("joint.toml"), JOINT_2).expect("scratch folder");
    let begun = std::time::Instant::now();
    let text = journal(session.folder());
    println!(
        "{} arm-days in {:.0} s",
        text.lines().count(),
        begun.elapsed().as_secs_f64()
    );
    fs::write(session.folder().join("fleet.jsonl"), &text).expect("scratch folder");
    let told = run(&session, &["fleet", "watch", "fleet.jsonl", "--json"])
        .success()
        .json();
    println!("{told:#}");
    assert_eq!(told["days"], DAYS);
    assert_eq!(told["robots"], arms());
    let named = told["named"].as_array().expect("named");
    let first = named.first().expect("nobody was named");
    assert_eq!(first["robot"], ROBOT, "{first:#}");
    assert_eq!(first["joint"], "joint_2");
    assert_eq!(first["kind"], "ramp");
    let day = first["day"].as_str().expect("a day");
    // Not before the sixth day, at which the spread is known at all.
    assert!(
        ("2005-04-06"..="2005-04-10").contains(&day),
        "named on {day}"
    );
    assert!(number(first, "evidence") > number(first, "threshold"));
    assert!(named.iter().all(|own| own["robot"] == ROBOT), "{named:#?}");

    // Without it there is nothing to name.
    let mark = format!("\"{ROBOT}\"");
    let others: Vec<&str> = text.lines().filter(|line| !line.contains(&mark)).collect();
    fs::write(session.folder().join("others.jsonl"), others.join("\n")).expect("scratch folder");
    let told = run(&session, &["fleet", "watch", "others.jsonl", "--json"])
        .success()
        .json();
    assert_eq!(told["robots"], arms() - 1);
    assert_eq!(told["named"], json!([]), "{told:#}");
    let words = run(&session, &["fleet", "watch", "others.jsonl"])
        .success()
        .stdout;
    assert!(words.contains("no joint ages differently"), "{words}");
}

#[test]
fn a_recording_with_a_twin_is_a_line_of_the_journal() {
    let session = Session::new();
    experiment_on_joint_2(&session);
    let arguments = [
        "lockstep",
        "--twin",
        "joint.toml",
        "--duration",
        "15",
        "--record",
        "day",
    ];
    run(&session, &arguments).success();
    let printed = run(&session, &["fleet", "day", "day", "--robot", "left"])
        .success()
        .stdout;
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), 1, "{printed}");
    let line: Value = serde_json::from_str(lines[0]).expect("JSON");
    assert_eq!(line["day"], "2005-03-24");
    assert_eq!(line["robot"], "left");
    assert_eq!(line["joint"], "joint_2");
    // The arm of Table 1, at its gears' own temperature.
    let b_0 = number(&line, "parameters.b0.value");
    assert!((b_0 - 12.372).abs() < 1.0, "{line:#}");
    assert!(
        (-20.0..30.0).contains(&number(&line, "temperature_degC")),
        "{line:#}"
    );
    // It goes back in; one robot alone has no siblings.
    fs::write(session.folder().join("fleet.jsonl"), printed).expect("scratch folder");
    let told = run(&session, &["fleet", "watch", "fleet.jsonl", "--json"])
        .success()
        .json();
    assert_eq!(told["joints"], 1);
    assert_eq!(told["standing"], json!([]));

    refused(
        &session,
        &["fleet", "day", "first", "--robot", "left"],
        &["no twin", "--twin"],
    );
    fs::write(session.folder().join("wrong.jsonl"), "{}").expect("scratch folder");
    refused(
        &session,
        &["fleet", "watch", "wrong.jsonl"],
        &["wrong.jsonl", "line 1", "\"robot\""],
    );
    refused(&session, &["fleet", "watch", "none.jsonl"], &["none.jsonl"]);
    refused(
        &session,
        &["fleet", "watch"],
        &["nothing to watch", "FILE or DIR"],
    );
}

//! Contact forces as a session's estimator tells them, against what MuJoCo lets the tip feel.

use std::fs;

use ferntast_msgs::{Time, topics};
use ferntast_tests::{Session, messages, process_driver, run};
use serde_json::Value;

/// Virtual time of a run that touches the table \[s\].
const TOUCHING: &str = "10";
/// When virtual time begins, in the scenario that runs: 2005-03-24 10:00 UTC.
const START: Time = Time::from_nanos(1_111_658_400_000_000_000);
/// Filters have settled \[ms\].
const SETTLED: usize = 500;
/// A force below this is no contact \[N\].
const TOUCHES: f64 = 1.0;

/// What is told of the force on the tip less what is true.
struct Compared {
    /// Greatest true force \[N\].
    peak: f64,
    /// How late what is told is \[ms\].
    late: usize,
    /// Root mean square in contact, after that delay \[N\].
    error: f64,
    /// What 99 % in contact are below \[N\].
    most: f64,
}

/// Runs `arm` in virtual time with MuJoCo in its place, recorded as `name`.
fn lockstep(session: &Session, arm: &str, options: &str, name: &str, duration: &str) -> Value {
    let options = format!("--truth {name}.csv {options}");
    let driver = process_driver("mujoco_plant.py", &options);
    let arguments = [
        "lockstep",
        "--arm",
        arm,
        "--driver",
        &driver,
        "--duration",
        duration,
        "--record",
        name,
        "--json",
    ];
    run(session, &arguments).success().json()
}

/// The recording `name` beside what was true in it.
fn compared(session: &Session, name: &str) -> Compared {
    let truth = fs::read_to_string(session.folder().join(format!("{name}.csv")));
    let truth: Vec<[f64; 3]> = truth
        .expect("what is true")
        .lines()
        .map(|line| {
            let numbers = line.split(',').map(|own| own.parse().expect("a number"));
            let numbers: Vec<f64> = numbers.collect();
            [numbers[1], numbers[2], numbers[3]]
        })
        .collect();
    let told = messages(&session.folder().join(name), topics::FOLLOWER_MEASURED_CF);
    let told: Vec<(usize, [f64; 3])> = told
        .iter()
        .map(|own| {
            let since = own.message.stamp.seconds_since(START);
            ((1e3 * since).round() as usize, own.message.force)
        })
        .collect();
    let length = |force: &[f64; 3]| force.iter().map(|own| own * own).sum::<f64>().sqrt();
    let at = |late: usize| {
        let pairs = told.iter().filter(|(tick, _)| *tick >= SETTLED);
        let pairs = pairs.filter_map(|(tick, own)| Some((own, truth.get(tick - late)?)));
        let errors = pairs.filter(|(_, true_)| length(true_) > TOUCHES);
        let mut errors: Vec<f64> = errors
            .map(|(own, true_)| length(&std::array::from_fn(|axis| own[axis] - true_[axis])))
            .collect();
        errors.sort_by(f64::total_cmp);
        assert!(errors.len() > 3000, "{name}: it hardly touches");
        let squares: f64 = errors.iter().map(|own| own * own).sum();
        Compared {
            peak: truth.iter().map(length).fold(0.0, f64::max),
            late,
            error: (squares / errors.len() as f64).sqrt(),
            most: errors[errors.len() * 99 / 100],
        }
    };
    let all = (0..40).map(at);
    let best = all
        .min_by(|a, b| a.error.total_cmp(&b.error))
        .expect("some");
    println!(
        "{name}: {:.1} N at most; {} ms late; off by {:.3} N, 99 % below {:.3} N",
        best.peak, best.late, best.error, best.most
    );
    best
}

/// The shipped file of an arm as `name`.toml, changed.
fn arm(session: &Session, arm: &str, name: &str, change: impl Fn(&mut toml::Table)) -> String {
    let folder = ferntast_tests::root().join("config/arms");
    let text = fs::read_to_string(folder.join(format!("{arm}.toml"))).expect("an arm");
    let mut table: toml::Table = text.parse().expect("TOML");
    change(&mut table);
    let file = format!("{name}.toml");
    fs::write(session.folder().join(&file), table.to_string()).expect("scratch");
    let urdf = format!("{arm}.urdf");
    fs::copy(folder.join(&urdf), session.folder().join(&urdf)).expect("scratch");
    file
}

fn set_sensors(table: &mut toml::Table, has: bool) {
    let arm = table["arm"].as_table_mut().expect("a table");
    arm.insert("torque_sensors".to_owned(), has.into());
}

#[test]
fn a_force_by_joint_torques_is_within_5_percent_of_the_peak_of_an_independent_library() {
    let session = Session::new();
    for name in ["panda", "ur5", "xarm7"] {
        let file = arm(&session, name, name, |table| set_sensors(table, true));
        lockstep(&session, &file, "", name, TOUCHING);
        let told = compared(&session, name);
        assert!((5.0..60.0).contains(&told.peak));
        // The filters' own delay: 9 ms.
        assert!((5..=12).contains(&told.late), "{} ms", told.late);
        assert!(told.error > 0.0 && told.most < 0.05 * told.peak);
    }
}

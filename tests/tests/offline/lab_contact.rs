//! The model lab on contacts: what slides along an edge in place of a joint.

use std::fs;

use ferntast_tests::{Session, number, refused, run};
use serde_json::Value;

/// A shipped experiment file in the session's folder, its recordings looked for there.
fn shipped(session: &Session, name: &str, change: impl Fn(String) -> String) -> String {
    let path = ferntast_tests::root().join("config/experiments").join(name);
    let text = fs::read_to_string(path).expect("a shipped experiment");
    let text = change(text.replace("../../recordings/", ""));
    fs::write(session.folder().join(name), text).expect("scratch folder");
    name.to_owned()
}

fn first(told: &Value) -> &str {
    told["candidates"][0]["effect"].as_str().unwrap_or_default()
}

#[test]
fn a_riddle_of_a_contact_is_made_solved_and_revealed() {
    let session = Session::new();
    let new = [
        "challenge",
        "new",
        "riddle",
        "--contact",
        "--hide",
        "contact_compliance",
        "--json",
    ];
    run(&session, &new).success();
    let diagnose = |file: &str| {
        run(&session, &["lab", "diagnose", file, "--json"])
            .success()
            .json()
    };
    let told = diagnose("riddle/experiment.toml");
    assert_eq!(first(&told), "contact_compliance", "{told:#}");
    let best = &told["candidates"][0];
    assert_eq!(best["parameters"]["k"]["unit"], "N/m");
    assert!(number(best, "held_out_after") < 0.3 * number(best, "held_out_before"));

    let auto = ["lab", "auto", "riddle/experiment.toml", "--json"];
    let auto = run(&session, &auto).success().json();
    assert_eq!(auto["verdict"], "complete", "{auto:#}");
    let last = auto["experiment"].as_str().expect("a file").to_owned();
    let history = run(&session, &["lab", "history", &last, "--json"])
        .success()
        .json();
    assert_eq!(history[1]["added"], "contact_compliance");
    assert_eq!(history[1]["unit"], "N");
    run(&session, &["lab", "report", &last, "-o", "page.html"]).success();
    let page = fs::read_to_string(session.folder().join("page.html")).expect("the page");
    assert!(page.contains("tip_velocity") && page.contains("normal_force"));

    let reveal = [
        "challenge",
        "reveal",
        "riddle",
        "contact_compliance",
        "--json",
    ];
    assert_eq!(run(&session, &reveal).success().json()["right"], true);
    refused(
        &session,
        &[
            "challenge",
            "new",
            "other",
            "--contact",
            "--hide",
            "stribeck",
        ],
        &["stribeck", "contact_stribeck"],
    );
}

/// What the simulated arm leaves in a recording of its own topics: equation (6),
/// and a surface that gives way along itself before the tip slides.
#[test]
fn the_arms_own_contact_is_coulomb_friction_that_winds_up_first() {
    let session = Session::new();
    let record = ["experiment", "contact", "--day", "57", "-o", "edge"];
    run(&session, &record).success();
    let file = shipped(&session, "contact.toml", |text| {
        // The bare edge lies along y.
        text.replace("position.x", "position.y")
            .replace("effects = [\"contact_coulomb\"]", "effects = []")
    });
    let auto = ["lab", "auto", &file, "-o", "found", "--json"];
    let told = run(&session, &auto).success().json();
    let steps = told["steps"].as_array().expect("steps");
    let names: Vec<&Value> = steps.iter().map(|step| &step["effect"]).collect();
    assert_eq!(names, ["contact_coulomb", "contact_compliance"], "{told:#}");
    assert_eq!(told["verdict"], "complete", "{told:#}");
    // As config/arms/rokviss.toml has it on day 57: b_0T 0.45, bristles of 2e5 N/m.
    let parameters = &steps[1]["parameters"];
    let (b0t, k) = (
        number(&parameters["b0T"], "value"),
        number(&parameters["k"], "value"),
    );
    assert!((b0t / 0.45 - 1.0).abs() < 0.03, "{b0t}");
    assert!((k / 2e5 - 1.0).abs() < 0.2, "{k} N/m");
}

/// Fig. 17, through the recorder: the lubricant wears off.
#[test]
fn wear_of_the_lubricated_edge_is_found_in_the_missions_recordings() {
    let session = Session::new();
    let days = [1.0, 57.0, 131.04, 201.05, 300.03, 407.01, 541.04, 736.02];
    let mission = format!(
        "name = \"edge\"\ndescription = \"The lubricated edge.\"\narm = \"rokviss\"\nseed = 5\nground = false\n\
         days = {days:?}\n[[experiment]]\nkind = \"contact\"\nsurface = \"lubricated\"\n\
         forces = [15.0, 25.0]\nfrequencies = [0.4]\ntime_per_press = 5.0\n"
    );
    fs::write(session.folder().join("edge.toml"), mission).expect("scratch folder");
    let campaign = ["experiment", "campaign", "edge.toml", "-o", "mission"];
    run(&session, &campaign).success();
    let file = shipped(&session, "contact_mission.toml", |text| {
        let kept = text.lines().filter(|line| {
            let is_recording = line.contains("mission/day_");
            !is_recording
                || days
                    .iter()
                    .any(|day| line.contains(&format!("day_{day:07.2}/")))
        });
        kept.collect::<Vec<_>>().join("\n")
    });
    let told = run(&session, &["lab", "diagnose", &file, "--json"])
        .success()
        .json();
    assert_eq!(told["verdict"], "missing", "{told:#}");
    assert_eq!(first(&told), "contact_wear", "{told:#}");
    // 0.35 in all, 63 % of it in 300 days.
    let parameters = &told["candidates"][0]["parameters"];
    let (all, days) = (
        number(&parameters["bw"], "value"),
        number(&parameters["tw"], "value"),
    );
    assert!((all / 0.35 - 1.0).abs() < 0.05, "{all}");
    assert!((days / 300.0 - 1.0).abs() < 0.1, "{days} d");
}

#[test]
fn bad_input_gets_one_clear_message() {
    let session = Session::new();
    let rows: Vec<String> = (0..2000)
        .map(|row| {
            let (sine, cosine) = (0.01 * f64::from(row)).sin_cos();
            format!(
                "{},{sine},{},{}",
                0.01 * f64::from(row),
                4.0 * cosine.signum(),
                10.0
            )
        })
        .collect();
    let text = format!("t_s,r,f_t,f_n\n{}\n", rows.join("\n"));
    fs::write(session.folder().join("edge.csv"), text).expect("scratch folder");
    let good = "[contact]\n[signals]\ntangential_force = \"f_t\"\nnormal_force = \"f_n\"\nposition = \"r\"";
    let joint = "[signals]\nposition = \"r\"\nmotor_torque = \"f_t\"";
    let diagnose = |head: &str, model: &str, words: &[&str]| {
        let text = format!("recording = \"edge.csv\"\n{head}\n[model]\n{model}\n");
        fs::write(session.folder().join("e.toml"), text).expect("scratch folder");
        refused(&session, &["lab", "diagnose", "e.toml"], words);
    };
    diagnose(
        good,
        "effects = [\"coulomb\"]",
        &["coulomb", "a joint", "a contact"],
    );
    diagnose(
        joint,
        "inertia = 1.0\neffects = [\"contact_coulomb\"]",
        &["contact_coulomb", "a contact", "a joint"],
    );
    let without = good.replace("normal_force = \"f_n\"\n", "");
    diagnose(
        &without,
        "effects = []",
        &["signals.normal_force", "missing"],
    );
    diagnose(good, "inertia = 1.0\neffects = []", &["inertia"]);
    diagnose(good, "effects = [\"contact_magic\"]", &["contact_spot"]);
    let text = format!("recording = \"edge.csv\"\n{good}\n[model]\neffects = []\n");
    fs::write(session.folder().join("twin.toml"), text).expect("scratch folder");
    refused(
        &session,
        &["lockstep", "--duration", "1", "--twin", "twin.toml"],
        &["contact", "joint"],
    );
}

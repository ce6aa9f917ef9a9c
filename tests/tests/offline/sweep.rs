//! The laws held against each other, from the command line.

use std::fs;

use ferntast_tests::{Session, number, refused, run};

const SMALL: &str = r#"
description = "Small."
rtt_ms = [0, 300]
jitter_ms = [0, 5]
loss = [0, 0.1]
environments = ["soft_spring", "hard_wall"]
seeds = [1, 2]
hand = { mass = 0.5, damping = 20.0, stiffness = 300.0 }
laws = [{ kind = "position_force", force_scale = 1.0 }, { kind = "wave", force_scale = 1.0 }]
"#;

#[test]
fn gives_rows_a_page_and_the_largest_stable_delays() {
    let session = Session::new();
    fs::write(session.folder().join("small.toml"), SMALL).expect("scratch folder");
    let arguments = ["sweep", "small.toml", "-o", "out", "--json"];
    let rows = run(&session, &arguments).success().json();
    let rows = rows.as_array().expect("a list").clone();
    // 2 laws, 2 environments, 2 delays, one trial without chance and six with.
    assert_eq!(rows.len(), 2 * 2 * 2 * 7);
    for row in &rows {
        for key in ["position_rmse_m", "true_energy_J", "peak_force_N", "rtt_ms"] {
            assert!(number(row, key).is_finite(), "{row:#}");
        }
    }
    let fails = |law: &str| {
        let own = rows
            .iter()
            .filter(|row| row["law"] == law && row["rtt_ms"] == 300.0);
        own.filter(|row| row["environment"] == "hard_wall" && row["stable"] == false)
            .count()
    };
    assert_eq!(fails("position_force"), 7);
    assert_eq!(fails("wave"), 0);
    let written = fs::read_to_string(session.folder().join("out/sweep.json")).expect("rows");
    let written: serde_json::Value = serde_json::from_str(&written).expect("JSON");
    assert_eq!(written.as_array(), Some(&rows));
    let page = fs::read_to_string(session.folder().join("out/sweep.html")).expect("a page");
    assert!(page.contains("position_force") && page.contains("showSweep"));

    let told = run(&session, &["sweep", "small.toml", "--law", "wave"]).success();
    assert!(
        told.stdout.contains("largest stable round trip"),
        "{told:#?}"
    );
    assert!(!told.stdout.contains("position_force"), "{told:#?}");
}

#[test]
fn refuses_what_it_cannot_sweep() {
    let session = Session::new();
    let path = session.folder().join("bad.toml");
    fs::write(&path, SMALL.replace("[0, 0.1]", "[0, 1.1]")).expect("scratch folder");
    refused(
        &session,
        &["sweep", "bad.toml"],
        &["bad.toml", "loss", "1.1"],
    );
    fs::write(&path, SMALL.replace("hard_wall", "glass")).expect("scratch folder");
    refused(&session, &["sweep", "bad.toml"], &["glass", "hard_wall"]);
    refused(&session, &["sweep", "none.toml"], &["none.toml"]);
    refused(&session, &["sweep", "--law", "none"], &["none", "wave"]);
}

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
    refused(&session, &["sweep", "--random", "0"], &["--random"]);
    refused(&session, &["sweep", "--seed", "3"], &["--random"]);
    refused(&session, &["sweep", "--codec", "zip"], &["zip", "deadband"]);
}

#[test]
fn draws_cases_at_random_and_tells_what_each_law_made_of_them() {
    let session = Session::new();
    fs::write(session.folder().join("small.toml"), SMALL).expect("scratch folder");
    let command = |seed: &str, count: &str| {
        let arguments = [
            "sweep",
            "small.toml",
            "--random",
            count,
            "--seed",
            seed,
            "--json",
        ];
        run(&session, &arguments).success().json()
    };
    let whole = command("5", "20");
    let laws = whole.as_array().expect("a list");
    assert_eq!(laws.len(), 2);
    for own in laws {
        assert_eq!(number(own, "cases"), 20.0, "{own:#}");
        let beyond = number(own, "beyond");
        assert_eq!(
            own["worst"].as_array().map(Vec::len),
            Some(beyond.min(10.0) as usize)
        );
        assert!((number(own, "share_beyond") - beyond / 20.0).abs() < 1e-12);
    }
    // In slices they are the same.
    let (first, second) = (command("5", "12"), command("17", "8"));
    for (law, own) in laws.iter().enumerate() {
        let parts = [&first[law], &second[law]];
        let sum: f64 = parts.iter().map(|part| number(part, "beyond")).sum();
        assert_eq!(sum, number(own, "beyond"), "{own:#}");
        let worst = parts.iter().map(|part| number(part, "worst_energy_J"));
        assert_eq!(worst.fold(0.0, f64::min), number(own, "worst_energy_J"));
    }
    let told = run(&session, &["sweep", "small.toml", "--random", "3"]).success();
    assert!(
        told.stdout.contains("beyond 0.02 J") && told.stdout.contains("wave"),
        "{told:#?}"
    );
}

/// Five joints before walls, behind a relay satellite: the law with two layers gives next to nothing
/// out, and what a spring between hand and tip makes of such a link is told as well.
#[test]
fn arms_are_judged_on_walls_by_what_is_true_of_them() {
    let session = Session::new();
    let laws = ["--law", "two_layer", "--law", "position_force"];
    let arguments = [&["sweep", "--arms", "so101", "--json"][..], &laws].concat();
    let ended = run(&session, &arguments);
    assert_eq!(ended.status.code(), Some(1), "{ended:#?}");
    let rows: serde_json::Value = serde_json::from_str(&ended.stdout).expect("JSON");
    let rows = rows.as_array().expect("a list");
    // 2 laws, 3 walls, 2 tasks.
    assert_eq!(rows.len(), 2 * 3 * 2);
    let misses = |row: &serde_json::Value, what: &str| {
        let all = row["misses"].as_array().expect("a list");
        all.iter().any(|own| own == what)
    };
    for row in rows {
        assert_eq!((&row["arm"], &row["joints"]), (&"so101".into(), &5.into()));
        assert_eq!(row["driver"], "simulated");
        assert!((25.0..35.0).contains(&number(row, "duration_s")), "{row:#}");
        let told = [
            ("energy", number(row, "true_energy_J") < -0.02),
            ("drift", number(row, "drift_mm") > 1.0),
            ("peak", number(row, "peak_ratio") > 1.5),
        ];
        for (what, broken) in told {
            assert_eq!(misses(row, what), broken, "{what}: {row:#}");
        }
        if row["law"] == "two_layer" {
            assert!(!misses(row, "drift"), "{row:#}");
            assert!(-number(row, "true_energy_J") < 0.001, "{row:#}");
            // What is not known well is rendered with 3.3 kN/m at most, what is with 9.
            let wall = number(row, "true_stiffness_N_per_m");
            let told = 0.8 * wall.min(3300.0)..1.6 * wall.min(9000.0);
            let felt = row["without_delay"]["felt_stiffness_N_per_m"].as_f64();
            assert!(felt.is_none_or(|felt| told.contains(&felt)), "{row:#}");
        }
    }
    let springs = rows.iter().filter(|row| row["law"] == "position_force");
    assert!(springs.clone().any(|row| misses(row, "energy")));
    refused(
        &session,
        &["sweep", "--arms", "rokviss"],
        &["rokviss", "URDF"],
    );
    refused(
        &session,
        &["sweep", "--arms", "z1"],
        &["config/arms/z1.urdf", "licence"],
    );
    refused(
        &session,
        &["sweep", "--driver", "process:true"],
        &["--arms"],
    );
}

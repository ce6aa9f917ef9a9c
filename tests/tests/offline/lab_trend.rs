//! What changed between recordings and dates.

use ferntast_tests::{Session, number, refused, run};

/// The same joint twice, the second time with an effect more: that one came.
#[test]
fn an_effect_that_came_is_told_and_a_joint_that_stays_is_not_said_to_change() {
    let session = Session::new();
    for (folder, hide) in [("spring", "none"), ("autumn", "stribeck")] {
        let new = ["challenge", "new", folder, "--seed", "89", "--hide", hide];
        run(&session, &new).success();
    }
    let files = ["spring/experiment.toml", "autumn/experiment.toml"];
    let both = ["lab", "trend", files[0], files[1], "--json", "-o", "t.html"];
    let told = run(&session, &both).success().json();
    let trend = &told[0];
    assert_eq!(trend["points"].as_array().map(Vec::len), Some(2));
    assert_eq!(trend["points"][0]["verdict"], "complete", "{trend:#}");
    assert_eq!(trend["points"][1]["missing"], "stribeck", "{trend:#}");
    let turns = trend["came_or_went"].as_array().expect("turns");
    let came = turns.iter().any(|own| {
        own["effect"] == "stribeck" && own["came"] == true && own["by_diagnosis"] == true
    });
    assert!(came, "{turns:#?}");
    let page = std::fs::read_to_string(session.folder().join("t.html")).expect("the page");
    assert!(page.contains("showTrend") && !page.contains("@DATA@"));

    // One experiment over its dates: a joint on its bench scatters, and does not drift.
    let dates = run(&session, &["lab", "trend", files[0], "--quick", "--json"]);
    let dates = dates.success().json();
    assert_eq!(dates[0]["points"].as_array().map(Vec::len), Some(6));
    assert!(number(&dates[0]["points"][5], "days") > 1.0, "{dates:#}");
    let b0 = dates[0]["parameters"].as_array().expect("parameters");
    let b0 = b0.iter().find(|own| own["name"] == "b0").expect("b0");
    assert_eq!(b0["steps"].as_array().map(Vec::len), Some(5), "{b0:#}");
    let (change, value) = (
        number(b0, "change.change"),
        number(&dates[0]["points"][0], "parameters.b0.value"),
    );
    assert!(change.abs() < 0.15 * value, "{change} of {value}");
    refused(
        &session,
        &["lab", "trend", "nowhere.toml"],
        &["nowhere.toml"],
    );
}

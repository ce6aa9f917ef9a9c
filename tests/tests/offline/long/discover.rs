//! The search for formulas on laws that no catalogue has, and on recordings that hide nothing.

use std::time::Duration;

use ferntast_tests::{Process, Session, is_thorough, number};

#[test]
fn formulas_for_laws_that_no_catalogue_has() {
    let session = Session::new();
    let (laws, nothing) = if is_thorough() { (8, 20) } else { (3, 5) };
    let arguments = [
        "challenge",
        "discover",
        "--laws",
        &laws.to_string(),
        "--strengths",
        "1",
        "--nothing",
        &nothing.to_string(),
        "--seed",
        "910001",
        "--json",
    ];
    let told = Process::spawn(session.ferntast(&arguments))
        .wait(Duration::from_secs(900))
        .success()
        .json();
    let as_good = &told["as_good_as_true"]["1"];
    let [tried, found] = ["tried", "found"].map(|key| number(as_good, key));
    assert_eq!(tried, f64::from(laws));
    assert!(found >= 0.75 * tried, "{as_good}");
    let answers = told["answers"].as_array().into_iter().flatten();
    for answer in answers.filter(|own| own["formula"].is_string()) {
        // Far below the true law's error is no formula, but a test that leaks what it judges by.
        let ratio = number(answer, "after") / number(answer, "truth");
        assert!(ratio > 0.9, "{answer}");
    }
    assert_eq!(number(&told["false_alarms"], "tried"), f64::from(nothing));
    assert_eq!(number(&told["false_alarms"], "found"), 0.0, "{told}");
}

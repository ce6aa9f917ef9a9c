//! The search for formulas on laws that no catalogue has, and on recordings that hide nothing.

use std::time::Duration;

use ferntast_tests::{Process, Session, number};

#[test]
fn formulas_for_laws_that_no_catalogue_has() {
    let session = Session::new();
    let arguments = [
        "challenge",
        "discover",
        "--laws",
        "4",
        "--strengths",
        "1",
        "--nothing",
        "10",
        "--seed",
        "910001",
        "--json",
    ];
    let told = Process::spawn(session.ferntast(&arguments))
        .wait(Duration::from_secs(600))
        .success()
        .json();
    let as_good = &told["as_good_as_true"]["1"];
    assert_eq!(number(as_good, "tried"), 4.0);
    assert!(number(as_good, "found") >= 3.0, "{as_good}");
    let answers = told["answers"].as_array().into_iter().flatten();
    for answer in answers.filter(|own| own["formula"].is_string()) {
        // Far below the true law's error is no formula, but a test that leaks what it judges by.
        let ratio = number(answer, "after") / number(answer, "truth");
        assert!(ratio > 0.9, "{answer}");
    }
    assert_eq!(number(&told["false_alarms"], "tried"), 10.0);
    assert_eq!(number(&told["false_alarms"], "found"), 0.0, "{told}");
}

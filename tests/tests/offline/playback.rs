//! Recordings that cannot be played.

use ferntast_tests::{Session, refused, run};

#[test]
fn what_cannot_be_played_is_refused() {
    let session = Session::new();
    refused(&session, &["play", "nowhere"], &["nowhere"]);
    std::fs::write(session.folder().join("broken.mcap"), b"no recording").expect("scratch folder");
    refused(&session, &["play", "broken.mcap"], &["broken.mcap"]);
    let record = ["lockstep", "--duration", "1", "--record", "run"];
    run(&session, &record).success();
    refused(&session, &["play", "run", "--rate", "nan"], &["--rate"]);
}

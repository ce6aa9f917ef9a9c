//! What changed between experiments, where it can be told at all.

#![allow(clippy::unwrap_used)]

use std::{fmt::Write as _, fs, path::Path};

use ferntast_lab::work::{self, TrendError, UnitIn, trends};

/// The joint: τ_m = 0.8 q̈ + 1.0 sign(q̇) + 2.0 q̇ + 0.5 u, two sines in closed form; u goes from
/// −1 to 1.
fn recording(path: &Path) {
    let mut text = "t,q,tau,u\n".to_owned();
    for n in 0..10_000 {
        let t = f64::from(n) * 0.002;
        let parts = [(0.6, 2.1), (0.25, 5.3)];
        let sum = |term: fn(f64, f64, f64) -> f64| -> f64 {
            parts.iter().map(|(a, w)| term(*a, *w, t)).sum()
        };
        let q = sum(|a, w, t| a * (w * t).sin());
        let qd = sum(|a, w, t| a * w * (w * t).cos());
        let qdd = sum(|a, w, t| -a * w * w * (w * t).sin());
        let u = (0.9 * t).sin();
        let tau = 0.8 * qdd + qd.signum() + 2.0 * qd + 0.5 * u;
        writeln!(text, "{t},{q},{tau},{u}").unwrap();
    }
    fs::write(path, text).unwrap();
}

/// Two experiments on the same recording that say of its columns and their joint what is in
/// `first` and `other`.
fn held_beside_each_other(first: &str, other: &str) -> Result<Vec<work::Trend>, TrendError> {
    let folder = tempfile::tempdir().unwrap();
    recording(&folder.path().join("run.csv"));
    let files = [("first.toml", first), ("other.toml", other)].map(|(name, said)| {
        let path = folder.path().join(name);
        let text = format!(
            "recording = \"run.csv\"\n{said}\n[model]\ninertia = {{ fit = true }}\n\
             effects = [\"coulomb\", \"viscous\", {{ name = \"push\", expression = \"k*u\" }}]\n"
        );
        fs::write(&path, text).unwrap();
        work::open(&path).unwrap()
    });
    trends(&files, false, &mut |_| ())
}

fn signals(torque: &str, extra: &str) -> String {
    format!(
        "[signals]\nposition = \"q\"\ntime = \"t\"\nmotor_torque = {torque}\nextra.u = {extra}\n"
    )
}

const NEWTON_METRES: &str = r#"{ column = "tau", unit = "Nm" }"#;
const VOLTS: &str = r#"{ column = "u", unit = "V" }"#;

/// What differs, with the units of both files.
fn refused(first: &str, other: &str) -> (String, [String; 2]) {
    let refused = held_beside_each_other(first, other).unwrap_err();
    let text = refused.to_string();
    let TrendError::Units { what, first, other } = refused else {
        panic!("{text}")
    };
    let unit = |own: &UnitIn, name: &str| {
        assert!(own.file.ends_with(name), "{text}");
        assert!(
            text.contains(&format!("{} in {}", own.unit, own.file)),
            "{text}"
        );
        own.unit.clone()
    };
    (
        what,
        [unit(&first, "first.toml"), unit(&other, "other.toml")],
    )
}

#[test]
fn values_of_different_units_are_not_held_beside_each_other() {
    let newton_metres = signals(NEWTON_METRES, VOLTS);
    let current = signals(r#"{ column = "tau", unit = "mA" }"#, VOLTS);
    let (what, units) = refused(&newton_metres, &current);
    assert_eq!(
        (what.as_str(), units),
        ("torque or force", ["Nm".into(), "A".into()])
    );

    // Of a current neither says what kind of joint it is.
    let prismatic = format!(
        "[joint]\ntype = \"prismatic\"\n{}",
        current.replace("\"q\"", "{ column = \"q\", unit = \"m\" }")
    );
    let (what, units) = refused(&current, &prismatic);
    assert_eq!(what, "what was recorded");
    assert_eq!(
        units,
        ["a revolute joint", "a prismatic joint"].map(str::to_owned)
    );

    let millivolts = signals(NEWTON_METRES, r#"{ column = "u", unit = "mV" }"#);
    let (what, units) = refused(&newton_metres, &millivolts);
    assert_eq!(
        (what.as_str(), units),
        ("signal u", ["V".into(), "mV".into()])
    );
}

#[test]
fn the_same_in_other_multiples_is_held_beside_it_and_does_not_change() {
    let newton_metres = signals(NEWTON_METRES, VOLTS);
    let milli = newton_metres.replace("\"Nm\"", "\"mNm\"");
    let found = held_beside_each_other(&newton_metres, &milli).unwrap();
    let b0 = found[0]
        .parameters
        .iter()
        .find(|own| own.name == "b0")
        .unwrap();
    let change = b0.change.as_ref().unwrap();
    // The same numbers as 1000th: 1 Nm, and 1 mNm.
    assert_eq!(b0.unit, "Nm");
    assert!((change.change + 0.999).abs() < 0.02, "{change:?}");
    // One that does not say the unit of an extra signal is taken at its word.
    let unsaid = signals(NEWTON_METRES, "\"u\"");
    let found = held_beside_each_other(&newton_metres, &unsaid).unwrap();
    assert!(
        found[0].parameters.iter().all(|own| !own.changes),
        "{found:?}"
    );
}

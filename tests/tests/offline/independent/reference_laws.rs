//! The laws of a sweep beside the plain equations of their papers, which
//! `tests/python/reference_laws.py` has on the same cases (`docs/reference_laws.md`).

use std::fs;

use ferntast_tests::{Session, ask_python, is_thorough, number, run};
use serde_json::{Value, json};

/// Without the line `arm`: the tip that the reference has too. The reference damps
/// position_position for `round_trip` whatever the delay is; ours measures, and has it as the least.
const SIMPLE_TIP: &str = r#"
description = "The light tip, whose contact force is known at once."
jitter_ms = [0]
loss = [0]
environments = ["soft_spring", "hard_wall", "corner"]
seeds = [1]
hand = { mass = 0.5, damping = 20.0, stiffness = 300.0 }
laws = [
    { kind = "position_force", force_scale = 1.0 },
    { kind = "position_position", force_scale = 1.0, round_trip = 0.35 },
    { kind = "four_channel", force_scale = 1.0 },
    { kind = "wave", force_scale = 1.0 },
    { kind = "tdpa", force_scale = 1.0 },
    { kind = "model_mediated", force_scale = 1.0 },
]
"#;
/// Round trips \[ms\]: on either side of what a hard wall bears.
fn round_trips() -> &'static [f64] {
    if is_thorough() {
        &[20.0, 100.0, 300.0]
    } else {
        &[20.0, 300.0]
    }
}

/// Spring of the tip's servo and of the two surfaces [N/m].
const SERVO: f64 = 6750.0;
const SOFT: f64 = 100.0;
const HARD: f64 = 20_000.0;

fn reference() -> Value {
    let script = ferntast_tests::root().join("tests/python/reference_laws.py");
    let input = json!({
        "rtt_ms": round_trips(),
        "environments": ["soft_spring", "hard_wall", "corner"],
        "tasks": ["press_and_slide"],
        "laws": [
            {"kind": "position_force"},
            {"kind": "position_position", "round_trip": 0.35},
            {"kind": "four_channel"},
            {"kind": "four_channel_commanded"},
            {"kind": "wave"},
            {"kind": "wave_drift"},
            {"kind": "tdpa_drift"},
            {"kind": "model_mediated"},
        ],
    });
    ask_python(&script, &input)
}

fn ours() -> Value {
    let session = Session::new();
    let sweep = format!("rtt_ms = {:?}\n{SIMPLE_TIP}", round_trips());
    fs::write(session.folder().join("simple.toml"), sweep).expect("scratch folder");
    let arguments = ["sweep", "simple.toml", "-o", "out", "--json"];
    run(&session, &arguments).success().json()
}

/// Of one table of rows.
struct Rows(Value);

impl Rows {
    fn row(&self, law: &str, environment: &str, rtt_ms: f64) -> &Value {
        let rows = self.0.as_array().expect("a list").iter();
        let mut own = rows.filter(|row| {
            row["law"] == law && row["environment"] == environment && row["rtt_ms"] == rtt_ms
        });
        own.next().expect("a row of this law")
    }

    fn stable(&self, law: &str, environment: &str, rtt_ms: f64) -> bool {
        self.row(law, environment, rtt_ms)["stable"] == true
    }

    fn felt(&self, law: &str, environment: &str, rtt_ms: f64) -> f64 {
        number(self.row(law, environment, rtt_ms), "felt_stiffness_N_per_m")
    }
}

fn near(own: f64, other: f64, share: f64) -> bool {
    (own - other).abs() <= share * other.abs()
}

fn in_series(stiffness: f64, other: f64) -> f64 {
    1.0 / (1.0 / stiffness + 1.0 / other)
}

#[test]
fn the_laws_are_those_of_their_papers_or_differ_as_told() {
    let (ours, theirs) = (Rows(ours()), Rows(reference()));
    the_same_equations_feel_the_same(&ours, &theirs);
    what_is_unstable_swings_alike(&ours, &theirs);
    four_channel_has_the_servo_in_series(&ours, &theirs);
    waves_are_as_soft_as_their_delay(&ours, &theirs);
    tdpa_pays_for_its_passivity_on_stiff_walls(&ours, &theirs);
    in_a_corner_the_first_wall_is_felt_as_before(&ours, &theirs);
}

/// Laws without a state that both walls share feel the first wall after the second as before it, here
/// as there. The plain model-mediated law, which knows both walls beforehand, jumps as at a single one.
fn in_a_corner_the_first_wall_is_felt_as_before(ours: &Rows, theirs: &Rows) {
    for &rtt_ms in round_trips() {
        for (law, other) in [
            ("position_position", "position_position"),
            ("four_channel", "four_channel_commanded"),
            ("model_mediated", "model_mediated"),
        ] {
            let felt = ours.felt(law, "corner", rtt_ms);
            for expected in [
                theirs.felt(other, "corner", rtt_ms),
                ours.felt(law, "hard_wall", rtt_ms),
            ] {
                assert!(
                    near(felt, expected, 0.12),
                    "{law} {rtt_ms}: {felt}, {expected}"
                );
            }
        }
        let peak = |rows: &Rows, law| number(rows.row(law, "corner", rtt_ms), "peak_force_N");
        let (own, other) = (peak(ours, "model_mediated"), peak(theirs, "model_mediated"));
        assert!(
            (4.0..9.0).contains(&own) && other > 60.0,
            "{rtt_ms}: {own}, {other} N"
        );
        // The hand comes to the second wall with what it reaches for 15 mm beyond it.
        let both = [ours, theirs].map(|rows| peak(rows, "position_position"));
        assert!(near(both[0], both[1], 0.2), "{rtt_ms}: {both:?} N");
    }
}

/// Where ours is what the paper says: stable alike, felt stiffness and drag within some percent.
fn the_same_equations_feel_the_same(ours: &Rows, theirs: &Rows) {
    let pairs = [
        ("position_force", "position_force"),
        ("position_position", "position_position"),
        ("four_channel", "four_channel_commanded"),
        ("wave", "wave_drift"),
        ("model_mediated", "model_mediated"),
    ];
    for (law, other) in pairs {
        for environment in ["soft_spring", "hard_wall"] {
            for &rtt_ms in round_trips() {
                let what = format!("{law} {environment} {rtt_ms}");
                let stable = ours.stable(law, environment, rtt_ms);
                assert_eq!(stable, theirs.stable(other, environment, rtt_ms), "{what}");
                assert_eq!(
                    stable,
                    (law, environment) != ("position_force", "hard_wall"),
                    "{what}"
                );
                if !stable || (law, environment) == ("wave", "hard_wall") {
                    continue;
                }
                let felt = ours.felt(law, environment, rtt_ms);
                let expected = theirs.felt(other, environment, rtt_ms);
                assert!(near(felt, expected, 0.10), "{what}: {felt}, {expected}");
                if law == "position_position" || law == "model_mediated" {
                    let drag = |rows: &Rows, law| {
                        number(rows.row(law, environment, rtt_ms), "drag_N_s_per_m")
                    };
                    let (drag, expected) = (drag(ours, law), drag(theirs, other));
                    assert!(near(drag, expected, 0.05), "{what}: {drag}, {expected}");
                }
            }
        }
    }
}

/// Position-force: two simulations agree in how hard it bounces and what energy that makes.
fn what_is_unstable_swings_alike(ours: &Rows, theirs: &Rows) {
    for environment in ["soft_spring", "hard_wall"] {
        for &rtt_ms in round_trips() {
            let both = [ours, theirs].map(|rows| rows.row("position_force", environment, rtt_ms));
            for (key, share) in [("peak_force_N", 0.05), ("true_energy_J", 0.15)] {
                let [own, other] = both.map(|row| number(row, key));
                assert!(near(own, other, share), "{rtt_ms} {key}: {own}, {other}");
            }
        }
    }
}

/// Lawrence's tip is driven by a force: it bounces on the hard wall from 100 ms on. Ours is told
/// where to be: it holds, and feels twice the servo in series with the wall, and its own coupling.
fn four_channel_has_the_servo_in_series(ours: &Rows, theirs: &Rows) {
    const COUPLING: f64 = 200.0;
    for &rtt_ms in round_trips() {
        let felt = ours.felt("four_channel", "hard_wall", rtt_ms);
        let expected = (1.0 + COUPLING / (2.0 * SERVO)) * in_series(HARD, 2.0 * SERVO);
        assert!(near(felt, expected, 0.03), "{rtt_ms}: {felt}, {expected}");
        let felt = theirs.felt("four_channel", "soft_spring", rtt_ms);
        assert!(near(felt, SOFT, 0.01), "{rtt_ms}: {felt}");
        let stable = theirs.stable("four_channel", "hard_wall", rtt_ms);
        assert_eq!(stable, rtt_ms < 100.0, "{rtt_ms}");
    }
}

/// Delay T each way is a spring b/T, here with the tick that a packet takes on top. The drift
/// correction takes that away in time: ours as far as its energy pays, so between both.
fn waves_are_as_soft_as_their_delay(ours: &Rows, theirs: &Rows) {
    const IMPEDANCE: f64 = 10.0;
    for &rtt_ms in round_trips() {
        let line = IMPEDANCE / (0.5e-3 * rtt_ms + 1e-3);
        for (environment, surface) in [("soft_spring", SOFT), ("hard_wall", HARD)] {
            let felt = theirs.felt("wave", environment, rtt_ms);
            let expected = in_series(in_series(surface, SERVO), line);
            assert!(near(felt, expected, 0.02), "{rtt_ms}: {felt}, {expected}");
        }
        let felt = ours.felt("wave", "hard_wall", rtt_ms);
        let least = 0.9 * theirs.felt("wave", "hard_wall", rtt_ms);
        let most = 1.1 * theirs.felt("wave_drift", "hard_wall", rtt_ms);
        assert!((least..most).contains(&felt), "{rtt_ms}: {felt}");
        let energy = |rows: &Rows, law| {
            let rows = ["soft_spring", "hard_wall"].map(|own| rows.row(law, own, rtt_ms));
            rows.map(|row| number(row, "true_energy_J"))
                .into_iter()
                .fold(0.0, f64::min)
        };
        assert!(energy(ours, "wave") > -1e-6);
        let made = energy(theirs, "wave_drift");
        assert_eq!(made < -0.01, rtt_ms >= 100.0, "{rtt_ms}: {made}");
    }
}

/// The papers' controllers act when the energy is gone: a hard wall feels stiff, bounces from
/// 100 ms on and gives energy. Ours keeps back what it can need: a soft spring is felt as by the
/// paper's, a hard wall holds and is soft.
fn tdpa_pays_for_its_passivity_on_stiff_walls(ours: &Rows, theirs: &Rows) {
    for &rtt_ms in round_trips() {
        let felt = ours.felt("tdpa", "soft_spring", rtt_ms);
        let expected = theirs.felt("tdpa_drift", "soft_spring", rtt_ms);
        assert!(near(expected, in_series(SOFT, SERVO), 0.01), "{expected}");
        assert!(near(felt, expected, 0.02), "{rtt_ms}: {felt}, {expected}");
        let energy = |rows: &Rows, law| number(rows.row(law, "hard_wall", rtt_ms), "true_energy_J");
        assert!(ours.stable("tdpa", "hard_wall", rtt_ms));
        assert!(energy(ours, "tdpa") > -1e-6);
        let stable = theirs.stable("tdpa_drift", "hard_wall", rtt_ms);
        assert_eq!(stable, rtt_ms < 100.0, "{rtt_ms}");
        assert!(energy(theirs, "tdpa_drift") < -0.01);
        let felt = ours.felt("tdpa", "hard_wall", rtt_ms);
        assert!((200.0..3000.0).contains(&felt), "{rtt_ms}: {felt}");
    }
}

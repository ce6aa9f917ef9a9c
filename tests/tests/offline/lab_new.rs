//! `lab new`: recordings as people bring them, each read right, or refused in words
//! that say what to do.

use std::fmt::Write as _;
use std::fs;

use ferntast_tests::{Session, number, refused, run};
use serde_json::Value;

/// The joint: τ_m = J q̈ + b₀ sign(q̇) + b₁ q̇.
pub const INERTIA: f64 = 0.8;
pub const COULOMB: f64 = 1.5;
pub const VISCOUS: f64 = 2.0;

/// Position \[rad\] and motor torque \[Nm\] at a time \[s\]: two sines, in closed form.
fn joint(t: f64) -> (f64, f64) {
    let parts = [(0.6, 2.1), (0.25, 5.3)];
    let sum = |term: fn(f64, f64, f64) -> f64| -> f64 {
        parts.iter().map(|(a, w)| term(*a, *w, t)).sum()
    };
    let position = sum(|a, w, t| a * (w * t).sin());
    let velocity = sum(|a, w, t| a * w * (w * t).cos());
    let acceleration = sum(|a, w, t| -a * w * w * (w * t).sin());
    let friction = COULOMB * velocity.signum() + VISCOUS * velocity;
    (position, INERTIA * acceleration + friction)
}

/// Rows at 500 Hz, written by `row` from number, time, position and torque.
fn rows(count: u32, row: impl Fn(u32, f64, f64, f64) -> String) -> String {
    let mut text = String::new();
    for n in 0..count {
        let t = f64::from(n) * 0.002;
        let (q, tau) = joint(t);
        writeln!(text, "{}", row(n, t, q, tau)).expect("a string");
    }
    text
}

const COUNT: u32 = 15_000;

fn write(session: &Session, name: &str, text: &str) {
    fs::write(session.folder().join(name), text).expect("scratch folder");
}

/// What `lab new` says of these files.
fn new(session: &Session, arguments: &[&str]) -> Value {
    let all = [&["lab", "new"], arguments, &["--json"]].concat();
    run(session, &all).success().json()
}

/// That the experiment has the joint's parameters, torques in `scale` of Nm and in `unit`.
fn holds(session: &Session, experiment: &str, scale: f64, unit: &str) {
    let told = run(session, &["lab", "compare", experiment, "--json"]);
    let told = told.success().json();
    assert_eq!(told["unit"], unit, "{experiment}: {told:#}");
    for (name, truth, own) in [
        ("inertia", INERTIA, None),
        ("b0", COULOMB, Some(unit.to_owned())),
        ("b1", VISCOUS, Some(format!("{unit} s/rad"))),
    ] {
        let value = number(&told, &format!("parameters.{name}.value")) * scale;
        assert!(
            (value / truth - 1.0).abs() < 0.03,
            "{experiment}: {name} {value}: {told:#}"
        );
        if let Some(own) = own {
            assert_eq!(told["parameters"][name]["unit"], own, "{experiment}");
        }
    }
}

#[test]
fn awkward_files_are_read_as_they_are() {
    let session = Session::new();
    let one = |name: &str, text: &str, more: &[&str], scale: f64, unit: &str| {
        write(&session, name, text);
        let made = new(&session, &[&[name], more].concat());
        let file = made["experiment"].as_str().expect("a file").to_owned();
        assert!((number(&made, "rate_hz") - 500.0).abs() < 0.5, "{made:#}");
        holds(&session, &file, scale, unit);
        made
    };
    // Without names, comments in between, blanks.
    let bare = rows(COUNT, |n, t, q, tau| {
        let comment = if n % 5000 == 9 {
            "% still running\n"
        } else {
            ""
        };
        format!("{comment}  {t:.3}   {q:.9} {tau:.9}")
    });
    one("bare.txt", &bare, &["--columns", "t,q,tau"], 1.0, "Nm");
    // Milliseconds, by the name and by the steps.
    let ms = rows(COUNT, |n, _, q, tau| format!("{},{q:.9},{tau:.9}", 2 * n));
    one("named_ms.csv", &format!("t_ms,q,tau\n{ms}"), &[], 1.0, "Nm");
    let made = one("ms.csv", &format!("t,q,tau\n{ms}"), &[], 1.0, "Nm");
    assert!(
        made["warnings"].to_string().contains("taken for ms"),
        "{made:#}"
    );
    // Degrees by the name.
    let degrees = rows(COUNT, |_, t, q, tau| {
        format!("{t:.3},{:.9},{tau:.9}", q.to_degrees())
    });
    one(
        "degrees.csv",
        &format!("t,q_deg,tau\n{degrees}"),
        &[],
        1.0,
        "Nm",
    );
    // Semicolons, decimal commas, a line of units, a preamble.
    let comma = rows(COUNT, |_, t, q, tau| {
        format!("{t:.3};{:.9};{tau:.9}", q.to_degrees()).replace('.', ",")
    });
    let comma = format!("Bench;7\n\nt;q;tau\n[s];[deg];[Nm]\n{comma}");
    one("comma.csv", &comma, &[], 1.0, "Nm");
    // Volts stay volts: 0.25 V for 1 Nm.
    let volts = rows(COUNT, |_, t, q, tau| {
        format!("{t:.3}\t{q:.9}\t{:.9}", tau * 0.25)
    });
    one("volts.tsv", &format!("# t\tq\tu_V\n{volts}"), &[], 4.0, "V");
    // No time, but a rate; milliamperes become amperes.
    let rate = rows(COUNT, |_, _, q, tau| format!("{q:.9},{:.9}", tau * 1000.0));
    let rate = format!("q,current_mA\n{rate}");
    one("rate.csv", &rate, &["--rate", "500"], 1.0, "A");
    // NaN once in a while, a gap, and a short stretch between two gaps.
    let holes = rows(COUNT, |n, t, q, tau| match n {
        6000..6500 | 6580..7000 => "# off".to_owned(),
        n if n % 997 == 3 => format!("{t:.3},nan,{tau:.9}"),
        _ => format!("{t:.3},{q:.9},{tau:.9}"),
    });
    let made = one("holes.csv", &format!("t,q,tau\n{holes}"), &[], 1.0, "Nm");
    let recording = &made["recordings"][0];
    assert_eq!(
        number(recording, "samples"),
        f64::from(COUNT - 920),
        "{made:#}"
    );
    assert_eq!(number(recording, "without_number"), 15.0, "{made:#}");
    assert_eq!(number(recording, "in_short_stretches"), 80.0, "{made:#}");
    assert_eq!(number(recording, "stretches"), 2.0, "{made:#}");
}

#[test]
fn files_of_one_run_are_joined_and_clocks_apart_are_told() {
    let session = Session::new();
    let position = rows(COUNT, |_, t, q, _| format!("{t:.3},{q:.9}"));
    write(&session, "position.csv", &format!("t,q\n{position}"));
    // The current at twice the rate, from a little later on.
    let mut current = "t,i\n".to_owned();
    for n in 0..2 * COUNT {
        let t = 0.1003 + f64::from(n) * 0.001;
        writeln!(current, "{t:.4},{:.9}", joint(t).1).expect("a string");
    }
    write(&session, "current.csv", &current);
    let made = new(
        &session,
        &["position.csv", "current.csv", "-o", "joined.toml"],
    );
    assert_eq!(made["signals"][2]["unit"], "A", "{made:#}");
    holds(&session, "joined.toml", 1.0, "A");
    let text = fs::read_to_string(session.folder().join("joined.toml")).expect("written");
    assert!(
        text.contains("[[\"position.csv\", \"current.csv\"]]"),
        "{text}"
    );

    let row = rows(COUNT, |_, _, _, tau| format!("{tau:.9}"));
    write(&session, "row.csv", &format!("i\n{row}"));
    new(&session, &["position.csv", "row.csv", "-o", "row.toml"]);
    holds(&session, "row.toml", 1.0, "A");
    write(&session, "short.csv", "i\n1\n2\n3\n");
    refused(
        &session,
        &["lab", "new", "position.csv", "short.csv", "-o", "x.toml"],
        &["short.csv has 3 rows", "has 15000"],
    );

    let late = rows(COUNT, |_, t, _, tau| format!("{:.3},{tau:.9}", t + 32.998));
    write(&session, "late.csv", &format!("t,i\n{late}"));
    refused(
        &session,
        &["lab", "new", "position.csv", "late.csv", "-o", "x.toml"],
        &["never overlap", "3.000 s apart"],
    );
}

#[test]
fn what_is_not_certain_is_refused_with_what_to_say() {
    let session = Session::new();
    let degrees = rows(2000, |_, t, q, tau| {
        format!("{t:.3},{:.9},{tau:.9}", q.to_degrees())
    });
    write(&session, "angle.csv", &format!("t,q,tau\n{degrees}"));
    let arguments = ["lab", "new", "angle.csv"];
    refused(
        &session,
        &arguments,
        &["may be in deg", "--position", "q:deg or q:rad"],
    );
    write(&session, "strange.csv", &format!("a,b,c\n{degrees}"));
    let arguments = ["lab", "new", "strange.csv"];
    refused(&session, &arguments, &["--motor-torque COLUMN", "a, b, c"]);
    write(&session, "untimed.csv", "q,tau\n0,1\n1,0\n0,1\n");
    refused(&session, &["lab", "new", "untimed.csv"], &["--rate HZ"]);
    refused(
        &session,
        &["lab", "compare", "angle.csv"],
        &["make one first: ferntast lab new angle.csv"],
    );
    // An experiment that is there is not written over.
    let said = ["angle.csv", "--position", "q:deg"];
    new(&session, &said);
    refused(
        &session,
        &[&["lab", "new"], &said[..]].concat(),
        &["exists", "--force"],
    );
    new(&session, &[&said[..], &["--force"]].concat());
    // A unit that is said is taken, and doubted where it can hardly be.
    let made = new(
        &session,
        &["angle.csv", "--position", "q:rad", "-o", "rad.toml"],
    );
    let warned = made["warnings"].to_string();
    assert!(warned.contains("it may be in deg"), "{made:#}");
    let made = new(&session, &[&said[..], &["-o", "deg.toml"]].concat());
    assert!(
        !made["warnings"].to_string().contains("may be in"),
        "{made:#}"
    );
    // A force and an angle belong to no joint.
    let unit = [
        "angle.csv",
        "--position",
        "q:deg",
        "--motor-torque",
        "tau:N",
        "--force",
    ];
    refused(
        &session,
        &[&["lab", "new"], &unit[..]].concat(),
        &["revolute", "unit \"deg\""],
    );
    // One that takes milliseconds for seconds is told so.
    let ms = rows(2000, |n, _, q, tau| format!("{},{q:.9},{tau:.9}", 2 * n));
    write(&session, "ms.csv", &format!("t,q,tau\n{ms}"));
    write(
        &session,
        "old.toml",
        "recording = \"ms.csv\"\n[signals]\nposition = \"q\"\nmotor_torque = \"tau\"\n[model]\ninertia = { fit = true }\neffects = [\"coulomb\"]\n",
    );
    let told = run(&session, &["lab", "compare", "old.toml"]);
    assert!(told.stderr.contains("unit = \"ms\""), "{told:#?}");
}

#[test]
fn contacts_arms_and_extra_signals_are_said_on_the_command_line() {
    let session = Session::new();
    // F_T = 0.3 F_N sign(ṙ) along an edge from (0.2, 0.1) straight up.
    let edge = rows(COUNT, |_, t, _, _| {
        let r = 0.1 + 0.05 * (2.0 * t).sin();
        let normal = 5.0 + 2.0 * (0.7 * t).sin();
        let tangential = 0.3 * normal * (2.0 * t).cos().signum();
        format!(
            "{t:.3},200,{:.6},{tangential:.6},{normal:.6}",
            100.0 + 1000.0 * r
        )
    });
    write(&session, "edge.csv", &format!("t,x,y,F_T,F_N\n{edge}"));
    let arguments = ["lab", "new", "edge.csv", "--tip", "x:mm,y:mm"];
    refused(&session, &arguments, &["--contour"]);
    let contour = [
        "edge.csv",
        "--tip",
        "x:mm,y:mm",
        "--contour",
        "0.2 0.1, 0.2 0.4",
    ];
    let made = new(&session, &contour);
    assert_eq!(made["joint"], "contact", "{made:#}");
    let told = run(&session, &["lab", "compare", "edge.toml", "--json"]);
    let friction = number(&told.success().json(), "parameters.b0T.value");
    assert!((friction - 0.3).abs() < 0.005, "{friction}");

    // Two joints without links' masses to speak of, so that each is a joint of its own.
    let urdf = "<robot name=\"two\"><link name=\"base\"/>\
        <link name=\"a\"><inertial><mass value=\"1e-9\"/><inertia ixx=\"1e-9\" ixy=\"0\" ixz=\"0\" iyy=\"1e-9\" iyz=\"0\" izz=\"1e-9\"/></inertial></link>\
        <link name=\"b\"><inertial><mass value=\"1e-9\"/><inertia ixx=\"1e-9\" ixy=\"0\" ixz=\"0\" iyy=\"1e-9\" iyz=\"0\" izz=\"1e-9\"/></inertial></link>\
        <joint name=\"pan\" type=\"continuous\"><parent link=\"base\"/><child link=\"a\"/><axis xyz=\"0 0 1\"/></joint>\
        <joint name=\"tilt\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/></joint></robot>";
    write(&session, "two.urdf", urdf);
    let both = rows(COUNT, |_, t, q, tau| {
        let (other, torque) = joint(t + 1.0);
        format!(
            "{t:.3},{q:.9},{tau:.9},{:.9},{torque:.9}",
            other.to_degrees()
        )
    });
    write(
        &session,
        "run.csv",
        &format!("t,q_pan,tau_pan,angle_2,tau_tilt\n{both}"),
    );
    let arm = ["lab", "new", "run.csv", "--urdf", "two.urdf"];
    refused(
        &session,
        &arm,
        &["position of tilt", "--position", "{joint}"],
    );
    let said = [
        "run.csv",
        "--urdf",
        "two.urdf",
        "--position",
        "q_pan:rad,angle_2:deg",
    ];
    let made = new(&session, &said);
    assert_eq!(
        made["joints"],
        serde_json::json!(["pan", "tilt"]),
        "{made:#}"
    );
    let told = run(&session, &["lab", "compare", "run.toml", "--json"]);
    let told = told.success().json();
    for own in ["pan", "tilt"] {
        let inertia = number(&told, &format!("joints.{own}.parameters.inertia.value"));
        assert!((inertia / INERTIA - 1.0).abs() < 0.03, "{own} {inertia}");
    }
    let one = [
        "run.csv", "--urdf", "two.urdf", "--joints", "pan", "-o", "pan.toml",
    ];
    assert_eq!(new(&session, &one)["joints"], serde_json::json!(["pan"]));

    let said = [
        "run.csv",
        "--position",
        "q_pan",
        "--motor-torque",
        "tau_pan",
        "--extra",
        "other=angle_2:deg",
        "-o",
        "extra.toml",
    ];
    let made = new(&session, &said);
    let last = made["signals"]
        .as_array()
        .and_then(|own| own.last().cloned());
    assert_eq!(
        last.map(|own| own["signal"].clone()),
        Some("extra.other".into()),
        "{made:#}"
    );
    holds(&session, "extra.toml", 1.0, "Nm");
}

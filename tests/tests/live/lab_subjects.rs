//! On the lab's page: contacts with their tip, whole arms, and signals of the user's own, each
//! begun and mapped again.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::{
    arm_of_three::{self, ARMATURES, JOINTS, URDF},
    lab_bench::{Bench, COUNT, table},
    lab_page::LONG,
};

/// A tip in mm on an edge that goes up by 30° from (0.2, 0.1) m, with F_T = 0.3 F_N sign(ṙ).
pub fn edge(count: u32) -> String {
    table("t,tip_x_mm,tip_y_mm,F_T,F_N", count, |_, t, _, _| {
        let r = 0.1 + 0.05 * (2.0 * t).sin() + 0.02 * (5.3 * t).sin();
        let speed = 0.1 * (2.0 * t).cos() + 0.106 * (5.3 * t).cos();
        let normal = 5.0 + 2.0 * (0.7 * t).sin();
        let (sine, cosine) = 30_f64.to_radians().sin_cos();
        let tip = [0.2 + cosine * r, 0.1 + sine * r].map(|own| 1000.0 * own);
        let tangential = 0.3 * normal * speed.signum();
        format!(
            "{t:.3},{:.6},{:.6},{tangential:.6},{normal:.6}",
            tip[0], tip[1]
        )
    })
}

/// A run of the arm of three joints: angles in degrees, torques in steps of so many decimals.
fn run_of(urdf: &str, count: u32, decimals: usize) -> String {
    let names = ["q_deg", "tau"].map(|own| JOINTS.map(|joint| format!("{joint}_{own}")));
    let mut text = format!("t,{},{}\n", names[0].join(","), names[1].join(","));
    for (t, q, torque) in arm_of_three::run(urdf, count) {
        let angles = q.map(|own| format!("{:.9}", own.to_degrees()));
        let torques = torque.map(|own| format!("{own:.decimals$}"));
        writeln!(text, "{t:.3},{},{}", angles.join(","), torques.join(",")).expect("a string");
    }
    text
}

pub fn arm_run(count: u32) -> String {
    run_of(URDF, count, 9)
}

/// A selector of an element by an id that has brackets or an @ in it.
fn id(name: &str) -> String {
    format!("[id='{name}']")
}

fn parameter(told: &Value, name: &str) -> f64 {
    told["parameters"][name]["value"]
        .as_f64()
        .unwrap_or(f64::NAN)
}

/// The experiment that is open is mapped again.
fn again(bench: &Bench) {
    let free = "return document.querySelector('#lab-head .figures b') !== null && document.querySelector('#again')?.disabled === false";
    bench.browser.until("it can be mapped again", LONG, free);
    bench.browser.click("#again");
    bench.comes_out("read");
}

#[test]
fn a_contact_is_mapped_by_its_tip_on_a_contour_and_again() {
    let bench = Bench::new(&[("edge.csv", &edge(COUNT))]);
    bench.open_as("edge.csv", "contact");
    // Forces are guessed where `lab new` guesses; there is no place along the contour.
    bench.comes_out("asking");
    assert_eq!(bench.value("#signal-tangential_force"), "F_T");
    assert_eq!(bench.value("#signal-normal_force"), "F_N");
    assert_eq!(bench.value("#unit-normal_force"), "N");
    bench.choose("#by-tip", "tip");
    bench.comes_out("asking");
    for (key, column) in [("tip[0]", "tip_x_mm"), ("tip[1]", "tip_y_mm")] {
        assert_eq!(bench.value(&id(&format!("signal-{key}"))), column);
        assert_eq!(bench.value(&id(&format!("unit-{key}"))), "mm");
    }
    assert!(bench.browser.text("#to-choose").contains("contour"));
    // What is no contour is not taken for one.
    bench.write("#contour", "0.2 0.1, 0.4");
    let invalid = "return document.querySelector('#contour').validity.customError";
    assert_eq!(bench.browser.run(invalid, Vec::new()), json!(true));
    bench.write("#contour", "0.2 0.1, 0.2866025404 0.15, 0.3732050808 0.2");
    bench.comes_out("read");
    assert_eq!(bench.read("tip[0]", "rate"), "500.0 Hz");
    let (greatest, axis) = bench.curve(0);
    assert!((0.33..0.36).contains(&greatest), "{greatest}");
    assert_eq!(axis, "tip x<br>[m]");
    bench.begun();
    let text = bench.text("edge.toml");
    for line in [
        "[contact]\ncontour = [[0.2, 0.1], [0.2866025404, 0.15], [0.3732050808, 0.2]]\n",
        "tip = [{ column = \"tip_x_mm\", unit = \"mm\" }, { column = \"tip_y_mm\", unit = \"mm\" }]",
        "effects = [\"contact_coulomb\"]",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let told = bench.compared("edge.toml");
    let friction = parameter(&told, "b0T");
    assert!((friction - 0.3).abs() < 0.005, "{friction}");

    // Again, with a remark in the file that stays.
    let remark = text.replace("[contact]", "# The new edge.\n[contact]");
    let remark = remark.replace("unit = \"N\" }\n", "unit = \"N\" } # by the scale\n");
    assert_ne!(remark, text);
    std::fs::write(bench.path("edge.toml"), &remark).expect("a file");
    again(&bench);
    assert_eq!(
        bench.value("#contour"),
        "0.2 0.1, 0.2866025404 0.15, 0.3732050808 0.2"
    );
    assert!(
        bench
            .browser
            .text("#changes")
            .contains("Nothing is changed")
    );
    bench.write("#contour", "0.2 0.1, 0.3732050808 0.2");
    let told =
        "return document.querySelector(\"#changes [data-change='contact.contour']\") !== null";
    bench.browser.until("the change is told", LONG, told);
    bench.comes_out("read");
    bench.begun();
    let corners = "[[0.2, 0.1], [0.2866025404, 0.15], [0.3732050808, 0.2]]";
    let expected = remark.replace(corners, "[[0.2, 0.1], [0.3732050808, 0.2]]");
    assert_eq!(bench.text("edge.toml"), expected);
    bench.end();
}

#[test]
fn a_whole_arm_is_mapped_joint_by_joint_and_again_with_a_joint_less() {
    let bench = Bench::new(&[("run.csv", &arm_run(COUNT)), ("three.urdf", URDF)]);
    bench.open_as("run.csv", "arm");
    bench.comes_out("read");
    // The folder has one URDF; its joints go from the base on, whatever the file's order is.
    assert_eq!(bench.value("#urdf"), "three.urdf");
    let joints = "return [...document.querySelectorAll('#joints input')].map((own) => [own.value, own.checked])";
    let all = JOINTS.map(|own| json!([format!("{own}_joint"), true]));
    assert_eq!(bench.browser.run(joints, Vec::new()), json!(all));
    for joint in JOINTS {
        for (key, column, unit) in [("position", "q_deg", "deg"), ("motor_torque", "tau", "Nm")] {
            let key = format!("{key}@{joint}_joint");
            let column = format!("{joint}_{column}");
            assert_eq!(bench.value(&id(&format!("signal-{key}"))), column);
            assert_eq!(bench.value(&id(&format!("unit-{key}"))), unit);
            assert_eq!(bench.read(&key, "rate"), "500.0 Hz");
        }
    }
    // Converted: the elbow's angle goes up to 0.95 rad.
    let elbow = "return document.querySelector('#chart-reading').data.findIndex((own) => own.hovertemplate.includes('elbow_q_deg'))";
    let number = bench.browser.number(elbow) as u32;
    let (greatest, axis) = bench.curve(number);
    assert!((0.7..0.96).contains(&greatest), "{greatest}");
    assert_eq!(axis, "elbow_joint<br>position<br>[rad]");
    bench.begun();
    let text = bench.text("run.toml");
    let named = |part: &str| format!("[\"shoulder_{part}\"");
    assert!(text.contains("[arm]\nurdf = \"three.urdf\"\njoints = [\"shoulder_joint\", \"elbow_joint\", \"wrist_joint\"]\n"), "{text}");
    assert!(text.contains(&named("tau")[1..]), "{text}");
    let compared = bench.compared("run.toml");
    for (joint, armature) in JOINTS.iter().zip(ARMATURES) {
        let own = &compared["joints"][format!("{joint}_joint")];
        for (name, truth) in [("inertia", armature), ("b0", 0.8), ("b1", 0.5)] {
            let value = parameter(own, name);
            assert!(
                (value / truth - 1.0).abs() < 0.05,
                "{joint} {name}: {value}"
            );
        }
    }

    // Again: armatures are given, the wrist is left out, comments and what the page has not stay.
    let remark = text.replace(
        "[arm]\n",
        "[arm] # on the wall\ngravity = [0.0, 0.0, -9.81]\n",
    );
    let remark = remark.replace("\"viscous\"]", "\"viscous\", \"stribeck@elbow_joint\"]");
    std::fs::write(bench.path("run.toml"), &remark).expect("a file");
    again(&bench);
    assert!(bench.browser.text("#changes").contains("arm.gravity"));
    bench.browser.click("#joints input[value=wrist_joint]");
    let two = "return document.querySelector('[id=\"signal-position@wrist_joint\"]') === null && document.querySelector('#reading').dataset.state === 'read'";
    bench.browser.until("the wrist is left out", LONG, two);
    bench.write("#armature", "0.3");
    bench.comes_out("refused");
    let told = bench.browser.text("#reading .error");
    assert!(told.contains("1 values for 2 joints"), "{told}");
    bench.write("#armature", "0.3, 0.1");
    bench.comes_out("read");
    let changes = "return [...document.querySelectorAll('#changes [data-change]')].map((own) => own.dataset.change)";
    let changes = bench.browser.run(changes, Vec::new());
    for key in [
        "arm.joints",
        "arm.armature",
        "signals.position",
        "signals.motor_torque",
    ] {
        assert!(
            changes
                .as_array()
                .is_some_and(|all| all.contains(&json!(key))),
            "{changes}"
        );
    }
    bench.begun();
    let new = bench.text("run.toml");
    for kept in [
        "[arm] # on the wall\ngravity = [0.0, 0.0, -9.81]\n",
        "joints = [\"shoulder_joint\", \"elbow_joint\"]\n",
        "armature = [0.3, 0.1]\n",
        "\"viscous\", \"stribeck@elbow_joint\"]",
    ] {
        assert!(new.contains(kept), "{kept}: {new}");
    }
    assert!(!new.contains("wrist"), "{new}");
    bench.end();
}

#[test]
fn an_effect_is_added_to_the_joint_of_an_arm_that_is_shown() {
    let bench = Bench::new(&[("run.csv", &arm_run(COUNT)), ("three.urdf", URDF)]);
    bench.open_as("run.csv", "arm");
    bench.comes_out("read");
    bench.begun();
    let is_shown = |title: &str, steps: usize| {
        let look = format!(
            "return document.querySelector('#lab-head h1')?.textContent === {title:?}
             && JSON.parse(document.querySelector('#chart-stairs')?.dataset.errors ?? '[]').length === {steps}"
        );
        bench.browser.until(title, LONG, &look);
    };
    bench.browser.click("#joint-0");
    is_shown("shoulder_joint", 1);
    bench.browser.click("#joint-1");
    is_shown("elbow_joint", 1);
    bench.choose("#add-effect", "quadratic_viscous");
    is_shown("elbow_joint", 2);
    let child = "run+quadratic_viscous@elbow_joint.toml";
    let text = bench.text(child);
    assert!(text.contains("\"quadratic_viscous@elbow_joint\""), "{text}");
    let compared = bench.compared(child);
    for joint in JOINTS {
        let own = &compared["joints"][format!("{joint}_joint")];
        // There is none: what is found is next to nothing.
        let found = parameter(own, "b2");
        assert_eq!(found.is_nan(), joint != "elbow", "{joint}: {found}");
        assert!(found.is_nan() || found.abs() < 0.01, "{found}");
    }
    bench.browser.click("#undo");
    is_shown("elbow_joint", 1);
    bench.end();
}

/// What the hand holds is in no URDF: a mass of 0.4 kg at the hand's own centre of mass.
#[test]
fn an_arm_is_diagnosed_as_a_whole_and_its_payload_added() {
    let held = URDF.replace("<mass value=\"0.5\"/>", "<mass value=\"0.9\"/>");
    assert_ne!(held, URDF);
    let bench = Bench::new(&[("run.csv", &run_of(&held, COUNT, 2)), ("three.urdf", URDF)]);
    bench.open_as("run.csv", "arm");
    bench.comes_out("read");
    bench.begun();
    let errors = "return [...document.querySelectorAll('#arm-joints tr[data-joint]')].map((own) => [own.dataset.joint, Number(own.dataset.error)])";
    let before = bench.browser.run(errors, Vec::new());
    for (row, joint) in JOINTS.iter().enumerate() {
        assert_eq!(before[row][0], format!("{joint}_joint"), "{before}");
    }
    bench.browser.click("#auto");
    let is_complete = "return document.querySelector('#verdict')?.dataset.verdict === 'complete'";
    bench.browser.until("it is complete", LONG, is_complete);
    let text = bench.text("run+payload.toml");
    assert!(text.contains("\"payload\""), "{text}");
    assert_eq!(bench.experiments(), ["run+payload.toml", "run.toml"]);
    // What is left is the torques' steps of 0.01 Nm.
    let after = bench.browser.run(errors, Vec::new());
    for row in 0..JOINTS.len() {
        let [before, after] = [&before, &after].map(|own| own[row][1].as_f64().unwrap_or(f64::NAN));
        assert!((1e-4..0.01).contains(&after), "{after} Nm");
        // The mass lies on the axis of the wrist, which does not feel it.
        let left = if row == 2 { 0.99..1.01 } else { 0.0..0.2 };
        assert!(left.contains(&(after / before)), "{before} to {after} Nm");
    }
    let cell = |name: &str, column: u32| {
        let selector = format!("[data-parameter='payload.{name}'] td:nth-child({column})");
        let text = bench.browser.text(&selector).replace('−', "-");
        text.parse::<f64>().unwrap_or(f64::NAN)
    };
    for (name, truth) in [("mass", 0.4), ("x", 0.05)] {
        let (value, error) = (cell(name, 3), cell(name, 4));
        assert!((value / truth - 1.0).abs() < 0.05, "{name}: {value}");
        assert!((1e-6..0.01).contains(&error), "{name}: ± {error}");
    }
    let verdicts = "return [...document.querySelectorAll('#arm-joints [data-verdict]')].map((own) => own.dataset.verdict)";
    assert_eq!(
        bench.browser.run(verdicts, Vec::new()),
        json!(["complete", "complete", "complete"])
    );
    assert_eq!(bench.browser.misfits(), Vec::<String>::new());
    // Its joints are a click away, and back.
    bench.browser.click("#joint-1");
    let curves = "return document.querySelector('#chart-stairs')?.dataset.errors !== undefined";
    bench.browser.until("the elbow's curves", LONG, curves);
    bench.browser.click("#whole-arm");
    let whole = "return document.querySelectorAll('#arm-joints tr[data-joint]').length === 3";
    bench.browser.until("the arm again", LONG, whole);
    bench.end();
}

#[test]
fn extra_signals_are_added_read_and_removed() {
    let run = table("t,q,tau,oil_K,u", COUNT, |n, t, q, tau| {
        let oil = 290.0 + 1e-3 * f64::from(n);
        format!("{t:.3},{q:.9},{tau:.9},{oil:.4},{:.3}", 24.0 + 0.1 * q)
    });
    let bench = Bench::new(&[("run.csv", &run)]);
    bench.open("run.csv");
    bench.comes_out("read");
    bench.browser.click("#add-extra");
    bench.write("#extra-0-name", "oil");
    bench.choose("#extra-0-column", "oil_K");
    assert_eq!(bench.value("#extra-0-unit"), "K");
    let read = "return document.querySelector('#reading').dataset.state === 'read' && document.querySelector(\"#reading [data-signal='extra.oil']\") !== null";
    bench.browser.until("it is read", LONG, read);
    assert_eq!(bench.read("extra.oil", "range"), "290.0 … 305.0 K");
    bench.browser.click("#add-extra");
    bench.write("#extra-1-name", "2nd supply");
    let invalid = "return !document.querySelector('#extra-1-name').checkValidity()";
    assert_eq!(bench.browser.run(invalid, Vec::new()), json!(true));
    bench.write("#extra-1-name", "oil");
    assert_eq!(bench.browser.run(invalid, Vec::new()), json!(true));
    // A name that effects use already is refused in words.
    bench.write("#extra-1-name", "qd");
    bench.choose("#extra-1-column", "u");
    bench.comes_out("refused");
    let told = bench.browser.text("#reading .error");
    assert!(
        told.contains("extra.qd") && told.contains("taken"),
        "{told}"
    );
    bench.write("#extra-1-name", "supply");
    bench.choose("#extra-1-unit", "V");
    bench.comes_out("read");
    bench.begun();
    let text = bench.text("run.toml");
    for line in [
        "extra.oil = { column = \"oil_K\", unit = \"K\" }\n",
        "extra.supply = { column = \"u\", unit = \"V\" }\n",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    // An effect can be one of it.
    let own = text.replace(
        "\"viscous\"]",
        "\"viscous\", { name = \"warm\", expression = \"a*oil*sign(qd)\" }]",
    );
    let own = own.replace("unit = \"V\" }\n", "unit = \"V\" } # of the drive\n");
    std::fs::write(bench.path("run.toml"), &own).expect("a file");
    let warm = parameter(&bench.compared("run.toml"), "a");
    assert!(warm.abs() < 1e-3, "{warm}");

    again(&bench);
    assert_eq!(bench.value("#extra-0-name"), "oil");
    assert_eq!(bench.value("#extra-1-unit"), "V");
    bench.write("#extra-1-name", "voltage");
    bench.choose("#extra-1-unit", "mV");
    let renamed = "return document.querySelector(\"#changes [data-change='signals.extra.voltage']\") !== null";
    bench.browser.until("the change is told", LONG, renamed);
    bench.browser.click("#extra-1-remove");
    let gone = "return document.querySelector('#extra-1-name') === null && document.querySelector(\"#changes [data-change='signals.extra.supply']\")?.textContent.includes('nothing') && document.querySelector('#reading').dataset.state === 'read'";
    bench.browser.until("it is removed", LONG, gone);
    bench.begun();
    let line = "extra.supply = { column = \"u\", unit = \"V\" } # of the drive\n";
    assert_eq!(bench.text("run.toml"), own.replace(line, ""));
    bench.end();
}

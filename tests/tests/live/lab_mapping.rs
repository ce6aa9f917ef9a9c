//! Recordings of one's own on the lab's page: what is read is shown, units are doubted,
//! several files are sessions or parts of one, an experiment is mapped again.

use std::{fs, path::Path};

use serde_json::{Value, json};

use super::{
    lab_bench::{Bench, COUNT, table},
    lab_page::LONG,
};

#[test]
fn holes_are_shown_and_what_cannot_be_read_leaves_the_form_and_no_file() {
    let text = table("t,q,broken,remark,tau", COUNT, |n, t, q, tau| match n {
        6000..6500 => String::new(),
        n if n % 997 == 3 => format!("{t:.3},nan,nan,,{tau:.9}"),
        _ => format!(
            "{t:.3},{q:.9},nan,{},{tau:.9}",
            if n == 4000 { "hot" } else { "1" }
        ),
    });
    let bench = Bench::new(&[("holes.csv", &text)]);
    bench.open("holes.csv");
    bench.comes_out("read");
    assert_eq!(bench.value("#signal-position"), "q");
    assert_eq!(bench.read("position", "missing"), "16");
    assert_eq!(bench.read("motor_torque", "missing"), "0");
    assert_eq!(bench.read("position", "rate"), "500.0 Hz");
    assert_eq!(bench.read("position", "gaps"), "1, up to 1.00 s");
    assert_eq!(bench.browser.text("#read-rate b"), "500.0 Hz");
    // 16 of 14 500 have no number.
    assert_eq!(bench.browser.text("#read-share b"), "99.9 %");
    for (column, words) in [
        (
            "broken",
            ["signals.position", "\"broken\"", "holds no number"],
        ),
        (
            "remark",
            ["signals.position", "line 4002", "not a number; fill it"],
        ),
    ] {
        bench.choose("#signal-position", column);
        bench.comes_out("refused");
        let told = bench.browser.text("#reading .error");
        for word in words {
            assert!(told.contains(word), "{word}: {told}");
        }
        // The other signal is seen all the same.
        assert_eq!(bench.read("motor_torque", "missing"), "0");
        bench.browser.click("#begin");
        let refused = "return document.querySelector('#mapping-trouble')?.hidden === false";
        bench.browser.until("it is refused", LONG, refused);
        assert!(bench.browser.text("#mapping-trouble").contains(words[1]));
        assert_eq!(bench.value("#signal-position"), column);
        assert!(!bench.path("holes.toml").exists());
    }
    bench.choose("#signal-position", "q");
    bench.comes_out("read");
    bench.begun();
    let told = bench.compared("holes.toml");
    let inertia = told["parameters"]["inertia"]["value"]
        .as_f64()
        .unwrap_or(0.0);
    assert!((0.78..0.82).contains(&inertia), "{inertia}");
    bench.end();
}

#[test]
fn units_are_guessed_asked_and_doubted_and_each_column_is_drawn() {
    let text = table("t,q,i", COUNT, |n, _, q, tau| {
        // 4 turns and more: no joint does that in radians.
        format!("{},{:.9},{tau:.9}", 2 * n, (20.0 * q).to_degrees() / 20.0)
    });
    let bench = Bench::new(&[("bench.csv", &text)]);
    bench.open("bench.csv");
    bench.comes_out("read");
    assert_eq!(bench.value("#unit-time"), "ms");
    assert_eq!(bench.value("#unit-motor_torque"), "A");
    assert_eq!(bench.value("#unit-position"), "");
    let asked = bench.browser.text("#hint-position");
    assert!(asked.contains("many turns in rad"), "{asked}");
    let (greatest, axis) = bench.curve(0);
    assert!((40.0..50.0).contains(&greatest), "{greatest}");
    assert_eq!(axis, "position<br>[rad]");
    assert_eq!(bench.curve(1).1, "torque<br>[A]");
    // Not written before it is said.
    bench.browser.click("#begin");
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(!bench.path("bench.toml").exists());

    bench.browser.click("#hint-position button");
    bench.comes_out("read");
    assert_eq!(bench.value("#unit-position"), "deg");
    assert_eq!(bench.browser.text("#hint-position"), "");
    let (greatest, axis) = bench.curve(0);
    assert!((0.7..0.87).contains(&greatest), "{greatest}");
    assert_eq!(axis, "position<br>[rad]");

    bench.choose("#unit-position", "rad");
    bench.comes_out("read");
    assert!(
        bench
            .browser
            .text("#hint-position")
            .contains("it may be in deg")
    );
    bench.choose("#unit-time", "s");
    bench.browser.until(
        "seconds are doubted",
        LONG,
        "return document.querySelector('#hint-time [data-unit=ms]') !== null",
    );
    assert!(bench.browser.text("#hint-time").contains("every 2.000 s"));
    bench.browser.click("#hint-time [data-unit=ms]");
    bench.browser.click("#hint-position [data-unit=deg]");
    bench.comes_out("read");
    assert_eq!(bench.browser.text("#mapping .hints"), "");
    let menu = bench.browser.run(
        "return [...document.querySelectorAll('#unit-motor_torque option')].map((own) => own.value)",
        Vec::new(),
    );
    for unit in ["Nm", "mNm", "A", "mA", "V"] {
        assert!(
            menu.as_array()
                .is_some_and(|all| all.contains(&json!(unit))),
            "{menu}"
        );
    }
    assert!(
        menu.as_array()
            .is_some_and(|all| !all.contains(&json!("N"))),
        "{menu}"
    );
    // A joint on rails has other units.
    bench.choose("#joint-kind", "prismatic");
    assert_eq!(bench.value("#unit-position"), "m");
    bench.choose("#unit-position", "mm");
    bench.comes_out("read");
    assert_eq!(bench.curve(0).1, "position<br>[m]");
    bench.choose("#joint-kind", "revolute");
    bench.choose("#unit-position", "deg");
    bench.comes_out("read");
    bench.begun();
    let told = bench.compared("bench.toml");
    assert_eq!(told["unit"], "A");
    let inertia = told["parameters"]["inertia"]["value"]
        .as_f64()
        .unwrap_or(0.0);
    assert!((0.78..0.82).contains(&inertia), "{inertia}");
    bench.end();
}

const HAND_WRITTEN: &str = r#"# Bench 3, the second gear.
recording = "run.csv"   # in degrees, as it turned out
[joint]
type = "revolute"
[signals]
# by the encoder
position = "q"          # output side
motor_torque = { column = "tau", unit = "Nm" }
[filter]
butterworth_hz = 80
decimation = 5
[model]
inertia = { fit = true }
effects = [
    "coulomb", # measured in 2023
    { name = "wave", expression = "a*sin(3*q)" },
]
"#;

#[test]
fn an_experiment_is_mapped_again_and_what_is_replaced_is_said_before() {
    let run = table("t,q,tau", COUNT, |_, t, q, tau| {
        format!("{t:.3},{:.9},{tau:.9}", q.to_degrees())
    });
    let bench = Bench::new(&[("run.csv", &run), ("own.toml", HAND_WRITTEN)]);
    let mapped_again = || {
        bench.open("own.toml");
        let free = "return document.querySelector('#lab-head .figures b') !== null && document.querySelector('#again')?.disabled === false";
        bench.browser.until("it is compared", LONG, free);
        bench.browser.click("#again");
        bench.comes_out("read");
    };
    mapped_again();
    assert_eq!(bench.value("#signal-position"), "q");
    assert_eq!(bench.value("#unit-position"), "");
    assert_eq!(bench.value("#unit-motor_torque"), "Nm");
    let enabled = "return !document.querySelector('#begin').disabled";
    assert_eq!(bench.browser.run(enabled, Vec::new()), json!(false));
    let kept = bench.browser.text("#changes");
    assert!(kept.contains("Nothing is changed"), "{kept}");
    assert!(kept.contains("filter, effect wave"), "{kept}");

    bench.browser.click("#hint-position [data-unit=deg]");
    let told = "return document.querySelectorAll('#changes [data-change]').length === 1";
    bench.browser.until("the change is told", LONG, told);
    let told = bench
        .browser
        .text("#changes [data-change='signals.position']");
    assert!(
        told.contains("\"q\" →") && told.contains("unit = \"deg\""),
        "{told}"
    );
    assert!(
        bench
            .browser
            .text("#begin")
            .contains("Replace this in own.toml")
    );
    assert_eq!(bench.text("own.toml"), HAND_WRITTEN);
    bench.comes_out("read");
    bench.begun();
    let new = "position = { column = \"q\", unit = \"deg\" }          # output side";
    let expected = HAND_WRITTEN.replace("position = \"q\"          # output side", new);
    assert_eq!(bench.text("own.toml"), expected);

    // Another name leaves the file as it is; one that is taken is refused.
    mapped_again();
    let effect = "#mapping input[value=viscous]";
    bench.browser.click(effect);
    let rename = |name: &str| {
        bench.browser.run(
            "const own = document.querySelector('#experiment-name'); own.value = arguments[0]; own.dispatchEvent(new Event('input'))",
            vec![json!(name)],
        );
        let text =
            format!("return document.querySelector('#begin').textContent === 'Write {name}'");
        bench.browser.until("the button tells", LONG, &text);
    };
    fs::write(bench.path("other.toml"), "mine").expect("a file");
    rename("other.toml");
    bench.browser.click("#begin");
    let refused = "return document.querySelector('#mapping-trouble')?.hidden === false";
    bench.browser.until("it is refused", LONG, refused);
    assert!(
        bench
            .browser
            .text("#mapping-trouble")
            .contains("exists already")
    );
    assert_eq!(bench.text("other.toml"), "mine");
    rename("copy.toml");
    bench.begun();
    assert_eq!(bench.text("own.toml"), expected);
    let copy = bench.text("copy.toml");
    let wave = "    { name = \"wave\", expression = \"a*sin(3*q)\" },\n";
    assert_eq!(
        copy,
        expected.replace(wave, &format!("{wave}    \"viscous\",\n"))
    );

    // Who changes the file meanwhile is not written over.
    mapped_again();
    bench.browser.click(effect);
    bench.browser.until("the change is told", LONG, enabled);
    let elsewhere = format!("{expected}# a remark\n");
    fs::write(bench.path("own.toml"), &elsewhere).expect("a file");
    bench.browser.click("#begin");
    bench.browser.until("it is refused", LONG, refused);
    assert!(
        bench
            .browser
            .text("#mapping-trouble")
            .contains("was changed meanwhile")
    );
    assert_eq!(bench.text("own.toml"), elsewhere);
    bench.end();
}

#[test]
fn one_whose_recording_cannot_be_read_can_be_mapped_again() {
    let run = table("t,angle,tau", COUNT, |_, t, q, tau| {
        format!("{t:.3},{q:.9},{tau:.9}")
    });
    let bench = Bench::new(&[("run.csv", &run), ("own.toml", HAND_WRITTEN)]);
    bench.open("own.toml");
    bench.browser.find("#lab-trouble .error");
    // The browser notes that the server refused, once.
    let noted = bench.browser.complaints();
    assert!(noted.len() == 1 && noted[0].contains("422"), "{noted:?}");
    bench.browser.click("#lab-trouble #again");
    bench.comes_out("refused");
    let told = bench.browser.text("#reading .error");
    assert!(told.contains("has no column \"q\""), "{told}");
    bench.choose("#signal-position", "angle");
    bench.comes_out("read");
    bench.begun();
    let new = "position = { column = \"angle\", unit = \"rad\" }          # output side";
    let old = "position = \"q\"          # output side";
    assert_eq!(bench.text("own.toml"), HAND_WRITTEN.replace(old, new));
    bench.end();
}

#[test]
fn several_files_are_sessions_of_which_some_are_held_out() {
    let day = |scale: f64| {
        table("t,q,tau", COUNT, |_, t, q, tau| {
            format!("{t:.3},{:.9},{:.9}", scale * q, scale * tau)
        })
    };
    let days = [day(1.0), day(1.0), day(1.01)];
    let bench = Bench::new(&[
        ("a.csv", &days[0]),
        ("b.csv", &days[1]),
        ("c.csv", &days[2]),
    ]);
    bench.open("a.csv");
    bench.comes_out("read");
    bench.choose("#add-recording", "b.csv");
    bench.comes_out("read");
    bench.choose("#add-recording", "c.csv");
    bench.comes_out("read");
    assert_eq!(bench.value("#together"), "");
    let curves = "return document.querySelector('#chart-reading').data.length";
    assert_eq!(bench.browser.run(curves, Vec::new()), json!(6));
    bench.choose("#part-2", "held");
    bench.comes_out("read");
    let last = "return document.querySelector('#chart-reading').data.at(-1).name";
    assert_eq!(
        bench.browser.run(last, Vec::new()),
        json!("c.csv (held out)")
    );
    bench.begun();
    let text = bench.text("a.toml");
    assert!(
        text.starts_with("recording = [\"a.csv\", \"b.csv\"]\nheld_out = \"c.csv\"\n"),
        "{text}"
    );
    assert!(
        bench
            .browser
            .text("#lab-head .headline")
            .contains("3 sessions")
    );

    // Again: another one is held out, and one left out.
    let free = "return document.querySelector('#again')?.disabled === false";
    bench.browser.until("it can be mapped again", LONG, free);
    bench.browser.click("#again");
    bench.comes_out("read");
    assert_eq!(bench.value("#part-2"), "held");
    bench.choose("#part-2", "");
    bench.choose("#part-0", "held");
    bench.comes_out("read");
    bench.browser.click("[data-recording='b.csv'] button");
    bench.comes_out("read");
    bench.begun();
    let text = bench.text("a.toml");
    assert!(
        text.starts_with("recording = \"c.csv\"\nheld_out = \"a.csv\"\n"),
        "{text}"
    );
    bench.end();
}

#[test]
fn files_dropped_together_with_other_columns_are_parts_of_one_run() {
    let position = table("t,q", COUNT, |_, t, q, _| format!("{t:.3},{q:.9}"));
    let current = table("t,i", COUNT, |_, t, _, tau| {
        format!("{:.3},{tau:.9}", t + 0.0005)
    });
    let bench = Bench::new(&[]);
    let dropped = |files: Value| {
        bench.browser.find("#lab .drop input");
        bench.browser.run(
            "const all = new DataTransfer(), pick = document.querySelector('#lab .drop input');
             for (const [name, text] of arguments[0]) all.items.add(new File([text], name));
             pick.files = all.files; pick.dispatchEvent(new Event('change'))",
            vec![files],
        );
    };
    dropped(json!([
        ["position.csv", position],
        ["current.csv", current]
    ]));
    bench.comes_out("read");
    assert_eq!(bench.text("position.csv"), position);
    let parts = "return document.querySelectorAll('#mapping .recording').length";
    assert_eq!(bench.browser.run(parts, Vec::new()), json!(1));
    assert_eq!(bench.value("#unit-motor_torque"), "A");
    bench.begun();
    let text = bench.text("position.toml");
    assert!(
        text.contains("[[\"position.csv\", \"current.csv\"]]"),
        "{text}"
    );
    let told = bench.compared("position.toml");
    let inertia = told["parameters"]["inertia"]["value"]
        .as_f64()
        .unwrap_or(0.0);
    assert!((0.78..0.82).contains(&inertia), "{inertia}");

    // Neither names nor time: both are said.
    let bare = table("# bare", COUNT, |_, _, q, tau| format!("{q:.9} {tau:.9}"));
    dropped(json!([["bare.txt", bare]]));
    bench.browser.until(
        "names are asked for",
        LONG,
        "return document.querySelector('#columns') !== null",
    );
    let say = |selector: &str, text: &str| {
        bench.browser.find(selector);
        bench.browser.run(
            "const own = document.querySelector(arguments[0]); own.value = arguments[1]; own.dispatchEvent(new Event('change'))",
            vec![json!(selector), json!(text)],
        );
    };
    say("#columns", "q,tau");
    say("#rate", "500");
    bench.comes_out("read");
    bench.begun();
    let text = bench.text("bare.toml");
    assert!(
        text.contains("columns = [\"q\", \"tau\"]\nrate_hz = 500"),
        "{text}"
    );
    assert!(Path::new(&bench.path("bare.toml")).is_file());
    bench.end();
}

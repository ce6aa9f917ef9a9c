//! Recordings as people bring them, made into experiments: the joint's parameters
//! come out, or words that say what to do.

#![allow(clippy::unwrap_used)]

#[path = "../../tests/shared/arm_of_three.rs"]
mod arm_of_three;

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use ferntast_identification::JointType;
use ferntast_lab::{
    guess::Role,
    work::{self, Made, NewError, OfArm, Request, Said, make},
};

/// The joint: τ_m = J q̈ + b₀ sign(q̇) + b₁ q̇.
const INERTIA: f64 = 0.8;
const COULOMB: f64 = 1.5;
const VISCOUS: f64 = 2.0;

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

const COUNT: u32 = 15_000;

/// Rows at 500 Hz, written by `row` from number, time, position and torque.
fn rows(row: impl Fn(u32, f64, f64, f64) -> String) -> String {
    let mut text = String::new();
    for n in 0..COUNT {
        let t = f64::from(n) * 0.002;
        let (q, tau) = joint(t);
        writeln!(text, "{}", row(n, t, q, tau)).unwrap();
    }
    text
}

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Bench {
        let folder = tempfile::tempdir().unwrap();
        Bench { folder }
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }

    fn request(&self, files: &[&str], said: &[(Role, &str)]) -> Request {
        let files = files.iter().map(|name| self.folder.path().join(name));
        Request {
            files: files.collect(),
            said: said
                .iter()
                .map(|(role, text)| (*role, Said::parse(text)))
                .collect(),
            ..Request::default()
        }
    }
}

/// That the experiment has the joint's parameters, torques in `scale` of Nm and in `unit`.
fn holds(experiment: &Path, scale: f64, unit: &str) {
    let opened = work::open_file(experiment).unwrap();
    assert_eq!(opened.torque_unit(), unit, "{experiment:?}");
    let found = opened.compare().unwrap();
    for (name, truth, own) in [
        ("inertia", INERTIA, None),
        ("b0", COULOMB, Some(unit.to_owned())),
        ("b1", VISCOUS, Some(format!("{unit} s/rad"))),
    ] {
        let parameter = &found.parameters[name];
        let value = parameter.value * scale;
        assert!(
            (value / truth - 1.0).abs() < 0.03,
            "{experiment:?}: {name} {value}"
        );
        if let Some(own) = own {
            assert_eq!(parameter.unit, own, "{experiment:?}: {name}");
        }
    }
}

#[test]
fn awkward_files_are_read_as_they_are() {
    let bench = Bench::new();
    let made = |request: &Request, scale: f64, unit: &str| -> Made {
        let made = make(request).unwrap_or_else(|error| panic!("{:?}: {error}", request.files));
        assert!((made.rate_hz - 500.0).abs() < 0.5, "{made:?}");
        holds(&made.experiment, scale, unit);
        made
    };
    // Without names, comments in between, blanks.
    bench.write(
        "bare.txt",
        rows(|n, t, q, tau| {
            let comment = if n % 5000 == 9 {
                "% still running\n"
            } else {
                ""
            };
            format!("{comment}  {t:.3}   {q:.9} {tau:.9}")
        }),
    );
    let columns = ["t", "q", "tau"].map(str::to_owned).to_vec();
    let bare = bench.request(&["bare.txt"], &[]);
    made(&Request { columns, ..bare }, 1.0, "Nm");
    // Milliseconds, by the name and by the steps.
    let ms = rows(|n, _, q, tau| format!("{},{q:.9},{tau:.9}", 2 * n));
    bench.write("named.csv", format!("t_ms,q,tau\n{ms}"));
    made(&bench.request(&["named.csv"], &[]), 1.0, "Nm");
    bench.write("ms.csv", format!("t,q,tau\n{ms}"));
    let told = made(&bench.request(&["ms.csv"], &[]), 1.0, "Nm")
        .warnings
        .join("\n");
    assert!(told.contains("taken for ms"), "{told}");
    // Degrees by the name.
    let degrees = rows(|_, t, q, tau| format!("{t:.3},{:.9},{tau:.9}", q.to_degrees()));
    bench.write("degrees.csv", format!("t,q_deg,tau\n{degrees}"));
    made(&bench.request(&["degrees.csv"], &[]), 1.0, "Nm");
    // Semicolons, decimal commas, a line of units, a preamble.
    let comma =
        rows(|_, t, q, tau| format!("{t:.3};{:.9};{tau:.9}", q.to_degrees()).replace('.', ","));
    bench.write(
        "comma.csv",
        format!("Bench;7\n\nt;q;tau\n[s];[deg];[Nm]\n{comma}"),
    );
    made(&bench.request(&["comma.csv"], &[]), 1.0, "Nm");
    // Volts stay volts: 0.25 V for 1 Nm.
    let volts = rows(|_, t, q, tau| format!("{t:.3}\t{q:.9}\t{:.9}", tau * 0.25));
    bench.write("volts.tsv", format!("# t\tq\tu_V\n{volts}"));
    made(&bench.request(&["volts.tsv"], &[]), 4.0, "V");
    // No time, but a rate; milliamperes become amperes.
    let rate = rows(|_, _, q, tau| format!("{q:.9},{:.9}", tau * 1000.0));
    bench.write("rate.csv", format!("q,current_mA\n{rate}"));
    let rate = bench.request(&["rate.csv"], &[]);
    let rate_hz = Some(500.0);
    made(&Request { rate_hz, ..rate }, 1.0, "A");
    // NaN once in a while, a gap, and a short stretch between two gaps.
    let holes = rows(|n, t, q, tau| match n {
        6000..6500 | 6580..7000 => "# off".to_owned(),
        n if n % 997 == 3 => format!("{t:.3},nan,{tau:.9}"),
        _ => format!("{t:.3},{q:.9},{tau:.9}"),
    });
    bench.write("holes.csv", format!("t,q,tau\n{holes}"));
    let told = made(&bench.request(&["holes.csv"], &[]), 1.0, "Nm");
    let own = &told.recordings[0];
    assert_eq!(
        (own.samples, own.stretches),
        (COUNT as usize - 920, 2),
        "{told:?}"
    );
    assert_eq!(
        (own.in_short_stretches, own.short_stretches),
        (80, 1),
        "{told:?}"
    );
    assert_eq!(
        own.without_number,
        (0..COUNT)
            .filter(|n| n % 997 == 3 && !(6000..7000).contains(n))
            .count()
    );
    assert!(
        told.share_used > 0.99
            && told
                .warnings
                .iter()
                .any(|own| own.contains("without a number"))
    );
}

/// NumPy's `.npy`: version 1.0, little end first.
fn npy(columns: usize, values: impl Iterator<Item = f64>) -> Vec<u8> {
    let values: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
    let rows = values.len() / 8 / columns;
    let header =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [
        &b"\x93NUMPY\x01\x00"[..],
        &length,
        header.as_bytes(),
        &values,
    ]
    .concat()
}

#[test]
fn an_array_is_a_table_too() {
    let bench = Bench::new();
    let values = (0..COUNT).flat_map(|n| {
        let t = f64::from(n) * 0.002;
        let (q, tau) = joint(t);
        [t, q, tau]
    });
    bench.write("run.npy", npy(3, values));
    let request = bench.request(
        &["run.npy"],
        &[(Role::Position, "q:rad"), (Role::MotorTorque, "tau:Nm")],
    );
    let columns = ["t", "q", "tau"].map(str::to_owned).to_vec();
    let made = make(&Request { columns, ..request }).unwrap();
    holds(&made.experiment, 1.0, "Nm");
}

#[test]
fn files_of_one_run_are_joined_and_clocks_apart_are_told() {
    let bench = Bench::new();
    let position = rows(|_, t, q, _| format!("{t:.3},{q:.9}"));
    bench.write("position.csv", format!("t,q\n{position}"));
    // The current at twice the rate, from a little later on.
    let mut current = "t,i\n".to_owned();
    for n in 0..2 * COUNT {
        let t = 0.1003 + f64::from(n) * 0.001;
        writeln!(current, "{t:.4},{:.9}", joint(t).1).unwrap();
    }
    bench.write("current.csv", current);
    let with = |other: &str, output: &str| {
        let request = bench.request(&["position.csv", other], &[]);
        let output = Some(bench.folder.path().join(output));
        make(&Request { output, ..request })
    };
    let made = with("current.csv", "joined.toml").unwrap();
    holds(&made.experiment, 1.0, "A");
    let text = fs::read_to_string(&made.experiment).unwrap();
    assert!(
        text.contains("[[\"position.csv\", \"current.csv\"]]"),
        "{text}"
    );

    let row = rows(|_, _, _, tau| format!("{tau:.9}"));
    bench.write("row.csv", format!("i\n{row}"));
    holds(&with("row.csv", "row.toml").unwrap().experiment, 1.0, "A");
    bench.write("short.csv", "i\n1\n2\n3\n");
    let told = with("short.csv", "x.toml").unwrap_err().to_string();
    assert!(told.contains("short.csv has 3 rows"), "{told}");

    let late = rows(|_, t, _, tau| format!("{:.3},{tau:.9}", t + 32.998));
    bench.write("late.csv", format!("t,i\n{late}"));
    let told = with("late.csv", "x.toml").unwrap_err().to_string();
    assert!(
        told.contains("never overlap") && told.contains("3.000 s apart"),
        "{told}"
    );
}

#[test]
fn what_is_not_certain_is_refused_with_what_to_say() {
    let bench = Bench::new();
    let degrees = rows(|_, t, q, tau| format!("{t:.3},{:.9},{tau:.9}", q.to_degrees()));
    bench.write("angle.csv", format!("t,q,tau\n{degrees}"));
    bench.write("strange.csv", format!("a,b,c\n{degrees}"));
    bench.write("untimed.csv", "q,tau\n0,1\n1,0\n0,1\n");
    let refused = |file: &str, said: &[(Role, &str)], words: &[&str]| {
        let told = make(&bench.request(&[file], said)).unwrap_err().to_string();
        for word in words {
            assert!(told.contains(word), "{told}");
        }
    };
    refused(
        "angle.csv",
        &[],
        &["may be in deg", "--position", "q:deg or "],
    );
    refused("strange.csv", &[], &["--motor-torque COLUMN", "a, b, c"]);
    refused("untimed.csv", &[], &["--rate HZ"]);
    // A force and an angle belong to no joint.
    let force = [(Role::Position, "q:deg"), (Role::MotorTorque, "tau:N")];
    refused("angle.csv", &force, &["revolute joint", "\"deg\""]);
    assert!(!bench.folder.path().join("angle.toml").exists());

    let said = [(Role::Position, "q:deg")];
    let request = bench.request(&["angle.csv"], &said);
    holds(&make(&request).unwrap().experiment, 1.0, "Nm");
    refused("angle.csv", &said, &["exists already", "--force"]);
    make(&Request {
        force: true,
        ..request
    })
    .unwrap();

    let told = work::open(&bench.folder.path().join("angle.csv")).unwrap_err();
    assert!(
        told.to_string()
            .contains("make one first: ferntast lab new"),
        "{told}"
    );
    // An experiment that takes milliseconds for seconds is told so.
    let ms = rows(|n, _, q, tau| format!("{},{q:.9},{tau:.9}", 2 * n));
    bench.write("ms.csv", format!("t,q,tau\n{ms}"));
    let old = bench.write(
        "old.toml",
        "recording = \"ms.csv\"\n[signals]\nposition = \"q\"\nmotor_torque = \"tau\"\n[model]\ninertia = { fit = true }\neffects = [\"coulomb\"]\n",
    );
    let notes = work::open_file(&old).unwrap().notes.join("\n");
    assert!(notes.contains("unit = \"ms\""), "{notes}");
    let none = make(&Request::default());
    assert!(matches!(none, Err(NewError::NoFile)));
}

/// Of a tip on a straight edge: F_T = μ F_N sign(ṙ), μ = 0.3; x and y in mm, r in m.
fn edge(n: u32) -> (f64, [f64; 2], f64, f64) {
    let t = f64::from(n) * 0.002;
    let r = 0.1 + 0.05 * (2.0 * t).sin() + 0.02 * (5.3 * t).sin();
    let speed = 0.1 * (2.0 * t).cos() + 0.106 * (5.3 * t).cos();
    let normal = 5.0 + 2.0 * (0.7 * t).sin();
    // The edge goes up to the right by 30 degrees from (0.2, 0.1).
    let tip = [200.0 + 866.025_403_8 * r, 100.0 + 500.0 * r];
    (r, tip, 0.3 * normal * speed.signum(), normal)
}

#[test]
fn a_contact_is_made_of_a_place_or_of_its_tip_on_a_contour() {
    let bench = Bench::new();
    let text = rows(|n, t, _, _| {
        let (r, tip, tangential, normal) = edge(n);
        format!(
            "{t:.3},{:.6},{:.6},{:.6},{tangential:.6},{normal:.6}",
            1000.0 * r,
            tip[0],
            tip[1]
        )
    });
    bench.write(
        "edge.csv",
        format!("t,place_mm,tip_x_mm,tip_y_mm,F_T,F_N\n{text}"),
    );
    let friction = |made: &Made| {
        let opened = work::open_file(&made.experiment).unwrap();
        assert_eq!(opened.torque_unit(), "N");
        let found = opened.compare().unwrap();
        found.parameters["b0T"].value
    };
    let joint = Some(JointType::Contact);
    let request = bench.request(&["edge.csv"], &[]);
    let by_place = make(&Request {
        joint,
        ..request.clone()
    })
    .unwrap();
    assert!((friction(&by_place) - 0.3).abs() < 0.005);
    let output = Some(bench.folder.path().join("tip.toml"));
    let by_tip = Request {
        joint,
        by_tip: true,
        output,
        ..request
    };
    let told = make(&by_tip).unwrap_err().to_string();
    assert!(
        told.contains("contact.contour") && told.contains("corners"),
        "{told}"
    );
    let contour = Some(vec![
        [0.2, 0.1],
        [0.286_602_540_4, 0.15],
        [0.373_205_080_8, 0.2],
    ]);
    let made = make(&Request { contour, ..by_tip }).unwrap();
    assert!((friction(&made) - 0.3).abs() < 0.005);
    let keys: Vec<&str> = made.signals.iter().map(|own| own.signal.as_str()).collect();
    assert_eq!(
        keys,
        [
            "time",
            "tip[0]",
            "tip[1]",
            "tangential_force",
            "normal_force"
        ]
    );
    // Both ways to the same place.
    let [place, tip] = [by_place, made].map(|own| work::open_file(&own.experiment).unwrap());
    let pairs = place.dataset.sessions[0].position.iter();
    for (a, b) in pairs.zip(&tip.dataset.sessions[0].position) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

/// A table of an arm of three joints, whose columns are called by `called` of a number; positions
/// in degrees.
fn arm_table(called: impl Fn(usize) -> [String; 2]) -> String {
    let names: Vec<String> = (0..3).flat_map(called).collect();
    let mut text = format!("t,{}\n", names.join(","));
    for (t, q, torque) in arm_of_three::run(arm_of_three::URDF, COUNT) {
        write!(text, "{t:.3}").unwrap();
        for (q, torque) in q.iter().zip(torque) {
            write!(text, ",{:.9},{torque:.9}", q.to_degrees()).unwrap();
        }
        text.push('\n');
    }
    text
}

#[test]
fn a_whole_arm_is_made_by_its_urdf_and_names_or_numbers_of_columns() {
    let bench = Bench::new();
    let urdf = bench.write("three.urdf", arm_of_three::URDF);
    let joints = arm_of_three::JOINTS;
    let named = arm_table(|at| ["q", "tau"].map(|own| format!("{own}_{}", joints[at])));
    bench.write("named.csv", named);
    bench.write(
        "numbers.csv",
        arm_table(|at| [format!("q{}_deg", at + 1), format!("tau_{}", at + 1)]),
    );
    bench.write(
        "strange.csv",
        arm_table(|at| [format!("a{at}x"), format!("b{at}y")]),
    );
    let arm = Some(OfArm {
        urdf,
        ..OfArm::default()
    });
    let with = |file: &str, said: &[(Role, &str)]| {
        let request = bench.request(&[file], said);
        make(&Request {
            arm: arm.clone(),
            force: true,
            ..request
        })
    };
    let holds = |made: &Made| {
        let whole: Vec<String> = joints.iter().map(|own| format!("{own}_joint")).collect();
        assert_eq!(made.joints, whole);
        assert!((made.rate_hz - 500.0).abs() < 0.5 && made.share_used > 0.99);
        let opened = work::open_arm(&made.experiment).unwrap().unwrap();
        let found = opened.compare().unwrap();
        for (joint, inertia) in whole.iter().zip([0.3, 0.1, 0.05]) {
            let own = &found.joints[joint];
            let value = |name: &str| own.parameters[name].value;
            assert!(
                (value("inertia") / inertia - 1.0).abs() < 0.03,
                "{joint}: {}",
                value("inertia")
            );
            assert!(
                (value("b0") - 0.8).abs() < 0.02 && (value("b1") - 0.5).abs() < 0.02,
                "{joint}"
            );
        }
    };
    // Degrees that nothing says are asked for, joint by joint.
    let told = with("named.csv", &[]).unwrap_err().to_string();
    for word in [
        "position of shoulder_joint",
        "may be in deg",
        "--position",
        "{joint}",
    ] {
        assert!(told.contains(word), "{word}: {told}");
    }
    holds(
        &with(
            "named.csv",
            &[(Role::Position, "q_shoulder,q_elbow,q_wrist:deg")],
        )
        .unwrap(),
    );
    holds(&with("numbers.csv", &[]).unwrap());
    let text = fs::read_to_string(bench.folder.path().join("numbers.toml")).unwrap();
    assert!(text.contains("urdf = \"three.urdf\""), "{text}");
    let told = with("strange.csv", &[]).unwrap_err().to_string();
    assert!(
        told.contains("nothing is called like a position of shoulder_joint"),
        "{told}"
    );
    let position = (Role::Position, "a0x:deg,a1x:deg,a2x:deg");
    let told = with("strange.csv", &[position, (Role::MotorTorque, "b0y")]);
    let told = told.unwrap_err().to_string();
    assert!(told.contains("is one column for 3 joints"), "{told}");
    let torque = (Role::MotorTorque, "b0y,b1y,b2y");
    holds(&with("strange.csv", &[position, torque]).unwrap());
    // Currents, of which 1 A is 1 Nm: what torque they make has to be said.
    let amperes = (Role::MotorTorque, "b0y,b1y,b2y:A");
    let told = with("strange.csv", &[position, amperes]).unwrap_err();
    assert!(told.to_string().contains("--drive-gain"), "{told}");
    let driven = Request {
        arm: Some(OfArm {
            drive_gain: Some(vec![1.0; 3]),
            ..arm.clone().unwrap()
        }),
        force: true,
        ..bench.request(&["strange.csv"], &[position, amperes])
    };
    holds(&make(&driven).unwrap());
    // A pattern, and one joint said by itself.
    let request = bench.request(&["strange.csv"], &[torque]);
    let mut request = Request {
        arm: arm.clone(),
        force: true,
        ..request
    };
    for (at, joint) in joints.iter().enumerate() {
        let said = Said::parse(&format!("a{at}x:deg"));
        request
            .of_joint
            .push((Role::Position, format!("{joint}_joint"), said));
    }
    holds(&make(&request).unwrap());
    // A part of the arm is an arm; a URDF that is none is told.
    let part = Some(OfArm {
        joints: vec!["nonsense".to_owned()],
        ..arm.clone().unwrap()
    });
    let told = make(&Request {
        arm: part,
        ..request.clone()
    })
    .unwrap_err()
    .to_string();
    assert!(
        told.contains("three.urdf") && told.contains("nonsense"),
        "{told}"
    );
    let none = Some(OfArm {
        urdf: bench.write("no.urdf", "<x/>"),
        ..OfArm::default()
    });
    let told = make(&Request {
        arm: none,
        ..request
    })
    .unwrap_err()
    .to_string();
    assert!(told.contains("no.urdf"), "{told}");
}

#[test]
fn an_extra_signal_is_written_with_its_unit_and_read() {
    let bench = Bench::new();
    let text =
        rows(|n, t, q, tau| format!("{t:.3},{q:.9},{tau:.9},{}", 20.0 + 1e-3 * f64::from(n)));
    bench.write("oil.csv", format!("t,q,tau,oil_K\n{text}"));
    let request = bench.request(&["oil.csv"], &[]);
    let extra = vec![("oil".to_owned(), Said::parse("oil_K"))];
    let made = make(&Request {
        extra,
        ..request.clone()
    })
    .unwrap();
    let own = made.signals.last().unwrap();
    assert_eq!((own.signal.as_str(), own.unit.as_str()), ("extra.oil", "K"));
    let opened = work::open_file(&made.experiment).unwrap();
    assert_eq!(
        opened.dataset.sessions[0].extra["oil"].len(),
        COUNT as usize
    );
    let extra = vec![("oil".to_owned(), Said::parse("water"))];
    let told = make(&Request {
        extra,
        force: true,
        ..request
    })
    .unwrap_err()
    .to_string();
    assert!(
        told.contains("extra.oil") && told.contains("water"),
        "{told}"
    );
}

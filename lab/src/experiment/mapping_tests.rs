//! Mappings read out of experiment files, changed, and written into them again.

use std::path::Path;

use ferntast_identification::{Inertia, JointType};

use super::{ArmPart, Changed, Mapping, Place};

const FILE: &str = r#"# The bench.
recording = [
    { file = "a.csv", conditions = { kp = 100 } }, # cold
    ["b.csv", "i.csv"],
    "c.csv",
]
[joint]
type = "revolute"
[signals]
position = { column = "q", unit = "deg" } # encoder
motor_torque = "i"
extra.supply = "u"
[filter]
butterworth_hz = 80
decimation = 5
[model]
inertia = 1.1 # by hand
effects = ["coulomb", { name = "wave", expression = "a*sin(q)" }, "viscous"]
"#;

fn changed(change: impl Fn(&mut Mapping)) -> Changed {
    let path = Path::new("e.toml");
    let mut mapping = Mapping::parse(FILE, path).unwrap().mapping;
    change(&mut mapping);
    mapping.put_into(FILE, path, path).unwrap()
}

fn keys(changed: &Changed) -> Vec<&str> {
    changed.changes.iter().map(|own| own.key.as_str()).collect()
}

#[test]
fn a_mapping_that_is_put_back_changes_nothing() {
    let mapped = Mapping::parse(FILE, Path::new("e.toml")).unwrap();
    assert_eq!(mapped.kept, ["filter", "effect wave"]);
    assert_eq!(mapped.mapping.recordings[1], ["b.csv", "i.csv"]);
    assert_eq!(mapped.mapping.effects, ["coulomb", "viscous"]);
    assert_eq!(mapped.mapping.signals["extra.supply"].column, "u");
    let same = changed(|_| {});
    assert_eq!((same.text.as_str(), same.changes.len()), (FILE, 0));
}

#[test]
fn what_is_changed_is_told_and_all_else_stays() {
    let unit = changed(|own| {
        let place = own.signals.get_mut("motor_torque").unwrap();
        place.unit = Some("A".to_owned());
    });
    assert_eq!(keys(&unit), ["signals.motor_torque"]);
    assert_eq!(unit.changes[0].before, "\"i\"");
    let new = "motor_torque = { column = \"i\", unit = \"A\" }";
    assert_eq!(unit.text, FILE.replace("motor_torque = \"i\"", new));

    let held = changed(|own| own.held_out = own.recordings.drain(..1).collect());
    assert_eq!(keys(&held), ["recording", "held_out"]);
    let stated = "held_out = [{ file = \"a.csv\", conditions = { kp = 100 } }]";
    assert!(held.text.contains(stated), "{}", held.text);
    assert!(
        !held
            .text
            .contains("\"a.csv\", conditions = { kp = 100 } }, # cold")
    );
    let again = Mapping::parse(&held.text, Path::new("e.toml")).unwrap();
    assert_eq!(again.mapping.recordings.len(), 2);

    let longer = changed(|own| own.recordings.push(vec!["d.csv".to_owned()]));
    let last = "    \"c.csv\",\n";
    let expected = FILE.replace(last, &format!("{last}    \"d.csv\",\n"));
    assert_eq!(longer.text, expected);

    let model = changed(|own| {
        own.inertia = Inertia::Fit;
        own.effects = vec!["viscous".to_owned(), "stribeck".to_owned()];
        own.signals.remove("extra.supply");
    });
    let expected = ["signals.extra.supply", "model.inertia", "model.effects"];
    assert_eq!(keys(&model), expected);
    assert!(model.text.contains("inertia = { fit = true } # by hand"));
    assert!(!model.text.contains("supply") && !model.text.contains("coulomb"));
    for kept in ["butterworth_hz = 80", "a*sin(q)", "# encoder", "stribeck"] {
        assert!(model.text.contains(kept), "{kept}: {}", model.text);
    }
}

#[test]
fn a_joint_can_become_a_contact_and_a_new_file_is_read_as_it_was_meant() {
    let place = |column: &str, unit: &str| Place {
        column: column.to_owned(),
        unit: Some(unit.to_owned()),
        time: None,
    };
    let contact = Mapping {
        recordings: vec![vec!["a.csv".to_owned()]],
        held_out: vec![vec!["b.csv".to_owned()]],
        columns: Vec::new(),
        rate_hz: Some(500.0),
        join: None,
        joint: JointType::Contact,
        arm: None,
        contour: None,
        signals: [
            ("position".to_owned(), place("x", "mm")),
            ("tangential_force".to_owned(), place("ft", "N")),
            ("normal_force".to_owned(), place("fn", "N")),
        ]
        .into(),
        inertia: Inertia::Given(0.0),
        gear_ratio: None,
        effects: vec!["contact_coulomb".to_owned()],
    };
    let path = Path::new("e.toml");
    let new = contact.document();
    assert_eq!(Mapping::parse(&new, path).unwrap().mapping, contact);
    let turned = contact.put_into(FILE, path, path).unwrap();
    let read = Mapping::parse(&turned.text, path).unwrap();
    assert_eq!(read.mapping, contact);
    assert!(keys(&turned).contains(&"joint.type"), "{turned:?}");
}

#[test]
fn a_copy_elsewhere_leads_to_the_same_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let sub = folder.path().join("sub");
    std::fs::create_dir(&sub).unwrap();
    let (path, output) = (folder.path().join("e.toml"), sub.join("e.toml"));
    let mut mapping = Mapping::parse(FILE, &path).unwrap().mapping;
    for file in mapping.recordings.iter_mut().flatten() {
        *file = format!("../{file}");
    }
    let copy = mapping.put_into(FILE, &path, &output).unwrap();
    assert_eq!(copy.changes, []);
    assert_eq!(
        Mapping::parse(&copy.text, &output).unwrap().mapping,
        mapping
    );
}

#[test]
fn a_tip_is_mapped_with_its_contour_and_gives_way_to_a_place() {
    let text = r#"recording = "a.csv"
[contact]
contour = [[0.2, -0.03], [0.4, -0.03]] # the edge
[signals]
tip = ["x", { column = "y", unit = "mm" }] # by the camera
tangential_force = "ft"
normal_force = "fn" # by the scale
[model]
effects = ["contact_coulomb"]
"#;
    let path = Path::new("e.toml");
    let mapped = Mapping::parse(text, path).unwrap();
    assert_eq!(mapped.kept, Vec::<String>::new());
    let mapping = mapped.mapping;
    assert_eq!(mapping.contour, Some(vec![[0.2, -0.03], [0.4, -0.03]]));
    assert_eq!(mapping.signals["tip[1]"].unit.as_deref(), Some("mm"));
    let needed = ["tip[0]", "tip[1]", "tangential_force", "normal_force"];
    assert_eq!(mapping.needed(), needed);
    let same = mapping.put_into(text, path, path).unwrap();
    assert_eq!((same.text.as_str(), same.changes.len()), (text, 0));

    let mut other = mapping.clone();
    other.signals.get_mut("tip[0]").unwrap().unit = Some("mm".to_owned());
    other.contour = Some(vec![[0.0, 0.0], [0.4, 0.0], [0.4, 0.1]]);
    let changed = other.put_into(text, path, path).unwrap();
    assert_eq!(keys(&changed), ["contact.contour", "signals.tip"]);
    for line in [
        "contour = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.1]] # the edge",
        "tip = [{ column = \"x\", unit = \"mm\" }, { column = \"y\", unit = \"mm\" }] # by the camera",
        "normal_force = \"fn\" # by the scale",
    ] {
        assert!(changed.text.contains(line), "{line}: {}", changed.text);
    }
    let mut by_place = mapping;
    by_place.contour = None;
    by_place.signals.retain(|key, _| !key.starts_with("tip"));
    let place = Place {
        column: "r".to_owned(),
        ..Place::default()
    };
    by_place.signals.insert("position".to_owned(), place);
    let changed = by_place.put_into(text, path, path).unwrap();
    let mut told = keys(&changed);
    told.sort_unstable();
    assert_eq!(told, ["contact.contour", "signals.position", "signals.tip"]);
    assert_eq!(
        Mapping::parse(&changed.text, path).unwrap().mapping,
        by_place
    );
}

#[test]
fn an_arm_is_mapped_joint_by_joint_and_written_by_one_name_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.urdf"), TWO).unwrap();
    let text = r#"recording = "a.csv"
[arm] # on the wall
urdf = "two.urdf"
base = "base"
tip = "hand"
gravity = [-9.81, 0.0, 0.0]
armature = [0.3, 0.1] # weighed
[signals]
position = { column = "q_{joint}", unit = "deg" } # encoders
motor_torque = ["i1", "i2"]
[model]
effects = ["coulomb", "stribeck@elbow"]
"#;
    let path = folder.path().join("e.toml");
    let mapped = Mapping::parse(text, &path).unwrap();
    assert_eq!(mapped.kept, ["arm.gravity"]);
    let mapping = mapped.mapping;
    let arm = mapping.arm.clone().unwrap();
    assert_eq!(arm.joints, ["shoulder", "elbow", "slide"][..2]);
    assert_eq!(arm.armature, Some(vec![0.3, 0.1]));
    let elbow = &mapping.signals["position@elbow"];
    assert_eq!(
        (elbow.column.as_str(), elbow.unit.as_deref()),
        ("q_elbow", Some("deg"))
    );
    assert_eq!(mapping.signals["motor_torque@elbow"].column, "i2");
    let same = mapping.put_into(text, &path, &path).unwrap();
    assert_eq!((same.text.as_str(), same.changes.len()), (text, 0));

    // One joint more, by other columns; what is not said otherwise stays.
    let mut more = mapping.clone();
    let place = |column: &str, unit: Option<&str>| Place {
        column: column.to_owned(),
        unit: unit.map(str::to_owned),
        time: None,
    };
    let own = more.arm.as_mut().unwrap();
    own.joints.push("slide".to_owned());
    own.armature = None;
    more.signals
        .insert("position@slide".to_owned(), place("x", Some("mm")));
    more.signals
        .insert("motor_torque@slide".to_owned(), place("f", Some("N")));
    more.effects.push("viscous".to_owned());
    let changed = more.put_into(text, &path, &path).unwrap();
    let expected = [
        "arm.joints",
        "arm.armature",
        "signals.motor_torque",
        "signals.position",
        "model.effects",
    ];
    assert_eq!(keys(&changed), expected);
    for kept in ["# on the wall", "gravity", "# encoders", "stribeck@elbow"] {
        assert!(changed.text.contains(kept), "{kept}: {}", changed.text);
    }
    assert!(!changed.text.contains("base ="), "{}", changed.text);
    assert_eq!(Mapping::parse(&changed.text, &path).unwrap().mapping, more);

    // A joint's file becomes an arm's.
    let from_joint = mapping.put_into(FILE, &path, &path).unwrap();
    assert!(keys(&from_joint).contains(&"joint.type"), "{from_joint:?}");
    let read = Mapping::parse(&from_joint.text, &path).unwrap().mapping;
    assert_eq!(read.arm, Some(arm.clone()));
    assert_eq!(read.signals, mapping.signals);
    assert!(from_joint.text.contains("butterworth_hz = 80"));
    // A new one has joints by name, and a URDF elsewhere is found from there.
    let new = Mapping {
        arm: Some(ArmPart {
            gear_ratio: Some(vec![100.0, 50.0]),
            ..arm
        }),
        ..mapping
    };
    assert_eq!(Mapping::parse(&new.document(), &path).unwrap().mapping, new);
    let sub = folder.path().join("sub");
    std::fs::create_dir(&sub).unwrap();
    let mut moved = new;
    moved.recordings = vec![vec!["../a.csv".to_owned()]];
    moved.arm.as_mut().unwrap().urdf = "../two.urdf".to_owned();
    let copy = moved.put_into(text, &path, &sub.join("e.toml")).unwrap();
    assert_eq!(keys(&copy), ["arm.gear_ratio"]);
    assert!(
        copy.text.contains("urdf = \"../two.urdf\""),
        "{}",
        copy.text
    );
}

const TWO: &str = r#"<robot name="three"><link name="base"/>
<link name="upper"><inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<link name="hand"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<link name="tool"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="hand"/><axis xyz="0 1 0"/></joint>
<joint name="slide" type="prismatic"><parent link="hand"/><child link="tool"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.2" effort="10" velocity="1"/></joint></robot>"#;

#[test]
fn extra_signals_come_and_go_among_the_others() {
    let more = changed(|own| {
        let place = Place {
            column: "temp".to_owned(),
            unit: Some("K".to_owned()),
            time: None,
        };
        own.signals.insert("extra.oil".to_owned(), place);
    });
    let line = "extra.supply = \"u\"\n";
    let new = "extra.oil = { column = \"temp\", unit = \"K\" }\n";
    assert_eq!(more.text, FILE.replace(line, &format!("{line}{new}")));
    let gone = changed(|own| own.signals.retain(|key, _| !key.starts_with("extra")));
    assert_eq!(gone.text, FILE.replace(line, ""));
    // Where there was none it stands among the signals, too.
    let path = Path::new("e.toml");
    let without = FILE.replace(line, "");
    let mapping = Mapping::parse(&more.text, path).unwrap().mapping;
    let first = mapping.put_into(&without, path, path).unwrap();
    assert!(first.text.contains(new), "{}", first.text);
    assert_eq!(Mapping::parse(&first.text, path).unwrap().mapping, mapping);
}

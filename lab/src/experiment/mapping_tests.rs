//! Mappings read out of experiment files, changed, and written into them again.

use std::path::Path;

use ferntast_identification::{Inertia, JointType};

use super::{Changed, Mapping, Place};

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

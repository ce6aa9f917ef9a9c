//! What is read, what is refused, what is written and read again.

use std::fs;

use super::*;

const SAMPLE: &str = r#"# my joint
recording = ["a.mcap", "${FERNTAST_DATA}/b.csv"] # two runs
held_out = "/abs/c.mcap"
[joint]
type = "prismatic"
[signals]
position = "/js.position[0]"   # m
motor_torque = "/m.effort[0]"
extra.supply = "/power.voltage"
[model]
inertia = { fit = true }
gear_ratio = 160
effects = ["coulomb", { name = "bump", expression = "b*exp(-(qd/vs)^2)", vs = [0.005, 0.2] }] # so far
"#;

fn parse(text: &str) -> Result<Experiment, ExperimentError> {
    Experiment::parse(text, Path::new("dir/e.toml"), Path::new("/data"))
}

#[test]
fn a_file_is_read_and_its_paths_count_from_its_folder() {
    let experiment = parse(SAMPLE).unwrap();
    let recordings = ["dir/a.mcap", "/data/b.csv"].map(PathBuf::from);
    assert_eq!(experiment.recordings, recordings);
    assert_eq!(experiment.held_out, [PathBuf::from("/abs/c.mcap")]);
    assert_eq!(experiment.joint, JointType::Prismatic);
    assert_eq!(experiment.signals.extra["supply"], "/power.voltage");
    assert_eq!(experiment.model.inertia, Inertia::Fit);
    let Term::Custom(custom) = &experiment.model.effects[1] else {
        panic!("{:?}", experiment.model);
    };
    assert_eq!(custom.bounds["vs"], [0.005, 0.2]);
}

#[test]
fn a_torque_that_a_model_gives_is_stated_and_there() {
    assert!(!parse(SAMPLE).unwrap().torque_is_modelled);
    let stated = SAMPLE.replace("[signals]", "torque_is_modelled = true\n[signals]");
    let told = parse(&stated).unwrap_err().to_string();
    assert!(
        told.contains("joint.torque_is_modelled: there is no signals.joint_torque"),
        "{told}"
    );
    let stated = stated.replace(
        "extra.supply",
        "joint_torque = \"/load.effort[0]\"\nextra.supply",
    );
    assert!(parse(&stated).unwrap().torque_is_modelled);
}

#[test]
fn conditions_belong_to_their_recording() {
    let stated = SAMPLE.replace(
        "[\"a.mcap\", \"${FERNTAST_DATA}/b.csv\"]",
        "[\"a.mcap\", { file = \"b.csv\", conditions = { kp = 100, mass = 0.5 } }, { file = [\"q.csv\", \"i.csv\"], conditions = { kp = 200 } }]",
    );
    let experiment = parse(&stated).unwrap();
    let files = ["dir/a.mcap", "dir/b.csv", "dir/q.csv"].map(PathBuf::from);
    assert_eq!(experiment.recordings, files);
    assert_eq!(experiment.joined[&files[2]], [PathBuf::from("dir/i.csv")]);
    assert!(!experiment.conditions.contains_key(&files[0]));
    assert_eq!(experiment.conditions[&files[1]]["mass"], 0.5);
    assert_eq!(experiment.conditions[&files[2]]["kp"], 200.0);
    for (from, to, words) in [
        (
            "mass = 0.5",
            "\"a mass\" = 0.5",
            "recording.conditions.a mass: a name is",
        ),
        (
            "mass = 0.5",
            "mass = nan",
            "recording.conditions.mass: NaN is no number",
        ),
    ] {
        let told = parse(&stated.replace(from, to)).unwrap_err().to_string();
        assert!(told.contains(words), "{told}");
    }
}

#[test]
fn a_file_begins_one_recording_alone() {
    let with =
        |list: &str| parse(&SAMPLE.replace("[\"a.mcap\", \"${FERNTAST_DATA}/b.csv\"]", list));
    // Both would be read with i2.csv, and both at 0.5 kg.
    for list in [
        "[[\"q.csv\", \"i1.csv\"], [\"q.csv\", \"i2.csv\"]]",
        "[\"q.csv\", [\"q.csv\", \"i2.csv\"]]",
        "[\"q.csv\", { file = \"q.csv\", conditions = { mass = 0.5 } }]",
    ] {
        let told = with(list).unwrap_err().to_string();
        assert!(
            told.contains("recording: dir/q.csv begins more than one recording"),
            "{told}"
        );
    }
    let turned = with("[[\"i1.csv\", \"q.csv\"], [\"i2.csv\", \"q.csv\"]]").unwrap();
    assert_eq!(turned.recordings.len(), 2);
    assert_eq!(turned.joined.len(), 2);
}

#[test]
fn what_is_wrong_is_named() {
    for (from, to, words) in [
        ("held_out", "heldout", "unknown field `heldout`"),
        (
            "motor_torque = \"/m.effort[0]\"",
            "",
            "signals.motor_torque: it is missing",
        ),
        ("position =", "positon =", "unknown field `positon`"),
        (
            "{ fit = true }",
            "{ fit = false }",
            "model.inertia: give a number",
        ),
        ("{ fit = true }", "\"big\"", "expected a number (kg m²"),
        ("{ fit = true }", "-1.0", "model.inertia: -1 is outside"),
        ("{ fit = true }", "nan", "model.inertia: NaN is outside"),
        ("= 160", "= 0", "model.gear_ratio: 0 is outside"),
        ("\"prismatic\"", "\"helical\"", "unknown variant `helical`"),
        ("[0.005, 0.2]", "[0.2, 0.2]", "exclude every value"),
        ("[0.005, 0.2]", "0.2", "expected an effect's id"),
        (
            "\"bump\"",
            "\"coulomb\"",
            "model.effects[1]: coulomb is there twice",
        ),
        ("\"bump\"", "\"a b\"", "a name is letters"),
        (
            "extra.supply",
            "extra.tau_m",
            "signals.extra.tau_m: the name is taken",
        ),
        (
            "[\"a.mcap\", \"${FERNTAST_DATA}/b.csv\"]",
            "[]",
            "the list is empty",
        ),
        ("[joint]", "[joint", "TOML parse error at line 4"),
    ] {
        assert!(SAMPLE.contains(from), "{from}");
        let error = parse(&SAMPLE.replacen(from, to, 1))
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("dir/e.toml: ") && error.contains(words),
            "{error}"
        );
    }
}

fn added(effect: Term, before: f64, after: f64) -> NextStep {
    let b0 = FittedParameter {
        value: 11.5,
        std_error: Some(0.2),
        unit: "N".to_owned(),
    };
    let bs = FittedParameter {
        value: 3.0,
        std_error: None,
        unit: "N".to_owned(),
    };
    NextStep {
        effect: Some(effect),
        twin_recording: None,
        held_out_before: before,
        held_out_after: after,
        unit: "N".to_owned(),
        parameters: [("b0".to_owned(), b0), ("bs".to_owned(), bs)].into(),
    }
}

#[test]
fn a_child_keeps_comments_and_knows_where_it_came_from() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("sub")).unwrap();
    fs::write(at("a.csv"), "first").unwrap();
    fs::write(at("b.csv"), "second").unwrap();
    let text = SAMPLE
        .replace("a.mcap", "a.csv")
        .replace("\"/abs/c.mcap\"", "[]");
    fs::write(at("e.toml"), text).unwrap();
    let first = Experiment::read(&at("e.toml"), folder.path()).unwrap();

    let stribeck = Term::Catalogue("stribeck".to_owned());
    write_child(
        &first,
        &added(stribeck.clone(), 2.0, 1.5),
        &at("sub/e2.toml"),
    )
    .unwrap();
    let text = fs::read_to_string(at("sub/e2.toml")).unwrap();
    for kept in [
        "# my joint",
        "# two runs",
        "# m\n",
        "] # so far",
        "\"../a.csv\"",
        "\"${FERNTAST_DATA}/b.csv\"",
    ] {
        assert!(text.contains(kept), "{kept} in {text}");
    }
    let second = Experiment::read(&at("sub/e2.toml"), folder.path()).unwrap();
    assert_eq!(second.model.effects[2], stribeck);
    assert_eq!(
        data_hash(&second.recordings).unwrap(),
        data_hash(&first.recordings).unwrap()
    );
    let lineage = second.lineage.clone().unwrap();
    assert_eq!(lineage.parent, "../e.toml");
    // printf '\005\0\0\0\0\0\0\0first\006\0\0\0\0\0\0\0second' | sha256sum
    assert_eq!(lineage.data_sha256, SHA256);
    assert_eq!(lineage.parameters["b0"].std_error, Some(0.2));
    assert_eq!(lineage.parameters["bs"].std_error, None);

    let mine = CustomEffect {
        name: "cogging".to_owned(),
        expression: "a*sin(k*q)".to_owned(),
        bounds: [("k".to_owned(), [5.0, 7.0])].into(),
    };
    let mine = Term::Custom(mine);
    fs::write(at("b.csv"), "changed").unwrap();
    write_child(&second, &added(mine.clone(), 1.5, 1.2), &at("e3.toml")).unwrap();
    let third = Experiment::read(&at("e3.toml"), folder.path()).unwrap();
    assert_eq!(third.model.effects[3], mine);
    assert_eq!(third.lineage.clone().unwrap().parent, "sub/e2.toml");

    let steps = history(&at("e3.toml"), folder.path()).unwrap();
    let errors: Vec<_> = steps.iter().map(|step| step.held_out).collect();
    assert_eq!(errors, [Some(2.0), Some(1.5), Some(1.2)]);
    let names: Vec<_> = steps.iter().map(|step| step.added.as_deref()).collect();
    assert_eq!(names, [None, Some("stribeck"), Some("cogging")]);
    assert_eq!(steps[2].effects.len(), 4);
    assert!(!steps[1].other_data && steps[2].other_data);

    // A parent that is gone shortens the chain.
    fs::remove_file(at("e.toml")).unwrap();
    assert_eq!(history(&at("e3.toml"), folder.path()).unwrap().len(), 2);
}

const SHA256: &str = "2ff8a9f01da276c49f015bbe38a3b50eb7bf8d960b1094bc289fdb50ed281c4f";

#[test]
fn what_must_not_be_written_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.csv"), "x").unwrap();
    let text = SAMPLE.replace("[\"a.mcap\", \"${FERNTAST_DATA}/b.csv\"]", "\"a.csv\"");
    fs::write(at("e.toml"), text.replace("\"/abs/c.mcap\"", "[]")).unwrap();
    let mut experiment = Experiment::read(&at("e.toml"), folder.path()).unwrap();
    let new = added(Term::Catalogue("stribeck".to_owned()), 2.0, 1.0);
    let old = added(Term::Catalogue("coulomb".to_owned()), 2.0, 1.0);
    let refused = |experiment: &Experiment, added, name| {
        write_child(experiment, added, &at(name))
            .unwrap_err()
            .to_string()
    };
    assert!(refused(&experiment, &new, "e.toml").contains("is the experiment itself"));
    assert!(refused(&experiment, &old, "f.toml").contains("coulomb is in the model already"));
    assert!(refused(&experiment, &new, "no/f.toml").contains("cannot write"));
    assert!(!at("f.toml").exists());
    experiment.path = None;
    assert!(refused(&experiment, &new, "f.toml").contains("no experiment file"));

    let circle = "[lineage]\nparent = \"e.toml\"\neffect = \"x\"\ndata_sha256 = \"\"\nheld_out_before = 1.0\nheld_out_after = 1.0\nunit = \"N\"\n";
    let text = fs::read_to_string(at("e.toml")).unwrap();
    fs::write(at("e.toml"), text + circle).unwrap();
    let error = history(&at("e.toml"), folder.path()).unwrap_err();
    assert!(error.to_string().contains("lead back to it"));
}

const CONTACT: &str = r#"
recording = "edge"
[contact]
contour = [[0.2, -0.03], [0.4, -0.03]]
[signals]
tangential_force = "/follower/contact_cf.wrench.force.x.@negative"
normal_force = "/follower/contact_cf.wrench.force.z"
tip = ["/follower/measured_cp.pose.position.x", "/follower/measured_cp.pose.position.y"]
[model]
effects = ["contact_coulomb", { name = "film", expression = "a*F_N*rd" }]
"#;

#[test]
fn a_contact_has_forces_and_a_place_in_place_of_torques() {
    let experiment = parse(CONTACT).unwrap();
    assert_eq!(experiment.joint, JointType::Contact);
    assert_eq!(experiment.model.inertia, Inertia::Given(0.0));
    let contour = experiment.contour.unwrap();
    assert!((contour.place(0.25, -0.0301) - 0.05).abs() < 1e-12);
    let signals = experiment.signals;
    assert!(signals.motor_torque.ends_with("force.x.@negative"));
    assert!(signals.normal_force.unwrap().ends_with("force.z"));
    assert!(signals.position.ends_with(".x") && signals.tip_y.unwrap().ends_with(".y"));

    let place = CONTACT
        .replace("contour = [[0.2, -0.03], [0.4, -0.03]]", "")
        .replace("tip = [\"/follower/measured_cp.pose.position.x\", \"/follower/measured_cp.pose.position.y\"]", "position = \"r\"");
    assert_eq!(parse(&place).unwrap().signals.position, "r");
}

#[test]
fn what_is_wrong_with_a_contact_is_named() {
    let normal = "normal_force = \"/follower/contact_cf.wrench.force.z\"";
    for (from, to, words) in [
        (normal, "", "signals.normal_force: it is missing"),
        (
            "tangential_force",
            "motor_torque",
            "signals.motor_torque: it is a signal of a joint",
        ),
        (
            "[contact]\ncontour = [[0.2, -0.03], [0.4, -0.03]]",
            "",
            "signals.tip: it is a signal of a contact",
        ),
        (
            "[contact]\n",
            "[joint]\ntype = \"contact\"\n[contact]\n",
            "there is a [joint] too",
        ),
        (
            "contour = [[0.2, -0.03], [0.4, -0.03]]",
            "",
            "contact.contour: it is missing",
        ),
        (
            "[0.4, -0.03]]",
            "[0.2, -0.03]]",
            "contact.contour: give two corners",
        ),
        (
            "[model]",
            "[model]\ninertia = 1.0",
            "model.inertia: a contact has no inertia",
        ),
        (
            "[model]",
            "[model]\ngear_ratio = 160",
            "model.gear_ratio: a contact has no gear",
        ),
        (
            "[model]",
            "[signals.extra]\nF_N = \"/x.y\"\n[model]",
            "the name is taken",
        ),
    ] {
        let told = parse(&CONTACT.replace(from, to)).unwrap_err().to_string();
        assert!(told.contains(words), "{told}\n{words}");
    }
    let kind = "recording = \"e\"\n[joint]\ntype = \"contact\"\n[signals]\nposition = \"r\"\n[model]\neffects = []\n";
    let told = parse(kind).unwrap_err().to_string();
    assert!(told.contains("write [contact]"), "{told}");
}

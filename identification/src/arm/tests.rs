//! A planar arm of two joints in gravity, whose torques are written down by hand.

mod soft_gear;

use std::f64::consts::PI;

use ferntast_model::rigid_body::{
    Chain, ChainJoint, JointKind, LinkInertia, Matrix3, Placement, PositionLimits, Vector3,
};

use super::*;
use crate::data::Inertia;
use crate::diagnosis::Verdict;
use crate::tests::recordings::noise;

const UPPER_ARM: f64 = 0.4;
const ARMATURE: [f64; 2] = [0.3, 0.1];
const GRAVITY: [f64; 2] = [0.0, -9.81];

/// A point mass on the second link: mass \[kg\] and place in its frame \[m\].
type Point = (f64, [f64; 2]);

const SHOULDER_MASS: f64 = 1.5;
const FOREARM: Point = (0.8, [0.3, 0.0]);

#[derive(Clone, Copy)]
struct State {
    q: [f64; 2],
    qd: [f64; 2],
    qdd: [f64; 2],
}

/// Torques of point masses on the links of a planar arm: textbook form (Spong, Hutchinson,
/// Vidyasagar, Robot Modeling and Control, 2006, section 7.4), each mass for itself.
fn links(s: &State, points: &[Point], gravity: [f64; 2]) -> [f64; 2] {
    let (l, [q1, q2]) = (UPPER_ARM, s.q);
    let pull = |angle: f64| -gravity[0] * angle.sin() + gravity[1] * angle.cos();
    let mut torque = [
        SHOULDER_MASS * l * l * s.qdd[0] - SHOULDER_MASS * l * pull(q1),
        0.0,
    ];
    for (mass, [x, y]) in points {
        let (r, alpha) = (x.hypot(*y), y.atan2(*x));
        let (sine, cosine) = (q2 + alpha).sin_cos();
        let coupled = mass * l * r;
        let elbow = mass * r * r;
        torque[0] += (mass * l * l + elbow + 2.0 * coupled * cosine) * s.qdd[0]
            + (elbow + coupled * cosine) * s.qdd[1]
            - coupled * sine * (2.0 * s.qd[0] * s.qd[1] + s.qd[1] * s.qd[1])
            - mass * (l * pull(q1) + r * pull(q1 + q2 + alpha));
        torque[1] += (elbow + coupled * cosine) * s.qdd[0]
            + elbow * s.qdd[1]
            + coupled * sine * s.qd[0] * s.qd[0]
            - mass * r * pull(q1 + q2 + alpha);
    }
    torque
}

/// Three sessions of 20 s; `more` is what a model of links, Coulomb and viscous friction
/// does not have.
fn recording(seed: u64, more: impl Fn(&State) -> [f64; 2]) -> ArmDataset {
    let mut noise = noise(2 * seed + 1);
    let sessions = (0..3).map(|k| {
        let mut session = empty_session(k, 0.005);
        for i in 0..4000 {
            let t = 0.005 * f64::from(i);
            let mut s = State {
                q: [0.3, 0.5],
                qd: [0.0; 2],
                qdd: [0.0; 2],
            };
            for (joint, parts) in [
                [(0.5, 0.7), (0.25, 1.9), (0.06, 5.1)],
                [(0.6, 1.1), (0.2, 2.3), (0.05, 6.3)],
            ]
            .iter()
            .enumerate()
            {
                for (amplitude, rate) in parts {
                    let rate = rate * (1.0 + 0.04 * f64::from(k));
                    let (sine, cosine) = (rate * t + f64::from(k) + joint as f64).sin_cos();
                    s.q[joint] += amplitude * sine;
                    s.qd[joint] += amplitude * rate * cosine;
                    s.qdd[joint] -= amplitude * rate * rate * sine;
                }
            }
            let (own, more) = (links(&s, &[FOREARM], GRAVITY), more(&s));
            measure(
                &mut session,
                &s,
                [own[0] + more[0], own[1] + more[1]],
                &mut noise,
            );
        }
        session
    });
    dataset(sessions)
}

fn empty_session(number: u32, period: f64) -> ArmSession {
    ArmSession {
        name: format!("session {}", number + 1),
        start: 100.0 * f64::from(number),
        period,
        position: vec![Vec::new(); 2],
        motor_torque: vec![Vec::new(); 2],
        ..ArmSession::default()
    }
}

fn dataset(sessions: impl Iterator<Item = ArmSession>) -> ArmDataset {
    ArmDataset {
        joints: ["shoulder", "elbow"].map(str::to_owned).to_vec(),
        sessions: sessions.collect(),
        ..ArmDataset::default()
    }
}

/// Adds a sample of motors with armature, Coulomb and viscous friction, which bear `load` \[Nm\].
fn measure(
    session: &mut ArmSession,
    motors: &State,
    load: [f64; 2],
    noise: &mut impl FnMut() -> f64,
) {
    for joint in 0..2 {
        let coulomb = [1.0, 0.4][joint] * motors.qd[joint].signum();
        let viscous = [0.8, 0.3][joint] * motors.qd[joint];
        let torque = load[joint] + ARMATURE[joint] * motors.qdd[joint] + coulomb + viscous;
        session.position[joint].push(motors.q[joint] + 2e-6 * noise());
        session.motor_torque[joint].push(torque + 0.03 * noise());
    }
}

fn model(effects: &[&str]) -> ArmSpec {
    let link = |at: f64, mass: f64, along: f64| ChainJoint {
        kind: JointKind::Revolute,
        placement: Placement {
            translation: Vector3::new(at, 0.0, 0.0),
            ..Placement::identity()
        },
        axis: Vector3::z(),
        armature: 0.0,
        limits: PositionLimits::NONE,
        link: LinkInertia::about_center_of_mass(
            mass,
            Vector3::new(along, 0.0, 0.0),
            Matrix3::zeros(),
        ),
    };
    let joints = [
        link(0.0, SHOULDER_MASS, UPPER_ARM),
        link(UPPER_ARM, FOREARM.0, FOREARM.1[0]),
    ];
    ArmSpec {
        chain: Chain::new(&joints, Placement::identity()).unwrap(),
        gravity: Vector3::new(GRAVITY[0], GRAVITY[1], 0.0),
        armature: ARMATURE.map(Inertia::Given).to_vec(),
        gear_ratio: vec![None; 2],
        effects: effects.iter().map(|text| ArmTerm::parse(text)).collect(),
    }
}

fn ask(dataset: &ArmDataset, effects: &[&str]) -> ArmDiagnosis {
    diagnose(dataset, &model(effects), &mut |_| ()).unwrap()
}

const PLAIN: [&str; 2] = ["coulomb", "viscous"];

fn all_complete(told: &ArmDiagnosis) {
    assert_eq!(told.verdict, Verdict::Complete, "{:#?}", told.candidates);
    let mut joints = told.joints.values();
    assert!(joints.all(|own| own.verdict == Verdict::Complete));
    assert!(told.candidates.is_empty());
    // Motions of the other joint are there; these sessions have no temperature, and no sensor.
    let not_tested = &told.not_tested.not_tested;
    assert!(
        !not_tested.iter().any(|own| own == "joint_coupling"),
        "{not_tested:?}"
    );
    assert!(
        not_tested.iter().any(|own| own == "elasticity"),
        "{not_tested:?}"
    );
}

#[test]
fn a_model_that_has_everything_is_complete_in_every_joint() {
    let dataset = recording(1, |_| [0.0; 2]);
    let compared = compare(&dataset, &model(&PLAIN)).unwrap();
    let value = |joint: &str, name: &str| compared.joints[joint].parameters[name].value;
    assert!((value("shoulder", "b0") - 1.0).abs() < 0.01);
    assert!((value("elbow", "b1") - 0.3).abs() < 0.01);
    // White noise of 0.03 Nm through the filter on columns.
    let errors = compared.joints.values().map(|own| own.rms.held_out);
    for error in errors {
        assert!(error > 0.005 && error < 0.02, "{error}");
    }
    all_complete(&ask(&dataset, &PLAIN));
}

#[test]
fn a_payload_wins_against_effects_of_single_joints_and_leaves_nothing() {
    let ball = (0.5, [0.35, 0.1]);
    let dataset = recording(2, |s| links_of(s, ball));
    let told = ask(&dataset, &PLAIN);
    assert_eq!(told.verdict, Verdict::Missing);
    assert_eq!(told.candidates.len(), 1, "{:#?}", told.candidates);
    let first = &told.candidates[0];
    assert_eq!(
        (first.named.effect.as_str(), &first.joint),
        ("payload", &None)
    );
    assert!(first.named.held_out_after < 0.1 * first.named.held_out_before);
    let mut joints = told.joints.values();
    assert!(joints.all(|own| own.verdict == Verdict::Missing));

    let more = [&PLAIN[..], &["payload"]].concat();
    let found = compare(&dataset, &model(&more)).unwrap();
    for (name, wanted) in [("mass", 0.5), ("x", 0.35), ("y", 0.1)] {
        let found = found.arm["payload"][name].value;
        assert!(
            (found - wanted).abs() < 0.01 * wanted.max(0.2),
            "{name} {found}"
        );
    }
    all_complete(&ask(&dataset, &more));

    let added = add(&dataset, &model(&PLAIN), &ArmTerm::parse("payload")).unwrap();
    assert!(added.lowers_error && added.joint.is_none());
    assert!((added.parameters["payload.mass"].value - 0.5).abs() < 0.005);
    assert!((added.parameters["b0@elbow"].value - 0.4).abs() < 0.01);
}

/// What a ball on the forearm adds.
fn links_of(s: &State, ball: Point) -> [f64; 2] {
    let (with, without) = (
        links(s, &[FOREARM, ball], GRAVITY),
        links(s, &[FOREARM], GRAVITY),
    );
    [with[0] - without[0], with[1] - without[1]]
}

#[test]
fn a_base_that_leans_is_told_from_a_payload() {
    let angle = 2.0 * PI / 180.0;
    let leaning = [9.81 * f64::sin(angle), -9.81 * f64::cos(angle)];
    let dataset = recording(3, |s| {
        let (then, now) = (links(s, &[FOREARM], leaning), links(s, &[FOREARM], GRAVITY));
        [then[0] - now[0], then[1] - now[1]]
    });
    let told = ask(&dataset, &PLAIN);
    let first = &told.candidates[0];
    // In a plane that is no other than a first joint whose zero is elsewhere, which is simpler.
    let place = (first.named.effect.as_str(), first.joint.as_deref());
    assert_eq!(place, ("joint_zero", Some("shoulder")), "{told:#?}");
    let alike = &first.named.indistinguishable_from;
    assert!(alike.contains(&"base_tilt".to_owned()), "{alike:?}");
    assert!(!alike.contains(&"payload".to_owned()), "{alike:?}");
    let more = [&PLAIN[..], &["base_tilt"]].concat();
    all_complete(&ask(&dataset, &more));
}

/// What links take more that are farther by `zeros` \[rad\] than the joints say.
fn links_farther(s: &State, zeros: [f64; 2]) -> [f64; 2] {
    let mut farther = *s;
    farther.q = [s.q[0] + zeros[0], s.q[1] + zeros[1]];
    let (then, now) = (
        links(&farther, &[FOREARM], GRAVITY),
        links(s, &[FOREARM], GRAVITY),
    );
    [then[0] - now[0], then[1] - now[1]]
}

#[test]
fn a_joint_whose_zero_is_elsewhere_is_named_with_it() {
    let zero = 2.0 * PI / 180.0;
    let dataset = recording(8, |s| links_farther(s, [0.0, zero]));
    let told = ask(&dataset, &PLAIN);
    let first = &told.candidates[0];
    let place = (first.named.effect.as_str(), first.joint.as_deref());
    assert_eq!(place, ("joint_zero", Some("elbow")), "{told:#?}");
    let more = [&PLAIN[..], &["joint_zero@elbow"]].concat();
    all_complete(&ask(&dataset, &more));
    // A third of a turn, too, which one linear step does not reach.
    for zero in [zero, PI / 3.0] {
        let dataset = recording(8, |s| links_farther(s, [0.0, zero]));
        let found = compare(&dataset, &model(&more)).unwrap();
        let found = &found.arm["joint_zero@elbow"]["zero"];
        assert!((found.value - zero).abs() < 1e-3, "{found:?}");
        assert_eq!(found.unit, "rad");
    }
}

#[test]
fn an_arm_that_is_not_calibrated_is_in_one_step() {
    let zeros = [0.15, -0.2];
    let dataset = recording(9, |s| links_farther(s, zeros));
    let told = ask(&dataset, &PLAIN);
    let first = &told.candidates[0];
    assert_eq!(first.named.effect, "joint_zeros", "{told:#?}");
    assert_eq!((&first.joint, told.candidates.len()), (&None, 1));
    let added = add(&dataset, &model(&PLAIN), &ArmTerm::parse("joint_zeros")).unwrap();
    assert!(added.lowers_error);
    for (joint, zero) in ["shoulder", "elbow"].into_iter().zip(zeros) {
        let found = added.parameters[&format!("joint_zeros.{joint}")].value;
        assert!((found - zero).abs() < 1e-3, "{joint}: {found}");
    }
    let more = [&PLAIN[..], &["joint_zeros"]].concat();
    all_complete(&ask(&dataset, &more));
}

/// The same recording with joints read otherwise: `(joint, position, torque)` changes each sample.
fn read_otherwise(
    mut dataset: ArmDataset,
    joint: usize,
    position: impl Fn(f64) -> f64,
    torque: impl Fn(f64) -> f64,
) -> ArmDataset {
    for session in &mut dataset.sessions {
        for own in &mut session.position[joint] {
            *own = position(*own);
        }
        for own in &mut session.motor_torque[joint] {
            *own = torque(*own);
        }
    }
    dataset
}

/// What is said of joints of `dataset` that are read otherwise than the model has them: nothing else is
/// named then.
fn misread(dataset: &ArmDataset) -> Vec<(String, bool, bool, f64)> {
    let told = ask(dataset, &PLAIN);
    assert_eq!(told.verdict, Verdict::Unexplained);
    assert!(told.candidates.is_empty(), "{:#?}", told.candidates);
    assert_eq!(
        compare(dataset, &model(&PLAIN)).unwrap().misread,
        told.misread
    );
    let each = told.misread.iter().map(|own| {
        assert!(own.error_after < 0.2 * own.error_before, "{own:?}");
        (
            own.joint.clone(),
            own.reversed,
            own.torque_reversed,
            own.zero,
        )
    });
    each.collect()
}

#[test]
fn joints_that_are_read_the_other_way_round_are_told_before_anything_is_named() {
    let right = || recording(10, |_| [0.0; 2]);
    let elbow = |reversed, torque, zero| vec![("elbow".to_owned(), reversed, torque, zero)];
    let turned = |own: f64| -own;
    let flipped = read_otherwise(right(), 1, |own| own, turned);
    assert_eq!(misread(&flipped), elbow(false, true, 0.0));
    let reversed = read_otherwise(right(), 1, turned, turned);
    assert_eq!(misread(&reversed), elbow(true, false, 0.0));
    let position = read_otherwise(right(), 1, turned, |own| own);
    assert_eq!(misread(&position), elbow(true, true, 0.0));
    let quarter = read_otherwise(right(), 1, |own| 0.5 * PI - own, turned);
    assert_eq!(misread(&quarter), elbow(true, false, 0.5 * PI));
}

#[test]
fn the_other_order_of_two_joints_is_told() {
    let mut dataset = recording(11, |_| [0.0; 2]);
    for session in &mut dataset.sessions {
        session.motor_torque.swap(0, 1);
    }
    let told = ask(&dataset, &PLAIN).misread;
    let whose: Vec<Option<&str>> = told
        .iter()
        .map(|own| own.torque_is_read_as.as_deref())
        .collect();
    assert_eq!(whose, [Some("elbow"), Some("shoulder")], "{told:?}");
}

/// What is missing, however much it is, is no other way to read a joint; nor is a model that is wrong.
#[test]
fn a_heavy_payload_and_offsets_are_no_misreading() {
    let offsets = recording(13, |_| [6.0, -4.0]);
    assert_eq!(compare(&offsets, &model(&PLAIN)).unwrap().misread, []);
    let dataset = recording(12, |s| links_of(s, (2.0, [0.35, 0.1])));
    let told = ask(&dataset, &PLAIN);
    assert_eq!(told.misread, []);
    assert_eq!(told.candidates[0].named.effect, "payload");
}

#[test]
fn an_effect_of_one_joint_is_named_there_and_nowhere_else() {
    let bump = |v: f64| 0.5 * (-(v / 0.1).powi(2)).exp() * v.signum();
    let dataset = recording(4, |s| [0.0, bump(s.qd[1])]);
    let told = ask(&dataset, &PLAIN);
    let first = &told.candidates[0];
    assert_eq!(first.joint.as_deref(), Some("elbow"));
    assert_eq!(first.named.effect, "stribeck", "{:#?}", told.candidates);
    assert_eq!(told.joints["shoulder"].verdict, Verdict::Complete);
    assert_eq!(told.joints["elbow"].verdict, Verdict::Missing);
    let more = [&PLAIN[..], &["stribeck@elbow"]].concat();
    all_complete(&ask(&dataset, &more));
}

#[test]
fn friction_by_another_joints_motion_says_from_which() {
    let dataset = recording(5, |s| [0.0, 0.1 * s.qd[0]]);
    let told = ask(&dataset, &PLAIN);
    let first = &told.candidates[0];
    let place = (first.joint.as_deref(), first.partner.as_deref());
    assert_eq!(place, (Some("elbow"), Some("shoulder")));
    assert_eq!(first.named.effect, "joint_coupling");
    let found = first.named.parameters["cv_of_shoulder"].value;
    assert!((found - 0.1).abs() < 0.005, "{found}");
    assert!(!first.named.parameters.contains_key("ct_of_shoulder"));
}

#[test]
fn what_has_no_name_is_placed_in_its_joint_with_its_signals() {
    let dataset = recording(6, |s| [0.0, 0.4 * s.q[0] * s.q[1]]);
    let told = ask(&dataset, &PLAIN);
    assert_eq!(told.verdict, Verdict::Unexplained, "{:#?}", told.candidates);
    assert_eq!(told.joints["elbow"].verdict, Verdict::Unexplained);
    assert_eq!(told.joints["shoulder"].verdict, Verdict::Complete);
    let first = &told.residual_depends_on[0];
    assert_eq!(first.joint, "elbow");
    assert_eq!(first.dependence.signals, ["position", "position_shoulder"]);
}

#[test]
fn effects_that_are_nowhere_are_refused() {
    let dataset = recording(7, |_| [0.0; 2]);
    let refused = |effect: &str| {
        let effects = [&PLAIN[..], &[effect]].concat();
        compare(&dataset, &model(&effects)).unwrap_err().to_string()
    };
    assert!(refused("stribeck@wrist").contains("its joints are shoulder, elbow"));
    assert!(refused("payload@elbow").contains("leave the joint out"));
    assert!(refused("link_inertia").contains("link_inertia@JOINT"));
    assert!(refused("nonsense@elbow").starts_with("elbow: "));
    let twice = model(&["payload", "payload"]);
    assert!(matches!(compare(&dataset, &twice), Err(ArmError::Twice(_))));
    let mut other = model(&PLAIN);
    other.armature.pop();
    let error = compare(&dataset, &other).unwrap_err().to_string();
    assert!(
        error.contains("armatures: 1 where the arm has 2 joints"),
        "{error}"
    );
}

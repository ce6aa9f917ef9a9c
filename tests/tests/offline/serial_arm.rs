//! Arms out of URDF files, from the hand to the contact and back, in virtual time.

use std::fs;

use ferntast_model::{Joints, rigid_body::Vector3};
use ferntast_msgs::topics;
use ferntast_tests::{Session, messages, number, refused, run};
use ferntast_urdf::Robot;
use serde_json::json;

/// A small arm of four joints, the last one sliding: a shoulder that pans and lifts, an
/// elbow, a stylus. Names as long as those of UR's arms.
const ARM: &str = r#"<?xml version="1.0"?>
<robot name="small">
  <link name="stand"/>
  <joint name="shoulder_pan_joint" type="revolute">
    <parent link="stand"/> <child link="shoulder"/> <origin xyz="0 0 0.2"/> <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="40" velocity="2"/>
  </joint>
  <link name="shoulder">
    <inertial> <mass value="2"/> <inertia ixx="0.01" iyy="0.01" izz="0.01"/> </inertial>
  </link>
  <joint name="shoulder_lift_joint" type="revolute">
    <parent link="shoulder"/> <child link="upper"/> <axis xyz="0 1 0"/>
    <limit lower="-2" upper="1" effort="40" velocity="2"/>
  </joint>
  <link name="upper">
    <inertial> <origin xyz="0.15 0 0"/> <mass value="1.5"/>
      <inertia ixx="0.002" iyy="0.012" izz="0.012"/> </inertial>
  </link>
  <joint name="elbow_joint" type="revolute">
    <parent link="upper"/> <child link="fore"/> <origin xyz="0.3 0 0"/> <axis xyz="0 1 0"/>
    <limit lower="0.1" upper="2.5" effort="25" velocity="2"/>
  </joint>
  <link name="fore">
    <inertial> <origin xyz="0.12 0 0"/> <mass value="1"/>
      <inertia ixx="0.001" iyy="0.006" izz="0.006"/> </inertial>
  </link>
  <joint name="stylus_joint" type="prismatic">
    <parent link="fore"/> <child link="stylus"/> <origin xyz="0.25 0 0"/> <axis xyz="1 0 0"/>
    <limit lower="-0.02" upper="0.05" effort="60" velocity="0.5"/>
  </joint>
  <link name="stylus">
    <inertial> <mass value="0.3"/> <inertia ixx="0.0005" iyy="0.0005" izz="0.0005"/> </inertial>
  </link>
</robot>
"#;

fn with_arm(text: &str) -> Session {
    let session = Session::new();
    fs::write(session.folder().join("small.urdf"), text).expect("scratch");
    session
}

#[test]
fn a_hand_drives_seven_joints_and_feels_the_table() {
    let session = Session::new();
    let arguments = [
        "lockstep",
        "--arm",
        "panda",
        "--duration",
        "10",
        "--record",
        "run",
        "--json",
    ];
    let told = run(&session, &arguments).success().json();
    assert_eq!(told["arm"], "panda");
    assert_eq!(told["joints"], 7);
    assert_eq!(told["driver"], "simulated");
    assert_eq!(told["contact"]["edges"], json!(["surface"]));
    assert_eq!(told["states"]["follower"]["final"], "ENABLED");
    let peak = number(&told, "contact.peak_force_N");
    assert!((10.0..60.0).contains(&peak), "{told:#}");
    assert!(number(&told, "contact.time_s") > 4.0, "{told:#}");
    assert!(number(&told, "tip.drift_mm") < 1.0, "{told:#}");
    // The arm gives way as well: less than the table's 20 kN/m.
    let felt = number(&told, "felt_stiffness_N_per_m");
    assert!((2e3..2e4).contains(&felt), "{told:#}");
    assert!(number(&told, "leader.peak_force_N") > 0.5, "{told:#}");

    // The recorded pose is that of the recorded joints, by the file's own geometry.
    let urdf = fs::read(ferntast_tests::root().join("config/arms/panda.urdf")).expect("a file");
    let arm = Robot::read(&urdf)
        .expect("readable")
        .whole_arm()
        .expect("an arm");
    let folder = session.folder().join("run");
    let poses = messages(&folder, topics::FOLLOWER_MEASURED_CP);
    let joints = messages(&folder, topics::FOLLOWER_MEASURED_JS);
    let pose = poses.last().expect("poses").message;
    let same = joints.iter().find(|own| own.message.stamp == pose.stamp);
    let joints = same.expect("the measurement of the pose").message;
    let q = Joints::from_fn(arm.chain.count(), |joint| joints.position[joint]);
    let tip = arm.chain.forward(&q).translation;
    assert!((tip - Vector3::from(pose.position)).norm() < 1e-3, "{tip}");
    assert_eq!(joints.joints.get(6), Some("panda_joint7"));

    let replay = run(&session, &["replay", "run", "--json"]).success().json();
    assert_eq!(replay["equal"], true, "{replay:#}");
}

#[test]
fn a_urdf_alone_is_enough() {
    let session = with_arm(ARM);
    let arguments = [
        "lockstep",
        "--arm",
        "small.urdf",
        "--duration",
        "8",
        "--json",
    ];
    let told = run(&session, &arguments).success().json();
    assert_eq!(
        (&told["arm"], &told["joints"]),
        (&json!("small"), &json!(4))
    );
    assert!(number(&told, "contact.time_s") > 2.0, "{told:#}");
    assert!(number(&told, "tip.drift_mm") < 1.0, "{told:#}");
    assert_eq!(told["states"]["follower"]["final"], "ENABLED");
    // The same seed gives the same.
    let again = run(&session, &arguments).success().json();
    assert_eq!(told["contact"], again["contact"]);
}

/// The arm on five turntables, one on the other.
fn nine_joints() -> String {
    let tables: String = (0..5)
        .map(|table| {
            let on = match table {
                0 => "stand".to_owned(),
                _ => format!("table_{table}"),
            };
            let own = match table {
                4 => "arm_stand".to_owned(),
                _ => format!("table_{}", table + 1),
            };
            format!(
                "<link name=\"{own}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" \
                 izz=\"0.01\"/></inertial></link><joint name=\"turn_{table}\" type=\"revolute\"><parent \
                 link=\"{on}\"/><child link=\"{own}\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" \
                 effort=\"40\" velocity=\"2\"/></joint>"
            )
        })
        .collect();
    let arm = ARM.replacen(
        "<parent link=\"stand\"/>",
        "<parent link=\"arm_stand\"/>",
        1,
    );
    arm.replacen("</robot>", &format!("{tables}</robot>"), 1)
}

/// Meshes are for the eye: an arm is driven without them.
#[test]
fn a_mesh_that_is_missing_is_not_needed() {
    let mesh = "<visual><geometry><mesh filename=\"package://nowhere/upper.stl\"/></geometry></visual>\
                <collision><geometry><mesh filename=\"missing.dae\"/></geometry></collision>";
    let text = ARM.replacen(
        "<link name=\"upper\">",
        &format!("<link name=\"upper\">{mesh}"),
        1,
    );
    assert!(text.contains("missing.dae"));
    let arguments = [
        "lockstep",
        "--arm",
        "small.urdf",
        "--duration",
        "1",
        "--json",
    ];
    let told = run(&with_arm(&text), &arguments).success().json();
    assert_eq!(told["joints"], 4);
    assert_eq!(told["states"]["follower"]["final"], "ENABLED");
}

#[test]
fn what_is_no_arm_is_refused_with_what_to_do() {
    let replaced = |from: &str, to: &str| {
        assert!(ARM.contains(from), "{from}");
        ARM.replacen(from, to, 1)
    };
    let cases = [
        (
            replaced(
                "<mass value=\"0.3\"/> <inertia ixx=\"0.0005\" iyy=\"0.0005\" izz=\"0.0005\"/>",
                "<mass value=\"0\"/> <inertia ixx=\"0\" iyy=\"0\" izz=\"0\"/>",
            ),
            vec!["small.urdf", "stylus", "no mass"],
        ),
        (
            replaced("type=\"prismatic\"", "type=\"floating\""),
            vec!["small.urdf", "stylus_joint", "floating"],
        ),
        (
            replaced("lower=\"0.1\" upper=\"2.5\"", "lower=\"2.5\" upper=\"0.1\""),
            vec!["small.urdf", "elbow_joint", "upside down"],
        ),
        (
            replaced("type=\"prismatic\"", "type=\"planar\""),
            vec![
                "small.urdf",
                "stylus_joint",
                "line",
                "planar",
                "prismatic joints",
            ],
        ),
        (
            replaced(
                "</robot>",
                "<joint name=\"back\" type=\"fixed\"><parent link=\"stylus\"/><child link=\"upper\"/></joint></robot>",
            ),
            vec!["small.urdf", "upper", "a loop", "line"],
        ),
        (nine_joints(), vec!["small.urdf", "9 joints", "at most 8"]),
        (replaced("</robot>", ""), vec!["small.urdf", "XML"]),
    ];
    for (text, words) in cases {
        let session = with_arm(&text);
        for command in ["lockstep", "session"] {
            refused(&session, &[command, "--arm", "small.urdf"], &words);
        }
    }
    let session = with_arm(ARM);
    refused(
        &session,
        &["lockstep", "--arm", "missing.urdf"],
        &["missing.urdf"],
    );
    let file = |text: &str| {
        let text = format!("[arm]\nurdf = \"small.urdf\"\n{text}");
        fs::write(session.folder().join("own.toml"), text).expect("scratch");
    };
    let cases = [
        ("tip = \"stilus\"", vec!["own.toml", "stilus", "stylus"]),
        (
            "home = [0.0, 0.0]",
            vec!["own.toml", "arm.home", "4 are needed"],
        ),
        (
            "[[joint]]\nname = \"wrist\"",
            vec!["own.toml", "wrist", "elbow_joint"],
        ),
        (
            "[[joint]]\nname = \"elbow_joint\"\nstifness = 3.0",
            vec!["own.toml", "elbow_joint", "stifness"],
        ),
        (
            "[servo]\ndamping = [1.0]",
            vec!["own.toml", "servo.damping", "4 are needed"],
        ),
        (
            "[estimator]\ncut_off = -1.0",
            vec!["own.toml", "estimator.cut_off"],
        ),
    ];
    for (text, words) in cases {
        file(text);
        refused(&session, &["lockstep", "--arm", "own.toml"], &words);
    }
}

//! Arms out of files, and what is said of files that are none.

use ferntast_model::{
    Joints,
    rigid_body::{JointKind, Vector3},
};
use ferntast_urdf::{Arm, ArmError, ReadError, Robot};

/// A shoulder that turns, a forearm that slides, a tool fixed to it with a finger.
const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="world"/>
  <joint name="stand" type="fixed">
    <parent link="world"/> <child link="base"/> <origin xyz="0 0 0.5"/>
  </joint>
  <link name="base"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/> <child link="upper"/>
    <origin xyz="0 0 0.5" rpy="0 0 0"/> <axis xyz="0 0 2"/>
    <limit lower="-1.5" upper="2.5" effort="80" velocity="2"/>
  </joint>
  <link name="upper">
    <inertial>
      <origin xyz="0.25 0 0"/> <mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
    </inertial>
    <visual><geometry><mesh filename="package://nowhere/upper.stl"/></geometry></visual>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="upper"/> <child link="fore"/> <origin xyz="0.5 0 0"/>
    <limit lower="0" upper="0.3" effort="100" velocity="1"/>
  </joint>
  <link name="fore">
    <inertial> <mass value="1"/> <inertia ixx="0.01" iyy="0.01" izz="0.01"/> </inertial>
  </link>
  <joint name="flange" type="fixed">
    <parent link="fore"/> <child link="tool"/> <origin xyz="0.2 0 0" rpy="0 0 1.5707963267948966"/>
  </joint>
  <link name="tool">
    <inertial>
      <origin xyz="0 -0.2 0"/> <mass value="0.5"/> <inertia ixx="0" iyy="0" izz="0"/>
    </inertial>
  </link>
  <joint name="finger_joint" type="revolute">
    <parent link="tool"/> <child link="finger"/> <origin xyz="0 0 0.1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="slide"/>
  </joint>
  <link name="finger">
    <inertial> <mass value="0.25"/> <inertia ixx="0" iyy="0" izz="0"/> </inertial>
  </link>
</robot>
"#;

fn arm(text: &str, base: &str, tip: &str) -> Result<Arm, ArmError> {
    Robot::read(text.as_bytes())
        .expect("readable")
        .between(base, tip)
}

fn read_error(text: &str) -> ReadError {
    Robot::read(text.as_bytes()).expect_err("no robot")
}

/// The file with a part replaced that is in it.
fn with(from: &str, to: &str) -> String {
    assert!(ARM.contains(from), "{from}");
    ARM.replacen(from, to, 1)
}

#[test]
fn an_arm_has_the_joints_between_base_and_tip() {
    let arm = arm(ARM, "world", "tool").unwrap();
    assert_eq!(arm.joints, ["shoulder", "slide"]);
    assert_eq!(arm.efforts, [Some(80.0), Some(100.0)]);
    assert_eq!(arm.velocities, [Some(2.0), Some(1.0)]);
    let chain = &arm.chain;
    assert_eq!(chain.kinds(), [JointKind::Revolute, JointKind::Prismatic]);
    let limits: Vec<_> = chain.limits().iter().map(|l| (l.lower, l.upper)).collect();
    assert_eq!(limits, [(-1.5, 2.5), (0.0, 0.3)]);

    // Half a turn's half: the arm points along y.
    let q = Joints::from([std::f64::consts::FRAC_PI_2, 0.1]);
    let tip = chain.forward(&q);
    assert!((tip.translation - Vector3::new(0.0, 0.8, 1.0)).norm() < 1e-14);
    // The tool's x axis: turned by the flange and the shoulder.
    assert!((tip.rotation.column(0) + Vector3::x()).norm() < 1e-14);
}

#[test]
fn what_hangs_on_a_link_is_part_of_it() {
    let arm = arm(ARM, "base", "fore").unwrap();
    let [upper, fore] = arm.chain.inertias()[..] else {
        panic!("two links")
    };
    assert_eq!(upper.mass, 2.0);
    assert!((upper.rotational.m33 - (0.02 + 2.0 * 0.25_f64.powi(2))).abs() < 1e-15);
    // The tool's mass is at (0.4, 0, 0), the finger's at (0.2, 0, 0.1) of the forearm.
    assert_eq!(fore.mass, 1.75);
    let wanted = Vector3::new(0.5 * 0.4 + 0.25 * 0.2, 0.0, 0.25 * 0.1);
    assert!((fore.first_moment - wanted).norm() < 1e-15);
    let moment = 0.01 + 0.5 * 0.4_f64.powi(2) + 0.25 * 0.2_f64.powi(2);
    assert!((fore.rotational.m33 - moment).abs() < 1e-15);

    // Torque on the slide, standing upright: none; its weight is on the shoulder's bearing.
    let (q, none) = (Joints::from([0.3, 0.2]), Joints::from([0.0, 0.0]));
    let torques = arm
        .chain
        .inverse_dynamics(&q, &none, &none, &Vector3::new(0.0, 0.0, -9.81));
    assert!(torques.iter().all(|torque| torque.abs() < 1e-14));
}

#[test]
fn a_list_of_joints_stands_on_what_is_fixed_below_it() {
    let robot = Robot::read(ARM.as_bytes()).unwrap();
    let arm = robot.of_joints(&["shoulder", "slide"]).unwrap();
    assert_eq!((arm.base.as_str(), arm.tip.as_str()), ("world", "fore"));
    let only = robot.of_joints(&["slide"]).unwrap();
    assert_eq!((only.base.as_str(), only.joints.len()), ("upper", 1));
    // What moves further out, and carries something.
    assert_eq!(arm.standing, ["finger_joint"]);
    let first = robot.of_joints(&["shoulder"]).unwrap();
    assert_eq!(first.standing, ["slide", "finger_joint"]);
    let told = |names: &[&str]| robot.of_joints(names).unwrap_err().to_string();
    assert_eq!(
        told(&["shoulder", "slidr"]),
        "there is no joint \"slidr\"; did you mean \"slide\"?"
    );
    assert!(told(&["slide", "shoulder"]).contains("is not below joint \"slide\""));
    assert!(told(&["shoulder", "shoulder"]).contains("is not below"));
    assert!(told(&["shoulder", "finger_joint"]).contains("joint \"slide\" (line 20) moves too"));
    assert!(told(&["shoulder", "flange"]).contains("joint \"flange\" (line 27) is fixed"));
    assert!(told(&["shoulder", "slide", "finger_joint"]).contains("mimics joint \"slide\""));
    assert!(matches!(
        robot.of_joints(&[""; 0]),
        Err(ArmError::EmptyList)
    ));
}

#[test]
fn base_and_tip_that_bound_no_arm_are_named() {
    let told = |base: &str, tip: &str| arm(ARM, base, tip).unwrap_err().to_string();
    assert_eq!(
        told("bse", "tool"),
        "there is no link \"bse\"; did you mean \"base\"?"
    );
    assert!(told("tool", "base").ends_with("above it; exchange them"));
    assert!(told("world", "base").contains("no joint moves"));
    let apart = with("</robot>", "<link name=\"table\"/></robot>");
    let error = arm(&apart, "base", "table").unwrap_err().to_string();
    assert!(
        error.contains("not below link \"base\"; choose two links"),
        "{error}"
    );
}

#[test]
fn joints_that_an_arm_cannot_have_are_named_with_their_line() {
    let told = |text: &str| arm(text, "base", "tool").unwrap_err().to_string();
    let shoulder = "<joint name=\"shoulder\" type=\"revolute\">";
    let typed = |other: &str| with(shoulder, &shoulder.replace("revolute", other));
    assert!(told(&typed("floating")).starts_with("joint \"shoulder\" (line 8) is floating"));
    assert!(told(&typed("planar")).contains("is planar"));
    assert!(told(&with("<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0 0\"/>")).contains("<axis>"));
    assert!(told(&with("<axis xyz", "<mimic joint=\"slide\"/><axis xyz")).contains("mimics"));
    assert!(told(&with("lower=\"-1.5\"", "lower=\"3\"")).contains("lower=3 and upper=2.5, upside"));
    let limit = "<limit lower=\"-1.5\" upper=\"2.5\" effort=\"80\" velocity=\"2\"/>";
    assert!(told(&with(limit, "")).contains("has no <limit>; add lower and upper"));
    // One that turns without end needs none.
    assert!(arm(&typed("continuous").replacen(limit, "", 1), "base", "tool").is_ok());
    let massless = with("<mass value=\"2\"/>", "<mass value=\"0\"/>");
    assert!(
        told(&massless).starts_with("link \"upper\" (line 13), which joint \"shoulder\" moves")
    );
}

#[test]
fn nine_joints_are_too_many() {
    let mut text = String::from("<robot name=\"snake\"><link name=\"l0\"/>");
    for joint in 1..=9 {
        text += &format!(
            "<link name=\"l{joint}\"><inertial><mass value=\"1\"/>\
             <inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>\
             <joint name=\"j{joint}\" type=\"continuous\"><parent link=\"l{}\"/>\
             <child link=\"l{joint}\"/></joint>",
            joint - 1
        );
    }
    text += "</robot>";
    let error = arm(&text, "l0", "l9").unwrap_err();
    assert!(
        matches!(error, ArmError::TooManyJoints { count: 9, .. }),
        "{error}"
    );
    assert_eq!(arm(&text, "l0", "l8").unwrap().chain.count().get(), 8);
}

#[test]
fn files_that_are_no_robot_are_refused_with_the_line() {
    let told = |text: &str| read_error(text).to_string();
    assert_eq!(
        Robot::read(b"<robot>\n\xff"),
        Err(ReadError::NotText { line: 2 })
    );
    assert!(told("<robot>\n<link name=\"a\">\n</robot>").contains("at 3:1"));
    assert!(told("").starts_with("not readable as XML"));
    assert!(told("\n<sdf/>").starts_with("line 2: the file begins with <sdf>"));
    let xacro = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:arm/></robot>";
    assert!(told(xacro).contains("line 2: <arm> is a macro of xacro"));
    assert!(told("<robot><link/></robot>").contains("<link> has no name"));
    assert!(told(&with("<mass value=\"2\"/>", "<mass/>")).contains("line 15: <mass> has no value"));
    assert!(told(&with("mass value=\"2\"", "mass value=\"-2\"")).contains("cannot be negative"));
    let numbers = told(&with("xyz=\"0.25 0 0\"", "xyz=\"0.25 0\""));
    assert!(
        numbers.starts_with("line 15: xyz=\"0.25 0\" of <origin> is not 3 finite numbers"),
        "{numbers}"
    );
    assert!(told(&with("xyz=\"0.25 0 0\"", "xyz=\"0.25 nan 0\"")).contains("3 finite numbers"));
    assert!(told(&with("rpy=\"0 0 0\"", "quat_xyzw=\"0 0 0 1\"")).contains("quat_xyzw is not"));
    assert!(told(&with("type=\"prismatic\"", "type=\"sliding\"")).contains("type \"sliding\""));
    assert!(told(&with("<link name=\"fore\">", "<link name=\"upper\">")).contains("another link"));
    let twice = told(&with("<joint name=\"slide\"", "<joint name=\"shoulder\""));
    assert!(twice.contains("another joint \"shoulder\""), "{twice}");
    let link = told(&with("<child link=\"fore\"/>", "<child link=\"for\"/>"));
    assert!(link.ends_with("did you mean \"fore\"?"), "{link}");
}

#[test]
fn loops_are_refused() {
    let second = "<joint name=\"strut\" type=\"fixed\"><parent link=\"base\"/>\
                  <child link=\"fore\"/></joint></robot>";
    let error = read_error(&with("</robot>", second));
    assert!(
        matches!(&error, ReadError::Loop { second, .. } if second == "strut"),
        "{error}"
    );
    let circle = with("<parent link=\"world\"/>", "<parent link=\"finger\"/>");
    let error = read_error(&circle);
    assert!(
        matches!(&error, ReadError::Circle { joint, .. } if joint == "stand"),
        "{error}"
    );
    let own = with("<parent link=\"base\"/>", "<parent link=\"upper\"/>");
    assert!(matches!(read_error(&own), ReadError::Circle { .. }));
}

#[test]
fn the_whole_arm_ends_where_a_hand_begins() {
    let whole = |text: &str| Robot::read(text.as_bytes()).expect("readable").whole_arm();
    let arm = whole(ARM).unwrap();
    assert_eq!((arm.base.as_str(), arm.tip.as_str()), ("world", "tool"));
    assert_eq!(arm.joints, ["shoulder", "slide"]);
    assert_eq!(arm.links, ["upper", "fore"]);
    // A finger of its own that does not follow another joint is a joint as any other.
    let text = with("<mimic joint=\"slide\"/>", "");
    assert_eq!(whole(&text).unwrap().joints.len(), 3);
    // Two fingers are a hand.
    let other = r#"<joint name="thumb" type="revolute"><parent link="tool"/><child link="thumb"/>
        <limit lower="0" upper="1"/></joint><link name="thumb"/>
        <joint name="eye" type="fixed"><parent link="tool"/><child link="eye_link"/></joint>
        <link name="eye_link"/></robot>"#;
    let hand = whole(&text.replace("</robot>", other)).unwrap();
    assert_eq!(hand.joints, ["shoulder", "slide"]);
    // Two arms of one body.
    let other = r#"<joint name="left" type="revolute"><parent link="base"/><child link="left_link"/>
        <limit lower="0" upper="1"/></joint><link name="left_link"/></robot>"#;
    let error = whole(&ARM.replace("</robot>", other)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "link \"world\" carries 2 joints that move (shoulder, left); say which arm is meant, by a \
         base and a tip"
    );
}

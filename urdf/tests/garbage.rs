//! No file makes the reader panic.

use ferntast_model::{Joints, rigid_body::Vector3};
use ferntast_urdf::Robot;
use proptest::prelude::*;

/// Reads it and makes every arm of two of its links.
fn take(file: &[u8]) -> usize {
    let Ok(robot) = Robot::read(file) else {
        return 0;
    };
    let names: Vec<&str> = robot.links.iter().take(6).map(|link| &*link.name).collect();
    let mut arms = 0;
    for base in &names {
        for tip in &names {
            let Ok(arm) = robot.between(base, tip) else {
                continue;
            };
            arms += 1;
            let q = Joints::filled(arm.chain.count(), 0.5);
            let gravity = Vector3::new(0.0, 0.0, -9.81);
            arm.chain.inverse_dynamics(&q, &q, &q, &gravity);
            assert!(robot.of_joints(&arm.joints).is_ok());
        }
    }
    arms
}

/// Words of which URDFs are made, and some that do not belong there.
fn word() -> impl Strategy<Value = String> {
    let words = [
        "<robot>",
        "</robot>",
        "<link name=\"a\"/>",
        "<link name=\"b\">",
        "</link>",
        "<inertial>",
        "</inertial>",
        "<mass value=\"1\"/>",
        "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>",
        "<joint name=\"j\" type=\"continuous\">",
        "<joint name=\"k\" type=\"revolute\">",
        "</joint>",
        "<parent link=\"a\"/>",
        "<child link=\"b\"/>",
        "<origin xyz=\"1 2 3\" rpy=\"1 2 3\"/>",
        "<axis xyz=\"1 1e300 0\"/>",
        "<limit lower=\"1\" upper=\"-1\"/>",
        "<mimic/>",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "&amp;",
        "&#0;",
        "<?xml version=\"1.0\"?>",
        "<!DOCTYPE r []>",
        "\u{feff}",
    ];
    prop_oneof![9 => proptest::sample::select(words.to_vec()).prop_map(str::to_owned), 1 => ".*"]
}

const ARM: &str = "<robot><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"1\"/>\
    <inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link><joint name=\"j\" type=\"revolute\">\
    <parent link=\"a\"/><child link=\"b\"/><origin xyz=\"1 2 3\" rpy=\"1 2 3\"/><axis xyz=\"0 0 1\"/>\
    <limit lower=\"-1\" upper=\"1\"/></joint></robot>";

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(file in proptest::collection::vec(any::<u8>(), 0..400)) {
        take(&file);
    }

    #[test]
    fn any_text_of_its_words_is_read_or_refused(words in proptest::collection::vec(word(), 0..40)) {
        take(words.concat().as_bytes());
        take(format!("<robot>{}</robot>", words.concat()).as_bytes());
    }

    #[test]
    fn an_arm_with_bytes_changed_is_read_or_refused(
        changes in proptest::collection::vec((0..ARM.len(), any::<u8>()), 1..6),
        cut in 0..ARM.len(),
    ) {
        let mut file = ARM.as_bytes().to_vec();
        for (at, byte) in changes {
            file[at] = byte;
        }
        take(&file);
        take(&file[..cut]);
    }
}

#[test]
fn the_file_that_is_changed_is_an_arm() {
    assert_eq!(take(ARM.as_bytes()), 1);
}

#[test]
fn a_deep_file_is_refused_or_read() {
    let depth = 100_000;
    let file = format!(
        "<robot>{}{}</robot>",
        "<a>".repeat(depth),
        "</a>".repeat(depth)
    );
    assert_eq!(take(file.as_bytes()), 0);
    // A tree of joints as deep: one arm of too many joints.
    let mut file = String::from("<robot><link name=\"0\"/>");
    for number in 1..20_000 {
        file += &format!(
            "<link name=\"{number}\"/><joint name=\"{number}\" type=\"fixed\">\
             <parent link=\"{}\"/><child link=\"{number}\"/></joint>",
            number - 1
        );
    }
    let robot = Robot::read((file + "</robot>").as_bytes()).unwrap();
    assert!(robot.between("0", "19999").is_err());
}

//! The `.msg` files of the ROS 2 package, which are written from the
//! declarations in `src/sample/own.rs`: `WRITE_MSG_FILES=1 cargo test -p
//! ferntast-msgs --test msg_files` writes them again.

use std::{collections::BTreeMap, fs, path::PathBuf};

use ferntast_msgs::{
    Message, RosMessage,
    sample::JointNames,
    topics::{self, Topic, Visitor},
};

/// File name and text of every message of ferntast's own.
#[derive(Default)]
struct Declared(BTreeMap<String, &'static str>);

impl Visitor for Declared {
    fn topic<M: Message>(&mut self, _: Topic<M>) {
        if let Some(text) = M::Ros::DEFINITION {
            let name = M::Ros::INTERFACE.trim_start_matches("ferntast_msgs/msg/");
            self.0.insert(format!("{name}.msg"), text);
        }
    }
}

#[test]
fn the_msg_files_are_those_of_the_declarations() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("msg");
    let mut declared = Declared::default();
    topics::visit(&JointNames::numbered(1), &mut declared).unwrap();
    assert!(declared.0.len() >= 8);
    if std::env::var_os("WRITE_MSG_FILES").is_some() {
        for (name, text) in &declared.0 {
            fs::write(folder.join(name), text).unwrap();
        }
    }
    for (name, text) in &declared.0 {
        let file = fs::read_to_string(folder.join(name)).unwrap_or_default();
        let hint = "run with WRITE_MSG_FILES=1 to write it from the declaration";
        assert_eq!(&file, text, "msgs/msg/{name}: {hint}");
    }
    for file in fs::read_dir(&folder).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        assert!(declared.0.contains_key(&name), "msgs/msg/{name}: no topic");
    }
}

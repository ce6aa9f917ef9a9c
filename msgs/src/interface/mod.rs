//! Interfaces by name: their `.msg` texts, schemas and RIHS01 type hashes.
//!
//! Those that ferntast speaks are built in ([`names`]); others may be read
//! into a [`Library`].

mod definition;
mod error;
mod hash;
mod kind;
mod library;
mod parse;
mod value;

#[cfg(test)]
mod hash_tests;
#[cfg(test)]
mod parse_tests;

pub use definition::{Constant, Definition, Field};
pub use error::{InterfaceError, ParseError, Problem};
pub use kind::{Base, Count, Primitive, Type};
pub use library::Library;
pub use parse::parse;
pub use value::Value;

use serde::Serialize;

use crate::{
    Message, RosMessage,
    sample::JointNames,
    topics::{self, Topic, Visitor},
};

macro_rules! texts {
    ($($name:literal: $path:literal;)*) => {
        /// Name and `.msg` text of the interfaces of other packages.
        const TEXTS: &[(&str, &str)] = &[$(($name, include_str!(concat!("../../", $path)))),*];
    };
}

texts! {
    "builtin_interfaces/msg/Time": "standard/builtin_interfaces/msg/Time.msg";
    "std_msgs/msg/Header": "standard/std_msgs/msg/Header.msg";
    "std_msgs/msg/String": "standard/std_msgs/msg/String.msg";
    "std_msgs/msg/MultiArrayDimension": "standard/std_msgs/msg/MultiArrayDimension.msg";
    "std_msgs/msg/MultiArrayLayout": "standard/std_msgs/msg/MultiArrayLayout.msg";
    "std_msgs/msg/Float64MultiArray": "standard/std_msgs/msg/Float64MultiArray.msg";
    "sensor_msgs/msg/JointState": "standard/sensor_msgs/msg/JointState.msg";
    "sensor_msgs/msg/Temperature": "standard/sensor_msgs/msg/Temperature.msg";
    "geometry_msgs/msg/Point": "standard/geometry_msgs/msg/Point.msg";
    "geometry_msgs/msg/Quaternion": "standard/geometry_msgs/msg/Quaternion.msg";
    "geometry_msgs/msg/Vector3": "standard/geometry_msgs/msg/Vector3.msg";
    "geometry_msgs/msg/Pose": "standard/geometry_msgs/msg/Pose.msg";
    "geometry_msgs/msg/PoseStamped": "standard/geometry_msgs/msg/PoseStamped.msg";
    "geometry_msgs/msg/Wrench": "standard/geometry_msgs/msg/Wrench.msg";
    "geometry_msgs/msg/WrenchStamped": "standard/geometry_msgs/msg/WrenchStamped.msg";
    "geometry_msgs/msg/Transform": "standard/geometry_msgs/msg/Transform.msg";
    "geometry_msgs/msg/TransformStamped": "standard/geometry_msgs/msg/TransformStamped.msg";
    "tf2_msgs/msg/TFMessage": "standard/tf2_msgs/msg/TFMessage.msg";
    "diagnostic_msgs/msg/KeyValue": "standard/diagnostic_msgs/msg/KeyValue.msg";
    "diagnostic_msgs/msg/DiagnosticStatus": "standard/diagnostic_msgs/msg/DiagnosticStatus.msg";
    "diagnostic_msgs/msg/DiagnosticArray": "standard/diagnostic_msgs/msg/DiagnosticArray.msg";
    "crtk_msgs/msg/OperatingState": "standard/crtk_msgs/msg/OperatingState.msg";
    "crtk_msgs/msg/StringStamped": "standard/crtk_msgs/msg/StringStamped.msg";
}

/// Name and `.msg` text of every interface: those of other packages, then
/// those of ferntast's own that the table of topics names.
fn texts() -> Vec<(&'static str, &'static str)> {
    struct Own(Vec<(&'static str, &'static str)>);
    impl Visitor for Own {
        fn topic<M: Message>(&mut self, _: Topic<M>) {
            let text = M::Ros::DEFINITION.map(|text| (M::Ros::INTERFACE, text));
            self.0.extend(text);
        }
    }
    let mut own = Own(Vec::new());
    // One joint, of a name that is always good, shows every type.
    let visited = topics::visit(&JointNames::numbered(1), &mut own);
    debug_assert_eq!(visited, Ok(()));
    own.0.sort_unstable();
    own.0.dedup();
    [TEXTS, &own.0].concat()
}

/// Full names (`package/msg/Type`) of the interfaces that are built in.
pub fn names() -> impl Iterator<Item = &'static str> {
    texts().into_iter().map(|(name, _)| name)
}

/// The `.msg` text of a built-in interface.
pub fn definition(name: &str) -> Option<&'static str> {
    let mut texts = texts().into_iter();
    texts
        .find(|&(known, _)| known == name)
        .map(|(_, text)| text)
}

/// The built-in interfaces, read.
///
/// # Errors
///
/// None in practice: a test reads them all.
pub fn library() -> Result<Library, InterfaceError> {
    let mut library = Library::default();
    for (name, text) in texts() {
        library.insert(name, text)?;
    }
    Ok(library)
}

/// The `ros2msg` schema of a built-in interface; see [`Library::schema`].
///
/// # Errors
///
/// The name is none or not among [`names`].
pub fn schema(name: &str) -> Result<String, InterfaceError> {
    library()?.schema(name)
}

/// The RIHS01 type hash of a built-in interface; see [`Library::type_hash`].
///
/// # Errors
///
/// The name is none or not among [`names`].
pub fn type_hash(name: &str) -> Result<String, InterfaceError> {
    library()?.type_hash(name)
}

/// An interface with all that a stock ROS 2 compares.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Described {
    /// Full name, `package/msg/Type`.
    pub name: String,
    /// RIHS01 type hash.
    pub hash: String,
    /// `ros2msg` schema.
    pub schema: String,
}

/// Every built-in interface, for listing.
///
/// # Errors
///
/// None in practice: a test describes them all.
pub fn describe() -> Result<Vec<Described>, InterfaceError> {
    let library = library()?;
    let described = |name: &str| {
        Ok(Described {
            name: name.to_owned(),
            hash: library.type_hash(name)?,
            schema: library.schema(name)?,
        })
    };
    names().map(described).collect()
}

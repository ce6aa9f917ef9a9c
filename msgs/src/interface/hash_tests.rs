//! The hashes against those that ROS 2 itself computed.
//!
//! The constants were read from the `type_hashes` of the JSON files that the
//! packages of ROS 2 install beside their `.msg` files
//! (`share/<package>/msg/<Type>.json`; packages std_msgs, sensor_msgs,
//! geometry_msgs and diagnostic_msgs 5.5.1, builtin_interfaces, rcl_interfaces
//! and type_description_interfaces of the same release), as pip installs them;
//! that of tf2_msgs as rosbags 0.11.9 computes it.

use super::{InterfaceError, Library, describe, library, names, schema, type_hash};

/// Those that are built in.
const STANDARD: &[(&str, &str)] = &[
    (
        "builtin_interfaces/msg/Time",
        "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
    ),
    (
        "std_msgs/msg/Header",
        "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    ),
    (
        "std_msgs/msg/MultiArrayDimension",
        "RIHS01_5e773a60a4c7fc8a54985f307c7837aa2994252a126c301957a24e31282c9cbe",
    ),
    (
        "std_msgs/msg/MultiArrayLayout",
        "RIHS01_4c66e6f78e740ac103a94cf63259f968e48c617e7699e829b63c21a5cb50dac6",
    ),
    (
        "std_msgs/msg/Float64MultiArray",
        "RIHS01_1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f",
    ),
    (
        "sensor_msgs/msg/JointState",
        "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
    ),
    (
        "sensor_msgs/msg/Temperature",
        "RIHS01_72514a14126ab9f8a9abec974c78e5610a367b59db5da355ff1fb982d5bad4b8",
    ),
    (
        "geometry_msgs/msg/Point",
        "RIHS01_6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881",
    ),
    (
        "geometry_msgs/msg/Quaternion",
        "RIHS01_8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684",
    ),
    (
        "geometry_msgs/msg/Vector3",
        "RIHS01_cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d",
    ),
    (
        "geometry_msgs/msg/Pose",
        "RIHS01_d501954e9476cea2996984e812054b68026ae0bfae789d9a10b23daf35cc90fa",
    ),
    (
        "geometry_msgs/msg/PoseStamped",
        "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    ),
    (
        "geometry_msgs/msg/Wrench",
        "RIHS01_018e8519d57c16adbe97c9fe1460ef21fec7e31bc541de3d653a35895677ce52",
    ),
    (
        "geometry_msgs/msg/WrenchStamped",
        "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77",
    ),
    (
        "diagnostic_msgs/msg/KeyValue",
        "RIHS01_d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42",
    ),
    (
        "diagnostic_msgs/msg/DiagnosticStatus",
        "RIHS01_b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4",
    ),
    (
        "diagnostic_msgs/msg/DiagnosticArray",
        "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    ),
    (
        "std_msgs/msg/String",
        "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    ),
    (
        "geometry_msgs/msg/Transform",
        "RIHS01_beb83fbe698636351461f6f35d1abb20010c43d55374d81bd041f1ba2581fddc",
    ),
    (
        "geometry_msgs/msg/TransformStamped",
        "RIHS01_0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206",
    ),
    (
        "tf2_msgs/msg/TFMessage",
        "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    ),
];

/// Those that recordings were made with, as they have always been.
const OWN: &[(&str, &str)] = &[
    (
        "crtk_msgs/msg/OperatingState",
        "RIHS01_5cc57eea589b217fe5194bf2735b91d4a7f2dd5ac1245ae657f7ea7590c2c80e",
    ),
    (
        "crtk_msgs/msg/StringStamped",
        "RIHS01_83efb802e6596e03f69ac322e3231037329946f2bd13ed48874d97f5b8f5db1d",
    ),
    (
        "ferntast_msgs/msg/Authority",
        "RIHS01_9bee3496c113cd8cea62c1da34c5651906bee5054649fc703cf2214594e48e2d",
    ),
    (
        "ferntast_msgs/msg/ContactState",
        "RIHS01_3e595b12b43871a6aa377d13d3cde1c5861450f4fe88bec0850e87c338c49a0d",
    ),
    (
        "ferntast_msgs/msg/FrictionStatus",
        "RIHS01_c89fc37bbeef45cb28d98e70bf2cbbb74fe17f95a39e1c205a505db894810531",
    ),
    (
        "ferntast_msgs/msg/LinkCommand",
        "RIHS01_586dcc74219d70aa69032e1ee5e30a5bc973feabd75622bf133c108007e793bf",
    ),
    (
        "ferntast_msgs/msg/LinkStatus",
        "RIHS01_04ce8b69ea2a7a41a6c9252a003d72a4a40eede9b74c7d3c4dd7f54d63d780d2",
    ),
    (
        "ferntast_msgs/msg/RecorderCommand",
        "RIHS01_947fc351cd130e8ad9481296bf391799d924821e4811032fda515bcd3981a0c8",
    ),
    (
        "ferntast_msgs/msg/RecorderStatus",
        "RIHS01_a48be59753232ea0011e41372dbd01510bdce0e7c2373e4e960c966607148f38",
    ),
    (
        "ferntast_msgs/msg/TwinParameters",
        "RIHS01_5846b7c6268d5ce6fdfb8e40d5cf6a4968ca2199b903317ced6503f2b96b8592",
    ),
];

#[test]
fn types_hash_as_in_ros_2_and_as_ever() {
    for (name, hash) in STANDARD.iter().chain(OWN) {
        assert_eq!(type_hash(name).unwrap(), *hash, "{name}");
    }
}

#[test]
fn every_standard_type_is_compared() {
    for name in names() {
        let ours = ["crtk_msgs/", "ferntast_msgs/"];
        let compared = STANDARD.iter().any(|(standard, _)| *standard == name);
        assert_eq!(
            compared,
            !ours.iter().any(|p| name.starts_with(p)),
            "{name}"
        );
    }
}

fn with(texts: &[(&str, &str)]) -> Library {
    let mut library = library().unwrap();
    for (name, text) in texts {
        library.insert(name, text).unwrap();
    }
    library
}

#[test]
fn an_empty_interface_hashes_as_in_ros_2() {
    let library = with(&[("std_msgs/msg/Empty", "# nothing\n")]);
    assert_eq!(
        library.type_hash("std_msgs/msg/Empty").unwrap(),
        "RIHS01_20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312"
    );
}

#[test]
fn a_char_hashes_as_in_ros_2() {
    let library = with(&[("std_msgs/msg/Char", "char data")]);
    assert_eq!(
        library.type_hash("std_msgs/msg/Char").unwrap(),
        "RIHS01_3ad2d04dd29ba19d04b16659afa3ccaedd691914b02a64e82e252f2fa6a586a9"
    );
}

#[test]
fn an_array_hashes_as_in_ros_2() {
    let text = "Pose pose\nfloat64[36] covariance\n";
    let library = with(&[("geometry_msgs/msg/PoseWithCovariance", text)]);
    assert_eq!(
        library
            .type_hash("geometry_msgs/msg/PoseWithCovariance")
            .unwrap(),
        "RIHS01_9a7c0fd234b7f45c6098745ecccd773ca1085670e64107135397aee31c02e1bb"
    );
}

#[test]
fn a_bounded_string_hashes_as_in_ros_2() {
    let library = with(&[
        (
            "type_description_interfaces/msg/FieldType",
            "uint8 type_id 0\nuint64 capacity\nuint64 string_capacity\nstring<=255 nested_type_name",
        ),
        (
            "type_description_interfaces/msg/Field",
            "string name\nFieldType type\nstring default_value",
        ),
        (
            "type_description_interfaces/msg/IndividualTypeDescription",
            "string<=255 type_name\nField[] fields",
        ),
    ]);
    assert_eq!(
        library
            .type_hash("type_description_interfaces/msg/IndividualTypeDescription")
            .unwrap(),
        "RIHS01_55c827d86c3c141bdd318fe6c22e11190e4d3b37c8f4f9751a084aa05ce96560"
    );
}

#[test]
fn a_bounded_sequence_hashes_as_in_ros_2() {
    let library = with(&[
        (
            "rcl_interfaces/msg/IntegerRange",
            "int64 from_value\nint64 to_value\nuint64 step",
        ),
        (
            "rcl_interfaces/msg/FloatingPointRange",
            "float64 from_value\nfloat64 to_value\nfloat64 step",
        ),
        (
            "rcl_interfaces/msg/ParameterDescriptor",
            "string name\nuint8 type\nstring description\nstring additional_constraints\n\
             bool read_only false\nbool dynamic_typing false\n\
             FloatingPointRange[<=1] floating_point_range\nIntegerRange[<=1] integer_range",
        ),
    ]);
    assert_eq!(
        library
            .type_hash("rcl_interfaces/msg/ParameterDescriptor")
            .unwrap(),
        "RIHS01_52175dbfda6c51153101d33d2a9da05743f66f02d5ab2ca9ec4709b46b73d704"
    );
}

#[test]
fn dependencies_come_once_and_after_their_user() {
    let schema = schema("geometry_msgs/msg/PoseStamped").unwrap();
    let rule = "=".repeat(80);
    let heads: Vec<&str> = schema
        .split(&format!("{rule}\nMSG: "))
        .skip(1)
        .filter_map(|part| part.lines().next())
        .collect();
    assert_eq!(
        heads,
        [
            "std_msgs/Header",
            "builtin_interfaces/Time",
            "geometry_msgs/Pose",
            "geometry_msgs/Point",
            "geometry_msgs/Quaternion",
        ]
    );
    assert!(schema.ends_with('\n') && !schema.contains("\n\n\n"));
}

#[test]
fn a_schema_alone_says_the_hash() {
    for described in describe().unwrap() {
        let library = Library::from_schema(&described.name, &described.schema).unwrap();
        assert_eq!(library.type_hash(&described.name).unwrap(), described.hash);
        assert_eq!(library.schema(&described.name).unwrap(), described.schema);
    }
}

#[test]
fn hashes_tell_interfaces_apart() {
    let mut hashes: Vec<String> = describe().unwrap().into_iter().map(|d| d.hash).collect();
    assert!(hashes.iter().all(|hash| hash.len() == 71));
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), names().count());
}

#[test]
fn what_is_missing_is_named() {
    assert_eq!(
        type_hash("sensor_msgs/msg/Image"),
        Err(InterfaceError::Unknown {
            name: "sensor_msgs/msg/Image".to_owned()
        })
    );
    assert_eq!(
        schema("JointState"),
        Err(InterfaceError::BadName {
            name: "JointState".to_owned()
        })
    );
    let library = with(&[("a_msgs/msg/A", "B b")]);
    assert_eq!(
        library.type_hash("a_msgs/msg/A"),
        Err(InterfaceError::MissingDependency {
            name: "a_msgs/msg/B".to_owned(),
            needed_by: "a_msgs/msg/A".to_owned()
        })
    );
}

#[test]
fn interfaces_made_of_each_other_come_to_an_end() {
    let library = with(&[("a_msgs/msg/A", "B b"), ("a_msgs/msg/B", "A[] a")]);
    assert_eq!(
        library
            .schema("a_msgs/msg/A")
            .unwrap()
            .matches("MSG:")
            .count(),
        1
    );
    assert_ne!(
        library.type_hash("a_msgs/msg/A"),
        library.type_hash("a_msgs/msg/B")
    );
}

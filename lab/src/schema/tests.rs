//! Messages are written by hand here, after the rules of CDR, and read back.

use proptest::prelude::*;

use super::*;
use crate::message_path::MessagePath;

/// Writes CDR: little- or big-endian, numbers aligned to their size.
struct Writer {
    bytes: Vec<u8>,
    little: bool,
    largest: usize,
}

impl Writer {
    fn new(identifier: u8) -> Writer {
        Writer {
            bytes: vec![0, identifier, 0, 0],
            little: identifier % 2 == 1,
            largest: if identifier < 6 { 8 } else { 4 },
        }
    }

    fn put<const N: usize>(mut self, mut little_endian: [u8; N]) -> Writer {
        while !(self.bytes.len() - 4).is_multiple_of(N.min(self.largest)) {
            self.bytes.push(0xee);
        }
        if !self.little {
            little_endian.reverse();
        }
        self.bytes.extend(little_endian);
        self
    }

    fn u32(self, value: u32) -> Writer {
        self.put(value.to_le_bytes())
    }

    fn f64(self, value: f64) -> Writer {
        self.put(value.to_le_bytes())
    }

    fn text(self, text: &str) -> Writer {
        let mut writer = self.u32(text.len() as u32 + 1);
        writer.bytes.extend(text.bytes());
        writer.bytes.push(0);
        writer
    }

    fn doubles(self, values: &[f64]) -> Writer {
        let writer = self.u32(values.len() as u32);
        values
            .iter()
            .fold(writer, |writer, &value| writer.f64(value))
    }
}

const HEADER: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

fn joint_state() -> Layout {
    let text = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n";
    let schema = format!("{text}{HEADER}");
    Layout::of_schema("sensor_msgs/msg/JointState", "ros2msg", &schema).unwrap()
}

fn joint_message(identifier: u8) -> Vec<u8> {
    Writer::new(identifier)
        .put(7i32.to_le_bytes())
        .u32(500)
        .text("base")
        .u32(2)
        .text("joint_1")
        .text("j2")
        .doubles(&[0.25, -0.5])
        .doubles(&[])
        .doubles(&[1.5, 2.5])
        .bytes
}

fn select(layout: &Layout, path: &str) -> Result<Selection, SelectError> {
    Selection::new(layout, &MessagePath::parse(path).unwrap())
}

fn found(layout: &Layout, bytes: &[u8], path: &str) -> Found {
    let selection = select(layout, path).unwrap();
    Reader::new(layout.clone()).read(bytes, &selection).unwrap()
}

#[test]
fn numbers_of_a_joint_state_are_found_in_every_plain_encoding() {
    let layout = joint_state();
    for identifier in [0, 1, 6, 7] {
        let bytes = joint_message(identifier);
        for (path, expected) in [
            ("/t.header.stamp.sec", Found::One(7.0)),
            ("/t.header.stamp.nanosec", Found::One(500.0)),
            ("/t.position[0]", Found::One(0.25)),
            ("/t.position[-1]", Found::One(-0.5)),
            ("/t.effort[1]", Found::One(2.5)),
            ("/t.effort[1:1]", Found::One(2.5)),
            ("/t.effort[1:9]", Found::One(2.5)),
            ("/t.effort[-9:0]", Found::One(1.5)),
            ("/t.effort[2]", Found::Nothing(Some(2))),
            ("/t.effort[-3]", Found::Nothing(Some(2))),
            ("/t.effort[1:0]", Found::Nothing(Some(2))),
            ("/t.velocity[0]", Found::Nothing(Some(0))),
            ("/t.effort[:]", Found::Several(2)),
            (r#"/t.effort[:]{name=="j2"}"#, Found::One(2.5)),
            (r#"/t.effort{name=="j2"}"#, Found::One(2.5)),
            (r#"/t.effort{name=="j2"}[:]"#, Found::One(2.5)),
            (r#"/t.effort[:]{name!="j2"}"#, Found::One(1.5)),
            (r#"/t.effort[:]{name=="j3"}"#, Found::Nothing(Some(2))),
            ("/t.effort[:]{position<0}", Found::One(2.5)),
            (r#"/t{header.frame_id=="base"}.effort[0]"#, Found::One(1.5)),
            (
                r#"/t{header.frame_id=="x"}.effort[0]"#,
                Found::Nothing(None),
            ),
            (r#"/t.header{frame_id=="base"}.stamp.sec"#, Found::One(7.0)),
        ] {
            assert_eq!(
                found(&layout, &bytes, path),
                expected,
                "{path}, {identifier}"
            );
        }
    }
}

#[test]
fn a_path_that_does_not_fit_says_why() {
    let layout = joint_state();
    for (path, words) in [
        (
            "/t.positions[0]",
            "sensor_msgs/msg/JointState has no field \"positions\"",
        ),
        ("/t.position", "/t.position is float64[], not a number"),
        (
            "/t.position.x",
            "float64[] (choose an element, such as [0]), which has no field",
        ),
        (
            "/t.position[0].x",
            "/t.position[0] is float64, which has no field",
        ),
        (
            "/t.position[0][0]",
            "/t.position[0] is float64, no array: leave [0] out",
        ),
        (
            "/t.header",
            "/t.header is std_msgs/msg/Header, not a number",
        ),
        (
            "/t.header.frame_id",
            "/t.header.frame_id is string, not a number",
        ),
        ("/t.name[0]", "/t.name[0] is string, not a number"),
        ("/t", "/t is sensor_msgs/msg/JointState, not a number"),
        (
            "/t.effort[:]{name==1}",
            "the field is string, which does not compare",
        ),
        ("/t.effort[:]{names==1}", "has no field \"names\""),
        ("/t.effort[:]{header==1}", "only another array"),
        ("/t{header==1}.effort[0]", "which does not compare"),
        ("/t{position==1}.effort[0]", "only single values"),
    ] {
        let message = select(&layout, path).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn every_kind_of_field_is_passed_over_and_read() {
    let schema = "\
int32 LIMIT=3  # a constant takes no space
bool flag true
byte raw
char letter
int8 a
uint16 b
float32 c 1.5
int64 d
uint64 e
string<=5 short \"x\"
wstring wide
int16[3] fixed
uint8[<=4] few
test_msgs/Inner one
Inner[2] two
Inner[] many
Empty nothing
float64 last
================================================================================
MSG: test_msgs/Inner
uint8 id
float64 value
================================================================================
MSG: test_msgs/Empty
";
    let layout = Layout::of_schema("test_msgs/msg/All", "ros2msg", schema).unwrap();
    for width in [2usize, 4] {
        let mut writer = Writer::new(1)
            .put([1])
            .put([200])
            .put([65])
            .put((-3i8).to_le_bytes())
            .put(60000u16.to_le_bytes())
            .put(1.25f32.to_le_bytes())
            .put((-9_000_000_000i64).to_le_bytes())
            .put(9_000_000_000u64.to_le_bytes())
            .text("abcde")
            .u32(3);
        for unit in "höh".encode_utf16() {
            let mut bytes = u32::from(unit).to_le_bytes().to_vec();
            bytes.truncate(width);
            writer.bytes.extend(bytes);
        }
        for value in [-1i16, 2, -3] {
            writer = writer.put(value.to_le_bytes());
        }
        writer = writer.u32(2).put([8]).put([9]);
        for (id, value) in [(1u8, 0.1), (2, 0.2), (3, 0.3)] {
            writer = writer.put([id]).f64(value);
        }
        writer = writer.u32(2);
        for (id, value) in [(4u8, 0.4), (5, 0.5)] {
            writer = writer.put([id]).f64(value);
        }
        let bytes = writer.put([0]).f64(6.5).bytes;
        for (path, expected) in [
            ("/t.flag", 1.0),
            ("/t.raw", 200.0),
            ("/t.letter", 65.0),
            ("/t.a", -3.0),
            ("/t.b", 60000.0),
            ("/t.c", 1.25),
            ("/t.d", -9e9),
            ("/t.e", 9e9),
            ("/t.fixed[2]", -3.0),
            ("/t.few[-1]", 9.0),
            ("/t.one.value", 0.1),
            ("/t.two[1].value", 0.3),
            ("/t.many[:]{id==5}.value", 0.5),
            ("/t.many{value>0.45}.value", 0.5),
            ("/t.many[0]{id==4}{value<1}.value", 0.4),
            ("/t{wide=='höh'}.last", 6.5),
            ("/t{flag==true}{short==\"abcde\"}.last", 6.5),
        ] {
            assert_eq!(found(&layout, &bytes, path), Found::One(expected), "{path}");
        }
        let mut reader = Reader::new(layout.clone());
        let paths = numeric_paths(&mut reader, "/t", Some(&bytes));
        for path in ["/t.fixed[2]", "/t.few[1]", "/t.many[1].value", "/t.last"] {
            assert!(
                paths.iter().any(|listed| listed == path),
                "{path}: {paths:?}"
            );
        }
        assert!(
            !paths
                .iter()
                .any(|path| path.contains("few[2]") || path.contains("LIMIT"))
        );
        for path in &paths {
            assert!(
                matches!(found(&layout, &bytes, path), Found::One(_)),
                "{path}"
            );
        }
    }
    let never = select(&layout, "/t.fixed[3]").unwrap_err().to_string();
    assert_eq!(never, "/t.fixed is int16[3]: it has no element 3");
}

#[test]
fn schemas_that_cannot_be_used_are_refused() {
    let refused = |encoding: &str, schema: &str| {
        let error = Layout::of_schema("a_msgs/msg/A", encoding, schema).unwrap_err();
        error.to_string()
    };
    assert!(refused("ros2idl", "module a {};").contains("only \"ros2msg\" is read"));
    assert!(refused("ros2msg", "B b\n").contains("a_msgs/msg/B, needed by a_msgs/msg/A"));
    assert!(refused("ros2msg", "float99 b\n").contains("line 1"));
    let circle = "B b\n===\nMSG: a_msgs/B\nA[] a\n";
    assert!(refused("ros2msg", circle).contains("contains itself"));
    let mut deep = String::from("T0 a\n");
    for level in 0..80 {
        deep.push_str(&format!("===\nMSG: a_msgs/T{level}\nT{} a\n", level + 1));
    }
    deep.push_str("===\nMSG: a_msgs/T80\nuint8 a\n");
    assert!(refused("ros2msg", &deep).contains("more than 64 deep"));
}

#[test]
fn lengths_that_lie_are_refused_without_setting_memory_aside() {
    let schema =
        "uint8[] a\nB[] b\nuint8[4000000000] c\nfloat64 d\n===\nMSG: a_msgs/B\nuint8[] x\n";
    let layout = Layout::of_schema("a_msgs/msg/A", "ros2msg", schema).unwrap();
    let selection = select(&layout, "/t.d").unwrap();
    let mut reader = Reader::new(layout);
    for bytes in [
        Writer::new(1).u32(u32::MAX).bytes,
        Writer::new(1).u32(0).u32(u32::MAX).bytes,
        Writer::new(1).u32(0).u32(0).bytes,
    ] {
        let error = reader.read(&bytes, &selection).unwrap_err();
        assert!(
            error.to_string().contains("does not fit its schema"),
            "{error}"
        );
    }
    assert!(reader.read(&[0, 1], &selection).is_err());
    assert!(reader.read(&[0, 9, 0, 0, 1], &selection).is_err());
}

/// `count` levels of types with two fields of the next one each, above one with `bottom`.
fn doubled(count: u32, bottom: &str) -> String {
    let levels = (0..count).map(|level| {
        let next = level + 1;
        format!("===\nMSG: a_msgs/T{level}\nT{next} a\nT{next} b\n")
    });
    let levels: String = levels.collect();
    format!("{levels}===\nMSG: a_msgs/T{count}\n{bottom} a\n")
}

#[test]
fn types_that_multiply_are_listed_up_to_a_limit() {
    let paths = |bottom: &str, message: Option<&[u8]>| {
        let schema = format!("uint8 first\nT0 a\n{}", doubled(50, bottom));
        let layout = Layout::of_schema("a_msgs/msg/A", "ros2msg", &schema).unwrap();
        numeric_paths(&mut Reader::new(layout), "/t", message)
    };
    let many = paths("uint8", None).len();
    assert!((2000..2100).contains(&many), "{many}");
    // Nor does it go on without an end where there is no number to be found.
    assert_eq!(paths("string", None), ["/t.first"]);
    let empty = [vec![0, 1, 0, 0], vec![0; 100_000]].concat();
    assert_eq!(paths("uint8[]", Some(&empty)), ["/t.first"]);
}

const TYPES: [&str; 9] = [
    "bool",
    "int16",
    "float64",
    "string",
    "wstring",
    "B",
    "string<=4",
    "C",
    "uint32",
];
const COUNTS: [&str; 4] = ["", "[]", "[2]", "[<=3]"];

/// Definitions of A, of B and of C; C has no messages inside, B has no B.
fn any_schema() -> impl Strategy<Value = String> {
    let fields = prop::collection::vec((0..TYPES.len(), 0..COUNTS.len()), 0..6);
    (fields.clone(), fields.clone(), fields).prop_map(|(a, b, c)| {
        let text = |fields: &[(usize, usize)], refused: &[&str]| -> String {
            let lines = fields.iter().enumerate();
            lines
                .filter(|(_, (kind, _))| !refused.contains(&TYPES[*kind]))
                .map(|(n, (kind, count))| format!("{}{} f{n}\n", TYPES[*kind], COUNTS[*count]))
                .collect()
        };
        format!(
            "{}===\nMSG: a_msgs/B\n{}===\nMSG: a_msgs/C\n{}",
            text(&a, &[]),
            text(&b, &["B"]),
            text(&c, &["B", "C"])
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Whatever the bytes are, by whatever schema: read or refused.
    #[test]
    fn any_bytes_are_read_or_refused(
        schema in any_schema(),
        identifier in prop::sample::select(vec![0u8, 1, 6, 7]),
        body in prop::collection::vec(prop_oneof![4 => Just(0u8), 2 => 0..4u8, 1 => any::<u8>()], 0..120),
    ) {
        let layout = Layout::of_schema("a_msgs/msg/A", "ros2msg", &schema).unwrap();
        let mut bytes = vec![0, identifier, 0, 0];
        bytes.extend(body);
        let mut reader = Reader::new(layout.clone());
        let paths = numeric_paths(&mut reader, "/t", Some(&bytes));
        for path in paths.iter().take(20) {
            let selection = select(&layout, path).unwrap();
            let _ = reader.read(&bytes, &selection);
        }
    }

    /// Any text is a schema or is refused.
    #[test]
    fn any_text_is_a_schema_or_refused(
        schema in prop_oneof![
            "\\PC{0,80}",
            "((uint8|string|wstring<=|B|a_msgs/B|Header|===|MSG: a_msgs/B|[a-c=#\\[\\]<\"' ]{1,3}|\n) ?){0,30}",
        ],
        cut in 0..400usize,
    ) {
        let _ = Layout::of_schema("a_msgs/msg/A", "ros2msg", &schema);
        let text = "std_msgs/Header header\nfloat64[] position\n".to_owned() + HEADER;
        let cut: String = text.chars().take(cut).collect();
        let _ = Layout::of_schema("a_msgs/msg/A", "ros2msg", &(cut + &schema));
    }
}

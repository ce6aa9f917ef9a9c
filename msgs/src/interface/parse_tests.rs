//! What the parser takes, and what it refuses and where.

use proptest::prelude::*;

use super::{
    Base, Count, Definition, InterfaceError, Library, ParseError, Primitive, Problem, Type, Value,
    definition, names, parse,
};

const NAME: &str = "test_msgs/msg/Test";

fn read(text: &str) -> Definition {
    parse(NAME, text).unwrap()
}

fn refused(text: &str) -> ParseError {
    match parse(NAME, text) {
        Err(InterfaceError::Definition { error, .. }) => error,
        other => panic!("{other:?}"),
    }
}

fn kind(text: &str) -> Type {
    read(&format!("{text} field")).fields.remove(0).kind
}

#[test]
fn every_built_in_text_is_read() {
    for name in names() {
        let read = parse(name, definition(name).unwrap()).unwrap();
        assert_eq!(read.name, name);
        assert!(!read.fields.is_empty());
    }
}

#[test]
fn our_own_names_are_those_that_ros_2_generates_code_for() {
    for name in names() {
        for field in parse(name, definition(name).unwrap()).unwrap().fields {
            let lower = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
            assert!(field.name.chars().all(lower), "{name}.{}", field.name);
            assert!(!field.name.contains("__") && !field.name.ends_with('_'));
        }
    }
}

#[test]
fn types_are_read() {
    let one = |base| Type {
        base,
        count: Count::One,
    };
    for primitive in Primitive::ALL {
        assert_eq!(kind(primitive.name()), one(Base::Primitive(primitive)));
    }
    assert_eq!(kind("string"), one(Base::String(None)));
    assert_eq!(kind("string<=10"), one(Base::String(Some(10))));
    assert_eq!(kind("wstring<=3"), one(Base::WideString(Some(3))));
    let interface = |name: &str| Base::Interface(name.to_owned());
    assert_eq!(kind("Other"), one(interface("test_msgs/msg/Other")));
    assert_eq!(kind("a_msgs/B"), one(interface("a_msgs/msg/B")));
    assert_eq!(kind("a_msgs/msg/B"), one(interface("a_msgs/msg/B")));
    assert_eq!(kind("Header"), one(interface("std_msgs/msg/Header")));
    let base = Base::Primitive(Primitive::Float64);
    for (text, count) in [
        ("float64[]", Count::Any),
        ("float64[36]", Count::Array(36)),
        ("float64[<=5]", Count::AtMost(5)),
    ] {
        let base = base.clone();
        assert_eq!(kind(text), Type { base, count });
    }
    assert_eq!(
        kind("string<=4[<=5]"),
        Type {
            base: Base::String(Some(4)),
            count: Count::AtMost(5)
        }
    );
}

#[test]
fn defaults_are_read() {
    let default = |line: &str| read(line).fields.remove(0).default.unwrap();
    assert_eq!(default("float64 w 1"), Value::Float(1.0));
    assert_eq!(default("bool b true # yes"), Value::Bool(true));
    assert_eq!(default("int8 i -128"), Value::Integer(-128));
    assert_eq!(default("uint64 u 0xff"), Value::Integer(255));
    assert_eq!(default("string s \"a # b\""), Value::Text("a # b".into()));
    assert_eq!(
        default("string s 'it''s'#".replace("''", "\\'").as_str()),
        Value::Text("it's".into())
    );
    assert_eq!(default("string s \"a = b\""), Value::Text("a = b".into()));
    assert_eq!(
        default("int32[] l [1, -2]"),
        Value::List(vec![Value::Integer(1), Value::Integer(-2)])
    );
    assert_eq!(default("float32[<=2] l []"), Value::List(vec![]));
    assert_eq!(
        default("string[2] l [\"a,b\", 'c']"),
        Value::List(vec![Value::Text("a,b".into()), Value::Text("c".into())])
    );
}

#[test]
fn constants_are_read() {
    let status = "diagnostic_msgs/msg/DiagnosticStatus";
    let status = parse(status, definition(status).unwrap()).unwrap();
    let byte = |name: &str, value| (name.to_owned(), Value::Integer(value));
    let constants: Vec<_> = status
        .constants
        .into_iter()
        .map(|constant| (constant.name, constant.value))
        .collect();
    assert_eq!(
        constants,
        [
            byte("OK", 0),
            byte("WARN", 1),
            byte("ERROR", 2),
            byte("STALE", 3)
        ]
    );
    let value = |line: &str| read(line).constants.remove(0).value;
    assert_eq!(
        value("string S=it's # a comment"),
        Value::Text("it's".into())
    );
    assert_eq!(value("string S = \"quoted\""), Value::Text("quoted".into()));
    assert_eq!(value("string S="), Value::Text(String::new()));
    assert_eq!(value("float64 PI =3.5"), Value::Float(3.5));
    assert_eq!(
        value("string S=an 'open # quote"),
        Value::Text("an 'open".into())
    );
}

#[test]
fn the_default_orientation_is_no_rotation() {
    let name = "geometry_msgs/msg/Quaternion";
    let defaults: Vec<_> = parse(name, definition(name).unwrap())
        .unwrap()
        .fields
        .into_iter()
        .map(|field| field.default)
        .collect();
    let number = |value| Some(Value::Float(value));
    assert_eq!(
        defaults,
        [number(0.0), number(0.0), number(0.0), number(1.0)]
    );
}

#[test]
fn refusals_say_line_and_reason() {
    let text = |text: &str| text.to_owned();
    for (line, problem) in [
        (
            "float64",
            Problem::NoName {
                kind: text("float64"),
            },
        ),
        ("float64 1x", Problem::BadName { name: text("1x") }),
        ("float64 =1", Problem::BadName { name: text("") }),
        (
            "float65 x",
            Problem::BadType {
                kind: text("float65"),
            },
        ),
        (
            "a/b/C x",
            Problem::BadType {
                kind: text("a/b/C"),
            },
        ),
        (
            "float64<=3 x",
            Problem::BadType {
                kind: text("float64<=3"),
            },
        ),
        ("float64[0] x", Problem::BadBound { bound: text("0") }),
        ("float64[+1] x", Problem::BadBound { bound: text("+1") }),
        ("string<= x", Problem::BadBound { bound: text("") }),
        (
            "Other x 1",
            Problem::NoDefault {
                kind: text("test_msgs/msg/Other"),
            },
        ),
        (
            "Other X=1",
            Problem::BadConstant {
                kind: text("test_msgs/msg/Other"),
            },
        ),
        (
            "int8[] X=1",
            Problem::BadConstant {
                kind: text("int8[]"),
            },
        ),
        (
            "bool known",
            Problem::Twice {
                name: text("known"),
            },
        ),
    ] {
        let error = refused(&format!("# one\nbool known\n\n  {line} # comment\n"));
        assert_eq!(error, ParseError { line: 4, problem });
    }
    for (kind, value) in [
        ("uint8", "256"),
        ("int8", "-129"),
        ("uint8", "-1"),
        ("uint8", "--1"),
        ("uint8", "+-1"),
        ("uint8", "0x+1"),
        ("bool", "yes"),
        ("float64", "one"),
        ("string", "open"),
        ("string<=2", "\"abc\""),
        ("int8[2]", "[1]"),
        ("int8[<=2]", "[1,2,3]"),
        ("int8[]", "1"),
    ] {
        let problem = Problem::BadValue {
            value: text(value),
            kind: text(kind),
        };
        let error = refused(&format!("{kind} x {value}"));
        assert_eq!(error, ParseError { line: 1, problem });
    }
}

#[test]
fn names_that_are_none_are_refused() {
    for name in [
        "",
        "A",
        "a/b/A",
        "a/msg/a",
        "a/msg/A/b",
        "1/msg/A",
        "a/msg/",
    ] {
        let refused = matches!(parse(name, ""), Err(InterfaceError::BadName { .. }));
        assert!(refused, "{name}");
    }
}

/// Lines that are nearly right, to get deep into the parser.
fn line() -> impl Strategy<Value = String> {
    let kind = "(u?int(8|16|32|64)|bool|w?string|float64|Other|a_msgs/B)(<=[0-9]{0,3})?(\\[(<=)?[0-9]{0,3}\\])?";
    let value = "[-0-9.a-fx\"'\\[\\],# \\\\é=]{0,12}";
    (kind, "[ \t]{0,2}", "[a-zA-Z_0-9é]{0,5}", "[ =]{0,2}", value)
        .prop_map(|(kind, gap, name, between, value)| kind + &gap + &name + &between + &value)
}

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic(text in any::<String>()) {
        let _ = parse(NAME, &text);
        let _ = Library::from_schema(NAME, &text);
    }

    #[test]
    fn no_name_makes_the_parser_panic(name in any::<String>()) {
        let _ = parse(&name, "");
    }

    #[test]
    fn nearly_right_text_makes_no_panic(lines in prop::collection::vec(line(), 0..6)) {
        let _ = parse(NAME, &lines.join("\n"));
        let _ = Library::from_schema(NAME, &lines.join("\n===\n"));
    }

    #[test]
    fn a_type_reads_back_as_written(size in 1u64.., bound in 1u64.., pick in 0..6usize) {
        let base = ["string", "float64", "a_msgs/msg/B"][pick % 3].to_owned();
        let base = if pick == 0 { format!("string<={bound}") } else { base };
        for count in [String::new(), "[]".into(), format!("[{size}]"), format!("[<={size}]")] {
            let written = format!("{base}{count}");
            prop_assert_eq!(kind(&written).to_string(), written);
        }
    }
}

//! What is read, and what is refused and where.

use proptest::prelude::*;

use super::*;

fn read(text: &str) -> MessagePath {
    MessagePath::parse(text).unwrap()
}

fn refused(text: &str) -> (usize, String) {
    let error = MessagePath::parse(text).unwrap_err();
    (error.column, error.to_string())
}

fn field(name: &str) -> Step {
    Step::Field(name.to_owned())
}

fn filter(path: &[&str], comparison: Comparison, value: Literal) -> Step {
    Step::Filter(Filter {
        path: path.iter().map(|&name| name.to_owned()).collect(),
        comparison,
        value,
    })
}

#[test]
fn foxgloves_own_examples_are_read() {
    let path = read("/my_models.objects[-1].width");
    assert_eq!(path.topic, "/my_models");
    assert_eq!(
        path.steps,
        [field("objects"), Step::Index(-1), field("width")]
    );
    assert_eq!(read("/o.colors[1:3].r").steps[1], Step::Slice(1, 3));
    assert_eq!(read("/o.colors[:].r").steps[1], Step::Slice(0, -1));
    assert_eq!(read("/o.numbers[-2:-1]").steps[1], Step::Slice(-2, -1));
    assert_eq!(read("/o.numbers[2:]").steps[1], Step::Slice(2, -1));
    assert_eq!(read("/o.numbers[:2]").steps[1], Step::Slice(0, 2));
}

#[test]
fn filters_are_read() {
    let text = |text: &str| Literal::Text(text.to_owned());
    assert_eq!(
        read(r#"/t.field[:]{name=="joint_1"}"#).steps,
        [
            field("field"),
            Step::Slice(0, -1),
            filter(&["name"], Comparison::Equal, text("joint_1"))
        ]
    );
    assert_eq!(
        read("/t{header.frame_id == 'it\\'s'}.b").steps,
        [
            filter(&["header", "frame_id"], Comparison::Equal, text("it's")),
            field("b")
        ]
    );
    for (sign, comparison) in [
        ("==", Comparison::Equal),
        ("!=", Comparison::NotEqual),
        ("<", Comparison::Less),
        ("<=", Comparison::LessOrEqual),
        (">", Comparison::Greater),
        (">=", Comparison::GreaterOrEqual),
    ] {
        let expected = filter(&["a"], comparison, Literal::Number(-1.5));
        assert_eq!(read(&format!("/t.f{{a{sign}-1.5}}.b")).steps[1], expected);
    }
    let two = read("/t.f{a==1}{b==true}.c").steps;
    assert_eq!(two, read("/t.f{a==1 && b == true}.c").steps);
    assert_eq!(
        two[2],
        filter(&["b"], Comparison::Equal, Literal::Bool(true))
    );
}

#[test]
fn quoted_names_and_functions_are_read() {
    let path = read(r#""/odd topic.1"."field {x}"[0].@deg2rad.@mul(-2e3)"#);
    assert_eq!(path.topic, "/odd topic.1");
    assert_eq!(path.steps, [field("field {x}"), Step::Index(0)]);
    let functions = [Function::DegreesToRadians, Function::Multiply(-2000.0)];
    assert_eq!(path.functions, functions);
    let value = functions.iter().fold(180.0, |x, each| each.apply(x));
    assert!((value + 2000.0 * std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn an_error_says_the_column_and_what_was_expected() {
    assert_eq!(
        refused("/t.position[0").1,
        "message path \"/t.position[0\", column 14: expected `]` or `:`, found the end"
    );
    for (text, column, words) in [
        ("", 1, "a topic's name"),
        ("/t.", 4, "a field's name"),
        ("/t..a", 4, "a field's name"),
        ("/t.a[]", 6, "a whole number or `:`"),
        ("/t.a[x]", 6, "a whole number or `:`"),
        ("/t.a[$i]", 6, "variables are not supported"),
        ("/t.a[99999999999999999999]", 6, "at most 18 digits"),
        ("/t.a[1:2", 9, "a whole number or `]`"),
        ("/t.a{b}", 7, "`==`"),
        ("/t.a{b=1}", 7, "`==`"),
        ("/t.a{b==}", 9, "a number, a text in quotes"),
        ("/t.a{b==inf}", 9, "a number, a text in quotes"),
        ("/t.a{b==\"x}", 12, "the closing quote"),
        ("/t.a{b==1", 10, "`}` or `&&`"),
        ("/t.a.@derivative", 7, "one of the functions abs"),
        ("/t.a.@mul", 7, "one of the functions abs"),
        ("/t.a.@mul(x)", 11, "a number"),
        ("/t.a.@div(0)", 7, "one of the functions abs"),
        ("/t.a.@abs.b", 10, "another function"),
        ("/t.a b", 6, "the end"),
        ("/t.a]", 5, "`.field`"),
    ] {
        let (at, message) = refused(text);
        assert_eq!(at, column, "{message}");
        assert!(message.contains(words), "{message}");
    }
    assert!(refused(&"/t".repeat(5000)).1.len() < 300);
}

#[test]
fn a_columns_functions_are_told_from_its_name() {
    assert_eq!(functions_of("q_deg.x").unwrap(), ("q_deg.x", vec![]));
    let (name, functions) = functions_of("q deg.@deg2rad.@negative").unwrap();
    assert_eq!(name, "q deg");
    assert_eq!(functions, [Function::DegreesToRadians, Function::Negative]);
    assert_eq!(functions_of("q.@sin").unwrap_err().column, 4);
    assert!(functions_of("q.@abs;").is_err());
}

fn any_name() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z_][a-z0-9_]{0,8}", "\\PC{1,6}"]
}

fn any_step() -> impl Strategy<Value = Step> {
    let literal = prop_oneof![
        (-1e9..1e9f64).prop_map(Literal::Number),
        any::<bool>().prop_map(Literal::Bool),
        "\\PC{0,6}".prop_map(Literal::Text),
    ];
    let comparison = prop_oneof![
        Just(Comparison::Equal),
        Just(Comparison::NotEqual),
        Just(Comparison::Less),
        Just(Comparison::LessOrEqual),
        Just(Comparison::Greater),
        Just(Comparison::GreaterOrEqual),
    ];
    prop_oneof![
        any_name().prop_map(Step::Field),
        (-9999..9999i64).prop_map(Step::Index),
        (-9999..9999i64, -9999..9999i64).prop_map(|(first, last)| Step::Slice(first, last)),
        (prop::collection::vec(any_name(), 1..3), comparison, literal).prop_map(
            |(path, comparison, value)| Step::Filter(Filter {
                path,
                comparison,
                value
            })
        ),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// What is written is read back.
    #[test]
    fn a_path_survives_being_written(
        topic in prop_oneof!["(/[a-z_0-9]{1,6}){1,3}", "\\PC{1,8}"],
        steps in prop::collection::vec(any_step(), 0..6),
        number in -1e6..1e6f64,
    ) {
        let functions = vec![Function::Negative, Function::Add(number)];
        let path = MessagePath { topic, steps, functions };
        prop_assert_eq!(MessagePath::parse(&path.to_string()), Ok(path));
    }

    /// Nothing makes it panic, and columns lie in the text or right behind.
    #[test]
    fn any_text_is_read_or_refused_in_place(text in "\\PC{0,40}") {
        if let Err(error) = MessagePath::parse(&text) {
            prop_assert!((1..=text.chars().count() + 1).contains(&error.column));
        }
    }

    /// The same near what is right.
    #[test]
    fn any_text_of_the_right_signs_is_read_or_refused_in_place(
        text in r#"/[ab./\[\]{}=<>!:0-9\-"'\\ @()&$]{0,30}"#,
    ) {
        if let Err(error) = MessagePath::parse(&text) {
            prop_assert!((1..=text.chars().count() + 1).contains(&error.column));
        }
    }
}

//! The formula itself: which text is accepted, and its value.

use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator};

/// Largest length of an expression \[bytes\].
const MAX_LENGTH: usize = 1000;
/// Largest number of different names in an expression.
pub const MAX_NAMES: usize = 24;
/// Largest depth of nested parentheses and functions.
const MAX_DEPTH: usize = 40;

const FUNCTIONS: [&str; 14] = [
    "abs", "sign", "sqrt", "exp", "ln", "sin", "cos", "tan", "asin", "acos", "atan", "sinh",
    "cosh", "tanh",
];

#[derive(Clone, Debug)]
struct Operators;

impl MakeOperators<f64> for Operators {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        let binary = |apply, prio, is_commutative| BinOp {
            apply,
            prio,
            is_commutative,
        };
        vec![
            Operator::make_bin("^", binary(|a: f64, b: f64| a.powf(b), 4, false)),
            Operator::make_bin("/", binary(|a, b| a / b, 3, false)),
            Operator::make_bin("*", binary(|a, b| a * b, 2, true)),
            Operator::make_bin("-", binary(|a, b| a - b, 1, false)),
            Operator::make_bin("+", binary(|a, b| a + b, 0, true)),
            Operator::make_unary("abs", f64::abs),
            Operator::make_unary("sign", crate::effects::sign),
            Operator::make_unary("sqrt", f64::sqrt),
            Operator::make_unary("exp", f64::exp),
            Operator::make_unary("ln", f64::ln),
            Operator::make_unary("sin", f64::sin),
            Operator::make_unary("cos", f64::cos),
            Operator::make_unary("tan", f64::tan),
            Operator::make_unary("asin", f64::asin),
            Operator::make_unary("acos", f64::acos),
            Operator::make_unary("atan", f64::atan),
            Operator::make_unary("sinh", f64::sinh),
            Operator::make_unary("cosh", f64::cosh),
            Operator::make_unary("tanh", f64::tanh),
            Operator::make_constant("pi", std::f64::consts::PI),
        ]
    }
}

#[derive(Clone, Debug)]
struct Number;

impl MatchLiteral for Number {
    fn is_literal(text: &str) -> Option<&str> {
        number(text)
    }
}

/// The number that a text starts with, exponent and all.
fn number(text: &str) -> Option<&str> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes
            .iter()
            .skip(from)
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let whole = digits(0);
    let mut end = whole;
    let mut decimals = 0;
    if bytes.get(end) == Some(&b'.') {
        decimals = digits(end + 1);
        end += 1 + decimals;
    }
    if whole + decimals == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    text.get(..end)
}

/// A parsed formula.
#[derive(Clone)]
pub struct Formula {
    parsed: FlatEx<f64, Operators, Number>,
}

impl Formula {
    /// Reads an expression.
    ///
    /// # Errors
    ///
    /// A text: the fault and its place.
    pub fn parse(expression: &str) -> Result<Self, String> {
        let text = prepare(expression)?;
        let parsed =
            FlatEx::<f64, Operators, Number>::parse(&text).map_err(|e| e.msg().to_owned())?;
        if parsed.var_names().len() > MAX_NAMES {
            return Err(format!(
                "it has {} names, at most {MAX_NAMES} are possible",
                parsed.var_names().len()
            ));
        }
        Ok(Self { parsed })
    }

    /// Names in it, in the order in which [`Self::value`] takes their values.
    #[must_use]
    pub fn names(&self) -> &[String] {
        self.parsed.var_names()
    }

    /// Its value; NaN if there are fewer values than names.
    #[must_use]
    pub fn value(&self, values: &[f64]) -> f64 {
        self.parsed.eval(values).unwrap_or(f64::NAN)
    }
}

/// Token of an expression, as far as its neighbours matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token {
    Start,
    Operand,
    Function,
    Operator,
    Open,
    Close,
}

/// Checks what stands next to what, so that nothing depends on how the parser
/// binds a sign (it would read `-q^2` as `(-q)^2`): a leading sign becomes
/// `0-…`, a sign after an operator is refused.
fn prepare(expression: &str) -> Result<String, String> {
    if expression.len() > MAX_LENGTH {
        return Err(format!("it is longer than {MAX_LENGTH} characters"));
    }
    let mut out = String::with_capacity(expression.len() + 8);
    let (mut before, mut depth, mut at) = (Token::Start, 0_usize, 0_usize);
    let mut name_before = None;
    while let Some(c) = expression[at..].chars().next() {
        let column = at + 1;
        let rest = &expression[at..];
        if c == ' ' || c == '\t' || c == '\n' {
            at += 1;
            continue;
        }
        let (token, text) = if let Some(number) = number(rest) {
            (Token::Operand, number)
        } else if c.is_ascii_alphabetic() || c == '_' {
            let end = rest
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .unwrap_or(rest.len());
            let name = &rest[..end];
            (
                if FUNCTIONS.contains(&name) {
                    Token::Function
                } else {
                    Token::Operand
                },
                name,
            )
        } else {
            match c {
                '+' | '-' | '*' | '/' | '^' => (Token::Operator, &rest[..1]),
                '(' => (Token::Open, &rest[..1]),
                ')' => (Token::Close, &rest[..1]),
                _ => return Err(format!("{c:?} at column {column} has no meaning here")),
            }
        };
        let open = matches!(before, Token::Start | Token::Open | Token::Operator);
        match token {
            Token::Operand | Token::Function if !open => {
                return Err(format!(
                    "an operator is missing before {text:?} at column {column}"
                ));
            }
            Token::Open if !(open || before == Token::Function) => {
                if let Some(name) = name_before {
                    return Err(format!(
                        "there is no function {name:?} (before column {column}); there are {}; a product is {name}*(…)",
                        FUNCTIONS.join(", ")
                    ));
                }
                return Err(format!(
                    "an operator is missing before \"(\" at column {column}"
                ));
            }
            Token::Operator if before == Token::Operator => {
                return Err(format!(
                    "two operators in a row at column {column}; put the sign in parentheses, like 2*(-q)"
                ));
            }
            Token::Operator if open => {
                if text != "-" && text != "+" {
                    return Err(format!("nothing before {text:?} at column {column}"));
                }
                out.push('0');
            }
            Token::Close if open => {
                return Err(format!("nothing before {text:?} at column {column}"));
            }
            _ => {}
        }
        if before == Token::Function && token != Token::Open {
            return Err(format!(
                "a function takes its argument in parentheses, column {column}"
            ));
        }
        match token {
            Token::Open => depth += 1,
            Token::Close if depth == 0 => {
                return Err(format!("a \")\" too many at column {column}"));
            }
            Token::Close => depth -= 1,
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(format!(
                "more than {MAX_DEPTH} parentheses within each other at column {column}"
            ));
        }
        out.push_str(text);
        let is_name = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        name_before = (token == Token::Operand && is_name).then_some(text);
        before = token;
        at += text.len();
    }
    match before {
        Token::Start => Err("it is empty".to_owned()),
        Token::Operand | Token::Close if depth == 0 => Ok(out),
        Token::Operand | Token::Close => Err(format!("{depth} \")\" missing at the end")),
        _ => Err("it breaks off at the end".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn value(expression: &str) -> f64 {
        Formula::parse(expression).unwrap().value(&[])
    }

    #[test]
    fn a_function_that_there_is_not_is_told_with_those_that_there_are() {
        let refused = |text: &str| Formula::parse(text).map(drop).unwrap_err();
        let words = refused("2*foo(q");
        assert!(words.starts_with("there is no function \"foo\""), "{words}");
        assert!(words.contains("abs, sign, sqrt"), "{words}");
        assert!(refused("(q)(q)").starts_with("an operator is missing"));
        assert!(refused("2(q)").starts_with("an operator is missing"));
    }

    #[test]
    fn arithmetic_is_as_in_mathematics() {
        assert_eq!(value("-2^2"), -4.0);
        assert_eq!(value("3-2-1"), 0.0);
        assert_eq!(value("3-2+1"), 2.0);
        assert_eq!(value("1+2*3-4/2"), 5.0);
        assert_eq!(value("8/4/2"), 1.0);
        assert_eq!(value("8/4*2"), 4.0);
        assert_eq!(value("2*(-1.5e-1)"), -0.3);
        assert_eq!(value("abs(-3) + sign(0) - sign(-(2))"), 4.0);
        assert!((value("exp(-(0.5/0.25)^2)") - (-4.0_f64).exp()).abs() < 1e-15);
        assert!((value("sin(pi/2)") - 1.0).abs() < 1e-15);
    }

    #[test]
    fn names_are_whole_words() {
        let formula = Formula::parse("a*sin(6*q) + sine*qd + absolute").unwrap();
        assert_eq!(formula.names(), ["a", "absolute", "q", "qd", "sine"]);
    }

    #[test]
    fn mistakes_are_placed() {
        for (expression, part) in [
            ("", "empty"),
            ("a*", "breaks off"),
            ("a*(q", "missing at the end"),
            ("a*q)", "column 4"),
            ("a q", "column 3"),
            ("a*-q", "column 3"),
            ("a*sin q", "column 7"),
            ("a*q$", "column 4"),
            ("a*τ", "column 3"),
            ("2(q)", "column 2"),
        ] {
            let error = Formula::parse(expression).err().unwrap_or_default();
            assert!(error.contains(part), "{expression}: {error}");
        }
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "[a-cq0-9+*/^(), .esinmax-]{0,40}") {
            if let Ok(formula) = Formula::parse(&text) {
                let values = vec![0.5; formula.names().len()];
                let _ = formula.value(&values);
            }
        }
    }
}

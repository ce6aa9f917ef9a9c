//! Reads message paths, a character at a time.

use super::{
    Comparison, FUNCTIONS, Filter, Function, Literal, MessagePath, MessagePathError, Step,
};

/// Longest path that is read \[characters\]: more is a mistake.
const LONGEST: usize = 4096;

pub(super) fn parse(text: &str) -> Result<MessagePath, MessagePathError> {
    let mut parser = Parser::new(text)?;
    parser.space();
    let topic = parser.topic()?;
    let mut steps = Vec::new();
    let mut functions = Vec::new();
    loop {
        let at = parser.at;
        match parser.next() {
            None => break,
            Some('.') if parser.peek() == Some('@') => {
                parser.at += 1;
                functions.push(parser.function()?);
            }
            Some(_) if !functions.is_empty() => {
                parser.at = at;
                return Err(parser.expected("another function (.@name) or the end"));
            }
            Some('.') => steps.push(Step::Field(parser.name("a field's name")?)),
            Some('[') => steps.push(parser.brackets()?),
            Some('{') => parser.filters(&mut steps)?,
            Some(c) if c.is_whitespace() => {
                parser.space();
                if parser.peek().is_some() {
                    return Err(parser.expected("the end"));
                }
            }
            Some(_) => {
                parser.at = at;
                return Err(parser.expected("`.field`, `[index]`, `{filter}` or the end"));
            }
        }
    }
    Ok(MessagePath {
        topic,
        steps,
        functions,
    })
}

/// A text split into what stands before its first `.@`, and the functions
/// from there on.
pub(crate) fn functions_of(text: &str) -> Result<(&str, Vec<Function>), MessagePathError> {
    let Some((name, _)) = text.split_once(".@") else {
        return Ok((text, Vec::new()));
    };
    let mut parser = Parser::new(text)?;
    parser.at = name.chars().count();
    let mut functions = Vec::new();
    while parser.peek().is_some() {
        parser.expect(".@", "another function (.@name) or the end")?;
        functions.push(parser.function()?);
    }
    Ok((name, functions))
}

struct Parser<'a> {
    text: &'a str,
    characters: Vec<char>,
    at: usize,
}

impl<'a> Parser<'a> {
    fn new(text: &'a str) -> Result<Parser<'a>, MessagePathError> {
        let characters: Vec<char> = text.chars().take(LONGEST + 1).collect();
        if characters.len() > LONGEST {
            return Err(MessagePathError {
                path: characters.into_iter().take(60).chain(['…']).collect(),
                column: LONGEST + 1,
                expected: format!("the end (at most {LONGEST} characters)"),
                found: "more".to_owned(),
            });
        }
        Ok(Parser {
            text,
            characters,
            at: 0,
        })
    }

    fn peek(&self) -> Option<char> {
        self.characters.get(self.at).copied()
    }

    fn next(&mut self) -> Option<char> {
        let next = self.peek()?;
        self.at += 1;
        Some(next)
    }

    /// The error that `what` is not where the parser stands.
    fn expected(&self, what: &str) -> MessagePathError {
        MessagePathError {
            path: self.text.to_owned(),
            column: self.at + 1,
            expected: what.to_owned(),
            found: match self.peek() {
                Some(c) => format!("{c:?}"),
                None => "the end".to_owned(),
            },
        }
    }

    fn space(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.at += 1;
        }
    }

    /// Takes `sign` if it stands here.
    fn take(&mut self, sign: &str) -> bool {
        let there = sign
            .chars()
            .enumerate()
            .all(|(place, c)| self.characters.get(self.at + place) == Some(&c));
        if there {
            self.at += sign.chars().count();
        }
        there
    }

    fn expect(&mut self, sign: &str, what: &str) -> Result<(), MessagePathError> {
        match self.take(sign) {
            true => Ok(()),
            false => Err(self.expected(what)),
        }
    }

    fn run(&mut self, wanted: impl Fn(char) -> bool) -> String {
        let begin = self.at;
        while self.peek().is_some_and(&wanted) {
            self.at += 1;
        }
        self.characters
            .get(begin..self.at)
            .unwrap_or_default()
            .iter()
            .collect()
    }

    fn topic(&mut self) -> Result<String, MessagePathError> {
        if matches!(self.peek(), Some('"' | '\'')) {
            return self.quoted();
        }
        let begin = self.at;
        let name = self.run(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '/' | '-' | '~'));
        if name.is_empty() {
            self.at = begin;
            return Err(self.expected("a topic's name, such as /joint_states"));
        }
        Ok(name)
    }

    fn name(&mut self, what: &str) -> Result<String, MessagePathError> {
        if matches!(self.peek(), Some('"' | '\'')) {
            return self.quoted();
        }
        let name = self.run(|c| c.is_ascii_alphanumeric() || c == '_');
        match name.is_empty() {
            true => Err(self.expected(what)),
            false => Ok(name),
        }
    }

    /// A text in quotes; a backslash takes the next character as it is.
    fn quoted(&mut self) -> Result<String, MessagePathError> {
        let quote = self.next();
        let mut content = String::new();
        loop {
            match self.next() {
                None => return Err(self.expected("the closing quote")),
                Some('\\') => match self.next() {
                    None => return Err(self.expected("a character after the backslash")),
                    Some(c) => content.push(c),
                },
                c if c == quote => return Ok(content),
                Some(c) => content.push(c),
            }
        }
    }

    fn brackets(&mut self) -> Result<Step, MessagePathError> {
        self.space();
        let first = self.whole_number()?;
        self.space();
        let step = if self.take(":") {
            self.space();
            let last = self.whole_number()?;
            self.space();
            Step::Slice(first.unwrap_or(0), last.unwrap_or(-1))
        } else {
            match first {
                Some(index) => Step::Index(index),
                None => return Err(self.expected("a whole number or `:`")),
            }
        };
        let what = match step {
            Step::Index(_) => "`]` or `:`",
            _ => "a whole number or `]`",
        };
        self.expect("]", what)?;
        Ok(step)
    }

    /// A whole number, if one stands here.
    fn whole_number(&mut self) -> Result<Option<i64>, MessagePathError> {
        let begin = self.at;
        if self.peek() == Some('$') {
            return Err(self.expected("a whole number (variables are not supported)"));
        }
        let sign = if self.take("-") { "-" } else { "" };
        let digits = self.run(|c| c.is_ascii_digit());
        if digits.is_empty() && sign.is_empty() {
            return Ok(None);
        }
        match format!("{sign}{digits}").parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) => {
                self.at = begin;
                Err(self.expected("a whole number of at most 18 digits"))
            }
        }
    }

    /// The conditions behind an opening brace, up to the closing one.
    fn filters(&mut self, steps: &mut Vec<Step>) -> Result<(), MessagePathError> {
        loop {
            steps.push(Step::Filter(self.filter()?));
            self.space();
            if self.take("}") {
                return Ok(());
            }
            self.expect("&&", "`}` or `&&`")?;
        }
    }

    fn filter(&mut self) -> Result<Filter, MessagePathError> {
        self.space();
        let mut path = vec![self.name("a field's name")?];
        while self.take(".") {
            path.push(self.name("a field's name")?);
        }
        self.space();
        let signs = [
            ("==", Comparison::Equal),
            ("!=", Comparison::NotEqual),
            ("<=", Comparison::LessOrEqual),
            (">=", Comparison::GreaterOrEqual),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        let found = signs.into_iter().find(|(sign, _)| self.take(sign));
        let Some((_, comparison)) = found else {
            return Err(self.expected("`==`, `!=`, `<`, `<=`, `>` or `>=`"));
        };
        self.space();
        Ok(Filter {
            path,
            comparison,
            value: self.literal()?,
        })
    }

    fn literal(&mut self) -> Result<Literal, MessagePathError> {
        const WHAT: &str = "a number, a text in quotes, true or false";
        if matches!(self.peek(), Some('"' | '\'')) {
            return Ok(Literal::Text(self.quoted()?));
        }
        let begin = self.at;
        let word = self.run(|c| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+'));
        let value = match word.as_str() {
            "true" => Some(Literal::Bool(true)),
            "false" => Some(Literal::Bool(false)),
            _ => number(&word).map(Literal::Number),
        };
        value.ok_or_else(|| {
            self.at = begin;
            self.expected(WHAT)
        })
    }

    /// The function behind `.@`.
    fn function(&mut self) -> Result<Function, MessagePathError> {
        let begin = self.at;
        let name = self.run(|c| c.is_ascii_alphanumeric() || c == '_');
        let mut argument = None;
        if self.take("(") {
            self.space();
            let at = self.at;
            let word = self.run(|c| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+'));
            argument = number(&word);
            if argument.is_none() {
                self.at = at;
                return Err(self.expected("a number"));
            }
            self.space();
            self.expect(")", "`)`")?;
        }
        Function::from_name(&name, argument).ok_or_else(|| {
            self.at = begin;
            self.expected(&format!("one of the functions {FUNCTIONS}"))
        })
    }
}

/// A finite number; nothing else that Rust reads as one.
fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

//! Default values and constants.

use super::kind::{Base, Count, Primitive, Type};

/// A default value or the value of a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of a `bool`.
    Bool(bool),
    /// Of a whole number, `byte` or `char`.
    Integer(i128),
    /// Of a `float32` or `float64`.
    Float(f64),
    /// Of a text.
    Text(String),
    /// Of a sequence.
    List(Vec<Value>),
}

/// The default value that `text` says for a field; `None` when it is none of
/// that type.
pub(super) fn default(kind: &Type, text: &str) -> Option<Value> {
    let bound = match kind.count {
        Count::One => return single(&kind.base, text),
        Count::Array(size) => size..=size,
        Count::AtMost(bound) => 0..=bound,
        Count::Any => 0..=u64::MAX,
    };
    let inside = text.strip_prefix('[')?.strip_suffix(']')?;
    let items = split(inside)?;
    let values: Option<Vec<Value>> = items.iter().map(|item| single(&kind.base, item)).collect();
    values
        .filter(|values| bound.contains(&(values.len() as u64)))
        .map(Value::List)
}

/// The value that `text` says for a constant. Other than a default, the value
/// of a text may stand without quotes.
pub(super) fn constant(base: &Base, text: &str) -> Option<Value> {
    match base {
        Base::String(_) | Base::WideString(_) => {
            let content = unquote(text).unwrap_or_else(|| text.to_owned());
            within(base, &content).then_some(Value::Text(content))
        }
        _ => single(base, text),
    }
}

fn single(base: &Base, text: &str) -> Option<Value> {
    match base {
        Base::Primitive(primitive) => number(*primitive, text),
        Base::String(_) | Base::WideString(_) => {
            let content = unquote(text)?;
            within(base, &content).then_some(Value::Text(content))
        }
        Base::Interface(_) => None,
    }
}

fn number(primitive: Primitive, text: &str) -> Option<Value> {
    let range = match primitive {
        Primitive::Bool => {
            return match text {
                "true" | "True" | "1" => Some(Value::Bool(true)),
                "false" | "False" | "0" => Some(Value::Bool(false)),
                _ => None,
            };
        }
        Primitive::Float32 | Primitive::Float64 => {
            return text.parse().ok().map(Value::Float);
        }
        Primitive::Byte | Primitive::Char | Primitive::Uint8 => 0..=u8::MAX.into(),
        Primitive::Int8 => i8::MIN.into()..=i8::MAX.into(),
        Primitive::Uint16 => 0..=u16::MAX.into(),
        Primitive::Int16 => i16::MIN.into()..=i16::MAX.into(),
        Primitive::Uint32 => 0..=u32::MAX.into(),
        Primitive::Int32 => i32::MIN.into()..=i32::MAX.into(),
        Primitive::Uint64 => 0..=u64::MAX.into(),
        Primitive::Int64 => i64::MIN.into()..=i64::MAX.into(),
    };
    integer(text)
        .filter(|value| range.contains(value))
        .map(Value::Integer)
}

/// A whole number: decimal, or with 0x, 0o or 0b in front.
fn integer(text: &str) -> Option<i128> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (radix, digits) = match digits.get(..2) {
        Some("0x" | "0X") => (16, digits.get(2..)?),
        Some("0o" | "0O") => (8, digits.get(2..)?),
        Some("0b" | "0B") => (2, digits.get(2..)?),
        _ => (10, digits),
    };
    // No second sign, which from_str_radix would take.
    if !digits.starts_with(|first: char| first.is_ascii_hexdigit()) {
        return None;
    }
    let value = i128::from_str_radix(digits, radix).ok()?;
    Some(if negative { -value } else { value })
}

/// The content of a text in double or single quotes; a backslash takes the
/// next character as it is.
fn unquote(text: &str) -> Option<String> {
    let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let mut content = String::new();
    let mut characters = text.chars().skip(1);
    loop {
        match characters.next()? {
            '\\' => content.push(characters.next()?),
            c if c == quote => return characters.next().is_none().then_some(content),
            c => content.push(c),
        }
    }
}

/// Whether a text keeps the bound of its type.
fn within(base: &Base, content: &str) -> bool {
    match base {
        Base::String(Some(bound)) => content.len() as u64 <= *bound,
        Base::WideString(Some(bound)) => content.encode_utf16().count() as u64 <= *bound,
        _ => true,
    }
}

/// The items between the commas that are not inside quotes; `None` when a
/// quote is left open.
fn split(inside: &str) -> Option<Vec<&str>> {
    if inside.trim().is_empty() {
        return Some(Vec::new());
    }
    let (mut items, mut start) = (Vec::new(), 0);
    let mut quotes = Quotes::default();
    for (index, c) in inside.char_indices() {
        if !quotes.inside(c) && c == ',' {
            items.push(inside.get(start..index)?.trim());
            start = index + 1;
        }
    }
    items.push(inside.get(start..)?.trim());
    (!quotes.are_open()).then_some(items)
}

/// Follows a text to tell what stands inside quotes. A quote opens where a
/// value may begin; within a word it is an apostrophe.
#[derive(Default)]
pub(super) struct Quotes {
    open: Option<char>,
    escaped: bool,
    in_word: bool,
}

impl Quotes {
    /// Takes the next character; whether it stands inside quotes, or is one.
    pub(super) fn inside(&mut self, c: char) -> bool {
        match self.open {
            Some(_) if self.escaped => self.escaped = false,
            Some(_) if c == '\\' => self.escaped = true,
            Some(quote) if c == quote => (self.open, self.in_word) = (None, true),
            Some(_) => {}
            None if matches!(c, '"' | '\'') && !self.in_word => self.open = Some(c),
            None => {
                self.in_word = !(c.is_whitespace() || matches!(c, '=' | '[' | ','));
                return false;
            }
        }
        true
    }

    /// Whether a quote was opened and not closed.
    pub(super) fn are_open(&self) -> bool {
        self.open.is_some()
    }
}

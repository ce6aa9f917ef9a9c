//! Foxglove message paths: which number of a message is meant.
//!
//! | written | meaning |
//! |---|---|
//! | `/topic.field.field` | a field of a field |
//! | `."odd name"` | a field (or topic) whose name has other signs than letters, digits and `_` |
//! | `[0]`, `[-1]` | one element, counted from the front, or from the back |
//! | `[1:3]`, `[:]`, `[-2:]` | the elements from … to, both included |
//! | `{field=="text"}` | only where it holds; `==`, `!=`, `<`, `<=`, `>`, `>=`; texts in `"` or `'`, numbers, `true`, `false`; several in a row or joined by `&&` must all hold |
//! | `.@deg2rad` | a function at the end: see [`FUNCTIONS`] |
//!
//! A filter on the topic (`/topic{…}`) or on a message inside takes or leaves
//! it; after an array it picks elements, before or after the brackets. As in
//! Foxglove, an element that is not there and a filter that does not hold
//! give no value for that message. Other than in Foxglove:
//!
//! * a path must give one number a message, so a slice must be narrowed by a
//!   filter or by its bounds;
//! * a filter on an array of numbers looks at the array beside it:
//!   `/joint_states.position[:]{name=="joint_1"}` is the position at the
//!   place where `name` says `joint_1`;
//! * variables (`$name`) and functions over time (`.@derivative`) are
//!   refused.

mod error;
mod function;
mod parse;
#[cfg(test)]
mod tests;

use std::fmt;

pub use error::MessagePathError;
pub use function::{FUNCTIONS, Function};
pub(crate) use parse::functions_of;

/// A message path.
#[derive(Clone, Debug, PartialEq)]
pub struct MessagePath {
    /// The topic's full name.
    pub topic: String,
    /// From the message to the number.
    pub steps: Vec<Step>,
    /// What is done with the number, in order.
    pub functions: Vec<Function>,
}

/// One step towards the number.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Into the field of that name.
    Field(String),
    /// To the element of that number; a negative one counts from the back,
    /// −1 the last.
    Index(i64),
    /// To the elements from the first to the last, both included, counted as
    /// for [`Step::Index`].
    Slice(i64, i64),
    /// Only where it holds.
    Filter(Filter),
}

/// A condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    /// Names of fields, from the message or element that it stands behind.
    pub path: Vec<String>,
    /// How they compare.
    pub comparison: Comparison,
    /// With what.
    pub value: Literal,
}

/// How a field compares with a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// `==`.
    Equal,
    /// `!=`.
    NotEqual,
    /// `<`.
    Less,
    /// `<=`.
    LessOrEqual,
    /// `>`.
    Greater,
    /// `>=`.
    GreaterOrEqual,
}

/// A value in a filter.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    /// A number.
    Number(f64),
    /// `true` or `false`.
    Bool(bool),
    /// A text.
    Text(String),
}

impl MessagePath {
    /// Reads a path.
    ///
    /// # Errors
    ///
    /// [`MessagePathError`]: the column, and what was expected there.
    pub fn parse(text: &str) -> Result<MessagePath, MessagePathError> {
        parse::parse(text)
    }
}

impl std::str::FromStr for MessagePath {
    type Err = MessagePathError;

    fn from_str(text: &str) -> Result<MessagePath, MessagePathError> {
        MessagePath::parse(text)
    }
}

impl Comparison {
    /// Whether it holds for two values that compare so; `None` are values
    /// that cannot be compared, as texts with numbers.
    pub fn holds(self, order: Option<std::cmp::Ordering>) -> bool {
        match self {
            Comparison::Equal => order.is_some_and(|order| order.is_eq()),
            Comparison::NotEqual => order.is_none_or(|order| order.is_ne()),
            Comparison::Less => order.is_some_and(|order| order.is_lt()),
            Comparison::LessOrEqual => order.is_some_and(|order| order.is_le()),
            Comparison::Greater => order.is_some_and(|order| order.is_gt()),
            Comparison::GreaterOrEqual => order.is_some_and(|order| order.is_ge()),
        }
    }

    fn sign(self) -> &'static str {
        match self {
            Comparison::Equal => "==",
            Comparison::NotEqual => "!=",
            Comparison::Less => "<",
            Comparison::LessOrEqual => "<=",
            Comparison::Greater => ">",
            Comparison::GreaterOrEqual => ">=",
        }
    }
}

/// Whether a name may stand without quotes.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// In double quotes, a backslash before quotes and backslashes.
struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"")?;
        for c in self.0.chars() {
            if matches!(c, '"' | '\\') {
                f.write_str("\\")?;
            }
            write!(f, "{c}")?;
        }
        f.write_str("\"")
    }
}

struct Name<'a>(&'a str);

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match is_plain(self.0) {
            true => f.write_str(self.0),
            false => Quoted(self.0).fmt(f),
        }
    }
}

impl fmt::Display for Filter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("{")?;
        for (place, name) in self.path.iter().enumerate() {
            let dot = if place == 0 { "" } else { "." };
            write!(f, "{dot}{}", Name(name))?;
        }
        f.write_str(self.comparison.sign())?;
        match &self.value {
            Literal::Number(number) => write!(f, "{number}")?,
            Literal::Bool(value) => write!(f, "{value}")?,
            Literal::Text(text) => Quoted(text).fmt(f)?,
        }
        f.write_str("}")
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Step::Field(name) => write!(f, ".{}", Name(name)),
            Step::Index(index) => write!(f, "[{index}]"),
            Step::Slice(0, -1) => f.write_str("[:]"),
            Step::Slice(first, last) => write!(f, "[{first}:{last}]"),
            Step::Filter(filter) => filter.fmt(f),
        }
    }
}

impl fmt::Display for MessagePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = self.topic.split('/').skip(1).all(is_plain) && self.topic.starts_with('/');
        match plain {
            true => f.write_str(&self.topic)?,
            false => Quoted(&self.topic).fmt(f)?,
        }
        self.steps.iter().try_for_each(|step| step.fmt(f))?;
        self.functions.iter().try_for_each(|each| each.fmt(f))
    }
}

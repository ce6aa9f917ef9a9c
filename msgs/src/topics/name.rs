//! Names of topics.

use std::{fmt, ops::Deref};

use crate::Text;

/// The longest name that a topic may have \[byte\].
pub const MAX_TOPIC_NAME: usize = 64;

/// Full ROS 2 name of a topic (`/follower/measured_js`): absolute, its parts of
/// letters, digits and single underscores. It lives in place, so that a control
/// loop may copy it.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct TopicName(Text<MAX_TOPIC_NAME>);

/// Why a text is no name of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TopicNameError {
    /// Longer than [`MAX_TOPIC_NAME`].
    #[error("the name has {length} bytes, more than {MAX_TOPIC_NAME}")]
    TooLong {
        /// Bytes given.
        length: usize,
    },
    /// It does not begin with `/`.
    #[error("the name does not begin with /")]
    NotAbsolute,
    /// Nothing between two slashes, or after the last.
    #[error("a part of the name is empty")]
    Empty,
    /// A part begins with a digit.
    #[error("a part of the name begins with a digit")]
    Digit,
    /// Something else than letters, digits and underscores.
    #[error("the name has other characters than letters, digits and _")]
    Character,
    /// Two underscores together, which ROS 2 keeps for itself.
    #[error("the name has two _ together")]
    Underscores,
}

impl TopicName {
    /// The topic of that name.
    ///
    /// # Errors
    ///
    /// [`TopicNameError`].
    pub const fn new(name: &str) -> Result<TopicName, TopicNameError> {
        if name.len() > MAX_TOPIC_NAME {
            let length = name.len();
            return Err(TopicNameError::TooLong { length });
        }
        match fault(name.as_bytes()) {
            None => Ok(TopicName(Text::new(name))),
            Some(fault) => Err(fault),
        }
    }

    /// A name that stands in the program.
    ///
    /// # Panics
    ///
    /// It is none; where it is the value of a constant, that does not compile.
    pub const fn constant(name: &str) -> TopicName {
        match TopicName::new(name) {
            Ok(name) => name,
            Err(_) => panic!("not the name of a topic"),
        }
    }

    /// The name.
    pub fn as_str(&self) -> &str {
        self.0.as_str()
    }
}

/// What keeps these bytes from being a name.
const fn fault(name: &[u8]) -> Option<TopicNameError> {
    if name.is_empty() || name[0] != b'/' {
        return Some(TopicNameError::NotAbsolute);
    }
    let mut at = 1;
    while at < name.len() {
        let fault = match (name[at - 1], name[at]) {
            (b'/', b'/') => Some(TopicNameError::Empty),
            (b'/', b'0'..=b'9') => Some(TopicNameError::Digit),
            (b'_', b'_') => Some(TopicNameError::Underscores),
            (_, b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'_' | b'/') => None,
            _ => Some(TopicNameError::Character),
        };
        if fault.is_some() {
            return fault;
        }
        at += 1;
    }
    match name[at - 1] {
        b'/' => Some(TopicNameError::Empty),
        _ => None,
    }
}

impl Deref for TopicName {
    type Target = str;

    fn deref(&self) -> &str {
        self.as_str()
    }
}

impl PartialEq<str> for TopicName {
    fn eq(&self, other: &str) -> bool {
        self.as_str() == other
    }
}

impl PartialEq<&str> for TopicName {
    fn eq(&self, other: &&str) -> bool {
        self.as_str() == *other
    }
}

impl From<TopicName> for String {
    fn from(name: TopicName) -> String {
        name.as_str().to_owned()
    }
}

impl fmt::Debug for TopicName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl fmt::Display for TopicName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

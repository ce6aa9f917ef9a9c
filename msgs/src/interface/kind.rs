//! Types of fields, as a `.msg` text names them.

use std::fmt;

/// The type of a field: what, and how many.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Type {
    /// What one element is.
    pub base: Base,
    /// How many there are.
    pub count: Count,
}

/// How many elements a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// One.
    One,
    /// That many, always (`[3]`).
    Array(u64),
    /// At most that many (`[<=3]`).
    AtMost(u64),
    /// Any number (`[]`).
    Any,
}

/// What one element is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Base {
    /// A number, truth value or byte.
    Primitive(Primitive),
    /// UTF-8 text, where bounded of at most that many bytes.
    String(Option<u64>),
    /// UTF-16 text, where bounded of at most that many code units.
    WideString(Option<u64>),
    /// Another interface, by its full name.
    Interface(String),
}

/// The primitive types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Primitive {
    /// `bool`.
    Bool,
    /// `byte`: eight bits without a meaning as a number.
    Byte,
    /// `char`, which ROS 2 treats as `uint8`.
    Char,
    /// `float32`.
    Float32,
    /// `float64`.
    Float64,
    /// `int8`.
    Int8,
    /// `uint8`.
    Uint8,
    /// `int16`.
    Int16,
    /// `uint16`.
    Uint16,
    /// `int32`.
    Int32,
    /// `uint32`.
    Uint32,
    /// `int64`.
    Int64,
    /// `uint64`.
    Uint64,
}

impl Primitive {
    /// Every primitive type.
    pub const ALL: [Primitive; 13] = [
        Primitive::Bool,
        Primitive::Byte,
        Primitive::Char,
        Primitive::Float32,
        Primitive::Float64,
        Primitive::Int8,
        Primitive::Uint8,
        Primitive::Int16,
        Primitive::Uint16,
        Primitive::Int32,
        Primitive::Uint32,
        Primitive::Int64,
        Primitive::Uint64,
    ];

    /// The word in a `.msg` text.
    pub const fn name(self) -> &'static str {
        match self {
            Primitive::Bool => "bool",
            Primitive::Byte => "byte",
            Primitive::Char => "char",
            Primitive::Float32 => "float32",
            Primitive::Float64 => "float64",
            Primitive::Int8 => "int8",
            Primitive::Uint8 => "uint8",
            Primitive::Int16 => "int16",
            Primitive::Uint16 => "uint16",
            Primitive::Int32 => "int32",
            Primitive::Uint32 => "uint32",
            Primitive::Int64 => "int64",
            Primitive::Uint64 => "uint64",
        }
    }

    /// The type of that name.
    pub fn from_name(name: &str) -> Option<Primitive> {
        Primitive::ALL
            .into_iter()
            .find(|primitive| primitive.name() == name)
    }
}

impl fmt::Display for Base {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Base::Primitive(primitive) => f.write_str(primitive.name()),
            Base::String(None) => f.write_str("string"),
            Base::String(Some(bound)) => write!(f, "string<={bound}"),
            Base::WideString(None) => f.write_str("wstring"),
            Base::WideString(Some(bound)) => write!(f, "wstring<={bound}"),
            Base::Interface(name) => f.write_str(name),
        }
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.base.fmt(f)?;
        match self.count {
            Count::One => Ok(()),
            Count::Array(count) => write!(f, "[{count}]"),
            Count::AtMost(bound) => write!(f, "[<={bound}]"),
            Count::Any => f.write_str("[]"),
        }
    }
}

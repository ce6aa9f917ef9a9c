//! What can be wrong with a definition.

/// Why a `.msg` text cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct ParseError {
    /// Where, counted from 1.
    pub line: usize,
    /// What is wrong there.
    pub problem: Problem,
}

/// What is wrong with a line of a `.msg` text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// Only a type stands there.
    #[error("{kind:?} has no field name after it: write `type name`")]
    NoName {
        /// The type.
        kind: String,
    },
    /// A name that no field or constant may have.
    #[error("{name:?} is no name: letters, digits and underscores, a letter first")]
    BadName {
        /// The name.
        name: String,
    },
    /// The type is neither primitive nor the name of an interface.
    #[error(
        "{kind:?} is no type: a primitive type, `Type` or `package/Type`, then [], [N] or [<=N] for a sequence"
    )]
    BadType {
        /// The type.
        kind: String,
    },
    /// A bound or size that is not a number above zero.
    #[error("{bound:?} is no bound: a whole number above zero")]
    BadBound {
        /// The bound.
        bound: String,
    },
    /// A value that is not of the type.
    #[error("{value:?} is no value of type {kind}")]
    BadValue {
        /// The value.
        value: String,
        /// The type.
        kind: String,
    },
    /// A constant that is a sequence or an interface.
    #[error("{kind} cannot be the type of a constant: take a primitive type or string")]
    BadConstant {
        /// The type.
        kind: String,
    },
    /// A default value for an interface.
    #[error("{kind} can have no default value: give the defaults in its own definition")]
    NoDefault {
        /// The type.
        kind: String,
    },
    /// A name that was given before.
    #[error("{name:?} is defined twice")]
    Twice {
        /// The name.
        name: String,
    },
}

/// Why there is no schema or hash of an interface.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InterfaceError {
    /// No interface can have that name.
    #[error("{name:?} is no interface name: write it as package/msg/Type")]
    BadName {
        /// The name.
        name: String,
    },
    /// The interface is not known here.
    #[error("interface {name} is not known; add its definition")]
    Unknown {
        /// The interface.
        name: String,
    },
    /// An interface that another one is made of is not known here.
    #[error("interface {name}, needed by {needed_by}, is not known; add its definition")]
    MissingDependency {
        /// The interface that is missing.
        name: String,
        /// The interface that needs it.
        needed_by: String,
    },
    /// The definition cannot be read.
    #[error("definition of {name}: {error}")]
    Definition {
        /// The interface.
        name: String,
        /// What is wrong.
        #[source]
        error: ParseError,
    },
}

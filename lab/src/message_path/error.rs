//! What can be wrong with a message path.

/// Why a text is no message path: where, what was expected there, what stands
/// there instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("message path {path:?}, column {column}: expected {expected}, found {found}")]
pub struct MessagePathError {
    /// The text.
    pub path: String,
    /// Where, in characters counted from 1.
    pub column: usize,
    /// What would be right there.
    pub expected: String,
    /// What stands there.
    pub found: String,
}

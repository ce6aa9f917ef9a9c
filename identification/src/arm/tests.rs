//! Small arms.

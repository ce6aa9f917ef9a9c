//! Mathematics without any notion of a joint: zero-phase filters, least squares from Gram
//! matrices, tests of significance.

pub mod filter;
pub mod gram;
pub mod regression;
pub mod statistics;
pub(crate) mod waves;

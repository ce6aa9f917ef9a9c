//! How much a test tries.

/// Whether each figure is to be judged on as many cases as it is stated for (`./tests/run
/// --thorough`), not on the few that show that it has not changed.
pub fn is_thorough() -> bool {
    std::env::var_os("FERNTAST_THOROUGH").is_some()
}

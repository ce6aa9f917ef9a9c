//! What takes longest: left out by `./tests/run --quick`.

mod blind;
mod discover;
mod paper;

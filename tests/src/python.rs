//! Programs in Python that are asked in JSON.

use std::{
    io::Write,
    path::Path,
    process::{Command, Stdio},
};

use serde_json::Value;

/// What the Python program `script` answers to `input`: JSON in, JSON out.
///
/// # Panics
///
/// It does not start, fails, or answers with something else.
pub fn ask_python(script: &Path, input: &Value) -> Value {
    let mut child = Command::new(crate::python())
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python starts");
    let text = input.to_string();
    child
        .stdin
        .take()
        .expect("a pipe")
        .write_all(text.as_bytes())
        .expect("python reads");
    let output = child.wait_with_output().expect("python ends");
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).expect("JSON")
}

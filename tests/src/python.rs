//! Programs in Python that are asked in JSON, or are a driver.

use std::{
    io::Write,
    path::Path,
    process::{Command, Stdio},
};

use serde_json::Value;

use crate::places::{peer, python};

/// The driver `process` with the peer `script` and its options: an arm in a program of its own.
pub fn process_driver(script: &str, options: &str) -> String {
    let (python, script) = (python(), peer(script));
    format!(
        "process:'{}' '{}' {options}",
        python.display(),
        script.display()
    )
}

/// What the Python program `script` answers to `input`: JSON in, JSON out.
///
/// # Panics
///
/// It does not start, fails, or answers with something else.
pub fn ask_python(script: &Path, input: &Value) -> Value {
    let mut child = Command::new(python())
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

//! An emulated bus of motors (`tests/python/peers/motor_bus.py`), for the tests of several crates.

#![allow(dead_code)] // Each test uses its part.

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
};

use serde_json::{Value, json};

/// A running bus. Dropped, it ends.
pub struct MotorBus {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    folder: tempfile::TempDir,
    /// The port that its motors are on.
    pub port: String,
}

impl MotorBus {
    /// A bus of `family` with `motors`, as the program takes them.
    pub fn start(family: &str, motors: &Value, options: &[&str]) -> MotorBus {
        let script =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/python/peers/motor_bus.py");
        let folder = tempfile::tempdir().expect("a folder");
        let mut child = Command::new("python3")
            .arg(script)
            .args(["--family", family, "--motors", &motors.to_string(), "--log"])
            .arg(folder.path().join("log"))
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("python3 starts");
        let input = child.stdin.take();
        let mut output = BufReader::new(child.stdout.take().expect("a pipe"));
        let port = answer(&mut output)["port"]
            .as_str()
            .expect("a port")
            .to_owned();
        MotorBus {
            child,
            input,
            output,
            folder,
            port,
        }
    }

    /// What it answers to `asked`.
    pub fn ask(&mut self, asked: &Value) -> Value {
        let input = self.input.as_mut().expect("a pipe");
        writeln!(input, "{asked}").expect("it reads");
        answer(&mut self.output)
    }

    /// How its motors are.
    pub fn motors(&mut self) -> Vec<Value> {
        let state = self.ask(&json!({"do": "state"}));
        state["motors"].as_array().expect("motors").clone()
    }

    /// A number of motor number `place`.
    pub fn number(&mut self, place: usize, key: &str) -> f64 {
        self.motors()[place][key].as_f64().expect(key)
    }

    /// What came in, an instruction a line.
    pub fn log(&self) -> PathBuf {
        self.folder.path().join("log")
    }
}

fn answer(output: &mut impl BufRead) -> Value {
    let mut line = String::new();
    output.read_line(&mut line).expect("it answers");
    serde_json::from_str(&line).expect("JSON")
}

impl Drop for MotorBus {
    fn drop(&mut self) {
        self.input = None;
        let _ = self.child.wait();
    }
}

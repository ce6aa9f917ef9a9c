//! Where things are.

use std::{
    env,
    path::{Path, PathBuf},
};

/// The project's root.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// The program: `FERNTAST_BIN`, else `ferntast` in the target folder of this test.
///
/// # Panics
///
/// It is not there.
pub fn ferntast() -> PathBuf {
    let path = match env::var_os("FERNTAST_BIN") {
        Some(path) => PathBuf::from(path),
        // target/release/deps/<this test>
        None => env::current_exe()
            .ok()
            .and_then(|test| Some(test.parent()?.parent()?.join("ferntast")))
            .unwrap_or_default(),
    };
    assert!(
        path.is_file(),
        "no program {}: 'cargo build --release', or set FERNTAST_BIN",
        path.display()
    );
    path
}

/// The recordings to test with: `FERNTAST_DATA`, else `../shared/data` beside the project.
///
/// # Panics
///
/// They are not there.
pub fn data() -> PathBuf {
    let path =
        env::var_os("FERNTAST_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    assert!(
        path.is_dir(),
        "no recordings in {}: set FERNTAST_DATA to the folder that has them",
        path.display()
    );
    path
}

/// Python with the peers' packages: `FERNTAST_PYTHON`, else that of `.venv`.
///
/// # Panics
///
/// It is not there.
pub fn python() -> PathBuf {
    let path = env::var_os("FERNTAST_PYTHON")
        .map_or_else(|| root().join(".venv/bin/python"), PathBuf::from);
    assert!(
        path.is_file(),
        "no Python {}: './tests/run' makes it, or set FERNTAST_PYTHON",
        path.display()
    );
    path
}

/// A peer's script, such as `ros_operator.py`.
///
/// # Panics
///
/// There is none of that name.
pub fn peer(script: &str) -> PathBuf {
    let path = root().join("tests/python/peers").join(script);
    assert!(path.is_file(), "no peer {}", path.display());
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_has_the_workspace_and_the_peers() {
        assert!(root().join("Cargo.lock").is_file());
        assert!(peer("ros_operator.py").ends_with("tests/python/peers/ros_operator.py"));
    }

    #[test]
    #[ignore = "needs outside recordings: hand"]
    fn the_recordings_are_there() {
        assert!(data().join("hand/hand_3.csv").is_file());
    }
}

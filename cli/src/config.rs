//! `ferntast config`.

use std::{
    fs::{self, OpenOptions},
    io::{self, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};

use ferntast_config::shipped;
use serde_json::json;

use super::{Failure, output::print_json};

/// The arms, links and scenarios that come along inside this program.
#[derive(Debug, clap::Args)]
#[command(after_help = "To change one:\n  \
    ferntast config export .              # writes ./config/arms/rokviss.toml and the rest\n  \
    $EDITOR config/scenarios/rokviss.toml\n  \
    ferntast session                      # a file below ./config comes before the one inside")]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List them.
    List,
    /// Print one.
    Show {
        /// Its name, as the list has it: arms/rokviss.toml.
        file: String,
    },
    /// Write them below DIR/config; files that are there already stay as they are.
    Export {
        /// Where `config` is to stand: the folder that ferntast is then run in.
        #[arg(value_name = "DIR", default_value = ".")]
        folder: PathBuf,
    },
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    match &arguments.action {
        Action::List => list(json)?,
        Action::Show { file } => show(file, json)?,
        Action::Export { folder } => export(&folder.join("config"), json)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn names() -> Vec<&'static str> {
    shipped::FILES.iter().map(|(name, _)| *name).collect()
}

fn list(json: bool) -> Result<(), Failure> {
    if json {
        return print_json(&names());
    }
    names().iter().for_each(|name| println!("{name}"));
    Ok(())
}

fn show(file: &str, json: bool) -> Result<(), Failure> {
    let name = file.strip_prefix("config/").unwrap_or(file);
    let text = shipped::text(name).ok_or_else(|| {
        let names = names().join(", ");
        Failure::refused(format!(
            "{file}: no such file comes along; there are {names}"
        ))
    })?;
    if json {
        return print_json(&json!({ "file": name, "text": text }));
    }
    print!("{text}");
    Ok(())
}

fn export(folder: &Path, json: bool) -> Result<(), Failure> {
    let mut written = Vec::new();
    let mut kept = Vec::new();
    for (name, text) in shipped::FILES {
        let path = folder.join(name);
        match write_new(&path, text) {
            Ok(()) => written.push(path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => kept.push(path),
            Err(error) => return Err(Failure::refused(format!("{}: {error}", path.display()))),
        }
    }
    if json {
        return print_json(&json!({ "written": written, "kept": kept }));
    }
    for path in &written {
        println!("{}", path.display());
    }
    for path in &kept {
        eprintln!("{}: is there already, kept as it is", path.display());
    }
    Ok(())
}

fn write_new(path: &Path, text: &str) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(text.as_bytes())
}

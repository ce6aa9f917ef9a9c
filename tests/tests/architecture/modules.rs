//! The source files of a crate, those of its tests left out.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    str::FromStr,
};

use proc_macro2::{TokenStream, TokenTree};

use super::source::is_cfg_test;

/// Every `.rs` file under `folder` with its text, but none that is declared by
/// `#[cfg(test)] mod name;`.
pub fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    collect(folder, &mut found);
    let mut left_out = BTreeSet::new();
    for (path, text) in &found {
        let below = children(path);
        for name in test_modules(text) {
            left_out.insert(below.join(format!("{name}.rs")));
            left_out.insert(below.join(name));
        }
    }
    found.retain(|(path, _)| !path.ancestors().any(|part| left_out.contains(part)));
    found
}

/// Where the modules that a file declares lie.
fn children(path: &Path) -> PathBuf {
    let stem = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or("");
    let folder = path.parent().unwrap_or(path);
    match stem {
        "lib" | "main" | "mod" => folder.to_path_buf(),
        _ => folder.join(stem),
    }
}

/// Names of the modules that are declared for tests only, in files of their own.
fn test_modules(text: &str) -> Vec<String> {
    let tokens: Vec<TokenTree> = TokenStream::from_str(text)
        .map(|stream| stream.into_iter().collect())
        .unwrap_or_default();
    tokens
        .windows(5)
        .filter_map(|window| match window {
            [
                hash,
                attribute,
                TokenTree::Ident(word),
                TokenTree::Ident(name),
                TokenTree::Punct(end),
            ] if is_cfg_test(hash, attribute) && word == "mod" && end.as_char() == ';' => {
                Some(name.to_string())
            }
            _ => None,
        })
        .collect()
}

fn collect(folder: &Path, found: &mut Vec<(PathBuf, String)>) {
    let entries = fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("cannot list {}: {error}", folder.display()));
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path)
                .unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
            found.push((path, text));
        }
    }
    found.sort();
}

#[test]
fn leaves_out_the_files_of_test_modules_only() {
    let session = ferntast_tests::Session::new();
    let folder = session.folder();
    for (path, text) in [
        ("lib.rs", "mod law; #[cfg(test)] mod tests;"),
        ("law.rs", "#[cfg(test)] mod samples; mod samples_of_hand;"),
        ("tests.rs", "use std::fs;"),
        ("law/samples.rs", "use std::fs;"),
        ("law/samples_of_hand.rs", ""),
    ] {
        let path = folder.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let names: Vec<PathBuf> = sources(folder)
        .into_iter()
        .map(|(path, _)| path.strip_prefix(folder).unwrap().to_path_buf())
        .collect();
    assert_eq!(
        names,
        ["law/samples_of_hand.rs", "law.rs", "lib.rs"].map(PathBuf::from)
    );
}

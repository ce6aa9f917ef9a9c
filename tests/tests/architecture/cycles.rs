//! Cycles between the source files of a crate: a file names items of another,
//! which, by way of others, names items of the first.
//!
//! Works on paths as they are written. A name that a module passes on
//! (`pub use`) belongs to the file that defines it, so that a `mod.rs` which
//! only lists its children depends on none of them.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use proc_macro2::{LexError, TokenStream, TokenTree};

use super::source::{branches, is_path_separator, test_only_item};

/// A module: names from the crate's root on.
type Module = Vec<String>;

/// What a file names.
#[derive(Default)]
struct Names {
    /// Path of each name that a `use` brings in.
    imported: BTreeMap<String, Vec<String>>,
    /// Paths that it uses itself, `pub use` left out.
    used: Vec<Vec<String>>,
}

/// The files of a crate by their modules.
struct Sources {
    paths: BTreeMap<Module, PathBuf>,
    names: BTreeMap<Module, Names>,
}

/// Every cycle with files of more than one folder, as lines `file -> file`
/// where it goes from folder to folder. `files` are those of the crate whose
/// sources lie in `root`.
pub fn cycles(root: &Path, files: &[(PathBuf, String)]) -> Result<Vec<String>, LexError> {
    let sources = Sources::read(root, files)?;
    let arrows = sources.arrows();
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = arrows
        .keys()
        .map(|from| (from, reached(&arrows, from)))
        .collect();
    let folder = |module: &Module| sources.paths[module].parent();
    let mut lines = Vec::new();
    for (from, targets) in &arrows {
        for to in targets {
            if folder(from) != folder(to) && reached[to].contains(from) {
                let [from, to] = [from, to].map(|module| sources.paths[module].display());
                lines.push(format!("{from} -> {to}"));
            }
        }
    }
    Ok(lines)
}

/// Modules that a way along the arrows leads to.
fn reached<'a>(
    arrows: &'a BTreeMap<Module, BTreeSet<Module>>,
    from: &Module,
) -> BTreeSet<&'a Module> {
    let mut found = BTreeSet::new();
    let mut left: Vec<&Module> = arrows[from].iter().collect();
    while let Some(next) = left.pop() {
        if found.insert(next) {
            left.extend(&arrows[next]);
        }
    }
    found
}

impl Sources {
    fn read(root: &Path, files: &[(PathBuf, String)]) -> Result<Sources, LexError> {
        let mut sources = Sources {
            paths: BTreeMap::new(),
            names: BTreeMap::new(),
        };
        for (path, text) in files {
            let module = module_of(path.strip_prefix(root).unwrap_or(path));
            let mut names = Names::default();
            names.collect(text.parse()?);
            sources.paths.insert(module.clone(), path.clone());
            sources.names.insert(module, names);
        }
        Ok(sources)
    }

    /// By file, the other files whose items it names.
    fn arrows(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let of = |(module, names): (&Module, &Names)| {
            let targets = names.used.iter();
            let targets = targets.filter_map(|path| self.file_of(module, path, 0));
            let others = targets.filter(|target| target != module).collect();
            (module.clone(), others)
        };
        self.names.iter().map(of).collect()
    }

    /// The file that defines what `module` calls `path`; `None` for another
    /// crate's and for modules as such.
    fn file_of(&self, module: &Module, path: &[String], depth: usize) -> Option<Module> {
        // A name may be passed on a few times; more than that would be a circle.
        if depth > 8 {
            return None;
        }
        let path = self.absolute(module, path)?;
        let length = (0..=path.len()).rev();
        let length = length
            .into_iter()
            .find(|length| self.paths.contains_key(&path[..*length]))?;
        let (found, rest) = path.split_at(length);
        let (found, name) = (found.to_vec(), rest.first()?);
        match self.names[&found].imported.get(name) {
            None => Some(found),
            Some(import) => {
                let further: Vec<String> = import.iter().chain(&rest[1..]).cloned().collect();
                self.file_of(&found, &further, depth + 1)
            }
        }
    }

    /// `path` as seen from `module`, from the crate's root on.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Vec<String>> {
        let (first, rest) = path.split_first()?;
        let supers = path.iter().take_while(|name| *name == "super").count();
        let (base, rest) = match first.as_str() {
            "crate" => (&[][..], rest),
            "self" => (module.as_slice(), rest),
            "super" => (
                &module[..module.len().saturating_sub(supers)],
                &path[supers..],
            ),
            _ => {
                let child = [module.as_slice(), std::slice::from_ref(first)].concat();
                let imported = self.names[module].imported.get(first);
                match imported.filter(|import| import.first() != Some(first)) {
                    _ if self.paths.contains_key(&child) => (module.as_slice(), path),
                    Some(import) => {
                        let base = self.absolute(module, import)?;
                        return Some([base.as_slice(), rest].concat());
                    }
                    None => return None,
                }
            }
        };
        Some([base, rest].concat())
    }
}

/// The module of a file, relative to the crate's sources.
fn module_of(path: &Path) -> Module {
    let mut module: Module = path
        .with_extension("")
        .iter()
        .map(|part| part.to_string_lossy().into_owned())
        .collect();
    if let Some("lib" | "main" | "mod") = module.last().map(String::as_str) {
        module.pop();
    }
    module
}

impl Names {
    fn collect(&mut self, stream: TokenStream) {
        let tokens: Vec<TokenTree> = stream.into_iter().collect();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            if let Some(end) = test_only_item(&tokens, at) {
                at = end;
                continue;
            }
            match token {
                TokenTree::Group(group) => self.collect(group.stream()),
                TokenTree::Ident(word) if word == "use" => {
                    let end = tokens[at..].iter().position(is(';'));
                    let end = at + end.unwrap_or(tokens.len() - at);
                    self.import(&tokens[at + 1..end], &[], is_public(&tokens[..at]));
                    at = end;
                }
                TokenTree::Ident(_) if !is_inside_path(&tokens, at) => {
                    let path = path_at(&tokens, at);
                    at += 3 * (path.len() - 1);
                    if path.len() > 1 {
                        self.used.push(path);
                    }
                }
                _ => {}
            }
            at += 1;
        }
    }

    /// Takes in the tree of a `use`, below `above`.
    fn import(&mut self, tokens: &[TokenTree], above: &[String], public: bool) {
        let own = path_at(tokens, 0);
        let after = match own.is_empty() {
            true => 0,
            false => 3 * own.len() - 2,
        };
        let mut path = [above, own.as_slice()].concat();
        let group = tokens.iter().find_map(|token| match token {
            TokenTree::Group(group) => Some(group),
            _ => None,
        });
        if let Some(group) = group {
            for branch in branches(group) {
                self.import(&branch, &path, public);
            }
            return;
        }
        if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
            path.pop();
        }
        let renamed = match tokens.get(after..) {
            Some([TokenTree::Ident(word), TokenTree::Ident(name), ..]) if word == "as" => {
                Some(name.to_string())
            }
            _ => None,
        };
        if let Some(name) = renamed.or_else(|| path.last().cloned()) {
            if !public {
                self.used.push(path.clone());
            }
            self.imported.insert(name, path);
        }
    }
}

/// The names of a path that begins at `at`.
fn path_at(tokens: &[TokenTree], mut at: usize) -> Vec<String> {
    let mut path = Vec::new();
    while let Some(TokenTree::Ident(name)) = tokens.get(at) {
        path.push(name.to_string());
        if !is_path_separator(tokens, at + 1) {
            break;
        }
        at += 3;
    }
    path
}

/// Whether the name at `at` goes on with a path, or is one of a macro's `$crate`.
fn is_inside_path(tokens: &[TokenTree], at: usize) -> bool {
    (at > 0 && is('$')(&tokens[at - 1])) || (at > 1 && is_path_separator(tokens, at - 2))
}

/// Whether what stands before a `use` makes it public.
fn is_public(before: &[TokenTree]) -> bool {
    match before {
        [.., TokenTree::Ident(word), TokenTree::Group(_)] | [.., TokenTree::Ident(word)] => {
            word == "pub"
        }
        _ => false,
    }
}

fn is(letter: char) -> impl Fn(&TokenTree) -> bool {
    move |token| matches!(token, TokenTree::Punct(own) if own.as_char() == letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<(PathBuf, String)> = files
            .iter()
            .map(|(path, text)| (Path::new("src").join(path), (*text).to_owned()))
            .collect();
        cycles(Path::new("src"), &files).unwrap()
    }

    #[test]
    fn finds_a_cycle_however_it_is_written() {
        for (there, back) in [
            ("use crate::b::B;", "use crate::a::A;"),
            (
                "use super::b::{self, C};",
                "use super::a::{self as other, A};",
            ),
            ("fn f() { crate::b::b() }", "type T = super::a::A;"),
            (
                "use crate::b; fn f() { b::b() }",
                "pub struct B(crate::a::A);",
            ),
            ("use crate::b::from_inner;", "use crate::{a::{A}};"),
            ("use crate::Passed;", "use crate::a::A;"),
        ] {
            let files = [
                ("lib.rs", "mod a; mod b; pub use b::Passed;"),
                ("a/mod.rs", there),
                ("b/mod.rs", back),
                ("b/inner.rs", "use super::B;"),
            ];
            let files = match there.contains("from_inner") {
                false => files,
                true => [
                    files[0],
                    files[1],
                    ("b/mod.rs", "mod inner; pub use inner::from_inner;"),
                    ("b/inner.rs", back),
                ],
            };
            let lines = found(&files);
            assert_eq!(lines.len(), 2, "{there} {back}: {lines:?}");
            assert!(lines[0].starts_with("src/a/mod.rs -> src/b/"), "{lines:?}");
        }
    }

    #[test]
    fn lets_alone_what_is_none() {
        for (there, back) in [
            ("use crate::b::B;", ""),
            (
                "use crate::b::B;",
                "#[cfg(test)] mod tests { use crate::a::A; }",
            ),
            ("use crate::b::B;", "// use crate::a::A;"),
            ("use other::b::B;", "use crate::a::A;"),
            // Of its own folder.
            ("use crate::b::B;", "use inner::B; mod inner;"),
        ] {
            let files = [
                ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
                ("a/mod.rs", there),
                ("b/mod.rs", back),
                ("b/inner.rs", "use super::C;"),
            ];
            assert_eq!(found(&files), Vec::<String>::new(), "{there} {back}");
        }
    }
}

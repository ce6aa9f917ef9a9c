//! What a source file names that a pure crate must not.
//!
//! Works on tokens, so comments and strings do not count; items under
//! `#[cfg(test)]` do not count either. It sees names, not meanings: one who
//! wants to deceive it can.

use std::str::FromStr;

use proc_macro2::{Delimiter, Group, Ident, LexError, TokenStream, TokenTree};

/// Paths in the standard library, with all below them.
const PATHS: [&str; 11] = [
    "std::env",
    "std::fs",
    "std::io::stderr",
    "std::io::stdin",
    "std::io::stdout",
    "std::net",
    "std::os",
    "std::process",
    "std::thread",
    "std::time::Instant",
    "std::time::SystemTime",
];

/// Paths that hide what is used; allowed is only what they contain by name.
const WHOLES: [&str; 4] = ["std::*", "std::time", "std::time::*", "std::time::self"];

/// Names of randomness that nobody passed in.
const NAMES: [&str; 7] = [
    "OsRng",
    "SysRng",
    "ThreadRng",
    "from_entropy",
    "from_os_rng",
    "thread_rng",
    "getrandom",
];

/// Paths of the same.
const RANDOM: [&str; 3] = ["rand::rng", "rand::random", "rand::*"];

/// Keywords that a path may follow.
const KEYWORDS: [&str; 12] = [
    "as", "break", "dyn", "else", "if", "impl", "in", "match", "mut", "return", "use", "while",
];

/// One place where a source names what it must not.
#[derive(Debug, PartialEq, Eq)]
pub struct Impurity {
    /// From 1.
    pub line: usize,
    /// What it names, in full.
    pub name: String,
}

/// Everything impure in a source text, in order.
pub fn impurities(text: &str) -> Result<Vec<Impurity>, LexError> {
    let mut found = Vec::new();
    walk(TokenStream::from_str(text)?, &mut found);
    Ok(found)
}

fn walk(stream: TokenStream, found: &mut Vec<Impurity>) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        if let Some(end) = test_only_item(&tokens, at) {
            at = end;
            continue;
        }
        match token {
            TokenTree::Group(group) => walk(group.stream(), found),
            TokenTree::Ident(ident) => {
                if NAMES.iter().any(|name| ident == name) {
                    report(ident, ident.to_string(), found);
                }
                if (ident == "std" || ident == "rand") && !is_inside_path(&tokens, at) {
                    paths(&tokens, at, String::new(), found);
                }
            }
            _ => {}
        }
        at += 1;
    }
}

/// Whether the name at `at` belongs to the one before it, as `std` does in `own::std` (but not
/// in `::std` or `use ::std`).
fn is_inside_path(tokens: &[TokenTree], at: usize) -> bool {
    if at < 3 || !is_path_separator(tokens, at - 2) {
        return false;
    }
    match &tokens[at - 3] {
        TokenTree::Ident(before) => !KEYWORDS.iter().any(|keyword| before == keyword),
        _ => false,
    }
}

/// Follows a path, through the braces of a `use`, and reports what is impure.
fn paths(tokens: &[TokenTree], mut at: usize, mut path: String, found: &mut Vec<Impurity>) {
    let mut last: Option<&Ident> = None;
    loop {
        match tokens.get(at) {
            Some(TokenTree::Ident(ident)) => {
                path.push_str(&ident.to_string());
                last = Some(ident);
            }
            Some(TokenTree::Punct(star)) if star.as_char() == '*' && !path.is_empty() => {
                path.push('*');
                if let Some(TokenTree::Punct(star)) = tokens.get(at) {
                    check(star.span().start().line, path, found);
                }
                return;
            }
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                for branch in branches(group) {
                    paths(&branch, 0, path.clone(), found);
                }
                return;
            }
            _ => break,
        }
        if !is_path_separator(tokens, at + 1) {
            break;
        }
        path.push_str("::");
        at += 3;
    }
    if let Some(ident) = last {
        check(
            ident.span().start().line,
            path.trim_end_matches("::").to_owned(),
            found,
        );
    }
}

fn check(line: usize, name: String, found: &mut Vec<Impurity>) {
    let below = |whole: &str| {
        name == whole
            || name
                .strip_prefix(whole)
                .is_some_and(|rest| rest.starts_with("::"))
    };
    if PATHS.iter().any(|path| below(path))
        || RANDOM.iter().any(|path| below(path))
        || WHOLES.contains(&name.as_str())
    {
        found.push(Impurity { line, name });
    }
}

fn report(ident: &Ident, name: String, found: &mut Vec<Impurity>) {
    found.push(Impurity {
        line: ident.span().start().line,
        name,
    });
}

/// Whether `::` stands at `at`.
pub fn is_path_separator(tokens: &[TokenTree], at: usize) -> bool {
    matches!(
        (tokens.get(at), tokens.get(at + 1)),
        (Some(TokenTree::Punct(one)), Some(TokenTree::Punct(two)))
            if one.as_char() == ':' && two.as_char() == ':'
    )
}

/// The parts between commas.
pub fn branches(group: &Group) -> Vec<Vec<TokenTree>> {
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    tokens
        .split(|token| matches!(token, TokenTree::Punct(comma) if comma.as_char() == ','))
        .map(<[TokenTree]>::to_vec)
        .collect()
}

/// If an item under `#[cfg(test)]` begins at `at`, where it ends.
pub fn test_only_item(tokens: &[TokenTree], at: usize) -> Option<usize> {
    if !is_cfg_test(tokens.get(at)?, tokens.get(at + 1)?) {
        return None;
    }
    let body = tokens[at..].iter().position(|token| match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(end) => end.as_char() == ';',
        _ => false,
    })?;
    Some(at + body + 1)
}

/// Whether two tokens are `#` and `[cfg(test)]`, or `[cfg(all(test, …))]`.
pub fn is_cfg_test(hash: &TokenTree, attribute: &TokenTree) -> bool {
    let (TokenTree::Punct(hash), TokenTree::Group(attribute)) = (hash, attribute) else {
        return false;
    };
    let words: String = attribute
        .stream()
        .to_string()
        .chars()
        .filter(|letter| !letter.is_whitespace())
        .collect();
    hash.as_char() == '#' && (words == "cfg(test)" || words.starts_with("cfg(all(test,"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        let found = impurities(text).unwrap();
        found.into_iter().map(|impurity| impurity.name).collect()
    }

    #[test]
    fn finds_what_is_named_in_full_and_in_use() {
        for (text, name) in [
            (
                "fn f() { let t = std::time::Instant::now(); }",
                "std::time::Instant::now",
            ),
            (
                "use std::time::{Duration, SystemTime};",
                "std::time::SystemTime",
            ),
            ("use std::{fmt, fs::{self, File}};", "std::fs::self"),
            ("use std::{collections::HashMap, net};", "std::net"),
            ("use ::std::thread as t;", "std::thread"),
            ("fn f() { ::std::process::exit(1) }", "std::process::exit"),
            (
                "fn f() -> Option<std::env::Args> { None }",
                "std::env::Args",
            ),
            (
                "macro_rules! m { () => { std::fs::read(\"\") } }",
                "std::fs::read",
            ),
            ("use std::time;", "std::time"),
            ("use std::time::*;", "std::time::*"),
            ("use std::*;", "std::*"),
            ("use std::io::stdout;", "std::io::stdout"),
            ("fn f() -> f64 { rand::rng().random() }", "rand::rng"),
            ("fn f() { let r = thread_rng(); }", "thread_rng"),
            (
                "#[cfg(not(test))] fn f() { std::fs::read(\"\"); }",
                "std::fs::read",
            ),
        ] {
            assert!(
                names(text).contains(&name.to_owned()),
                "{text}: {:?}",
                names(text)
            );
        }
    }

    #[test]
    fn leaves_alone_what_is_pure() {
        for text in [
            "use std::{fmt, time::Duration, marker::PhantomData};",
            "// std::time::Instant\n/* std::fs */ fn f() {}",
            "/// Not a [`std::time::Instant`].\nfn f() {}",
            "const WORDS: &str = \"std::fs::read\";",
            "const WORDS: &str = r#\"use std::net;\"#;",
            "fn f() { own::std::fs::read(); fs::read(); let thread = 1; }",
            "use std::io::Write; use std::timer; use std::threads::x;",
            "use rand_pcg::Pcg64Mcg; use rand::Rng;",
            "#[cfg(test)] mod tests { use std::fs; fn f() { std::env::var(\"\"); } }",
            "#[cfg(test)]\n#[allow(dead_code)]\nfn f() { std::fs::read(\"\"); }",
            "#[cfg(test)] use std::fs;",
        ] {
            assert_eq!(names(text), Vec::<String>::new(), "{text}");
        }
    }

    #[test]
    fn goes_on_after_a_test_module() {
        let text = "#[cfg(test)] mod tests { use std::fs; }\nmod other { use std::net; }";
        assert_eq!(
            impurities(text).unwrap(),
            [Impurity {
                line: 2,
                name: "std::net".into()
            }]
        );
        assert_eq!(names("#[cfg(test)] mod tests;\nuse std::fs;"), ["std::fs"]);
    }

    #[test]
    fn refuses_what_is_no_rust() {
        assert!(impurities("fn f( {").is_err());
    }
}

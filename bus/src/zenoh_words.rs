//! What Zenoh says of an error, for people.

use std::fmt;

/// The words without the places in source files that Zenoh adds, " at /…/utils.rs:523": they are
/// of the computer on which it was compiled, and say nothing of the cause.
pub(crate) fn words(error: impl fmt::Display) -> String {
    let text = error.to_string();
    let mut words = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some((before, after)) = rest.split_once(" at ") {
        words.push_str(before);
        match place(after) {
            Some(length) => rest = after.get(length..).unwrap_or_default(),
            None => {
                words.push_str(" at ");
                rest = after;
            }
        }
    }
    words.push_str(rest);
    words.trim_end().to_owned()
}

/// How long the place is that `text` begins with: `FILE.rs:LINE`.
fn place(text: &str) -> Option<usize> {
    let (file, after) = text.split_once(".rs:")?;
    if file.contains([' ', '\n']) {
        return None;
    }
    let digits = after.chars().take_while(char::is_ascii_digit).count();
    (digits > 0).then_some(file.len() + ".rs:".len() + digits)
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn places_in_source_files_are_left_out_and_causes_stay() {
        let text = "Unable to open listener at /home/me/.cargo/registry/src/index-1/zenoh-1.5/src/net/utils.rs:523. - \
                    Caused by: address in use at src/tcp.rs:7.";
        let expected = "Unable to open listener. - Caused by: address in use.";
        assert_eq!(words(text), expected);
        for whole in [
            "nothing listens at tcp/localhost:7447",
            "read at a.rs and at b.rs: no",
            "",
        ] {
            assert_eq!(words(whole), whole);
        }
    }
}

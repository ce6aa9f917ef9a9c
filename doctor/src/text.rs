//! The report as a person reads it.

use std::fmt::{self, Display, Formatter};

use super::report::{Report, Status};

/// The report as aligned text; see [`Report::text`].
#[derive(Clone, Copy, Debug)]
pub struct ReportText<'a> {
    report: &'a Report,
    colour: bool,
}

impl Report {
    /// The report as aligned text, one check after the other, then the counts.
    /// Colour only where a terminal shows it.
    pub fn text(&self, colour: bool) -> ReportText<'_> {
        ReportText {
            report: self,
            colour,
        }
    }
}

/// Without colour.
impl Display for Report {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        self.text(false).fmt(formatter)
    }
}

impl Display for ReportText<'_> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let checks = &self.report.checks;
        let lengths = checks.iter().map(|check| check.title.chars().count());
        let width = lengths.max().unwrap_or(0);
        let indent = " ".repeat(2 + 4 + 2 + width + 2);
        for check in checks {
            let (word, paint) = match check.status {
                Status::Ok => ("ok  ", "\x1b[32m"),
                Status::Warn => ("warn", "\x1b[33m"),
                Status::Fail => ("FAIL", "\x1b[1;31m"),
            };
            let (begin, end) = self.paint(paint);
            write!(formatter, "  {begin}{word}{end}  {:<width$}  ", check.title)?;
            for (index, line) in check.found.lines().enumerate() {
                let before = if index == 0 { "" } else { &indent };
                writeln!(formatter, "{before}{}", printable(line))?;
            }
            if check.found.is_empty() {
                writeln!(formatter)?;
            }
            let (begin, end) = self.paint("\x1b[36m");
            for line in check.mend.iter().flat_map(|mend| mend.lines()) {
                writeln!(formatter, "{indent}{begin}→ {}{end}", printable(line))?;
            }
        }
        let count = |status| self.report.count(status);
        writeln!(
            formatter,
            "{} ok, {} warn, {} fail",
            count(Status::Ok),
            count(Status::Warn),
            count(Status::Fail)
        )
    }
}

impl ReportText<'_> {
    fn paint(&self, code: &'static str) -> (&'static str, &'static str) {
        if self.colour {
            (code, "\x1b[0m")
        } else {
            ("", "")
        }
    }
}

/// Names come from other processes and hosts: none may steer the terminal.
fn printable(line: &str) -> String {
    let keep = |character: char| {
        if character.is_control() {
            char::REPLACEMENT_CHARACTER
        } else {
            character
        }
    };
    line.chars().map(keep).collect()
}

/// A word that a shell takes as it is; names are anybody's.
pub(super) fn quoted(word: &str) -> String {
    let plain = |character: char| character.is_ascii_alphanumeric() || "._-/".contains(character);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::report::Check;
    use super::*;

    fn report() -> Report {
        Report {
            checks: vec![
                Check::ok("kernel", "Kernel", "Linux 6.1"),
                Check::ok("ports", "TCP ports", "").warn("one\x1b[2Jtwo\nthree", "stop it"),
            ],
        }
    }

    #[test]
    fn columns_line_up_and_nothing_steers_the_terminal() {
        let expected = "  ok    Kernel     Linux 6.1\n  \
            warn  TCP ports  one\u{fffd}[2Jtwo\n                   three\n                   \
            → stop it\n1 ok, 1 warn, 0 fail\n";
        assert_eq!(report().to_string(), expected);
    }

    #[test]
    fn colour_is_there_only_when_asked_for() {
        assert!(!report().text(false).to_string().contains('\x1b'));
        let coloured = report().text(true).to_string();
        assert!(coloured.contains("\x1b[33mwarn\x1b[0m"));
        assert!(!coloured.contains("\x1b[2J"));
    }

    #[test]
    fn a_word_stays_one_word_in_a_shell() {
        assert_eq!(quoted("/data/s-1.x"), "/data/s-1.x");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}

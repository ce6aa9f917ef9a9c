//! A line cut into fields.

/// What separates the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// A tabulator.
    Tab,
    /// A semicolon.
    Semicolon,
    /// A comma.
    Comma,
    /// Any number of blanks and tabulators.
    Blank,
}

impl Separator {
    /// In the order in which they are preferred where several would do.
    pub const ALL: [Separator; 4] = [
        Separator::Tab,
        Separator::Semicolon,
        Separator::Comma,
        Separator::Blank,
    ];

    /// Whether a comma within a field is a decimal one.
    #[must_use]
    pub const fn decimal_comma(self) -> bool {
        !matches!(self, Separator::Comma)
    }

    const fn sign(self) -> char {
        match self {
            Separator::Tab => '\t',
            Separator::Semicolon => ';',
            Separator::Comma => ',',
            Separator::Blank => ' ',
        }
    }

    /// The fields of `line`, blanks and quotation marks around them taken off.
    #[must_use]
    pub fn fields(self, line: &str) -> Fields<'_> {
        let line = match self {
            Separator::Blank => line.trim(),
            _ => line.trim_end_matches(['\r', '\n']),
        };
        Fields {
            rest: Some(line),
            separator: self,
        }
    }
}

/// The fields of a line, one after the other.
#[derive(Clone, Debug)]
pub struct Fields<'a> {
    rest: Option<&'a str>,
    separator: Separator,
}

impl<'a> Iterator for Fields<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest?;
        let separator = self.separator;
        let quoted = rest.trim_start_matches(' ').strip_prefix('"');
        if let Some(inside) = quoted
            && let Some((field, behind)) = inside.split_once('"')
        {
            self.rest = behind
                .find(separator.sign())
                .and_then(|at| behind.get(at + 1..));
            return Some(field.trim());
        }
        if separator == Separator::Blank {
            let (field, behind) = match rest.find([' ', '\t']) {
                Some(at) => rest.split_at(at),
                None => (rest, ""),
            };
            let behind = behind.trim_start();
            self.rest = (!behind.is_empty()).then_some(behind);
            return Some(field);
        }
        match rest.split_once(separator.sign()) {
            Some((field, behind)) => {
                self.rest = Some(behind);
                Some(field.trim())
            }
            None => {
                self.rest = None;
                Some(rest.trim())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_what_is_between_separators() {
        let fields = |separator: Separator, line| separator.fields(line).collect::<Vec<&str>>();
        assert_eq!(
            fields(Separator::Comma, "1, 2 ,,x\r\n"),
            ["1", "2", "", "x"]
        );
        assert_eq!(
            fields(Separator::Comma, "\"a,b\",\"c\" ,d"),
            ["a,b", "c", "d"]
        );
        assert_eq!(
            fields(Separator::Blank, "  1.0 \t 2   3\n"),
            ["1.0", "2", "3"]
        );
        assert_eq!(fields(Separator::Tab, "1\t\t3"), ["1", "", "3"]);
        assert_eq!(fields(Separator::Semicolon, "\"open;1"), ["\"open", "1"]);
        assert_eq!(fields(Separator::Semicolon, "1;2;"), ["1", "2", ""]);
    }
}

//! How a text file writes its table, found from its beginning.

use super::{
    number::{Cell, cell},
    split::Separator,
};
use crate::unit::Unit;

/// How a text file writes its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Dialect {
    /// What separates the columns.
    pub separator: Separator,
    /// The columns' names; `column_1` and so on where the file has none.
    pub names: Vec<String>,
    /// Whether the names stand in the file.
    pub named: bool,
    /// What a line of units below the names says of each column.
    pub units: Vec<Option<String>>,
    /// The line of the first row, counted from 1.
    pub first_row: u64,
    /// Mean length of a row \[bytes\].
    pub row_bytes: f64,
    /// Whether the last column is nothing but what stands behind a separator at a row's end:
    /// it has neither a name nor a value.
    pub last_is_empty: bool,
}

/// Whether a line is a comment.
#[must_use]
pub fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with(['#', '%'])
}

struct Line<'a> {
    number: u64,
    text: &'a str,
}

/// What the lines of a file look like to one separator.
struct Look {
    separator: Separator,
    /// The first row, as an index of the lines with content.
    first: usize,
    /// Fields of a row.
    fields: usize,
    /// Numbers in all rows, less what is neither number nor missing.
    score: i64,
}

/// How the file that begins with `head` (whole lines) writes its table; `None`
/// where there is no line with content.
#[must_use]
pub fn of_head(head: &str) -> Option<Dialect> {
    let lines = (1..).zip(head.lines());
    let lines = lines.map(|(number, text)| Line { number, text });
    let (comments, content): (Vec<Line<'_>>, Vec<Line<'_>>) = lines
        .filter(|line| !line.text.trim().is_empty())
        .partition(|line| is_comment(line.text));
    let looks = Separator::ALL
        .iter()
        .filter_map(|&each| look(&content, each));
    // The first of equals.
    let best = looks.reduce(|best, other| match other.score > best.score {
        true => other,
        false => best,
    });
    let Some(best) = best else {
        return without_rows(&content);
    };
    let first = content.get(best.first)?;
    let rows = content.get(best.first..)?;
    let bytes: usize = rows.iter().map(|line| line.text.len() + 1).sum();
    let (names, mut units) = names(&content, &comments, &best);
    let named = names.is_some();
    let mut names = names.unwrap_or_default();
    let last = best.fields.saturating_sub(1);
    let has_value = |line: &Line<'_>| {
        let mut fields = best.separator.fields(line.text);
        fields.nth(last).is_some_and(|field| !field.is_empty())
    };
    // One more value than names: what numbers the rows has none, as R and pandas write it.
    if named && names.len() == last && rows.iter().all(has_value) {
        names.insert(0, String::new());
        units.insert(0, None);
    }
    let last_is_empty = names.get(last).is_none_or(String::is_empty) && !rows.iter().any(has_value);
    Some(Dialect {
        separator: best.separator,
        names: filled(names, best.fields),
        named,
        units: (0..best.fields)
            .map(|at| units.get(at).cloned().flatten())
            .collect(),
        first_row: first.number,
        row_bytes: bytes as f64 / rows.len().max(1) as f64,
        last_is_empty,
    })
}

/// No line is a row: the first one has the names.
fn without_rows(content: &[Line<'_>]) -> Option<Dialect> {
    let line = content.first()?;
    let separator = [Separator::Tab, Separator::Semicolon, Separator::Comma]
        .into_iter()
        .max_by_key(|separator| separator.fields(line.text).count())?;
    let names: Vec<String> = separator.fields(line.text).map(str::to_owned).collect();
    Some(Dialect {
        separator,
        units: vec![None; names.len()],
        names: filled(names, 0),
        named: true,
        first_row: line.number + 1,
        row_bytes: line.text.len() as f64 + 1.0,
        last_is_empty: false,
    })
}

/// As many names as columns, none empty.
fn filled(mut names: Vec<String>, columns: usize) -> Vec<String> {
    names.resize(columns.max(names.len()), String::new());
    for (number, name) in (1..).zip(&mut names) {
        if name.is_empty() {
            *name = format!("column_{number}");
        }
    }
    names
}

/// Numbers, missing ones and other fields of a line.
fn count(line: &str, separator: Separator) -> [usize; 3] {
    let mut counts = [0; 3];
    for field in separator.fields(line) {
        match cell(field, separator.decimal_comma()) {
            Cell::Number(_) => counts[0] += 1,
            Cell::Missing => counts[1] += 1,
            Cell::Text(_) => counts[2] += 1,
        }
    }
    counts
}

/// A row has a number, and no more words than numbers and holes.
fn is_row([numbers, missing, words]: [usize; 3]) -> bool {
    numbers >= 1 && numbers + missing >= words
}

fn look(content: &[Line<'_>], separator: Separator) -> Option<Look> {
    let counts: Vec<[usize; 3]> = content
        .iter()
        .map(|line| count(line.text, separator))
        .collect();
    let fields = |counts: &[usize; 3]| counts.iter().sum::<usize>();
    let first = (0..counts.len()).find(|&at| {
        let (Some(own), next) = (counts.get(at), counts.get(at + 1)) else {
            return false;
        };
        let goes_on = next.is_none_or(|next| is_row(*next) && fields(next) == fields(own));
        // The last line may be cut off.
        let goes_on = goes_on || (at == 1 && counts.len() == 3);
        is_row(*own) && goes_on
    })?;
    let width = counts.get(first).map_or(0, fields);
    let rows = counts.iter().skip(first).filter(|own| fields(own) == width);
    let score = rows.map(|own| own[0] as i64 - own[2] as i64).sum();
    Some(Look {
        separator,
        first,
        fields: width,
        score,
    })
}

type Names = (Option<Vec<String>>, Vec<Option<String>>);

/// Names and units of the columns from the lines before the first row, or from
/// the comment before it.
fn names(content: &[Line<'_>], comments: &[Line<'_>], look: &Look) -> Names {
    let fields_of = |line: &Line<'_>, separator: Separator| -> Vec<String> {
        let text = line.text.trim_start_matches(['#', '%', ' ']);
        separator.fields(text).map(str::to_owned).collect()
    };
    // A row may end with a separator that the names do not have.
    let fits = |names: &Vec<String>| {
        let words = names.iter().filter(|name| !name.is_empty()).count();
        words > 0 && (names.len() == look.fields || names.len() + 1 == look.fields)
    };
    let above: Vec<Vec<String>> = content
        .iter()
        .take(look.first)
        .rev()
        .map(|line| fields_of(line, look.separator))
        .take_while(fits)
        .collect();
    match above.as_slice() {
        [units, names, ..] if units.iter().all(|text| is_unit(text)) => {
            let units = units.iter().map(|text| unit_in(text)).collect();
            return (Some(names.clone()), units);
        }
        [names, ..] => return (Some(names.clone()), Vec::new()),
        [] => {}
    }
    let Some(row) = content.get(look.first) else {
        return (None, Vec::new());
    };
    let comment = comments.iter().rfind(|line| line.number < row.number);
    let of_comment = comment.and_then(|line| {
        let separators = [look.separator, Separator::Comma, Separator::Blank];
        let mut tried = separators.iter().map(|&each| fields_of(line, each));
        tried.find(|names| {
            let is_word = |name: &String| matches!(cell(name, true), Cell::Text(_));
            names.len() == look.fields && look.fields > 1 && names.iter().all(is_word)
        })
    });
    (of_comment, Vec::new())
}

/// Whether a field of a line below the names can be a unit.
fn is_unit(text: &str) -> bool {
    text.is_empty() || text == "-" || unit_in(text).is_some()
}

/// `[deg]`, `(deg)` or `deg`.
fn unit_in(text: &str) -> Option<String> {
    let inner = text.trim_matches(['[', ']', '(', ')', '<', '>', ' ']);
    Unit::parse(inner).map(|unit| unit.name().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialect(head: &str) -> (Separator, Vec<String>, bool, u64) {
        let found = of_head(head).unwrap();
        (found.separator, found.names, found.named, found.first_row)
    }

    #[test]
    fn separators_names_and_the_first_row_are_found() {
        use Separator::{Blank, Comma, Semicolon, Tab};
        for (head, separator, names, named, first) in [
            ("t,q\n0,1\n1,2\n", Comma, "t q", true, 2),
            ("t;q\n0,5;1,5\n1,5;2,5\n", Semicolon, "t q", true, 2),
            ("0,5 1,2\n0,6 1,3\n", Blank, "column_1 column_2", false, 1),
            ("0,5\t1,2\n0,6\t1,3\n", Tab, "column_1 column_2", false, 1),
            (
                "0, 1, 2\n1, 2, 3\n",
                Comma,
                "column_1 column_2 column_3",
                false,
                1,
            ),
            ("# t q\n  0.0   1\n  0.1   2\n", Blank, "t q", true, 2),
            ("% my rig\n% t, q\n0,1\n", Comma, "t q", true, 3),
            ("% my rig\n0 1\n1 1\n", Blank, "my rig", true, 2),
            (
                "Rig;3\nDate;today\n\nt;q;i\n0;1;2\n1;1;2\n",
                Semicolon,
                "t q i",
                true,
                5,
            ),
            ("t,q,state\n0,1,run\n1,1,run\n", Comma, "t q state", true, 2),
            ("t,q\n0,\n1,\n", Comma, "t q", true, 2),
            ("t,q\n0,1,\n1,2,\n", Comma, "t q column_3", true, 2),
            (
                "\"t\" \"q\"\n\"1\" 0 1\n\"2\" 1 2\n",
                Blank,
                "column_1 t q",
                true,
                2,
            ),
            ("t,q\nx,y\n", Comma, "t q", true, 2),
        ] {
            let names: Vec<String> = names.split(' ').map(str::to_owned).collect();
            assert_eq!(dialect(head), (separator, names, named, first), "{head}");
        }
        assert_eq!(of_head("# nothing\n\n"), None);
    }

    #[test]
    fn a_line_of_units_is_read() {
        let found = of_head("t,q,i,x\n[ms],[deg],A,-\n0,1,2,3\n1,2,3,4\n").unwrap();
        let units: Vec<Option<&str>> = found.units.iter().map(Option::as_deref).collect();
        assert_eq!(units, [Some("ms"), Some("deg"), Some("A"), None]);
        assert_eq!((found.first_row, found.names[1].as_str()), (3, "q"));
    }
}

//! Values of a column, as a page holds them.

use super::thrift::varint;

/// A column, or what kind of one.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Whole numbers.
    Long(Vec<i64>),
    /// Numbers of 32 bits.
    Float(Vec<f32>),
    /// Numbers of 64 bits.
    Double(Vec<f64>),
    /// Texts.
    Text(Vec<String>),
    /// A list of numbers of 32 bits a row.
    Floats(Vec<Vec<f32>>),
    /// A list of numbers of 64 bits a row.
    Doubles(Vec<Vec<f64>>),
    /// A list of texts a row.
    Texts(Vec<Vec<String>>),
}

impl Column {
    /// Rows.
    pub fn rows(&self) -> usize {
        match self {
            Column::Long(own) => own.len(),
            Column::Float(own) => own.len(),
            Column::Double(own) => own.len(),
            Column::Text(own) => own.len(),
            Column::Floats(own) => own.len(),
            Column::Doubles(own) => own.len(),
            Column::Texts(own) => own.len(),
        }
    }

    /// The format's number of the kind of a value.
    pub fn kind(&self) -> i32 {
        match self {
            Column::Long(_) => 2,
            Column::Float(_) | Column::Floats(_) => 4,
            Column::Double(_) | Column::Doubles(_) => 5,
            Column::Text(_) | Column::Texts(_) => 6,
        }
    }

    /// Whether values are texts.
    pub fn is_text(&self) -> bool {
        matches!(self, Column::Text(_) | Column::Texts(_))
    }

    /// Whether a row has a list.
    pub fn is_list(&self) -> bool {
        self.lengths().is_some()
    }

    /// Where its values stand in the schema.
    pub fn path<'a>(&self, name: &'a str) -> Vec<&'a str> {
        match self.is_list() {
            true => vec![name, "list", "element"],
            false => vec![name],
        }
    }

    /// Values, and empty lists.
    pub fn leaves(&self) -> usize {
        match self.lengths() {
            None => self.rows(),
            Some(lengths) => lengths.iter().map(|length| (*length).max(1)).sum(),
        }
    }

    fn lengths(&self) -> Option<Vec<usize>> {
        match self {
            Column::Floats(own) => Some(own.iter().map(Vec::len).collect()),
            Column::Doubles(own) => Some(own.iter().map(Vec::len).collect()),
            Column::Texts(own) => Some(own.iter().map(Vec::len).collect()),
            _ => None,
        }
    }

    /// The bytes of a page with all of them: of lists the levels first, which say where a
    /// list begins and whether it has anything.
    pub fn page(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        if let Some(lengths) = self.lengths() {
            // 0 begins a list, 1 goes on with it.
            let repetition = lengths.iter().flat_map(|length| {
                let rest = length.saturating_sub(1);
                [(1, 0), (rest, 1)]
            });
            levels(&mut bytes, repetition);
            // 1 where there is a value, 0 where the list is empty.
            let definition = lengths
                .iter()
                .map(|length| ((*length).max(1), u8::from(*length > 0)));
            levels(&mut bytes, definition);
        }
        match self {
            Column::Long(own) => own.iter().for_each(|v| bytes.extend(v.to_le_bytes())),
            Column::Float(own) => own.iter().for_each(|v| bytes.extend(v.to_le_bytes())),
            Column::Double(own) => own.iter().for_each(|v| bytes.extend(v.to_le_bytes())),
            Column::Text(own) => own.iter().for_each(|v| text(&mut bytes, v)),
            Column::Floats(own) => own
                .iter()
                .flatten()
                .for_each(|v| bytes.extend(v.to_le_bytes())),
            Column::Doubles(own) => own
                .iter()
                .flatten()
                .for_each(|v| bytes.extend(v.to_le_bytes())),
            Column::Texts(own) => own.iter().flatten().for_each(|v| text(&mut bytes, v)),
        }
        bytes
    }
}

fn text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
}

/// Levels of one bit as runs of equal ones, each with its length, behind their length in
/// bytes.
fn levels(bytes: &mut Vec<u8>, runs: impl Iterator<Item = (usize, u8)>) {
    let mut encoded = Vec::new();
    let mut put = |(length, level): (usize, u8)| {
        if length > 0 {
            varint(&mut encoded, (length as u64) << 1);
            encoded.push(level);
        }
    };
    let mut last = (0, 0);
    for (length, level) in runs {
        match level == last.1 {
            true => last.0 += length,
            false => {
                // A run of no length is none.
                if length > 0 {
                    put(last);
                    last = (length, level);
                }
            }
        }
    }
    put(last);
    bytes.extend((encoded.len() as u32).to_le_bytes());
    bytes.extend(encoded);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_stand_behind_the_levels_that_say_where_they_begin() {
        let column = Column::Floats(vec![vec![1.0, 2.0, 3.0], Vec::new(), vec![4.0]]);
        assert_eq!((column.rows(), column.leaves()), (3, 5));
        let page = column.page();
        // Begins, goes on twice, begins twice: runs of 1, 2 and 2.
        assert_eq!(page[..10], [6, 0, 0, 0, 2, 0, 4, 1, 4, 0]);
        // Three values, nothing, one value.
        assert_eq!(page[10..20], [6, 0, 0, 0, 6, 1, 2, 0, 2, 1]);
        assert_eq!(page[20..24], 1.0_f32.to_le_bytes());
        assert_eq!(page.len(), 20 + 4 * 4);
    }
}

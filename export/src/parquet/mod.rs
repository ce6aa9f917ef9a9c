//! Tables as Apache Parquet, as much of the format as they need: columns without gaps of
//! whole numbers, floating-point numbers and texts, and lists of these; plain encoding,
//! gzip, one page a column and row group.
//!
//! After the format's specification (parquet-format 2.10: `parquet.thrift`,
//! `Encodings.md`, `LogicalTypes.md`).

mod column;
mod thrift;

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use super::table::{Table, rows};
use thrift::Struct;

pub use column::Column;

/// Rows of a group, at most.
const GROUP: usize = 1 << 18;
const MAGIC: &[u8] = b"PAR1";

/// A page of data.
const DATA_PAGE: i32 = 0;
const PLAIN: i32 = 0;
const RLE: i32 = 3;
const GZIP: i32 = 2;
const REQUIRED: i32 = 0;
const REPEATED: i32 = 2;

/// Writes a file, group by group.
pub struct Writer<W: Write> {
    sink: W,
    written: u64,
    /// Name and kind of each column.
    schema: Vec<(String, Column)>,
    groups: Vec<Struct>,
    rows: usize,
}

/// Writes `table`, all of whose columns are numbers, to the file at `path`.
///
/// # Errors
///
/// What the system says.
pub fn write_numbers(path: &Path, table: &Table) -> io::Result<()> {
    let schema = table
        .iter()
        .map(|own| (own.name.clone(), Column::Double(Vec::new())));
    let mut writer = Writer::new(BufWriter::new(File::create(path)?), schema.collect())?;
    let all = rows(table);
    let mut from = 0;
    while from < all {
        let to = (from + GROUP).min(all);
        let group = table.iter().map(|own| {
            let values = own.values.get(from..to).unwrap_or_default();
            Column::Double(values.to_vec())
        });
        writer.group(&group.collect::<Vec<_>>())?;
        from = to;
    }
    writer.finish(&[])
}

impl<W: Write> Writer<W> {
    /// Begins a file with columns of these names and kinds (their values count for
    /// nothing).
    ///
    /// # Errors
    ///
    /// What the system says.
    pub fn new(mut sink: W, schema: Vec<(String, Column)>) -> io::Result<Writer<W>> {
        sink.write_all(MAGIC)?;
        Ok(Writer {
            sink,
            written: MAGIC.len() as u64,
            schema,
            groups: Vec::new(),
            rows: 0,
        })
    }

    /// Writes a group of rows: the columns in the order of the schema.
    ///
    /// # Errors
    ///
    /// What the system says.
    pub fn group(&mut self, columns: &[Column]) -> io::Result<()> {
        let rows = columns.first().map_or(0, Column::rows);
        let mut chunks = Vec::new();
        let mut bytes = 0;
        let names: Vec<String> = self.schema.iter().map(|(name, _)| name.clone()).collect();
        for (name, column) in names.iter().zip(columns) {
            let page = column.page();
            let packed = gzip(&page)?;
            let mut data = Struct::default();
            data.int(1, column.leaves() as i32)
                .int(2, PLAIN)
                .int(3, RLE)
                .int(4, RLE);
            let mut header = Struct::default();
            header
                .int(1, DATA_PAGE)
                .int(2, page.len() as i32)
                .int(3, packed.len() as i32)
                .inner(5, data);
            let header = header.bytes();
            let at = self.written;
            self.put(&header)?;
            self.put(&packed)?;
            let whole = (header.len() + page.len()) as i64;
            let mut about = Struct::default();
            about
                .int(1, column.kind())
                .ints(2, &[PLAIN, RLE])
                .texts(3, &column.path(name))
                .int(4, GZIP)
                .long(5, column.leaves() as i64)
                .long(6, whole)
                .long(7, (header.len() + packed.len()) as i64)
                .long(9, at as i64);
            let mut chunk = Struct::default();
            chunk.long(2, at as i64).inner(3, about);
            chunks.push(chunk);
            bytes += whole;
        }
        let mut group = Struct::default();
        group.list(1, &chunks).long(2, bytes).long(3, rows as i64);
        self.groups.push(group);
        self.rows += rows;
        Ok(())
    }

    /// Ends the file; `metadata` are texts by key.
    ///
    /// # Errors
    ///
    /// What the system says.
    pub fn finish(mut self, metadata: &[(&str, String)]) -> io::Result<()> {
        let mut root = Struct::default();
        root.text(4, "schema").int(5, self.schema.len() as i32);
        let mut schema = vec![root];
        for (name, column) in &self.schema {
            schema.extend(elements(name, column));
        }
        let pairs: Vec<Struct> = metadata
            .iter()
            .map(|(key, value)| {
                let mut pair = Struct::default();
                pair.text(1, key).text(2, value);
                pair
            })
            .collect();
        let mut footer = Struct::default();
        footer
            .int(1, 2)
            .list(2, &schema)
            .long(3, self.rows as i64)
            .list(4, &self.groups);
        if !pairs.is_empty() {
            footer.list(5, &pairs);
        }
        footer.text(6, concat!("ferntast version ", env!("CARGO_PKG_VERSION")));
        let footer = footer.bytes();
        self.put(&footer)?;
        self.put(&(footer.len() as u32).to_le_bytes())?;
        self.put(MAGIC)?;
        self.sink.flush()
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.written += bytes.len() as u64;
        self.sink.write_all(bytes)
    }
}

/// A column in the schema: itself, or the three levels of a list.
fn elements(name: &str, column: &Column) -> Vec<Struct> {
    let leaf = |name: &str| {
        let mut leaf = Struct::default();
        leaf.int(1, column.kind()).int(3, REQUIRED).text(4, name);
        if column.is_text() {
            // UTF8, as before and after there were logical types.
            let mut logical = Struct::default();
            logical.inner(1, Struct::default());
            leaf.int(6, 0).inner(10, logical);
        }
        leaf
    };
    if !column.is_list() {
        return vec![leaf(name)];
    }
    let mut logical = Struct::default();
    logical.inner(3, Struct::default());
    let mut outer = Struct::default();
    outer
        .int(3, REQUIRED)
        .text(4, name)
        .int(5, 1)
        .int(6, 3)
        .inner(10, logical);
    let mut middle = Struct::default();
    middle.int(3, REPEATED).text(4, "list").int(5, 1);
    vec![outer, middle, leaf("element")]
}

fn gzip(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::new(4));
    packer.write_all(bytes)?;
    packer.finish()
}

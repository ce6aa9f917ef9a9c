//! Tables as CSV: decimal point, commas, a line of names; no number where there is none.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use super::table::{Table, rows};

/// Writes `table` to the file at `path`.
///
/// # Errors
///
/// What the system says.
pub fn write(path: &Path, table: &Table) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let names: Vec<String> = table.iter().map(|column| quoted(&column.name)).collect();
    writeln!(file, "{}", names.join(","))?;
    for row in 0..rows(table) {
        for (number, column) in table.iter().enumerate() {
            if number > 0 {
                file.write_all(b",")?;
            }
            match column.values.get(row) {
                Some(value) if !value.is_nan() => write!(file, "{value}")?,
                _ => {}
            }
        }
        writeln!(file)?;
    }
    file.flush()
}

fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}

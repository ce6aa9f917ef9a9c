//! Opening one MCAP file: by its index, or by going through all of it.

use std::path::Path;

use mcap::{
    MAGIC,
    records::{Record, op},
};

use super::{
    block::{FRAME, Fault, frame, parse},
    error::OpenBagError,
    layout::{Layout, TAIL},
    scan::scan,
};

/// The record that ends the data section, with its frame \[bytes\].
const DATA_END: u64 = FRAME as u64 + 4;

impl Layout {
    /// Opens a file that is whole.
    pub(crate) fn open(path: &Path) -> Result<Layout, OpenBagError> {
        let mut layout = Layout::begin(path)?;
        let truncated = || OpenBagError::Truncated {
            path: path.to_owned(),
        };
        let footer = layout.footer()?.ok_or_else(truncated)?;
        layout.closed = true;
        if footer.summary_start != 0 {
            layout.read_summary(&footer)?;
            if layout.is_indexed() {
                layout.blocks.sort_by_key(|block| block.offset);
                return Ok(layout);
            }
        }
        // Closed, but without an index that could be used.
        let layout = scan(Layout::begin(path)?)?;
        match layout.faults.first() {
            Some(fault) => Err(layout.damaged(fault.clone())),
            None => Ok(layout),
        }
    }

    /// Opens a file as far as it can be read; reads all of it once.
    pub(crate) fn salvage(path: &Path) -> Result<Layout, OpenBagError> {
        let mut layout = match Layout::open(path) {
            Err(OpenBagError::Truncated { .. } | OpenBagError::Damaged { .. }) => {
                return scan(Layout::begin(path)?);
            }
            opened => opened?,
        };
        let broken = layout.check_data()?;
        layout.faults.extend(broken);
        Ok(layout)
    }

    /// Compares the data section with its checksum, if it has one.
    fn check_data(&self) -> Result<Option<Fault>, OpenBagError> {
        let Some(footer) = self.footer()? else {
            return Ok(None);
        };
        let summary = match footer.summary_start {
            0 => self.length - TAIL,
            start => start,
        };
        let Some(end) = summary.checked_sub(DATA_END) else {
            return Ok(None);
        };
        let record = self.bytes(end, DATA_END)?;
        let expected = match parse(op::DATA_END, &record[FRAME..]) {
            Ok(Record::DataEnd(end)) if frame(&record) == Some((op::DATA_END, 4)) => {
                end.data_section_crc
            }
            _ => 0,
        };
        // Some writers count the magic number, some do not.
        let intact = expected == 0
            || self.checksum(0, end)? == expected
            || self.checksum(MAGIC.len() as u64, end)? == expected;
        Ok((!intact).then(|| Fault {
            offset: end,
            reason: "the checksum of all data is wrong".to_owned(),
        }))
    }
}

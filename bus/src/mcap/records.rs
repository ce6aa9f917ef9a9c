//! MCAP's framing of records: an opcode, a length of 64 bits, the body.

/// Opcode and length in front of every record \[bytes\].
pub(super) const FRAME: usize = 9;

/// Channel, sequence, log time and publish time in front of a message's data \[bytes\].
pub(super) const MESSAGE_HEADER: usize = 22;

/// The longest record and the largest chunk that is read \[bytes\]: what
/// garbage may claim must not exhaust the memory. rosbag2's chunks have less
/// than 1 MiB.
pub(super) const LARGEST_RECORD: usize = 256 << 20;

/// One record, borrowed.
pub(super) struct RawRecord<'a> {
    /// What it is: `mcap::records::op`.
    pub(super) opcode: u8,
    /// What it holds.
    pub(super) body: &'a [u8],
}

/// The whole records at the front of `bytes`; ends at the first that is cut.
pub(super) struct Records<'a> {
    rest: &'a [u8],
}

impl<'a> Records<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Records<'a> {
        Records { rest: bytes }
    }

    /// Bytes behind the last whole record.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = RawRecord<'a>;

    fn next(&mut self) -> Option<RawRecord<'a>> {
        let (opcode, length) = frame(self.rest)?;
        let end = usize::try_from(length).ok()?.checked_add(FRAME)?;
        let body = self.rest.get(FRAME..end)?;
        self.rest = &self.rest[end..];
        Some(RawRecord { opcode, body })
    }
}

/// Opcode and length of the record at the front of `bytes`.
pub(super) fn frame(bytes: &[u8]) -> Option<(u8, u64)> {
    Some((*bytes.first()?, u64_at(bytes, 1)?))
}

/// The fields in front of a message's data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MessageHeader {
    pub(super) channel: u16,
    pub(super) sequence: u32,
    pub(super) log_time: u64,
    pub(super) publish_time: u64,
}

/// The header in a message record's body; the data follows at
/// [`MESSAGE_HEADER`]. `None` when the body is too short.
pub(super) fn message_header(body: &[u8]) -> Option<MessageHeader> {
    Some(MessageHeader {
        channel: u16::from_le_bytes(body.get(..2)?.try_into().ok()?),
        sequence: u32_at(body, 2)?,
        log_time: u64_at(body, 6)?,
        publish_time: u64_at(body, 14)?,
    })
}

/// The little-endian number at `offset`.
pub(super) fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    let end = offset.checked_add(4)?;
    Some(u32::from_le_bytes(bytes.get(offset..end)?.try_into().ok()?))
}

/// The little-endian number at `offset`.
pub(super) fn u64_at(bytes: &[u8], offset: usize) -> Option<u64> {
    let end = offset.checked_add(8)?;
    Some(u64::from_le_bytes(bytes.get(offset..end)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_record_ends_the_list() {
        let mut bytes = vec![7, 2, 0, 0, 0, 0, 0, 0, 0, 0xAA, 0xBB];
        bytes.extend([5, 200, 0, 0, 0, 0, 0, 0, 0, 1]);
        let mut records = Records::new(&bytes);
        let first = records.next().unwrap();
        assert_eq!((first.opcode, first.body), (7, &[0xAA, 0xBB][..]));
        assert!(records.next().is_none());
        assert_eq!(records.left(), 10);
    }

    #[test]
    fn a_length_beyond_all_memory_is_no_record() {
        let bytes = [5, 255, 255, 255, 255, 255, 255, 255, 255, 0];
        assert!(Records::new(&bytes).next().is_none());
    }

    #[test]
    fn a_message_header_is_22_bytes() {
        let mut body = vec![3, 0, 9, 0, 0, 0];
        body.extend(11_u64.to_le_bytes());
        body.extend(12_u64.to_le_bytes());
        let header = MessageHeader {
            channel: 3,
            sequence: 9,
            log_time: 11,
            publish_time: 12,
        };
        assert_eq!(message_header(&body), Some(header));
        assert_eq!(body.len(), MESSAGE_HEADER);
        assert_eq!(message_header(&body[..21]), None);
    }
}

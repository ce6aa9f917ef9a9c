//! Whatever the bytes: an error or messages, never a panic.

#![allow(clippy::unwrap_used)] // A test may.

mod samples;

use std::{fs, path::Path, sync::LazyLock};

use ferntast_bag::{BagReader, info, repair};
use ferntast_msgs::sample::JointSample;
use mcap::records::op;
use proptest::prelude::*;
use samples::write_sample_bag;

static RECORDING: LazyLock<(Vec<u8>, String)> = LazyLock::new(|| {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 60).unwrap();
    (
        fs::read(path.join("run_0.mcap")).unwrap(),
        fs::read_to_string(path.join("metadata.yaml")).unwrap(),
    )
});

/// Does everything that can be done with a recording. Messages that could be
/// read before repair and after it.
fn use_it(path: &Path, output: &Path) -> (usize, Option<u64>) {
    let mut read = 0;
    if let Ok(reader) = BagReader::open(path) {
        read = reader.raw().filter(Result::is_ok).count();
        if let Ok(messages) = reader.messages::<JointSample>("/follower/measured_js") {
            let _ = messages.count();
        }
        let _ = (reader.bounds(), reader.metadata());
    }
    let _ = info(path);
    let repaired = repair(path, Some(output)).ok();
    if let Some(report) = &repaired {
        // What was mended is whole, whatever it was before.
        let reader = BagReader::open(output).unwrap();
        let messages = reader
            .raw()
            .inspect(|message| assert!(message.is_ok()))
            .count();
        assert_eq!(messages as u64, report.messages);
    }
    (read, repaired.map(|report| report.messages))
}

fn use_bytes(bytes: &[u8]) -> (usize, Option<u64>) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("any.mcap");
    fs::write(&path, bytes).unwrap();
    use_it(&path, &directory.path().join("mended.mcap"))
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

/// Footer and magic number of a file whose summary begins at `start`.
fn end(start: u64) -> Vec<u8> {
    let body = [&start.to_le_bytes()[..], &[0; 12]].concat();
    [record(op::FOOTER, &body), mcap::MAGIC.to_vec()].concat()
}

/// The `mcap` crate's own readers panic at these, or never end.
#[test]
fn files_that_the_library_does_not_survive() {
    // An attachment without its checksum: in the summary, and in the data.
    let attachment = record(op::ATTACHMENT, &[0; 32]);
    for summary_start in [0, 8] {
        let file = [mcap::MAGIC, &attachment, &end(summary_start)].concat();
        assert_eq!(use_bytes(&file), (0, Some(0)));
    }
    // A chunk that says how long it is and does not hold it; the index, and
    // the summary with it, is found by the library's writer.
    let whole = &RECORDING.0;
    let chunk = mcap::Summary::read(whole).unwrap().unwrap().chunk_indexes[0].clone();
    let data = chunk.compressed_data_offset().unwrap() as usize;
    for place in [data, data + chunk.compressed_size as usize / 2] {
        let mut file = whole.clone();
        file[place] ^= 0xFF;
        let (read, repaired) = use_bytes(&file);
        assert!(read > 0, "messages of the other chunks");
        assert_eq!(repaired, Some(read as u64));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        use_bytes(&bytes);
    }

    /// Records with any opcode, length and content behind the magic number,
    /// with and without a proper end.
    #[test]
    fn any_records(
        records in prop::collection::vec(
            (0_u8..17, prop::option::weighted(0.2, any::<u64>()), prop::collection::vec(any::<u8>(), 0..80)),
            0..12,
        ),
        summary_start in 0_u64..400,
        closed in any::<bool>(),
    ) {
        let mut bytes = mcap::MAGIC.to_vec();
        for (opcode, length, body) in records {
            bytes.push(opcode);
            bytes.extend(length.unwrap_or(body.len() as u64).to_le_bytes());
            bytes.extend(body);
        }
        if closed {
            bytes.extend([2, 20, 0, 0, 0, 0, 0, 0, 0]);
            bytes.extend(summary_start.to_le_bytes());
            bytes.extend([0; 12]);
            bytes.extend(mcap::MAGIC);
        }
        use_bytes(&bytes);
    }

    #[test]
    fn a_recording_cut_anywhere(part in 0.0..1.0_f64) {
        let whole = &RECORDING.0;
        let length = (whole.len() as f64 * part) as usize;
        let (read, repaired) = use_bytes(&whole[..length]);
        prop_assert_eq!(read, 0);
        prop_assert!(length < 8 || repaired.is_some());
    }

    #[test]
    fn a_recording_with_flipped_bits(
        flips in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..8), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = RECORDING.0.clone();
        for (place, bit) in flips {
            let place = place.index(bytes.len());
            bytes[place] ^= 1 << bit;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        use_bytes(&bytes);
    }

    #[test]
    fn a_recording_with_a_piece_overwritten(
        place in any::<prop::sample::Index>(),
        piece in prop::collection::vec(any::<u8>(), 1..64),
    ) {
        let mut bytes = RECORDING.0.clone();
        let start = place.index(bytes.len());
        let end = (start + piece.len()).min(bytes.len());
        bytes[start..end].copy_from_slice(&piece[..end - start]);
        use_bytes(&bytes);
    }

    #[test]
    fn metadata_with_a_piece_overwritten(
        place in any::<prop::sample::Index>(),
        piece in "[ -~\n]{0,40}",
        length in 0_usize..60,
    ) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("run");
        fs::create_dir(&path).unwrap();
        fs::write(path.join("run_0.mcap"), &RECORDING.0).unwrap();
        let mut text = RECORDING.1.clone();
        let start = place.index(text.len());
        let end = (start + length).min(text.len());
        text.replace_range(start..end, &piece);
        fs::write(path.join("metadata.yaml"), text).unwrap();
        use_it(&path, &directory.path().join("mended"));
    }
}

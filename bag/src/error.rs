//! What can go wrong with a recording: one enum an operation.

use std::{io, path::PathBuf};

use ferntast_msgs::{
    InvalidMessage, Time,
    cdr::{DecodeError, EncodeError},
};

/// Why a recording cannot be begun.
#[derive(Debug, thiserror::Error)]
pub enum CreateBagError {
    /// The directory holds something.
    #[error("{} exists and is not empty: choose another directory, or move that one away", path.display())]
    NotEmpty {
        /// The directory asked for.
        path: PathBuf,
    },
    /// The path names no directory that could be made.
    #[error("{} does not end in a directory's name (UTF-8): write for example recordings/run_1", path.display())]
    NoName {
        /// The path asked for.
        path: PathBuf,
    },
    /// The system refuses.
    #[error("cannot record into {}: {source}; see that the directory above it exists, is yours, and its disk has room", path.display())]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The MCAP library refuses.
    #[error("cannot begin {}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What the library said.
        reason: String,
    },
}

/// Why a message was not recorded. All that was recorded before stays.
#[derive(Debug, thiserror::Error)]
pub enum WriteBagError {
    /// The disk is full.
    #[error("{} is not recorded further, the disk is full: free some room and recording goes on by itself; what was recorded so far is safe", path.display())]
    DiskFull {
        /// The file.
        path: PathBuf,
    },
    /// The system refuses for another reason.
    #[error("{} is not recorded further: {reason}; what was recorded so far is safe", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The channel comes from another recording.
    #[error("channel {channel} is not of this recording: register the topic with it first")]
    UnknownChannel {
        /// The channel's number.
        channel: u16,
    },
    /// The topic carries another type.
    #[error("{topic} carries {found}, not {wanted}: use the topic's own type, or another name")]
    WrongType {
        /// The topic.
        topic: String,
        /// The type given.
        wanted: String,
        /// The type that the topic was registered with.
        found: String,
    },
    /// Zero or before 1970.
    #[error("{topic}: {what} is {nanos} ns, which is no time: take nanoseconds since 1970")]
    NoTime {
        /// The topic.
        topic: String,
        /// Log time or publish time.
        what: &'static str,
        /// What was given \[ns\].
        nanos: i64,
    },
    /// The message does not go into CDR.
    #[error("{topic}: {source}")]
    Encode {
        /// The topic.
        topic: String,
        /// What is wrong.
        source: EncodeError,
    },
    /// The package of messages does not describe the type.
    #[error("{interface} has no schema: {reason}")]
    NoSchema {
        /// Interface name.
        interface: &'static str,
        /// What is missing.
        reason: String,
    },
    /// The MCAP library refuses.
    #[error("cannot write {}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What the library said.
        reason: String,
    },
}

/// Why a recording was not closed. Its messages are on disk as far as they
/// were taken; `ferntast bag repair` closes it.
#[derive(Debug, thiserror::Error)]
pub enum FinishBagError {
    /// The MCAP file cannot be closed.
    #[error("{source}; it is not closed: free some room and run `ferntast bag repair {}`", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: WriteBagError,
    },
    /// `metadata.yaml` cannot be written.
    #[error("cannot write {}: {source}; free some room and run `ferntast bag repair` on its directory", path.display())]
    Metadata {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Why a recording cannot be opened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenBagError {
    /// There is nothing.
    #[error("there is no recording at {}: see that the path is right", path.display())]
    Missing {
        /// What was asked for.
        path: PathBuf,
    },
    /// A directory without a recording.
    #[error("{} holds no recording: neither metadata.yaml nor an .mcap file is in it", path.display())]
    NoRecording {
        /// The directory.
        path: PathBuf,
    },
    /// `metadata.yaml` is broken or asks for what is not supported.
    #[error("{} cannot be used: {reason}", path.display())]
    Metadata {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file without a byte.
    #[error("{} is empty: nothing was recorded, or it was not copied whole", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Not an MCAP file.
    #[error("{} is not an MCAP file: its first bytes are not those of one", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// The file was not closed or not copied whole.
    #[error("{} ends before its end: it was cut off while recording or copying; run `ferntast bag repair {}`", path.display(), path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
    },
    /// The content is broken.
    #[error("{} is damaged at byte {offset}: {reason}; run `ferntast bag repair {}`", path.display(), path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where \[byte\].
        offset: u64,
        /// What is wrong.
        reason: String,
    },
    /// The system refuses.
    #[error("cannot read {}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// Why a topic cannot be read from a recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SelectTopicError {
    /// The recording has no such topic.
    #[error("the recording has no topic {topic}; it has: {}", available.join(", "))]
    NoSuchTopic {
        /// The topic asked for.
        topic: String,
        /// The topics that there are.
        available: Vec<String>,
    },
    /// The topic carries another type.
    #[error("{topic} carries {found}, not {wanted}: read it as what it is")]
    WrongType {
        /// The topic.
        topic: String,
        /// The type asked for.
        wanted: String,
        /// The type in the recording, with what tells it apart.
        found: String,
    },
    /// Its messages are not CDR.
    #[error("{topic} is encoded as {encoding:?}, not as cdr: only its raw bytes can be read")]
    NotCdr {
        /// The topic.
        topic: String,
        /// The message encoding in the recording.
        encoding: String,
    },
}

/// Why a message of a recording cannot be read. Reading can go on: the next
/// message comes from behind the fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadMessageError {
    /// A chunk is broken: its messages are left out.
    #[error("{} is damaged at byte {offset}: {reason}; `ferntast bag repair {}` leaves the broken part out", path.display(), path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where \[byte\].
        offset: u64,
        /// What is wrong.
        reason: String,
    },
    /// The bytes are no message of the type.
    #[error("{topic} at {} ns: {source}", log_time.nanos())]
    Decode {
        /// The topic.
        topic: String,
        /// When it was recorded.
        log_time: Time,
        /// What is wrong.
        source: DecodeError,
    },
    /// The message is none that can be acted on.
    #[error("{topic} at {} ns: {source}", log_time.nanos())]
    Invalid {
        /// The topic.
        topic: String,
        /// When it was recorded.
        log_time: Time,
        /// What is wrong.
        source: InvalidMessage,
    },
    /// The system refuses.
    #[error("cannot read {}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// Why nothing can be said of a recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(transparent)]
pub struct InfoError(#[from] pub OpenBagError);

/// Why a recording was not repaired. The original is as it was.
#[derive(Debug, thiserror::Error)]
pub enum RepairError {
    /// It cannot be opened, not even in part.
    #[error(transparent)]
    Open(#[from] OpenBagError),
    /// The result exists.
    #[error("{} exists: move it away, or name another output", path.display())]
    OutputExists {
        /// The output.
        path: PathBuf,
    },
    /// A folder of files that are not of one recording.
    #[error(
        "{}: {files} MCAP files whose names are not those of one recording (NAME_0.mcap, NAME_1.mcap, …), and no \
        metadata.yaml that says so: repair each by its own name, as in ferntast bag repair {}",
        path.display(),
        path.join(first).display()
    )]
    Unrelated {
        /// The folder.
        path: PathBuf,
        /// How many.
        files: usize,
        /// Name of the first.
        first: PathBuf,
    },
    /// The path names no file or directory.
    #[error("{} does not end in a name (UTF-8)", path.display())]
    NoName {
        /// The path asked for.
        path: PathBuf,
    },
    /// The result cannot be written.
    #[error("cannot write the repaired {}: {reason}; the original is untouched", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        reason: String,
    },
}

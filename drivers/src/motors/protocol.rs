//! Packets on a bus of motors, as far as families have them in common.

/// What a motor is told to do. Both makers count alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Instruction {
    /// Say that you are there.
    Ping = 0x01,
    /// Give registers.
    Read = 0x02,
    /// Take registers.
    Write = 0x03,
    /// Several motors give the same registers, one after the other.
    SyncRead = 0x82,
    /// Several motors take the same registers.
    SyncWrite = 0x83,
    /// Several motors give the same registers, in one packet.
    FastSyncRead = 0x8A,
}

/// All motors of a bus.
pub const EVERYBODY: u8 = 0xFE;

/// The most bytes of data in an answer.
pub const LONGEST: usize = 256;

/// What a motor answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Which motor.
    pub id: u8,
    /// What it says of itself.
    pub error: u8,
    data: [u8; LONGEST],
    length: usize,
}

impl Answer {
    /// An answer without data.
    pub fn new(id: u8, error: u8) -> Answer {
        Answer {
            id,
            error,
            data: [0; LONGEST],
            length: 0,
        }
    }

    /// The same with one byte more, as far as there is room.
    pub fn push(&mut self, byte: u8) {
        if let Some(place) = self.data.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }

    /// Its registers.
    pub fn data(&self) -> &[u8] {
        &self.data[..self.length]
    }
}

/// What the beginning of some bytes is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// Too little to tell.
    Nothing,
    /// So many bytes that are no answer.
    Garbage(usize),
    /// So many bytes of an answer whose checksum is wrong.
    Damaged(usize),
    /// An answer, of so many bytes.
    Answer(Box<Answer>, usize),
}

/// How a maker writes packets.
pub trait Protocol {
    /// Bytes of an answer without data.
    const FRAME: usize;

    /// Writes an instruction for `id` into `packet`, in place of what was there.
    fn write(packet: &mut Vec<u8>, id: u8, instruction: Instruction, parameters: &[u8]);

    /// Writes an address, or a length, as a parameter.
    fn write_number(parameters: &mut Vec<u8>, number: u16);

    /// What stands at the beginning of what came in.
    fn find(bytes: &[u8]) -> Found;

    /// Why an instruction was refused, by the error of the answer.
    fn refusal(error: u8) -> Option<&'static str>;

    /// Whether the motor says that something is wrong with it.
    fn alerts(error: u8) -> bool;
}

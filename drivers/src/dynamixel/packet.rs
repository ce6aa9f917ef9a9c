//! Dynamixel Protocol 2.0 (emanual.robotis.com/docs/en/dxl/protocol2):
//! `FF FF FD 00 | id | length, little-endian | instruction | parameters | CRC, little-endian`;
//! the length counts what follows it. An `FF FF FD` among instruction and parameters gets
//! another `FD` behind it, but not in the one answer of several motors (fast sync read).

use crate::motors::protocol::{Answer, EVERYBODY, Found, Instruction, LONGEST, Protocol};

const HEADER: [u8; 4] = [0xFF, 0xFF, 0xFD, 0x00];
/// The instruction of an answer.
const STATUS: u8 = 0x55;
/// Header, id and length.
const HEAD: usize = 7;

/// The packets of Protocol 2.0.
pub struct Protocol2;

/// CRC-16 with the polynomial 0x8005 from zero, highest bit first.
pub fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |sum: u16, byte| {
        let index = (sum >> 8) ^ u16::from(*byte);
        (sum << 8) ^ CRC[usize::from(index)]
    })
}

const CRC: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut sum = (byte as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            sum = (sum << 1) ^ if sum & 0x8000 != 0 { 0x8005 } else { 0 };
            bit += 1;
        }
        table[byte] = sum;
        byte += 1;
    }
    table
};

impl Protocol for Protocol2 {
    const FRAME: usize = 11;

    fn write(packet: &mut Vec<u8>, id: u8, instruction: Instruction, parameters: &[u8]) {
        packet.clear();
        packet.extend(HEADER);
        packet.extend([id, 0, 0, instruction as u8]);
        for byte in parameters {
            packet.push(*byte);
            if packet[HEAD..].ends_with(&HEADER[..3]) {
                packet.push(HEADER[2]);
            }
        }
        let length = (packet.len() - HEAD + 2) as u16;
        packet[5..HEAD].copy_from_slice(&length.to_le_bytes());
        packet.extend(crc(packet).to_le_bytes());
    }

    fn write_number(parameters: &mut Vec<u8>, number: u16) {
        parameters.extend(number.to_le_bytes());
    }

    fn find(bytes: &[u8]) -> Found {
        let begins = |at: usize| HEADER.starts_with(&bytes[at..bytes.len().min(at + 4)]);
        let begin = (0..bytes.len()).find(|at| begins(*at));
        match begin {
            None if bytes.is_empty() => return Found::Nothing,
            None => return Found::Garbage(bytes.len()),
            Some(0) => {}
            Some(begin) => return Found::Garbage(begin),
        }
        let Some(&[id, low, high, instruction, error]) = bytes.get(4..9) else {
            return Found::Nothing;
        };
        let whole = HEAD + usize::from(u16::from_le_bytes([low, high]));
        // Instruction, error and CRC are the least there is.
        if instruction != STATUS || !(Self::FRAME..=Self::FRAME + LONGEST).contains(&whole) {
            return Found::Garbage(1);
        }
        let Some((body, sum)) = bytes.get(..whole).and_then(<[u8]>::split_last_chunk) else {
            return Found::Nothing;
        };
        if crc(body) != u16::from_le_bytes(*sum) {
            return Found::Damaged(whole);
        }
        let mut answer = Answer::new(id, error);
        let stuffed = id != EVERYBODY;
        for (at, byte) in body.iter().enumerate().skip(9) {
            if !(stuffed && body[HEAD..at].ends_with(&HEADER[..3]) && *byte == HEADER[2]) {
                answer.push(*byte);
            }
        }
        Found::Answer(Box::new(answer), whole)
    }

    fn refusal(error: u8) -> Option<&'static str> {
        match error & 0x7F {
            0 => None,
            1 => Some("the instruction failed"),
            2 => Some("it does not know the instruction"),
            3 => Some("it got the instruction damaged"),
            4 => Some("the value is out of range"),
            5 => Some("the value has another length"),
            6 => Some("the value is beyond a limit that is set in the motor"),
            7 => Some("the register cannot be written now"),
            _ => Some("of an error that is not known"),
        }
    }

    fn alerts(error: u8) -> bool {
        error & 0x80 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An answer as a motor writes it, by another way than [`Protocol2::write`].
    fn answer(id: u8, error: u8, data: &[u8]) -> Vec<u8> {
        let mut body = vec![STATUS, error];
        body.extend(data);
        let mut stuffed: Vec<u8> = Vec::new();
        for byte in body {
            stuffed.push(byte);
            if stuffed.ends_with(&[0xFF, 0xFF, 0xFD]) {
                stuffed.push(0xFD);
            }
        }
        let length = (stuffed.len() + 2) as u16;
        let mut packet = vec![0xFF, 0xFF, 0xFD, 0x00, id];
        packet.extend(length.to_le_bytes());
        packet.extend(stuffed);
        let sum = crc(&packet);
        packet.extend(sum.to_le_bytes());
        packet
    }

    /// The examples of the maker's manual.
    #[test]
    fn instructions_are_those_of_the_manual() {
        let mut packet = Vec::new();
        Protocol2::write(&mut packet, 1, Instruction::Ping, &[]);
        assert_eq!(packet, [0xFF, 0xFF, 0xFD, 0, 1, 3, 0, 1, 0x19, 0x4E]);
        Protocol2::write(&mut packet, 1, Instruction::Read, &[0x84, 0, 4, 0]);
        assert_eq!(
            packet,
            [0xFF, 0xFF, 0xFD, 0, 1, 7, 0, 2, 0x84, 0, 4, 0, 0x1D, 0x15]
        );
        Protocol2::write(&mut packet, 1, Instruction::Write, &[0x74, 0, 0, 2, 0, 0]);
        assert_eq!(
            packet,
            [
                0xFF, 0xFF, 0xFD, 0, 1, 9, 0, 3, 0x74, 0, 0, 2, 0, 0, 0xCA, 0x89
            ]
        );
    }

    proptest! {
        #[test]
        fn an_answer_is_found_in_noise(
            id in 0_u8..=252, error in any::<u8>(),
            data in prop::collection::vec(prop::sample::select(vec![0xFF, 0xFD, 0x00, 0x55, 7]), 0..40),
            before in prop::collection::vec(0_u8..0xFF, 0..20),
        ) {
            let mut bytes = before;
            bytes.extend(answer(id, error, &data));
            bytes.extend([0xFF, 0xFF]);
            loop {
                match Protocol2::find(&bytes) {
                    Found::Garbage(length) => { bytes.drain(..length); }
                    Found::Answer(found, length) => {
                        prop_assert_eq!((found.id, found.error, found.data()), (id, error, &data[..]));
                        prop_assert_eq!(bytes.len() - length, 2);
                        break;
                    }
                    other => prop_assert!(false, "{:?}", other),
                }
            }
        }

        #[test]
        fn whatever_comes_in_is_gone_through(mut bytes in prop::collection::vec(
            prop_oneof![Just(0xFF), Just(0xFD), Just(0), Just(STATUS), any::<u8>()], 0..300)) {
            loop {
                let length = match Protocol2::find(&bytes) {
                    Found::Nothing => break,
                    Found::Garbage(length) | Found::Damaged(length) | Found::Answer(_, length) => length,
                };
                prop_assert!((1..=bytes.len()).contains(&length));
                bytes.drain(..length);
            }
        }

        #[test]
        fn one_bit_that_is_wrong_is_no_answer(
            data in prop::collection::vec(any::<u8>(), 0..20), bit in 0_usize..8 * 11) {
            let mut bytes = answer(3, 0, &data);
            bytes[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(!matches!(Protocol2::find(&bytes), Found::Answer(..)));
        }
    }
}

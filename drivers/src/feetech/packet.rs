//! Packets of Feetech's STS motors: `FF FF | id | length | instruction | parameters | sum`; the
//! length counts what follows it, the sum is the complement of all bytes from the id on.
//! In an answer the motor's error stands in the instruction's place.

use crate::motors::protocol::{Answer, Found, Instruction, Protocol};

const HEADER: [u8; 2] = [0xFF, 0xFF];
/// Header, id and length.
const HEAD: usize = 4;

/// The packets of STS motors.
pub struct StsProtocol;

fn sum(bytes: &[u8]) -> u8 {
    !bytes
        .iter()
        .fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

impl Protocol for StsProtocol {
    const FRAME: usize = 6;

    fn write(packet: &mut Vec<u8>, id: u8, instruction: Instruction, parameters: &[u8]) {
        packet.clear();
        packet.extend(HEADER);
        packet.extend([id, parameters.len() as u8 + 2, instruction as u8]);
        packet.extend(parameters);
        packet.push(sum(&packet[2..]));
    }

    fn write_number(parameters: &mut Vec<u8>, number: u16) {
        // Registers and lengths have one byte.
        parameters.push(number as u8);
    }

    fn find(bytes: &[u8]) -> Found {
        let begins = |at: usize| HEADER.starts_with(&bytes[at..bytes.len().min(at + 2)]);
        match (0..bytes.len()).find(|at| begins(*at)) {
            None if bytes.is_empty() => return Found::Nothing,
            None => return Found::Garbage(bytes.len()),
            Some(0) => {}
            Some(begin) => return Found::Garbage(begin),
        }
        let Some(&[id, length, error]) = bytes.get(2..5) else {
            return Found::Nothing;
        };
        let whole = HEAD + usize::from(length);
        if id > 0xFD || error > 0x7F || whole < Self::FRAME {
            return Found::Garbage(1);
        }
        let Some((own, body)) = bytes.get(..whole).and_then(<[u8]>::split_last) else {
            return Found::Nothing;
        };
        if sum(&body[2..]) != *own {
            return Found::Damaged(whole);
        }
        let mut answer = Answer::new(id, error);
        body[5..].iter().for_each(|byte| answer.push(*byte));
        Found::Answer(Box::new(answer), whole)
    }

    fn refusal(_error: u8) -> Option<&'static str> {
        // Its error says how the motor is, not what it thinks of an instruction.
        None
    }

    fn alerts(error: u8) -> bool {
        error != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn answer(id: u8, error: u8, data: &[u8]) -> Vec<u8> {
        let mut packet = vec![0xFF, 0xFF, id, data.len() as u8 + 2, error];
        packet.extend(data);
        let total: u32 = packet[2..].iter().map(|byte| u32::from(*byte)).sum();
        packet.push(255 - (total % 256) as u8);
        packet
    }

    /// The examples of the maker's manual.
    #[test]
    fn instructions_are_those_of_the_manual() {
        let mut packet = Vec::new();
        StsProtocol::write(&mut packet, 1, Instruction::Ping, &[]);
        assert_eq!(packet, [0xFF, 0xFF, 1, 2, 1, 0xFB]);
        StsProtocol::write(&mut packet, 1, Instruction::Read, &[0x38, 2]);
        assert_eq!(packet, [0xFF, 0xFF, 1, 4, 2, 0x38, 2, 0xBE]);
    }

    proptest! {
        #[test]
        fn an_answer_is_found_in_noise(
            id in 0_u8..=252, error in 0_u8..=0x7F,
            data in prop::collection::vec(any::<u8>(), 0..40),
            before in prop::collection::vec(0_u8..0xFF, 0..20),
        ) {
            let mut bytes = before;
            bytes.extend(answer(id, error, &data));
            bytes.push(0xFF);
            loop {
                match StsProtocol::find(&bytes) {
                    Found::Garbage(length) => { bytes.drain(..length); }
                    Found::Answer(found, length) => {
                        prop_assert_eq!((found.id, found.error, found.data()), (id, error, &data[..]));
                        prop_assert_eq!(bytes.len() - length, 1);
                        break;
                    }
                    other => prop_assert!(false, "{:?}", other),
                }
            }
        }

        #[test]
        fn whatever_comes_in_is_gone_through(mut bytes in prop::collection::vec(
            prop_oneof![Just(0xFF), Just(0), Just(2), any::<u8>()], 0..300)) {
            loop {
                let length = match StsProtocol::find(&bytes) {
                    Found::Nothing => break,
                    Found::Garbage(length) | Found::Damaged(length) | Found::Answer(_, length) => length,
                };
                prop_assert!((1..=bytes.len()).contains(&length));
                bytes.drain(..length);
            }
        }
    }
}

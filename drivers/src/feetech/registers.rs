//! Registers of Feetech's STS series (memory table of the STS/SMS series, feetechrc.com): those
//! below 40 outlast the power, and are written only while [`LOCK`] is zero.

/// What the motor is (2).
pub const MODEL: u16 = 3;
/// Time before an answer (1) \[2 µs\].
pub const RETURN_DELAY: u16 = 7;
/// Whether everything is answered (1).
pub const ANSWERS: u16 = 8;
/// Gain of the position (1).
pub const P_GAIN: u16 = 21;
/// What the motor controls (1); 0 for a position.
pub const OPERATING_MODE: u16 = 33;
/// Whether the drive is on (1).
pub const TORQUE_ENABLE: u16 = 40;
/// Limit of acceleration on the way to a position (1); 0 for none.
pub const ACCELERATION: u16 = 41;
/// Where to be (2) \[count\].
pub const GOAL_POSITION: u16 = 42;
/// Time and speed on the way there (2 + 2); 0 for as fast as it goes.
pub const GOAL_TIME_AND_SPEED: u16 = 44;
/// The largest duty now (2) \[0.001\].
pub const TORQUE_LIMIT: u16 = 48;
/// Whether what outlasts the power is protected (1).
pub const LOCK: u16 = 55;
/// Position (2), velocity (2) \[count/s\], duty (2) \[0.001\], voltage (1) \[0.1 V\], temperature (1)
/// \[degC\], writing pending (1), status (1), moving (1), goal (2), current (2) \[6.5 mA\] now.
pub const PRESENT: u16 = 56;
/// Bytes of [`PRESENT`].
pub const PRESENT_BYTES: usize = 15;

/// What currents are counted in \[A\].
pub const CURRENT_UNIT: f64 = 0.0065;
/// The duty that the firmware asks for, by the gain and by how far the goal is away \[1/rad\]:
/// measured by Rhoban's `bam` with an oscilloscope (github.com/Rhoban/bam).
pub const DUTY_BY_GAIN: f64 = 0.166;

/// A number whose bit `sign` tells that it is negative.
pub fn signed(bytes: [u8; 2], sign: u32) -> f64 {
    let value = u16::from_le_bytes(bytes);
    let size = f64::from(value & ((1 << sign) - 1));
    if value & (1 << sign) == 0 {
        size
    } else {
        -size
    }
}

/// The other way round, where bit 15 tells the sign.
pub fn unsigned(value: f64) -> [u8; 2] {
    let size = value.abs().min(32767.0).round() as u16;
    (size | if value < 0.0 { 0x8000 } else { 0 }).to_le_bytes()
}

/// What the bits of an answer's error say.
pub fn hardware_error(bits: u8) -> String {
    const NAMES: [(u8, &str); 5] = [
        (0, "the voltage of its supply is out of range"),
        (1, "its encoder fails"),
        (2, "overheated"),
        (3, "too much current"),
        (5, "overloaded for too long"),
    ];
    let said = NAMES.iter().filter(|(bit, _)| bits & (1 << bit) != 0);
    let said: Vec<&str> = said.map(|(_, name)| *name).collect();
    match said.is_empty() {
        true => format!("status {bits}"),
        false => said.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_stand_in_a_bit_of_their_own() {
        assert_eq!(signed([0x01, 0x80], 15), -1.0);
        assert_eq!(signed([0xE8, 0x07], 10), -1000.0);
        assert_eq!(signed([0xE8, 0x03], 10), 1000.0);
        for value in [-4095.0, -1.0, 0.0, 5.0, 32767.0] {
            assert_eq!(signed(unsigned(value), 15), value);
        }
    }
}

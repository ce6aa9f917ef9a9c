//! Registers of the X series (emanual.robotis.com/docs/en/dxl/x): those up to 63 can be written
//! only while the drive is off, and outlast the power.

/// Time before an answer (1) \[2 µs\].
pub const RETURN_DELAY: u16 = 9;
/// What the motor controls (1).
pub const OPERATING_MODE: u16 = 11;
/// Of [`OPERATING_MODE`]: a position, with a current that is limited by [`GOAL_CURRENT`].
pub const CURRENT_BASED_POSITION: u8 = 5;
/// The largest current (2).
pub const CURRENT_LIMIT: u16 = 38;
/// Whether the drive is on (1).
pub const TORQUE_ENABLE: u16 = 64;
/// Which instructions are answered (1); 2 for all.
pub const STATUS_RETURN_LEVEL: u16 = 68;
/// What is wrong with the motor (1).
pub const HARDWARE_ERROR: u16 = 70;
/// Gains of the position: derivative and integral (2 + 2), proportional (2) \[1/128\].
pub const POSITION_D_AND_I_GAIN: u16 = 80;
/// See above.
pub const POSITION_P_GAIN: u16 = 84;
/// Gains of acceleration and velocity ahead of the position (2 + 2).
pub const FEED_FORWARD_GAINS: u16 = 88;
/// After how long a silence the motor stops (1) \[20 ms\]; 255 once it has.
pub const BUS_WATCHDOG: u16 = 98;
/// What [`BUS_WATCHDOG`] counts in \[s\].
pub const WATCHDOG_UNIT: f64 = 0.020;
/// The largest current now (2).
pub const GOAL_CURRENT: u16 = 102;
/// Limits of acceleration and velocity on the way to a position (4 + 4); 0 for none.
pub const PROFILE: u16 = 108;
/// Where to be (4) \[count\].
pub const GOAL_POSITION: u16 = 116;
/// Current (2), velocity (4) \[0.229 rpm\], position (4) \[count\] now.
pub const PRESENT: u16 = 126;
/// Bytes of [`PRESENT`].
pub const PRESENT_BYTES: usize = 10;
/// The position alone (4).
pub const PRESENT_POSITION: u16 = 132;
/// Voltage (2) \[0.1 V\] and temperature (1) \[degC\] now.
pub const PRESENT_SUPPLY: u16 = 144;

/// What [`PRESENT`] counts velocities in \[rad/s\].
pub const VELOCITY_UNIT: f64 = 0.229 * std::f64::consts::TAU / 60.0;

/// What the bits of [`HARDWARE_ERROR`] say.
pub fn hardware_error(bits: u8) -> String {
    const NAMES: [(u8, &str); 5] = [
        (0, "the voltage of its supply is out of range"),
        (2, "overheated"),
        (3, "its encoder fails"),
        (4, "electric shock, or too little power"),
        (5, "overloaded for too long"),
    ];
    let said: Vec<&str> = NAMES
        .iter()
        .filter(|(bit, _)| bits & (1 << bit) != 0)
        .map(|(_, name)| *name)
        .collect();
    match said.is_empty() {
        true => format!("hardware error {bits}"),
        false => said.join(", "),
    }
}

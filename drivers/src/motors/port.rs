//! A serial port that is this program's alone.

use std::{
    io,
    os::fd::AsRawFd,
    path::Path,
    time::{Duration, Instant},
};

use serial2::{SerialPort, Settings};

use super::error::MotorError;

/// An open port.
pub struct Port {
    serial: SerialPort,
    baud: u32,
}

impl Port {
    /// Opens the port `name`, with 8 bits, no parity, one stop bit.
    ///
    /// # Errors
    ///
    /// There is no such port, it is not to be had, is taken, or does not go that fast.
    pub fn open(name: &str, baud: u32) -> Result<Port, MotorError> {
        let path = Path::new(name);
        let opened = SerialPort::open(path, |settings: Settings| Ok(settings));
        let serial = opened.map_err(|source| match source.raw_os_error() {
            Some(libc::EBUSY) => MotorError::Taken(name.to_owned()),
            _ => MotorError::Open {
                port: name.to_owned(),
                source,
            },
        })?;
        alone(&serial).map_err(|_| MotorError::Taken(name.to_owned()))?;
        let mut port = Port { serial, baud };
        port.configure().map_err(|source| MotorError::Baud {
            port: name.to_owned(),
            baud,
            source,
        })?;
        Ok(port)
    }

    fn configure(&mut self) -> io::Result<()> {
        let mut settings = self.serial.get_configuration()?;
        settings.set_raw();
        settings.set_baud_rate(self.baud)?;
        self.serial.set_configuration(&settings)?;
        self.serial.set_read_timeout(Duration::from_millis(1))?;
        self.serial.set_write_timeout(Duration::from_millis(50))?;
        self.serial.discard_buffers()
    }

    /// How long so many bytes take on the wire.
    pub fn time_of(&self, bytes: usize) -> Duration {
        // A start bit, eight of data, a stop bit.
        Duration::from_secs_f64(10.0 * bytes as f64 / f64::from(self.baud))
    }

    /// Sends `packet`; what came in before belongs to nothing any more.
    ///
    /// # Errors
    ///
    /// The port is gone.
    pub fn send(&mut self, packet: &[u8]) -> io::Result<()> {
        self.serial.discard_input_buffer()?;
        self.serial.write_all(packet)
    }

    /// What came in, into the beginning of `buffer`; nothing once `deadline` has passed.
    ///
    /// # Errors
    ///
    /// The port is gone.
    pub fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        loop {
            match self.serial.read(buffer) {
                // The other end of the line is closed.
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    if Instant::now() >= deadline {
                        return Ok(0);
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Err(error),
            }
        }
    }
}

/// Keeps others away: those that ask for a lock, and (as far as they are not root) those that
/// just open the port.
fn alone(serial: &SerialPort) -> io::Result<()> {
    let descriptor = serial.as_raw_fd();
    // SAFETY: a descriptor that is open; no memory is handed over.
    let locked = unsafe { libc::flock(descriptor, libc::LOCK_EX | libc::LOCK_NB) };
    if locked != 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: as above.
    match unsafe { libc::ioctl(descriptor, libc::TIOCEXCL) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

//! Everything the doctor asks of the machine, so that tests can answer.

use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::time::Duration;

/// A mounted file system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileSystem {
    /// Its size \[bytes\].
    pub size_bytes: u64,
    /// What this user may still write \[bytes\].
    pub free_bytes: u64,
    /// Mounted read-only.
    pub read_only: bool,
    /// Mounted so that nothing on it can be executed.
    pub no_exec: bool,
}

/// A network interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// `lo`, `eth0`.
    pub name: String,
    /// Up and with a carrier.
    pub running: bool,
    /// The loopback interface.
    pub loopback: bool,
    /// May carry multicast.
    pub multicast: bool,
    /// Its IPv4 addresses.
    pub addresses: Vec<Ipv4Addr>,
}

/// A loop whose wake-ups are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WakeUps {
    /// Time between two wake-ups.
    pub period: Duration,
    /// Number of wake-ups.
    pub count: usize,
    /// SCHED_FIFO priority; `None` for a normal thread.
    pub priority: Option<i32>,
}

/// The machine as the doctor sees it. Errors are the operating system's.
pub trait Host {
    /// An environment variable; `None` when it is not set.
    fn variable(&self, name: &str) -> Option<String>;
    /// The text of a file, invalid UTF-8 replaced.
    fn read(&self, path: &str) -> io::Result<String>;
    /// The names in a folder, sorted.
    fn list(&self, folder: &str) -> io::Result<Vec<String>>;
    /// Where a symbolic link points.
    fn link_target(&self, path: &str) -> io::Result<String>;
    /// The file system that holds `folder`.
    fn file_system(&self, folder: &Path) -> io::Result<FileSystem>;
    /// Writes a page into a new file in `folder` and removes it.
    fn try_writing(&self, folder: &Path) -> io::Result<()>;
    /// Whether this user may read and write a file; it is not opened.
    fn try_reading_and_writing(&self, path: &str) -> io::Result<()>;
    /// Connects over TCP and hangs up.
    fn try_connecting(&self, address: SocketAddr) -> io::Result<()>;
    /// Asks for SCHED_FIFO on a thread that then ends.
    fn try_real_time_priority(&self, priority: i32) -> io::Result<()>;
    /// How late each wake-up of such a loop was \[ns\].
    fn wake_up_lateness(&self, wake_ups: WakeUps) -> io::Result<Vec<i64>>;
    /// The addresses of `HOST:PORT`.
    fn resolve(&self, address: &str) -> io::Result<Vec<SocketAddr>>;
    /// Listens on a TCP port and stops again.
    fn try_listening(&self, address: SocketAddr) -> io::Result<()>;
    /// Binds a UDP port on all addresses, shared as DDS does, and closes it.
    fn try_sharing_udp_port(&self, port: u16) -> io::Result<()>;
    /// The network interfaces.
    fn interfaces(&self) -> io::Result<Vec<Interface>>;
    /// Sends a datagram to a multicast group through the interface that has
    /// this address, and receives it back.
    fn try_multicast(&self, group: Ipv4Addr, interface: Ipv4Addr) -> io::Result<()>;
}

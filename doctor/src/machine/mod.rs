//! The machine that the program runs on.

use std::ffi::CString;
use std::fs;
use std::io::{self, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::time::Duration;

use super::host::{FileSystem, Host, Interface, WakeUps};

/// A service on this host, or on one beside it, answers sooner.
const CONNECTS_WITHIN: Duration = Duration::from_secs(1);

mod network;
mod scheduling;

/// The machine that the program runs on (Linux).
#[derive(Clone, Copy, Debug, Default)]
pub struct Machine;

impl Host for Machine {
    fn variable(&self, name: &str) -> Option<String> {
        let value = std::env::var_os(name)?;
        Some(value.to_string_lossy().into_owned())
    }

    fn read(&self, path: &str) -> io::Result<String> {
        let bytes = fs::read(path)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn list(&self, folder: &str) -> io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in fs::read_dir(folder)? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
        names.sort_unstable();
        Ok(names)
    }

    fn link_target(&self, path: &str) -> io::Result<String> {
        let target = fs::read_link(path)?;
        Ok(target.to_string_lossy().into_owned())
    }

    fn file_system(&self, folder: &Path) -> io::Result<FileSystem> {
        let path = CString::new(folder.as_os_str().as_bytes())?;
        // SAFETY: an all-zero statvfs is a valid value.
        let mut statistics: libc::statvfs = unsafe { std::mem::zeroed() };
        // SAFETY: `path` ends in a zero byte, `statistics` is valid for writing.
        if unsafe { libc::statvfs(path.as_ptr(), &mut statistics) } != 0 {
            return Err(io::Error::last_os_error());
        }
        let block = statistics.f_frsize as u64;
        Ok(FileSystem {
            size_bytes: (statistics.f_blocks as u64).saturating_mul(block),
            free_bytes: (statistics.f_bavail as u64).saturating_mul(block),
            read_only: statistics.f_flag & libc::ST_RDONLY != 0,
            no_exec: statistics.f_flag & libc::ST_NOEXEC != 0,
        })
    }

    fn try_writing(&self, folder: &Path) -> io::Result<()> {
        let (path, mut file) = new_file(folder)?;
        let written = file.write_all(&[0; 4096]).and_then(|()| file.sync_data());
        let removed = fs::remove_file(path);
        written.and(removed)
    }

    fn try_reading_and_writing(&self, path: &str) -> io::Result<()> {
        let path = CString::new(path)?;
        // SAFETY: `path` ends in a zero byte and lives through the call.
        match unsafe { libc::access(path.as_ptr(), libc::R_OK | libc::W_OK) } {
            0 => Ok(()),
            _ => Err(io::Error::last_os_error()),
        }
    }

    fn try_connecting(&self, address: SocketAddr) -> io::Result<()> {
        TcpStream::connect_timeout(&address, CONNECTS_WITHIN).map(drop)
    }

    fn try_real_time_priority(&self, priority: i32) -> io::Result<()> {
        scheduling::try_real_time_priority(priority)
    }

    fn wake_up_lateness(&self, wake_ups: WakeUps) -> io::Result<Vec<i64>> {
        scheduling::wake_up_lateness(wake_ups)
    }

    fn resolve(&self, address: &str) -> io::Result<Vec<SocketAddr>> {
        Ok(address.to_socket_addrs()?.collect())
    }

    fn try_listening(&self, address: SocketAddr) -> io::Result<()> {
        TcpListener::bind(address).map(drop)
    }

    fn try_sharing_udp_port(&self, port: u16) -> io::Result<()> {
        network::try_sharing_udp_port(port)
    }

    fn interfaces(&self) -> io::Result<Vec<Interface>> {
        network::interfaces()
    }

    fn try_multicast(&self, group: Ipv4Addr, interface: Ipv4Addr) -> io::Result<()> {
        network::try_multicast(group, interface)
    }
}

/// A file that was not there before: never one that somebody else put there.
fn new_file(folder: &Path) -> io::Result<(std::path::PathBuf, fs::File)> {
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    let mut last = io::Error::from(io::ErrorKind::AlreadyExists);
    for attempt in 0..16 {
        let name = format!(".ferntast-doctor-{}-{attempt}", std::process::id());
        let path = folder.join(name);
        match options.open(&path) {
            Ok(file) => return Ok((path, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => last = error,
            Err(error) => return Err(error),
        }
    }
    Err(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_written_to_and_left_clean() {
        let folder = std::env::temp_dir().join(format!("doctor-writing-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("temporary folder");
        assert!(Machine.try_writing(&folder).is_ok());
        let left = fs::read_dir(&folder).expect("is there").count();
        fs::remove_dir(&folder).expect("empty");
        assert_eq!(left, 0);
        let gone = Machine.try_writing(&folder).map_err(|error| error.kind());
        assert_eq!(gone, Err(io::ErrorKind::NotFound));
    }

    #[test]
    fn the_root_file_system_has_a_size() {
        let root = Machine.file_system(Path::new("/")).expect("statvfs");
        assert!(root.size_bytes > 0 && root.free_bytes <= root.size_bytes);
        assert!(Machine.file_system(Path::new("/no/such")).is_err());
    }

    #[test]
    fn a_taken_tcp_port_is_refused() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("bound");
        let refused = Machine.try_listening(address).map_err(|error| error.kind());
        assert_eq!(refused, Err(io::ErrorKind::AddrInUse));
        assert!(Machine.try_connecting(address).is_ok());
        drop(listener);
        assert!(Machine.try_listening(address).is_ok());
        assert!(Machine.try_connecting(address).is_err());
    }
}

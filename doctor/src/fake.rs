//! A machine that answers what a test told it.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use super::host::{FileSystem, Host, Interface, WakeUps};

type Answer = Result<(), (io::ErrorKind, &'static str)>;

/// See the module. Whatever it was not told is not there.
#[derive(Clone, Debug)]
pub(super) struct Fake {
    pub(super) variables: BTreeMap<String, String>,
    pub(super) files: BTreeMap<String, String>,
    pub(super) links: BTreeMap<String, String>,
    pub(super) forbidden: BTreeSet<String>,
    pub(super) file_systems: BTreeMap<PathBuf, FileSystem>,
    pub(super) writing: Answer,
    pub(super) real_time: Answer,
    /// Lateness of normal and of real-time threads \[ns\], repeated.
    pub(super) lateness: [Vec<i64>; 2],
    pub(super) hosts: BTreeMap<String, Vec<SocketAddr>>,
    /// Where something answers.
    pub(super) services: BTreeSet<SocketAddr>,
    pub(super) tcp: BTreeMap<SocketAddr, io::ErrorKind>,
    pub(super) taken_udp: BTreeSet<u16>,
    pub(super) interfaces: Vec<Interface>,
    pub(super) multicast: BTreeSet<Ipv4Addr>,
}

impl Fake {
    /// Has nothing and permits nothing.
    pub(super) fn empty() -> Fake {
        let denied = Err((io::ErrorKind::PermissionDenied, "Operation not permitted"));
        Fake {
            variables: BTreeMap::new(),
            files: BTreeMap::new(),
            links: BTreeMap::new(),
            forbidden: BTreeSet::new(),
            file_systems: BTreeMap::new(),
            writing: denied,
            real_time: denied,
            lateness: [Vec::new(), Vec::new()],
            hosts: BTreeMap::new(),
            services: BTreeSet::new(),
            tcp: BTreeMap::new(),
            taken_udp: BTreeSet::new(),
            interfaces: Vec::new(),
            multicast: BTreeSet::new(),
        }
    }

    /// A workstation that lacks nothing.
    pub(super) fn good() -> Fake {
        let mut fake = Fake::empty()
            .file("/proc/sys/kernel/osrelease", "6.12.9-rt\n")
            .file(
                "/proc/version",
                "Linux version 6.12.9-rt #1 SMP PREEMPT_RT\n",
            )
            .file("/sys/kernel/realtime", "1\n")
            .file(
                "/sys/devices/system/clocksource/clocksource0/current_clocksource",
                "tsc\n",
            )
            .file("/proc/self/status", "Cpus_allowed_list:\t0-3\nCapEff:\t0\n")
            .file("/proc/loadavg", "0.20 0.10 0.05 1/100 999\n")
            .file(
                "/proc/self/limits",
                "Max locked memory unlimited unlimited bytes\nMax realtime priority 98 98\n",
            )
            .file("/proc/mounts", "tmpfs /dev/shm tmpfs rw,nosuid,nodev 0 0\n")
            .file("/dev/shm/other", "")
            .file("/proc/net/tcp", "header\n")
            .file("/proc/net/udp", "header\n")
            .file("/proc/sys/net/ipv4/ip_local_port_range", "32768\t60999\n")
            .disk("/dev/shm", 16 << 30, 15 << 30)
            .disk("recordings", 500 << 30, 400 << 30)
            .file("/opt/ros/jazzy/setup.bash", "");
        for core in 0..4 {
            let path = format!("/sys/devices/system/cpu/cpu{core}/cpufreq/scaling_governor");
            fake = fake.file(&path, "performance\n");
        }
        fake.writing = Ok(());
        fake.real_time = Ok(());
        fake.lateness = [vec![60_000, 55_000, 90_000], vec![5_000, 6_000, 12_000]];
        let interface = |name: &str, loopback, address| Interface {
            name: name.to_owned(),
            running: true,
            loopback,
            multicast: !loopback,
            addresses: vec![address],
        };
        let ethernet = Ipv4Addr::new(192, 168, 1, 5);
        fake.interfaces = vec![
            interface("lo", true, Ipv4Addr::LOCALHOST),
            interface("eth0", false, ethernet),
        ];
        fake.multicast.insert(ethernet);
        fake
    }

    pub(super) fn file(mut self, path: &str, text: &str) -> Fake {
        self.files.insert(path.to_owned(), text.to_owned());
        self
    }

    pub(super) fn without_file(mut self, path: &str) -> Fake {
        self.files.remove(path);
        self
    }

    pub(super) fn variable(mut self, name: &str, value: &str) -> Fake {
        self.variables.insert(name.to_owned(), value.to_owned());
        self
    }

    pub(super) fn disk(mut self, folder: &str, size_bytes: u64, free_bytes: u64) -> Fake {
        let file_system = FileSystem {
            size_bytes,
            free_bytes,
            read_only: false,
            no_exec: false,
        };
        self.file_systems.insert(PathBuf::from(folder), file_system);
        self
    }

    /// A process that holds open what `targets` name.
    pub(super) fn process(mut self, pid: u32, name: &str, targets: &[&str]) -> Fake {
        for (number, target) in targets.iter().enumerate() {
            let path = format!("/proc/{pid}/fd/{number}");
            self.links.insert(path, (*target).to_owned());
        }
        self.file(&format!("/proc/{pid}/comm"), &format!("{name}\n"))
    }
}

fn error(answer: (io::ErrorKind, &'static str)) -> io::Error {
    io::Error::new(answer.0, answer.1)
}

fn not_there(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::NotFound, format!("no {what}"))
}

impl Host for Fake {
    fn variable(&self, name: &str) -> Option<String> {
        self.variables.get(name).cloned()
    }

    fn read(&self, path: &str) -> io::Result<String> {
        if self.forbidden.contains(path) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        self.files.get(path).cloned().ok_or_else(|| not_there(path))
    }

    fn list(&self, folder: &str) -> io::Result<Vec<String>> {
        if self.forbidden.contains(folder) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        let folder = folder.trim_end_matches('/');
        let child = |path: &String| {
            let rest = path.strip_prefix(folder)?.strip_prefix('/')?;
            rest.split('/').next().map(str::to_owned)
        };
        let paths = self.files.keys().chain(self.links.keys());
        let names: BTreeSet<String> = paths.filter_map(child).collect();
        if names.is_empty() {
            return Err(not_there(folder));
        }
        Ok(names.into_iter().collect())
    }

    fn link_target(&self, path: &str) -> io::Result<String> {
        self.links.get(path).cloned().ok_or_else(|| not_there(path))
    }

    fn file_system(&self, folder: &Path) -> io::Result<FileSystem> {
        let found = self.file_systems.get(folder).copied();
        found.ok_or_else(|| not_there(&folder.display().to_string()))
    }

    fn try_writing(&self, _folder: &Path) -> io::Result<()> {
        self.writing.map_err(error)
    }

    fn try_reading_and_writing(&self, path: &str) -> io::Result<()> {
        match (self.forbidden.contains(path), self.files.contains_key(path)) {
            (true, _) => Err(io::ErrorKind::PermissionDenied.into()),
            (false, true) => Ok(()),
            (false, false) => Err(not_there(path)),
        }
    }

    fn try_connecting(&self, address: SocketAddr) -> io::Result<()> {
        match self.services.contains(&address) {
            true => Ok(()),
            false => Err(io::ErrorKind::ConnectionRefused.into()),
        }
    }

    fn try_real_time_priority(&self, _priority: i32) -> io::Result<()> {
        self.real_time.map_err(error)
    }

    fn wake_up_lateness(&self, wake_ups: WakeUps) -> io::Result<Vec<i64>> {
        if wake_ups.priority.is_some() {
            self.real_time.map_err(error)?;
        }
        let pattern = &self.lateness[usize::from(wake_ups.priority.is_some())];
        Ok(pattern
            .iter()
            .copied()
            .cycle()
            .take(wake_ups.count)
            .collect())
    }

    fn resolve(&self, address: &str) -> io::Result<Vec<SocketAddr>> {
        match address.parse() {
            Ok(address) => Ok(vec![address]),
            Err(_) => self
                .hosts
                .get(address)
                .cloned()
                .ok_or_else(|| not_there("such host")),
        }
    }

    fn try_listening(&self, address: SocketAddr) -> io::Result<()> {
        match self.tcp.get(&address) {
            Some(kind) => Err((*kind).into()),
            None => Ok(()),
        }
    }

    fn try_sharing_udp_port(&self, port: u16) -> io::Result<()> {
        if self.taken_udp.contains(&port) {
            return Err(io::ErrorKind::AddrInUse.into());
        }
        Ok(())
    }

    fn interfaces(&self) -> io::Result<Vec<Interface>> {
        if self.interfaces.is_empty() {
            return Err(not_there("interface"));
        }
        Ok(self.interfaces.clone())
    }

    fn try_multicast(&self, _group: Ipv4Addr, interface: Ipv4Addr) -> io::Result<()> {
        if self.multicast.contains(&interface) {
            return Ok(());
        }
        Err(error((io::ErrorKind::TimedOut, "did not come back")))
    }
}

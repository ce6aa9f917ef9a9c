//! Two hosts on one machine: two network namespaces joined by a veth pair.
//!
//! Each host also has shared memory of its own. The namespaces have no names:
//! they live as long as the process that holds them, so that nothing stays
//! behind, however a test ends, and two tests never meet.

use std::{
    fs,
    os::unix::process::CommandExt,
    path::Path,
    process::{Child, Command, Stdio},
    time::Duration,
};

use crate::{Process, Session, wait_until};

/// How long a namespace may take to be there.
const PATIENCE: Duration = Duration::from_secs(10);

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {
    /// With the master.
    Operator,
    /// With the arm.
    Arm,
}

impl Host {
    /// Its address.
    pub const fn address(self) -> &'static str {
        match self {
            Host::Operator => "10.77.0.1",
            Host::Arm => "10.77.0.2",
        }
    }

    /// Its network device.
    pub const fn device(self) -> &'static str {
        match self {
            Host::Operator => "operator0",
            Host::Arm => "arm0",
        }
    }
}

/// Holds a namespace until it is dropped.
#[derive(Debug)]
struct Holder(Child);

impl Drop for Holder {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Two hosts and the line between them.
#[derive(Debug)]
pub struct TwoHosts {
    operator: Holder,
    arm: Holder,
    /// Where each host has its own shared memory.
    memory: String,
    rootless: bool,
}

impl TwoHosts {
    /// Makes them for `session`: an empty line without loss or limit.
    ///
    /// # Errors
    ///
    /// Why this machine does not allow it.
    pub fn new(session: &Session) -> Result<TwoHosts, String> {
        for tool in ["unshare", "nsenter", "ip", "tc", "nft"] {
            let found = Command::new("sh")
                .args(["-c", "command -v \"$0\"", tool])
                .stdout(Stdio::null())
                .status();
            if !found.is_ok_and(|status| status.success()) {
                return Err(format!(
                    "no program {tool}: 'apt-get install util-linux iproute2 nftables' fixes that"
                ));
            }
        }
        // SAFETY: takes nothing, always succeeds.
        let rootless = unsafe { libc::geteuid() } != 0;
        let memory = format!("/tmp/ferntast.{}", session.name());
        fs::create_dir_all(&memory).map_err(|error| format!("{memory}: {error}"))?;
        let mut first = Command::new("unshare");
        if rootless {
            first.args(["--user", "--map-root-user"]);
        }
        first.args(["--net", "--mount", "sleep", "infinity"]);
        let operator = hold(first, &[])?;
        let mut second = enter(&operator, rootless);
        second.args(["unshare", "--net", "--mount", "sleep", "infinity"]);
        let own = fs::read_link(format!("/proc/{}/ns/net", operator.0.id()));
        let arm = hold(second, &own.into_iter().collect::<Vec<_>>())?;
        let hosts = TwoHosts {
            operator,
            arm,
            memory,
            rootless,
        };
        hosts.wire()?;
        Ok(hosts)
    }

    fn wire(&self) -> Result<(), String> {
        let [here, there] = [Host::Operator.device(), Host::Arm.device()];
        let arm = self.arm.0.id();
        self.shell(
            Host::Operator,
            &format!("ip link add {here} type veth peer name {there} netns {arm}"),
        )?;
        for host in [Host::Operator, Host::Arm] {
            let (device, address, memory) = (host.device(), host.address(), &self.memory);
            self.shell(
                host,
                &format!(
                    "ip addr add {address}/24 dev {device} && ip link set {device} up && ip link set lo up \
                     && mount -t tmpfs tmpfs /dev/shm && mount -t tmpfs tmpfs {memory}"
                ),
            )?;
        }
        Ok(())
    }

    /// Runs a line of shell on `host`.
    ///
    /// # Errors
    ///
    /// What it said on standard error.
    pub fn shell(&self, host: Host, line: &str) -> Result<String, String> {
        let output = self
            .command(host, &["sh", "-c", line])
            .output()
            .map_err(|error| format!("{line}: {error}"))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            return Err(format!("{line}: {}", said.trim()));
        }
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// Narrows the line out of `host` to `rate` \[bit/s\], with `queue` \[byte\] before it.
    ///
    /// # Errors
    ///
    /// What `tc` said.
    pub fn narrow(&self, host: Host, rate: f64, queue: u32) -> Result<(), String> {
        let device = host.device();
        self.shell(
            host,
            &format!(
                "tc qdisc add dev {device} root tbf rate {rate:.0}bit burst 1600 limit {queue}"
            ),
        )
        .map(drop)
    }

    /// From now on loses a share of the packets that come to `host`, in
    /// thousandths.
    ///
    /// # Errors
    ///
    /// What `nft` said.
    pub fn lose(&self, host: Host, thousandths: u32) -> Result<(), String> {
        let device = host.device();
        self.shell(
            host,
            &format!(
                "nft add table inet line && nft add chain inet line come '{{ type filter hook input priority 0; }}' \
                 && nft add rule inet line come iifname {device} numgen random mod 1000 '<' {thousandths} counter drop"
            ),
        )
        .map(drop)
    }

    /// `command` as it is run on `host`, with its environment and folder.
    pub fn on(&self, host: Host, command: &Command) -> Command {
        let folder = command.get_current_dir().unwrap_or(Path::new("/"));
        let mut inside = self.command(host, &["sh", "-c", "cd \"$0\" && exec \"$@\""]);
        inside.arg(folder);
        inside.arg(command.get_program()).args(command.get_args());
        for (name, value) in command.get_envs() {
            match value {
                Some(value) => inside.env(name, value),
                None => inside.env_remove(name),
            };
        }
        inside
    }

    /// Starts `command` on `host`.
    pub fn start(&self, host: Host, command: &Command) -> Process {
        Process::spawn(self.on(host, command))
    }

    fn command(&self, host: Host, words: &[&str]) -> Command {
        let holder = match host {
            Host::Operator => &self.operator,
            Host::Arm => &self.arm,
        };
        let mut command = enter(holder, self.rootless);
        command.args(words);
        command
    }
}

impl Drop for TwoHosts {
    fn drop(&mut self) {
        // Empty: what was mounted on it is seen by the hosts alone.
        let _ = fs::remove_dir(&self.memory);
    }
}

fn enter(holder: &Holder, rootless: bool) -> Command {
    let mut command = Command::new("nsenter");
    command.args(["--target", &holder.0.id().to_string(), "--net", "--mount"]);
    if rootless {
        command.args(["--user", "--preserve-credentials"]);
    }
    command.arg("--");
    command
}

/// Starts `command`, which makes a namespace and sleeps in it; waits until it
/// is neither in this one nor in one of `others`.
fn hold(mut command: Command, others: &[std::path::PathBuf]) -> Result<Holder, String> {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    // SAFETY: prctl takes no pointers here; it may be called after fork. Ends the
    // holder with the test, whatever ends the test.
    unsafe {
        command.pre_exec(|| {
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
            Ok(())
        });
    }
    let child = command
        .spawn()
        .map_err(|error| format!("cannot run {command:?}: {error}"))?;
    let mut holder = Holder(child);
    let here = fs::read_link("/proc/self/ns/net").map_err(|error| error.to_string())?;
    let process = holder.0.id();
    let mut ended = false;
    let there = wait_until(PATIENCE, || {
        ended = !matches!(holder.0.try_wait(), Ok(None));
        let sleeps = fs::read_to_string(format!("/proc/{process}/comm"))
            .is_ok_and(|name| name.trim() == "sleep");
        let apart = fs::read_link(format!("/proc/{process}/ns/net"))
            .is_ok_and(|own| own != here && !others.contains(&own));
        ended || (sleeps && apart)
    });
    if there && !ended {
        return Ok(holder);
    }
    let mut said = String::new();
    if ended && let Some(mut pipe) = holder.0.stderr.take() {
        // What it said is only for the message.
        let _ = std::io::Read::read_to_string(&mut pipe, &mut said);
    }
    Err(format!("no namespace: {}", said.trim()))
}

//! Two hosts on one machine: two network namespaces joined by a veth pair.
//!
//! Each host also has shared memory of its own. The namespaces have no names:
//! they live as long as the process that holds them, so that nothing stays
//! behind, however a test ends, and two tests never meet.

use std::{
    fs,
    os::unix::process::CommandExt,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

use crate::{Process, Session, wait_until};

/// How long a namespace may take to be there.
const PATIENCE: Duration = Duration::from_secs(10);

/// Names the folder with the keys of a host.
pub const LINK_KEYS: &str = "FERNTAST_LINK_KEYS";

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

    /// Where it has its keys of the link.
    pub fn keys(self, session: &Session) -> PathBuf {
        session.folder().join(format!("keys-{}", self.device()))
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
    rootless: bool,
}

impl TwoHosts {
    /// Makes them: an empty line without loss or limit.
    ///
    /// # Panics
    ///
    /// This machine does not allow it.
    #[expect(clippy::new_without_default, reason = "it makes what is outside")]
    pub fn new() -> TwoHosts {
        TwoHosts::made().unwrap_or_else(|error| {
            panic!(
                "this machine does not allow network namespaces ({error}); \
                 './tests/run --without-netns' does without this test"
            )
        })
    }

    fn made() -> Result<TwoHosts, String> {
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
            let (device, address) = (host.device(), host.address());
            self.shell(
                host,
                &format!(
                    "ip addr add {address}/24 dev {device} && ip link set {device} up && ip link set lo up \
                     && mount -t tmpfs tmpfs /dev/shm"
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
        let which = match thousandths {
            // What `numgen` cannot say.
            1000.. => String::new(),
            some => format!("numgen random mod 1000 '<' {some}"),
        };
        self.shell(
            host,
            &format!(
                "nft add table inet line && nft add chain inet line come '{{ type filter hook input priority 0; }}' \
                 && nft add rule inet line come iifname {device} {which} counter drop"
            ),
        )
        .map(drop)
    }

    /// Pulls the plug at `host`: its network device is down.
    ///
    /// # Errors
    ///
    /// What `ip` said.
    pub fn unplug(&self, host: Host) -> Result<(), String> {
        self.shell(host, &format!("ip link set {} down", host.device()))
            .map(drop)
    }

    /// Puts the plug in again.
    ///
    /// # Errors
    ///
    /// What `ip` said.
    pub fn plug(&self, host: Host) -> Result<(), String> {
        self.shell(host, &format!("ip link set {} up", host.device()))
            .map(drop)
    }

    /// From now on a share of the datagrams that `host` sends, in hundredths, goes out twice
    /// or, since the copy passes here too, more often.
    ///
    /// # Errors
    ///
    /// What `nft` said.
    pub fn duplicate(&self, host: Host, hundredths: u32) -> Result<(), String> {
        let device = host.device();
        self.shell(
            host,
            &format!(
                "nft 'add table netdev twice; \
                 add chain netdev twice go {{ type filter hook egress device {device} priority 0; }}; \
                 add rule netdev twice go ip protocol udp numgen random mod 100 < {hundredths} dup to {device}'"
            ),
        )
        .map(drop)
    }

    /// Nothing is lost or sent twice at `host` any more.
    ///
    /// # Errors
    ///
    /// What `nft` said.
    pub fn heal(&self, host: Host) -> Result<(), String> {
        self.shell(host, "nft flush ruleset").map(drop)
    }

    /// Each host makes its key and is told the other's, as people would do it.
    ///
    /// # Panics
    ///
    /// `ferntast link keys` fails.
    pub fn exchange_keys(&self, session: &Session) {
        let keys = |host: Host, arguments: &[&str]| {
            let mut command = session.ferntast(&["--json", "link", "keys"]);
            command.args(arguments).env(LINK_KEYS, host.keys(session));
            let output = command.output().expect("ferntast runs");
            assert!(output.status.success(), "{output:?}");
            let shown: serde_json::Value =
                serde_json::from_slice(&output.stdout).expect("JSON of link keys");
            shown["key"].as_str().expect("a key").to_owned()
        };
        let [operator, arm] = [Host::Operator, Host::Arm].map(|host| keys(host, &["new"]));
        keys(Host::Operator, &["add", "arm", &arm]);
        keys(Host::Arm, &["add", "operator", &operator]);
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
fn hold(mut command: Command, others: &[PathBuf]) -> Result<Holder, String> {
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

//! What can go wrong on two real hosts, and how it is done and undone.

use std::{fmt, fs, thread, time::Duration};

use ferntast_tests::{BusyLoops, Host, Member, Pair, limit_files};

/// Programs that want a processor, while the computer is busy.
const LOAD: usize = 30;
/// No file grows beyond this while the disk is full \[bytes\].
const FULL: u64 = 1 << 16;
/// The file that the clock of the operator's host is read from, where it may jump.
pub const CLOCK_FILE: &str = "operator-clock";

/// One thing that goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Nothing.
    Nothing,
    /// The operator says pause at the arm: no fault, but the arm is armed again after it as well.
    Pause,
    /// The process of a node is stopped, and goes on later.
    Stop(Member),
    /// A node is killed, and started again as by its supervisor.
    Kill(Member),
    /// Every node of a host is killed at once, and started again.
    LoseHost(Host),
    /// The network device of the arm's host is down.
    Unplug,
    /// Packets that come to these hosts are lost, in thousandths.
    Lose(&'static [Host], u32),
    /// Packets of both hosts are sent more than once, in hundredths.
    Duplicate(u32),
    /// The operator's recorder cannot write.
    FillDisk,
    /// The computer has far too much to do.
    Load,
    /// The clock of the operator's host jumps.
    JumpClock {
        /// To so far from the right time \[s\].
        to: f64,
    },
}

/// A fault while it lasts.
#[derive(Debug, Default)]
pub struct Lasting {
    _busy: Option<BusyLoops>,
}

const OPERATORS_RECORDER: Member = Member {
    host: Host::Operator,
    name: "recorder",
};

impl Fault {
    /// Whether the servo says nothing meanwhile.
    pub fn silences_servo(self) -> bool {
        match self {
            Fault::Stop(member) | Fault::Kill(member) => member.name == "servo",
            Fault::LoseHost(host) => host == Host::Arm,
            _ => false,
        }
    }

    /// Begins.
    pub fn begin(self, pair: &mut Pair) -> Lasting {
        match self {
            Fault::Nothing => {}
            Fault::Pause => pair.word(Host::Arm, "pause"),
            Fault::Stop(member) => pair.signal(member, libc::SIGSTOP),
            Fault::Kill(member) => pair.kill(member),
            Fault::LoseHost(host) => {
                for member in Member::ALL.into_iter().filter(|own| own.host == host) {
                    pair.kill(member);
                }
            }
            Fault::Unplug => done(pair.hosts.unplug(Host::Arm)),
            Fault::Lose(hosts, thousandths) => {
                for &host in hosts {
                    done(pair.hosts.lose(host, thousandths));
                }
            }
            Fault::Duplicate(hundredths) => {
                for host in [Host::Operator, Host::Arm] {
                    done(pair.hosts.duplicate(host, hundredths));
                }
            }
            Fault::FillDisk => {
                done(limit_files(pair.process(OPERATORS_RECORDER), FULL));
            }
            Fault::Load => {
                return Lasting {
                    _busy: Some(BusyLoops::start(LOAD)),
                };
            }
            Fault::JumpClock { to } => set_clock(pair, to),
        }
        Lasting::default()
    }

    /// Ends, but for what started again takes to be there.
    pub fn end(self, pair: &mut Pair, lasting: Lasting) {
        drop(lasting);
        match self {
            Fault::Stop(member) => pair.signal(member, libc::SIGCONT),
            Fault::Kill(_) | Fault::LoseHost(_) => pair.revive(),
            Fault::Unplug => done(pair.hosts.plug(Host::Arm)),
            Fault::Lose(..) | Fault::Duplicate(_) => {
                for host in [Host::Operator, Host::Arm] {
                    done(pair.hosts.heal(host));
                }
            }
            Fault::FillDisk => {
                let all = libc::RLIM_INFINITY;
                done(limit_files(pair.process(OPERATORS_RECORDER), all));
            }
            Fault::JumpClock { .. } => set_clock(pair, 0.0),
            Fault::Nothing | Fault::Pause | Fault::Load => {}
        }
    }
}

/// Says how far from the right time the clock of the operator's host is \[s\].
fn set_clock(pair: &Pair, offset: f64) {
    write_clock(&pair.folder().join(CLOCK_FILE), offset);
    // It is looked at once a second.
    thread::sleep(Duration::from_millis(1100));
}

/// Writes the file of a clock.
pub fn write_clock(path: &std::path::Path, offset: f64) {
    done(fs::write(path, format!("{offset:+}\n")));
}

fn done<T, E: fmt::Display>(result: Result<T, E>) {
    if let Err(error) = result {
        panic!("the fault cannot be made: {error}");
    }
}

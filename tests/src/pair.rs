//! A session's nodes on two hosts, with what a supervisor does there: one that dies is
//! started again.

use std::{
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use ferntast_msgs::Time;

use crate::{
    Deputy, Ended, Host, LINK_KEYS, PATIENCE, Process, Session, Sight, TwoHosts, run, signal,
    wait_until,
};

/// How long after its death a node is started again, as by the supervisor.
const RESTART_PAUSE: Duration = Duration::from_millis(200);
/// Between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// A node of the session, on its host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Where it runs.
    pub host: Host,
    /// Its name.
    pub name: &'static str,
}

impl Member {
    const fn new(host: Host, name: &'static str) -> Member {
        Member { host, name }
    }

    /// All, in the order in which they are started.
    pub const ALL: [Member; 8] = [
        Member::new(Host::Arm, "recorder"),
        Member::new(Host::Arm, "arm"),
        Member::new(Host::Arm, "servo"),
        Member::new(Host::Arm, "estimator"),
        Member::new(Host::Arm, "link_follower"),
        Member::new(Host::Operator, "recorder"),
        Member::new(Host::Operator, "link_leader"),
        Member::new(Host::Operator, "master"),
    ];
}

/// A word that was given, and when.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// When.
    pub at: Time,
    /// Whether it arms: `enable` or `resume`.
    pub arms: bool,
}

/// What the session is to be.
#[derive(Clone, Debug)]
pub struct PairOptions {
    /// The delay law that it starts with.
    pub law: String,
    /// A file with the motion of the hand.
    pub hand: String,
    /// Of the emulated channel \[ms\].
    pub round_trip_ms: f64,
    /// Program of a deputy (`CARGO_BIN_EXE_deputy`).
    pub deputy: PathBuf,
    /// Environment of the nodes on the operator's host.
    pub operator_environment: Vec<(String, String)>,
}

struct Running {
    member: Member,
    process: Option<Process>,
    /// How often it was started before.
    generation: u32,
    died: Option<Instant>,
}

/// The session. In this order its parts are dropped.
pub struct Pair {
    nodes: Vec<Running>,
    operator: Deputy,
    arm: Deputy,
    /// Every word that was given.
    pub words: Vec<Word>,
    options: PairOptions,
    /// The two hosts.
    pub hosts: TwoHosts,
    session: Session,
}

impl Pair {
    /// Starts it; it is armed by [`Pair::ready`].
    ///
    /// # Panics
    ///
    /// A node cannot be started.
    pub fn start(session: Session, options: PairOptions) -> Pair {
        let hosts = TwoHosts::new();
        hosts.exchange_keys(&session);
        let start = |member| Running {
            member,
            process: Some(start(&session, &hosts, &options, member, 0)),
            generation: 0,
            died: None,
        };
        let nodes = Member::ALL.map(start).into();
        let deputy = |host: Host, device: &str| {
            let mut command = std::process::Command::new(&options.deputy);
            command.args([session.name(), device]);
            Deputy::start(hosts.on(host, &command))
        };
        let operator = deputy(Host::Operator, "leader");
        let arm = deputy(Host::Arm, "follower");
        Pair {
            nodes,
            operator,
            arm,
            words: Vec::new(),
            options,
            hosts,
            session,
        }
    }

    /// The folder that it records into.
    pub fn folder(&self) -> &Path {
        self.session.folder()
    }

    /// How often nodes were started again.
    pub fn restarts(&self) -> u32 {
        self.nodes.iter().map(|own| own.generation).sum()
    }

    fn node(&mut self, member: Member) -> &mut Running {
        let found = self.nodes.iter_mut().find(|own| own.member == member);
        found.unwrap_or_else(|| panic!("no node {member:?}"))
    }

    /// Process id of a node.
    ///
    /// # Panics
    ///
    /// It does not run.
    pub fn process(&mut self, member: Member) -> i32 {
        let process = self.node(member).process.as_ref();
        let id = process.and_then(|own| i32::try_from(own.id()).ok());
        id.unwrap_or_else(|| panic!("{member:?} does not run"))
    }

    /// A signal to a node.
    pub fn signal(&mut self, member: Member, number: libc::c_int) {
        signal(self.process(member), number);
    }

    /// The node dies.
    pub fn kill(&mut self, member: Member) {
        let node = self.node(member);
        if let Some(process) = node.process.take() {
            process.crash();
            node.died = Some(Instant::now());
        }
    }

    /// Starts every node again that died, each after the supervisor's pause.
    pub fn revive(&mut self) {
        for place in 0..self.nodes.len() {
            let Some(died) = self.nodes[place].died.take() else {
                continue;
            };
            thread::sleep(RESTART_PAUSE.saturating_sub(died.elapsed()));
            let own = &mut self.nodes[place];
            own.generation += 1;
            let (member, generation) = (own.member, own.generation);
            let process = start(
                &self.session,
                &self.hosts,
                &self.options,
                member,
                generation,
            );
            self.nodes[place].process = Some(process);
        }
    }

    /// Runs `ferntast` with these arguments, on this session, on a host.
    pub fn command(&self, host: Host, arguments: &[&str]) -> Ended {
        let mut command = self.session.ferntast(arguments);
        command.args(["--session", self.session.name()]);
        self.hosts.start(host, &command).wait(PATIENCE)
    }

    /// Gives a word to the device of a host.
    pub fn word(&mut self, host: Host, word: &str) {
        let at = match host {
            Host::Operator => self.operator.word("leader", word),
            Host::Arm => self.arm.word("follower", word),
        };
        let arms = matches!(word, "enable" | "resume");
        self.words.push(Word { at, arms });
    }

    /// What is to be seen on a host.
    pub fn look(&mut self, host: Host) -> Sight {
        match host {
            Host::Operator => self.operator.look(),
            Host::Arm => self.arm.look(),
        }
    }

    /// Changes to another law.
    ///
    /// # Panics
    ///
    /// The link does not.
    pub fn rule(&mut self, law: &str) {
        self.operator.say(&format!("law {law}"));
        let changed = || self.operator.look().law.as_deref() == Some(law);
        assert!(wait_until(PATIENCE, changed), "the link stays with its law");
    }

    /// Whether both devices are ENABLED and the arm is commanded.
    pub fn is_ready(&mut self) -> bool {
        let (operator, arm) = (self.operator.look(), self.arm.look());
        let enabled = |own: &Sight| own.state.as_deref() == Some("ENABLED");
        enabled(&operator) && enabled(&arm) && arm.commanded
    }

    /// Arms it as an operator would, until it is commanded.
    ///
    /// # Panics
    ///
    /// It does not get there.
    pub fn ready(&mut self) {
        let mut steady = 0;
        let ready = wait_until(PATIENCE, || {
            for host in [Host::Operator, Host::Arm] {
                let word = match self.look(host).state.as_deref() {
                    Some("PAUSED") => "resume",
                    Some("FAULT") => "disable",
                    Some("DISABLED") => "enable",
                    _ => continue,
                };
                self.word(host, word);
            }
            thread::sleep(LOOK);
            steady = if self.is_ready() { steady + 1 } else { 0 };
            steady >= 3
        });
        assert!(
            ready,
            "it cannot be armed: {:?}, {:?}",
            self.operator.look(),
            self.arm.look()
        );
    }

    /// Ends it; gives the folders that were recorded, the operator's and the arm's, and the
    /// session with them.
    ///
    /// # Panics
    ///
    /// A node does not end.
    pub fn finish(self) -> (Session, [Vec<PathBuf>; 2]) {
        let Pair {
            nodes,
            operator,
            arm,
            hosts,
            session,
            ..
        } = self;
        drop((operator, arm));
        let generations = |host: Host| {
            let recorder = Member::new(host, "recorder");
            let found = nodes.iter().find(|own| own.member == recorder);
            found.map_or(0, |own| own.generation)
        };
        let generations = [Host::Operator, Host::Arm].map(generations);
        // Recorders last.
        let (recorders, others): (Vec<_>, Vec<_>) = nodes
            .into_iter()
            .partition(|own| own.member.name == "recorder");
        for nodes in [others, recorders] {
            let processes = nodes.into_iter().filter_map(|own| own.process);
            let processes: Vec<Process> = processes.collect();
            for process in &processes {
                process.interrupt();
            }
            for process in processes {
                process.wait(PATIENCE);
            }
        }
        drop(hosts);
        let hosts = [Host::Operator, Host::Arm].into_iter().zip(generations);
        let parts = hosts.map(|(host, last)| {
            let parts = (0..=last).map(|generation| part(host, generation));
            let parts: Vec<String> = parts.collect();
            // One that was killed, or whose disk was full, did not close its own.
            for part in &parts {
                let path = session.folder().join(part);
                if !ferntast_bag::info(&path).is_ok_and(|info| info.closed) {
                    run(&session, &["bag", "repair", part, "--json"]).success();
                }
            }
            parts
                .iter()
                .map(|part| session.folder().join(part))
                .collect()
        });
        let parts: Vec<Vec<PathBuf>> = parts.collect();
        let [operator, arm] = <[_; 2]>::try_from(parts).unwrap_or_default();
        (session, [operator, arm])
    }
}

/// The folder that a recorder on `host` writes when it was started so often before.
fn part(host: Host, generation: u32) -> String {
    match generation {
        0 => host.device().to_owned(),
        again => format!("{}_restart_{again}", host.device()),
    }
}

fn start(
    session: &Session,
    hosts: &TwoHosts,
    options: &PairOptions,
    member: Member,
    generation: u32,
) -> Process {
    let Member { host, name } = member;
    let mut command = session.ferntast(&["node", name, "--session", session.name()]);
    command.env(LINK_KEYS, host.keys(session));
    // Over UDP what is lost stays lost.
    let endpoint = format!("sealed-udp/{}:7448", Host::Arm.address());
    let round_trip = options.round_trip_ms.to_string();
    command.args(["--law", &options.law, "--hand", &options.hand]);
    command.args(["--rtt", &round_trip, "--link-endpoint", &endpoint]);
    command.args(["--generation", &generation.to_string()]);
    if name == "recorder" {
        command.args(["--bag", host.device()]);
    }
    if host == Host::Operator {
        let environment = options.operator_environment.iter();
        command.envs(environment.map(|(name, value)| (name, value)));
    }
    hosts.start(host, &command)
}

//! The table of faults: what goes wrong with whom, how often, and what has to hold then.

use std::time::Duration;

use ferntast_control::delay::Law;
use ferntast_tests::{Host, Member};

use super::fault::Fault;

/// What the arm has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Must {
    /// Hold in time, and stay so until an operator says otherwise.
    Hold,
    /// Go on as if nothing were.
    GoOn,
    /// Either.
    HoldOrGoOn,
}

impl Must {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Must::Hold => "holds, stays so",
            Must::GoOn => "goes on",
            Must::HoldOrGoOn => "goes on, or holds and stays so",
        }
    }
}

/// The clock of the operator's host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clock {
    /// Right.
    Right,
    /// So far from that of the arm's host \[s\].
    Ahead(f64),
    /// Faster by so many millionths.
    Fast(f64),
    /// Read from a file, so that it may jump.
    Jumps,
}

/// A row: repetitions of one fault.
#[derive(Clone, Debug)]
pub struct Row {
    /// What goes wrong, in words.
    pub fault_words: &'static str,
    /// With whom.
    pub party: String,
    /// What goes wrong.
    pub fault: Fault,
    /// How long.
    pub lasts: Duration,
    /// How often, under each law.
    pub times: usize,
    /// Under which laws.
    pub laws: &'static [&'static str],
    /// What the arm has to do.
    pub must: Must,
    /// From the fault to the hold at most, where that is bounded \[s\].
    pub by_fault: Option<f64>,
    /// Only while the arm presses.
    pub pressing: bool,
    /// Clock of the operator's host.
    pub clock: Clock,
}

const ONE_LAW: &[&str] = &["position_force"];
const WORDLESS: Duration = Duration::from_millis(80);
/// From the servo's last measurement to its fault: its watchdog of 20 ms, and a step or two.
const UNMEASURED: f64 = 0.025;

/// The node `name` of the host `host`.
pub const fn member(host: Host, name: &'static str) -> Member {
    Member { host, name }
}

const MASTER: Member = member(Host::Operator, "master");
const LINK_LEADER: Member = member(Host::Operator, "link_leader");
const LINK_FOLLOWER: Member = member(Host::Arm, "link_follower");
const SERVO: Member = member(Host::Arm, "servo");
const ESTIMATOR: Member = member(Host::Arm, "estimator");
const ARM: Member = member(Host::Arm, "arm");
const RECORDERS: [Member; 2] = [
    member(Host::Arm, "recorder"),
    member(Host::Operator, "recorder"),
];
const BOTH: &[Host] = &[Host::Operator, Host::Arm];
const TO_ARM: &[Host] = &[Host::Arm];
const TO_OPERATOR: &[Host] = &[Host::Operator];

impl Row {
    fn new(fault_words: &'static str, party: impl Into<String>, fault: Fault, must: Must) -> Row {
        Row {
            fault_words,
            party: party.into(),
            fault,
            lasts: Duration::from_millis(150),
            times: 20,
            laws: ONE_LAW,
            must,
            by_fault: None,
            pressing: false,
            clock: Clock::Right,
        }
    }

    fn lasting(self, ms: u64, times: usize) -> Row {
        Row {
            lasts: Duration::from_millis(ms),
            times,
            ..self
        }
    }

    fn clock(self, clock: Clock) -> Row {
        Row { clock, ..self }
    }

    /// Its name, for people and for the filter.
    pub fn name(&self) -> String {
        format!("{}: {}", self.fault_words, self.party)
    }

    fn stop(member: Member) -> Row {
        let must = match member.name {
            // A servo that did not run goes on when the others are heard at once; without
            // estimates a law may go on, or hold.
            "servo" | "estimator" => Must::HoldOrGoOn,
            "recorder" => Must::GoOn,
            _ => Must::Hold,
        };
        let row = Row::new(
            "stopped (SIGSTOP)",
            party(member),
            Fault::Stop(member),
            must,
        );
        Row {
            by_fault: (member == ARM).then_some(UNMEASURED),
            ..row
        }
    }

    fn kill(member: Member) -> Row {
        let must = match member.name {
            "estimator" => Must::HoldOrGoOn,
            "recorder" => Must::GoOn,
            _ => Must::Hold,
        };
        let row = Row::new("killed (SIGKILL)", party(member), Fault::Kill(member), must);
        Row {
            by_fault: (member == ARM).then_some(UNMEASURED),
            ..row
        }
    }
}

fn party(member: Member) -> String {
    match member {
        Member {
            host: Host::Arm,
            name: "recorder",
        } => "recorder of the arm's host".to_owned(),
        Member {
            name: "recorder", ..
        } => "recorder of the operator's host".to_owned(),
        own => own.name.to_owned(),
    }
}

/// Nothing goes wrong, for some strokes of the hand, and while the operator arms the pressing
/// arm again: what the others are held against.
pub fn calm() -> [Row; 2] {
    let calm = Row::new("nothing", "–", Fault::Nothing, Must::GoOn);
    let pause = Row::new(
        "nothing, but pause and resume while the arm presses",
        "the operator",
        Fault::Pause,
        Must::HoldOrGoOn,
    );
    let pause = Row {
        pressing: true,
        ..pause
    };
    [calm.lasting(5600, 8), pause]
}

/// Every row in which something goes wrong again and again.
pub fn rows() -> Vec<Row> {
    let nodes = [MASTER, LINK_LEADER, LINK_FOLLOWER, SERVO, ESTIMATOR, ARM];
    let mut rows = Vec::new();
    rows.extend(nodes.map(Row::kill));
    rows.extend(RECORDERS.map(|own| Row {
        times: 10,
        ..Row::kill(own)
    }));
    rows.extend(nodes.map(Row::stop));
    rows.extend(RECORDERS.map(|own| Row {
        times: 10,
        ..Row::stop(own)
    }));
    for host in [Host::Operator, Host::Arm] {
        // The arm's recorder dies with the rest and takes along what it had not written.
        let (party, must) = match host {
            Host::Operator => ("the operator's host", Must::Hold),
            Host::Arm => ("the arm's host", Must::HoldOrGoOn),
        };
        let row = Row::new(
            "all nodes killed at once",
            party,
            Fault::LoseHost(host),
            must,
        );
        rows.push(row.lasting(300, 5));
    }
    rows.push(
        Row::new(
            "device down",
            "veth of the arm's host",
            Fault::Unplug,
            Must::Hold,
        )
        .lasting(200, 20),
    );
    rows.push(
        Row::new(
            "device down for 3 s",
            "veth of the arm's host",
            Fault::Unplug,
            Must::Hold,
        )
        .lasting(3000, 3),
    );
    let loss = |words, party: &str, hosts, thousandths, must| {
        Row::new(words, party, Fault::Lose(hosts, thousandths), must)
    };
    rows.push(
        loss(
            "5 % of packets lost",
            "both ways",
            BOTH,
            50,
            Must::HoldOrGoOn,
        )
        .lasting(2000, 3),
    );
    rows.push(
        loss(
            "5 % of packets lost",
            "to the arm",
            TO_ARM,
            50,
            Must::HoldOrGoOn,
        )
        .lasting(2000, 3),
    );
    rows.push(
        loss(
            "30 % of packets lost",
            "both ways",
            BOTH,
            300,
            Must::HoldOrGoOn,
        )
        .lasting(2000, 3),
    );
    rows.push(
        loss(
            "30 % of packets lost",
            "to the arm",
            TO_ARM,
            300,
            Must::HoldOrGoOn,
        )
        .lasting(2000, 3),
    );
    rows.push(loss(
        "all packets lost",
        "both ways",
        BOTH,
        1000,
        Must::Hold,
    ));
    rows.push(loss(
        "all packets lost",
        "to the arm",
        TO_ARM,
        1000,
        Must::Hold,
    ));
    rows.push(loss(
        "all packets lost",
        "to the operator",
        TO_OPERATOR,
        1000,
        Must::Hold,
    ));
    rows.push(
        Row::new(
            "30 % of packets doubled",
            "both ways",
            Fault::Duplicate(30),
            Must::GoOn,
        )
        .lasting(2000, 3),
    );
    rows.push(
        Row::new(
            "99 % of packets doubled",
            "both ways",
            Fault::Duplicate(99),
            Must::GoOn,
        )
        .lasting(2000, 3),
    );
    rows.push(
        Row::new(
            "disk full",
            "recorder of the operator's host",
            Fault::FillDisk,
            Must::GoOn,
        )
        .lasting(1000, 3),
    );
    let clock = "clock of the operator's host";
    for (words, set) in [
        ("10 s ahead", Clock::Ahead(10.0)),
        ("10 s behind", Clock::Ahead(-10.0)),
        ("0.2 s behind", Clock::Ahead(-0.2)),
        ("100 ppm fast", Clock::Fast(100.0)),
    ] {
        rows.push(
            Row::new(words, clock, Fault::Nothing, Must::GoOn)
                .lasting(5000, 2)
                .clock(set),
        );
    }
    let jump = Fault::JumpClock { to: 0.2 };
    rows.push(
        Row::new("jumps by 0.2 s", clock, jump, Must::HoldOrGoOn)
            .lasting(2000, 3)
            .clock(Clock::Jumps),
    );
    rows.push(
        Row::new(
            "30 busy loops",
            "both processors",
            Fault::Load,
            Must::HoldOrGoOn,
        )
        .lasting(10_000, 2),
    );
    let kills = [SERVO, LINK_FOLLOWER, ESTIMATOR, LINK_LEADER, MASTER];
    rows.extend(kills.map(|own| Row {
        fault_words: "killed while the arm presses",
        pressing: true,
        times: 8,
        ..Row::kill(own)
    }));
    rows
}

/// The parties whose silence is measured under every law.
pub fn silences(times: usize) -> Vec<Row> {
    let all = [
        ("master stopped", Fault::Stop(MASTER)),
        ("link_leader stopped", Fault::Stop(LINK_LEADER)),
        ("link_follower stopped", Fault::Stop(LINK_FOLLOWER)),
        ("link cut both ways", Fault::Lose(BOTH, 1000)),
        ("return link cut", Fault::Lose(TO_OPERATOR, 1000)),
    ];
    let row = |(party, fault)| Row {
        lasts: WORDLESS,
        times,
        laws: Law::NAMES,
        ..Row::new("time to hold", party, fault, Must::Hold)
    };
    all.into_iter().map(row).collect()
}

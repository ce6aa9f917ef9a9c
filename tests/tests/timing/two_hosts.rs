//! The two ends of the link on two hosts, over a line that loses packets and
//! is narrow: as in lockstep with a channel that is said to do the same.
//!
//! The hosts are network namespaces (see [`TwoHosts`]). Where the machine does
//! not allow them the test fails and says so; `./tests/run --without-netns`
//! leaves it out, and says that too.

use std::{fs, path::Path, thread, time::Duration};

use ferntast_msgs::{
    Time,
    sample::{LinkStatusSample, OperatingState},
    topics::{self, Topic},
};
use ferntast_tests::{
    Host, LINK_KEYS, Machine, PATIENCE, Process, Session, TwoHosts, messages, run, wait_until,
};

/// What is looked at, from when the master is armed \[s\].
const SECONDS: f64 = 10.0;
/// Lost each way, in thousandths.
const LOSS: u32 = 50;
/// Rate of the line each way \[bit/s\].
const RATE: f64 = 1e6;
/// Bytes before the line.
const QUEUE: u32 = 3000;
/// Each way, emulated by both \[s\].
const DELAY: f64 = 0.05;
/// Bytes that a frame of 60 costs on the wire besides: Zenoh 37, QUIC 30 (header, tag and
/// now and then an acknowledgement), UDP 8, IP 20, Ethernet 14.
const OVERHEAD: u32 = 109;

/// What a run comes to.
#[derive(Debug)]
struct Behaviour {
    round_trip: f64,
    lost_up: f64,
    lost_down: f64,
    peak_normal_force: f64,
    contact_time: f64,
    peak_hand_force: f64,
    energy_in: f64,
}

/// Of the recordings at the operator's and at the arm's host.
fn behaviour(operator: &Path, arm: &Path) -> Behaviour {
    let armed = messages(operator, topics::LEADER_OPERATING_STATE)
        .into_iter()
        .find(|own| own.message.state == OperatingState::ENABLED)
        .expect("the master is armed")
        .message
        .stamp;
    // The first second is the script's pause, and in it the losses begin.
    let seen = |stamp: Time| (1.0..SECONDS).contains(&stamp.seconds_since(armed));
    let status = |path: &Path, topic: Topic<LinkStatusSample>| -> Vec<LinkStatusSample> {
        let all = messages(path, topic).into_iter().map(|own| own.message);
        all.filter(|own| seen(own.stamp)).collect()
    };
    let lost = |all: &[LinkStatusSample]| {
        let [first, .., last] = all else {
            panic!("no link status");
        };
        let lost = (last.lost - first.lost) as f64;
        lost / (lost + (last.received - first.received) as f64)
    };
    let leader = status(operator, topics::LINK_STATUS);
    let follower = status(arm, topics::LINK_FOLLOWER_STATUS);
    let mut round_trips: Vec<f64> = leader.iter().map(|own| own.round_trip).collect();
    round_trips.sort_by(f64::total_cmp);
    let contact: Vec<_> = messages(arm, topics::FOLLOWER_CONTACT_STATE)
        .into_iter()
        .map(|own| own.message)
        .filter(|own| seen(own.stamp))
        .collect();
    let touching = || {
        contact
            .iter()
            .filter(|own| own.in_contact == 1 && own.valid == 1)
    };
    let forces = messages(operator, topics::LEADER_SERVO_CF).into_iter();
    Behaviour {
        round_trip: round_trips[round_trips.len() / 2],
        lost_up: lost(&follower),
        lost_down: lost(&leader),
        peak_normal_force: touching().map(|own| own.normal_force).fold(0.0, f64::max),
        contact_time: touching().count() as f64 / contact.len() as f64 * (SECONDS - 1.0),
        peak_hand_force: forces
            .filter(|own| seen(own.message.stamp))
            .map(|own| own.message.force.map(|f| f * f).iter().sum::<f64>().sqrt())
            .fold(0.0, f64::max),
        energy_in: leader.last().expect("status").energy_in - leader[0].energy_in,
    }
}

/// A link file; `whole` with the losses and the narrow line, else only the delay.
fn link(folder: &Path, name: &str, whole: bool) -> String {
    let loss = f64::from(LOSS) / 1000.0;
    let mut text = String::new();
    for way in ["up", "down"] {
        text += &format!("[{way}]\ndelay = {DELAY}\n");
        if whole {
            text += &format!(
                "loss = {{ kind = \"independent\", probability = {loss} }}\n\
                 bandwidth = {{ rate = {RATE:e}, queue = {QUEUE}, overhead = {OVERHEAD} }}\n"
            );
        }
    }
    let path = folder.join(name);
    fs::write(&path, text).expect("the link's file");
    path.to_str().expect("a path in UTF-8").to_owned()
}

fn in_lockstep(session: &Session) -> Behaviour {
    let link = link(session.folder(), "lockstep.toml", true);
    let arguments = [
        "lockstep",
        "--law",
        "wave",
        "--link",
        &link,
        "--duration",
        "11",
    ];
    let arguments = [&arguments[..], &["--record", "lockstep", "--json"]].concat();
    run(session, &arguments).success();
    let path = session.folder().join("lockstep");
    behaviour(&path, &path)
}

/// Runs the session's nodes on the two hosts, with what `hosts` does to the line.
fn on_two_hosts(session: &Session, hosts: &TwoHosts) -> Behaviour {
    let link = link(session.folder(), "delay.toml", false);
    let endpoint = format!("quic/{}:7448", Host::Arm.address());
    hosts.exchange_keys(session);
    let node = |host: Host, name: &str| {
        let mut command = session.ferntast(&["node", name, "--session", session.name()]);
        command.env(LINK_KEYS, Host::keys(host, session));
        command.args([
            "--law",
            "wave",
            "--link",
            &link,
            "--link-endpoint",
            &endpoint,
        ]);
        if name == "recorder" {
            command.args(["--bag", host.device()]);
        }
        hosts.start(host, &command)
    };
    let mut nodes: Vec<Process> = Vec::new();
    for name in ["arm", "servo", "estimator", "recorder", "link_follower"] {
        nodes.push(node(Host::Arm, name));
    }
    for name in ["recorder", "link_leader", "master"] {
        nodes.push(node(Host::Operator, name));
    }
    // Frames get through; on this host the other end's status is not to be had.
    let connected = || {
        let arguments = ["link", "law", "--session", session.name(), "--json"];
        let asked = hosts.start(Host::Operator, &session.ferntast(&arguments));
        asked.wait(PATIENCE).status.success()
    };
    assert!(
        wait_until(PATIENCE, connected),
        "the operator's end is silent"
    );
    thread::sleep(Duration::from_secs(2));
    // A fault from the moments in which the nodes were being started is left by
    // disabling first.
    let enable = |host, device| {
        let tell = |word| {
            let arguments = ["state", device, word, "--session", session.name(), "--json"];
            let told = hosts.start(host, &session.ferntast(&arguments));
            told.wait(PATIENCE).status.success()
        };
        let enabled = wait_until(PATIENCE, || {
            let done = tell("enable");
            if !done {
                tell("disable");
            }
            done
        });
        assert!(enabled, "{device} cannot be enabled");
    };
    enable(Host::Operator, "leader");
    enable(Host::Arm, "follower");
    for host in [Host::Operator, Host::Arm] {
        hosts
            .lose(host, LOSS)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    thread::sleep(Duration::from_secs_f64(SECONDS + 1.0));
    for process in nodes.iter().rev() {
        process.interrupt();
    }
    for process in nodes.into_iter().rev() {
        process.wait(PATIENCE).success();
    }
    let folder = session.folder();
    behaviour(
        &folder.join(Host::Operator.device()),
        &folder.join(Host::Arm.device()),
    )
}

fn near(what: &str, found: f64, expected: f64, share: f64) {
    assert!(
        (found - expected).abs() <= share * expected.abs(),
        "{what}: {found} on two hosts, {expected} in lockstep (bound {share})"
    );
}

#[test]
fn behave_as_in_lockstep() {
    let machine = Machine::alone();
    // A hold that the machine causes ends the motion.
    machine.undisturbed(|| {
        let session = Session::new();
        let hosts = TwoHosts::new();
        for host in [Host::Operator, Host::Arm] {
            hosts
                .narrow(host, RATE, QUEUE)
                .unwrap_or_else(|error| panic!("{error}"));
        }
        let expected = in_lockstep(&session);
        let found = on_two_hosts(&session, &hosts);
        println!("on two hosts {found:#?}\nin lockstep {expected:#?}");
        let loss = f64::from(LOSS) / 1000.0;
        for (what, lost) in [("up", found.lost_up), ("down", found.lost_down)] {
            // 4500 frames: a standard deviation of 0.3 percent.
            assert!((lost - loss).abs() < 0.02, "{what}: {lost} lost");
        }
        // A token bucket lets a single frame through at once, a line of that rate
        // takes time for it, each way.
        let sending = 2.0 * 8.0 * f64::from(60 + OVERHEAD) / RATE;
        let late = found.round_trip - (expected.round_trip - sending);
        assert!(
            (-0.0005..0.004).contains(&late),
            "{late} s later than in lockstep"
        );
        near(
            "peak normal force",
            found.peak_normal_force,
            expected.peak_normal_force,
            0.15,
        );
        near(
            "contact time",
            found.contact_time,
            expected.contact_time,
            0.1,
        );
        near(
            "peak force in the hand",
            found.peak_hand_force,
            expected.peak_hand_force,
            // Of an impact: what both hosts are late by in its milliseconds shows.
            0.3,
        );
        near(
            "energy from the hand",
            found.energy_in,
            expected.energy_in,
            0.2,
        );
        assert!(found.peak_normal_force > 2.0, "nothing was touched");
    });
}

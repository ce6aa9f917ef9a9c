//! Gives words on a host and says what is to be seen there. `deputy SESSION DEVICE`, where the
//! device is the one of that host; a line in, a line of JSON out, until the input ends:
//! `follower resume`, `leader enable`, `law wave`, `look`.

use std::{
    io::{BufRead, Write},
    time::{Duration, Instant},
};

use ferntast_bus::{Bus, CreateError, Depth, Publisher, SharedMemoryBus, Subscriber};
use ferntast_msgs::{
    Message, Text,
    sample::{
        ContactStateSample, JointSample, LawCommandSample, LinkStatusSample, OperatingStateSample,
        PoseSample, StateCommand, StateCommandSample, WrenchSample,
    },
    topics,
};
use ferntast_tests::{PATIENCE, now, wait_for};
use serde_json::{Value, json};

/// Who says something in every step is heard of as often.
const LATELY: Duration = Duration::from_millis(15);

/// Who is there and what is said.
struct Deputy {
    device: String,
    follower: Publisher<StateCommandSample>,
    leader: Publisher<StateCommandSample>,
    law: Publisher<LawCommandSample>,
    states: Subscriber<OperatingStateSample>,
    /// What the servo, or the master, says in every step.
    torques: Subscriber<JointSample>,
    forces: Subscriber<WrenchSample>,
    commands: Subscriber<PoseSample>,
    contacts: Subscriber<ContactStateSample>,
    link: Subscriber<LinkStatusSample>,
    state: Option<String>,
    ruling: Option<String>,
    force: f64,
    /// When the device, and when a command, was last heard of.
    spoke: Option<Instant>,
    commanded: Option<Instant>,
}

impl Deputy {
    fn open(bus: &Bus, device: &str) -> Result<Deputy, CreateError> {
        let states = match device {
            "leader" => topics::LEADER_OPERATING_STATE,
            _ => topics::FOLLOWER_OPERATING_STATE,
        };
        Ok(Deputy {
            device: device.to_owned(),
            follower: bus.publisher(topics::FOLLOWER_STATE_COMMAND)?,
            leader: bus.publisher(topics::LEADER_STATE_COMMAND)?,
            law: bus.publisher(topics::LINK_LAW_COMMAND)?,
            states: bus.subscriber(states, Depth::Newest)?,
            torques: bus.subscriber(topics::FOLLOWER_SERVO_JF, Depth::Newest)?,
            forces: bus.subscriber(topics::LEADER_SERVO_CF, Depth::Newest)?,
            commands: bus.subscriber(topics::FOLLOWER_SERVO_CP, Depth::Newest)?,
            contacts: bus.subscriber(topics::FOLLOWER_CONTACT_STATE, Depth::Newest)?,
            link: bus.subscriber(topics::LINK_STATUS, Depth::Newest)?,
            state: None,
            ruling: None,
            force: 0.0,
            spoke: None,
            commanded: None,
        })
    }

    fn obey(&mut self, line: &str) -> Value {
        let mut words = line.split_whitespace();
        match (words.next(), words.next()) {
            (Some("look"), None) => self.look(),
            (Some("law"), Some(name)) => {
                let stamp = now();
                let command = LawCommandSample {
                    stamp,
                    law: Text::new(name),
                };
                told(self.law.publish(stamp, &command).is_ok(), stamp.nanos())
            }
            (Some(device), Some(word)) => match StateCommand::from_name(word) {
                Some(command) => {
                    let stamp = now();
                    let publisher = match device {
                        "leader" => &mut self.leader,
                        _ => &mut self.follower,
                    };
                    let sample = StateCommandSample::new(stamp, command);
                    told(publisher.publish(stamp, &sample).is_ok(), stamp.nanos())
                }
                None => json!({ "error": format!("no word {word:?}") }),
            },
            _ => json!({ "error": "DEVICE WORD, law NAME, or look" }),
        }
    }

    fn look(&mut self) -> Value {
        if let Some(own) = newest(&mut self.states) {
            self.state = own.state.name().map(str::to_owned);
        }
        if let Some(own) = newest(&mut self.link) {
            self.ruling = Some(own.law.to_string());
        }
        if let Some(own) = newest(&mut self.contacts) {
            let touches = own.in_contact == 1 && own.valid == 1;
            self.force = if touches { own.normal_force } else { 0.0 };
        }
        let spoke = match self.device.as_str() {
            "leader" => newest(&mut self.forces).is_some(),
            _ => newest(&mut self.torques).is_some(),
        };
        note(&mut self.spoke, spoke);
        note(&mut self.commanded, newest(&mut self.commands).is_some());
        // A state lasts; a device that is dead or stopped has none.
        json!({
            "state": self.state.as_ref().filter(|_| lately(self.spoke)),
            "law": self.ruling,
            "commanded": lately(self.commanded),
            "force": self.force,
        })
    }
}

fn note(heard: &mut Option<Instant>, now: bool) {
    if now {
        *heard = Some(Instant::now());
    }
}

fn lately(heard: Option<Instant>) -> bool {
    heard.is_some_and(|at| at.elapsed() < LATELY)
}

fn newest<M: Message>(subscriber: &mut Subscriber<M>) -> Option<M> {
    subscriber.newest(now()).map(|own| own.message)
}

fn told(said: bool, at: i64) -> Value {
    match said {
        true => json!({ "at": at }),
        false => json!({ "error": "it could not be said" }),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, session, device] = &arguments[..] else {
        panic!("deputy SESSION DEVICE");
    };
    let visit = || SharedMemoryBus::visit(session).ok().flatten();
    let bus = wait_for(PATIENCE, visit).expect("a session of that name on this host");
    let bus = Bus::SharedMemory(bus);
    let mut deputy = Deputy::open(&bus, device).expect("topics");
    let mut output = std::io::stdout();
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let answer = deputy.obey(&line);
        if writeln!(output, "{answer}")
            .and_then(|()| output.flush())
            .is_err()
        {
            break;
        }
    }
}

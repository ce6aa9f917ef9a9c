//! Messages of every type, and recordings made of them.

#![allow(dead_code)] // Each test uses its part.

use std::{any::Any, error::Error, path::Path};

use ferntast_bag::{BagOptions, BagSummary, BagWriter};
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        Fault, Faults, Frame, HealthSample, JointNames, JointSample, LawCommandSample, Level,
        OperatingState, OperatingStateSample, PoseSample, RobotDescriptionSample, Rule,
        StateCommand, StateCommandSample, TransformsSample, WrenchSample,
    },
    topics::{self, Topic, Visitor},
};

/// When the sample recordings begin: 2025-01-01 00:00:00 UTC.
pub const START: Time = Time::from_nanos(1_735_689_600_000_000_000);

/// The arm's joints.
fn joints() -> JointNames {
    JointNames::numbered(2)
}

/// Number of topics, and so of messages in one round.
pub fn topic_count() -> usize {
    struct Count(usize);
    impl Visitor for Count {
        fn topic<M: Message>(&mut self, _: Topic<M>) {
            self.0 += 1;
        }
    }
    let mut count = Count(0);
    topics::visit(&joints(), &mut count).expect("numbered joints");
    count.0
}

/// The `k`-th message of any type of the table, all fields distinct.
pub fn sample<M: Message>(k: u32, stamp: Time) -> Option<M> {
    let x = f64::from(k);
    pick(joint(x, stamp))
        .or_else(|| pick(pose(x, stamp)))
        .or_else(|| pick(wrench(x, stamp)))
        .or_else(|| pick(operating_state(k, stamp)))
        .or_else(|| pick(state_command(k, stamp)))
        .or_else(|| pick(law_command(k, stamp)))
        .or_else(|| pick(health(k, stamp)))
        .or_else(|| pick(transforms(x, stamp)))
        .or_else(|| pick(robot_description(k)))
        .or_else(|| declared(k, stamp))
}

/// A message that is declared with its rules (`#[message]`), all numbers distinct.
fn declared<M: Message>(k: u32, stamp: Time) -> Option<M> {
    let mut bytes = vec![0_u8; size_of::<M>()];
    for (i, field) in M::FIELDS.iter().enumerate() {
        let place = &mut bytes[field.offset..field.offset + field.size];
        let number = f64::from(k) + 0.25 + i as f64;
        match field.rule {
            Rule::Stamp => place.copy_from_slice(&stamp.nanos().to_ne_bytes()),
            Rule::Number { .. } | Rule::Numbers => {
                place[..8].copy_from_slice(&number.to_ne_bytes());
            }
            Rule::Count { .. } => place.copy_from_slice(&1_u32.to_ne_bytes()),
            Rule::Text { .. } | Rule::Texts { .. } => place[..4].copy_from_slice(b"text"),
            Rule::Codes(codes) => place[0] = codes[k as usize % codes.len()],
            Rule::Anything => place[0] = i as u8,
            Rule::Flag => place[0] = 1,
            Rule::Local => {}
        }
    }
    // SAFETY: as long as the sample, of which every bit pattern is a value.
    let sample = unsafe { bytes.as_ptr().cast::<M>().read_unaligned() };
    (!M::FIELDS.is_empty()).then_some(sample)
}

fn pick<M: Message, T: Message>(value: T) -> Option<M> {
    (&value as &dyn Any).downcast_ref::<M>().copied()
}

pub fn joint(x: f64, stamp: Time) -> JointSample {
    JointSample::empty(joints(), stamp)
        .with_position([0.25 + x, -0.5 - x])
        .with_velocity([1.5 + x, -2.5 - x])
        .with_effort([10.5 + x, -20.25 - x])
}

fn pose(x: f64, stamp: Time) -> PoseSample {
    PoseSample {
        stamp,
        position: [0.5 + x, 0.125, 0.0],
        orientation: [0.0, 0.0, 0.0, 1.0],
        source: 0,
        frame: Frame::FOLLOWER_BASE,
        reserved: [0; 7],
    }
}

fn transforms(x: f64, stamp: Time) -> TransformsSample {
    let about_z = |angle: f64| [0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()];
    TransformsSample::planar(
        stamp,
        [[x, 0.0, 0.0], [0.25, x, 0.0], [0.25, 0.0, x]],
        [about_z(x), about_z(0.5 * x), about_z(0.1)],
    )
}

fn robot_description(k: u32) -> RobotDescriptionSample {
    RobotDescriptionSample {
        urdf: Text::new(&format!("<robot name=\"arm {k}\"/>")),
    }
}

fn wrench(x: f64, stamp: Time) -> WrenchSample {
    WrenchSample {
        stamp,
        force: [3.5 + x, -4.5, 0.0],
        torque: [0.0, 0.0, 0.75],
        frame: Frame::CONTACT,
        reserved: [0; 7],
    }
}

pub fn operating_state(k: u32, stamp: Time) -> OperatingStateSample {
    OperatingStateSample {
        stamp,
        state: OperatingState((k % 4) as u8),
        is_homed: 1,
        is_busy: 0,
        reserved: [0; 5],
        // The CRTK type has no room for a reason.
        reason: Text::EMPTY,
    }
}

pub fn state_command(k: u32, stamp: Time) -> StateCommandSample {
    StateCommandSample {
        stamp,
        command: StateCommand((k % 4 + 1) as u8),
        reserved: [0; 7],
    }
}

pub fn law_command(k: u32, stamp: Time) -> LawCommandSample {
    LawCommandSample {
        stamp,
        law: Text::display(format_args!("law_{k}")),
    }
}

fn health(k: u32, stamp: Time) -> HealthSample {
    let mut faults = Faults::default();
    faults.set(Fault::DeadlineMissed);
    HealthSample {
        stamp,
        rate: 999.5,
        lateness_p99: 0.000_02,
        input_age: 0.001,
        missed: u64::from(k),
        refused: 2,
        lost: 3,
        faults,
        node: Text::new("servo"),
        message: Text::new("1 deadline missed"),
        process: 4321,
        level: Level::WARN,
        reserved: [0; 3],
    }
}

/// Options with all that can be said about a recording.
pub fn options() -> BagOptions {
    BagOptions {
        custom: [(
            "ferntast".to_owned(),
            [
                (
                    "scenario".to_owned(),
                    "seed = 1\n[arm]\nname = \"rokviss\"\n".to_owned(),
                ),
                ("version".to_owned(), "0.1.0".to_owned()),
            ]
            .into(),
        )]
        .into(),
        ..BagOptions::default()
    }
}

/// When the `k`-th message of every topic is logged: every 10 ms.
pub fn log_time(k: u32) -> Time {
    START.plus_nanos(i64::from(k) * 10_000_000)
}

struct Record<'a> {
    writer: &'a mut BagWriter,
    k: u32,
    failed: Option<Box<dyn Error>>,
}

impl Record<'_> {
    fn one<M: Message>(&mut self, topic: Topic<M>) -> Result<(), Box<dyn Error>> {
        let now = log_time(self.k);
        let message: M =
            sample(self.k, now).ok_or_else(|| format!("no sample for {}", topic.name))?;
        let channel = self.writer.topic(topic)?;
        self.writer
            .write(channel, now, now.plus_nanos(-1000), &message)?;
        Ok(())
    }
}

impl Visitor for Record<'_> {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        if self.failed.is_none() {
            self.failed = self.one(topic).err();
        }
    }
}

/// Writes `messages` messages on every topic of the table.
pub fn record(
    writer: &mut BagWriter,
    messages: std::ops::Range<u32>,
) -> Result<(), Box<dyn Error>> {
    for k in messages {
        let mut visitor = Record {
            writer,
            k,
            failed: None,
        };
        topics::visit(&joints(), &mut visitor)?;
        if let Some(error) = visitor.failed {
            return Err(error);
        }
    }
    Ok(())
}

/// A closed recording with `messages` messages on every topic of the table.
pub fn write_sample_bag(directory: &Path, messages: u32) -> Result<BagSummary, Box<dyn Error>> {
    let mut writer = BagWriter::create(directory, options())?;
    record(&mut writer, 0..messages)?;
    Ok(writer.finish()?)
}

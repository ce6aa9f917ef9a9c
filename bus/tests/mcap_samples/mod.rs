//! Messages of every type, and recordings made of them.

#![allow(dead_code)] // Each test uses its part.

use std::{any::Any, error::Error, path::Path};

use ferntast_bus::mcap::{BagOptions, BagSummary, BagWriter};
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        AuthoritySample, ContactStateSample, Edge, Fault, Faults, Frame, FrictionCommand,
        FrictionCommandSample, FrictionSource, FrictionStatusSample, HealthSample, JointFields,
        JointSample, LawCommandSample, Level, LinkCommandSample, LinkEnd, LinkStatusSample,
        OperatingState, OperatingStateSample, PoseSample, RecorderAction, RecorderCommandSample,
        RecorderStatusSample, RobotDescriptionSample, StateCommand, StateCommandSample,
        TemperatureSample, TransformsSample, TwinParametersSample, TwinVerdict, WrenchSample,
    },
    topics::{self, Topic, Visitor},
};

/// When the sample recordings begin: 2025-01-01 00:00:00 UTC.
pub const START: Time = Time::from_nanos(1_735_689_600_000_000_000);

/// Number of topics, and so of messages in one round.
pub fn topic_count() -> usize {
    struct Count(usize);
    impl Visitor for Count {
        fn topic<M: Message>(&mut self, _: Topic<M>) {
            self.0 += 1;
        }
    }
    let mut count = Count(0);
    topics::visit(&mut count);
    count.0
}

/// The `k`-th message of any type of the table, all fields distinct.
pub fn sample<M: Message>(k: u32, stamp: Time) -> Option<M> {
    let x = f64::from(k);
    pick(joint(x, stamp))
        .or_else(|| pick(pose(x, stamp)))
        .or_else(|| pick(wrench(x, stamp)))
        .or_else(|| pick(temperature(x, stamp)))
        .or_else(|| pick(contact_state(x, stamp)))
        .or_else(|| pick(operating_state(k, stamp)))
        .or_else(|| pick(state_command(k, stamp)))
        .or_else(|| pick(law_command(k, stamp)))
        .or_else(|| pick(friction_command(k, stamp)))
        .or_else(|| pick(friction_status(k, stamp)))
        .or_else(|| pick(authority(k, stamp)))
        .or_else(|| pick(link_status(k, stamp)))
        .or_else(|| pick(twin_parameters(k, stamp)))
        .or_else(|| pick(health(k, stamp)))
        .or_else(|| pick(link_command(x, stamp)))
        .or_else(|| pick(recorder_command(stamp)))
        .or_else(|| pick(recorder_status(k, stamp)))
        .or_else(|| pick(transforms(x, stamp)))
        .or_else(|| pick(robot_description(k)))
}

fn pick<M: Message, T: Message>(value: T) -> Option<M> {
    (&value as &dyn Any).downcast_ref::<M>().copied()
}

pub fn joint(x: f64, stamp: Time) -> JointSample {
    JointSample {
        stamp,
        position: [0.25 + x, -0.5 - x],
        velocity: [1.5 + x, -2.5 - x],
        effort: [10.5 + x, -20.25 - x],
        fields: JointFields::ALL,
        reserved: [0; 4],
    }
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
    TransformsSample {
        stamp,
        translations: [[x, 0.0, 0.0], [0.25, x, 0.0], [0.25, 0.0, x]],
        rotations: [about_z(x), about_z(0.5 * x), about_z(0.1)],
    }
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

fn temperature(x: f64, stamp: Time) -> TemperatureSample {
    TemperatureSample {
        stamp,
        temperature: 20.5 + x,
        variance: 0.25,
    }
}

fn contact_state(x: f64, stamp: Time) -> ContactStateSample {
    ContactStateSample {
        stamp,
        normal_force: 7.5 + x,
        tangential_force: 2.25,
        friction_coefficient: 0.375,
        friction_coefficient_error: 0.0625,
        in_contact: 1,
        valid: 1,
        near_rest: 0,
        edge: Edge::UNLUBRICATED,
        reserved: [0; 4],
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

fn friction_command(k: u32, stamp: Time) -> FrictionCommandSample {
    FrictionCommandSample::new(stamp, FrictionCommand((k % 2 + 1) as u8))
}

fn friction_status(k: u32, stamp: Time) -> FrictionStatusSample {
    let mut sample = FrictionStatusSample {
        commands: u64::from(k),
        refused: Text::new("no twin was heard"),
        count: 1,
        source: FrictionSource::TWIN,
        joint: Text::new("joint_2"),
        ..FrictionStatusSample::initial(stamp)
    };
    sample.names[0] = Text::new("b_0");
    sample.configured[0] = 12.5;
    sample.values[0] = 13.25;
    sample.targets[0] = 14.0;
    sample
}

fn authority(k: u32, stamp: Time) -> AuthoritySample {
    AuthoritySample {
        stamp,
        holder: 0x1234_5678_9ABC_DEF0,
        refused: 42,
        refused_count: u64::from(k),
        reason: Text::new("another master holds the authority"),
    }
}

fn link_status(k: u32, stamp: Time) -> LinkStatusSample {
    let count = u64::from(k);
    LinkStatusSample {
        stamp,
        round_trip: 0.020,
        delay: 0.010,
        jitter: 0.0005,
        loss: 0.001,
        age: 0.012,
        energy_in: 1.5,
        energy_out: 1.25,
        energy_dissipated: 0.25,
        sent: 1000 + count,
        received: 998 + count,
        lost: 1,
        refused_length: 1,
        refused_version: 2,
        refused_session: 3,
        refused_checksum: 4,
        refused_time: 5,
        refused_value: 6,
        refused_replayed: 7,
        refused_late: 8,
        law: Text::new("position_force"),
        session: 7,
        end: LinkEnd::FOLLOWER,
        connected: 1,
        reserved: [0; 4],
    }
}

fn twin_parameters(k: u32, stamp: Time) -> TwinParametersSample {
    let mut sample = TwinParametersSample {
        residual_rms: 1.5 + f64::from(k),
        band: 1.25,
        change_before: 13.0,
        change_after: 25.0,
        change_time: 61.5,
        assessed_at: 60.0,
        changed: Text::new("b1"),
        change_kind: Text::new("step"),
        candidate: Text::new("stribeck"),
        goes_with: Text::new("velocity"),
        count: 2,
        out_of_band: 1,
        verdict: TwinVerdict::MISSING,
        joint: Text::new("joint_2"),
        ..TwinParametersSample::initial(stamp)
    };
    for (i, name) in ["b0", "b1"].into_iter().enumerate() {
        let x = i as f64;
        sample.names[i] = Text::new(name);
        sample.values[i] = 11.5 + x;
        sample.off_line[i] = 11.25 + x;
        sample.std_errors[i] = 0.125 + x;
        sample.excitation[i] = 0.5 + x;
    }
    sample
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

fn link_command(x: f64, stamp: Time) -> LinkCommandSample {
    LinkCommandSample {
        stamp,
        round_trip: 0.5 + x,
        jitter: 0.125,
        loss: 0.25,
    }
}

fn recorder_command(stamp: Time) -> RecorderCommandSample {
    RecorderCommandSample::new(stamp, RecorderAction::MARK, "second contact")
}

fn recorder_status(k: u32, stamp: Time) -> RecorderStatusSample {
    RecorderStatusSample {
        messages: u64::from(k),
        folder: Text::new("recordings/first"),
        recording: 1,
        ..RecorderStatusSample::initial(stamp)
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
        topics::visit(&mut visitor);
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

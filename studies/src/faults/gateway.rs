//! Peers on ROS 2: what they publish comes in as the gateway lets it in.

use ferntast_bus::{Bus, CreateError, MemoryBus, Publisher};
use ferntast_config::Scenario;
use ferntast_control::planted::Planted;
use ferntast_model::MAX_JOINTS;
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        Faults, Frame, FrictionCommand, FrictionCommandSample, HealthSample, JointNames,
        JointSample, LawCommandSample, LinkCommandSample, PoseSample, RecorderAction,
        RecorderCommandSample, StateCommand, StateCommandSample, WrenchSample,
    },
    topics::{self, Topic},
};
use ferntast_nodes::{
    bridge::{
        forwarder::{Forwarder, Forwarding, Stamp},
        gateway::comes_in,
    },
    node::{HealthMeter, InputWatch, NodeHealth},
};

use super::fault::Garbage;

/// The gateway of a host, and a bus in memory in ROS 2's place.
pub struct Gateway {
    ros: Bus,
    forwarder: Forwarder,
    watch: InputWatch,
    meter: HealthMeter,
    diagnostics: Publisher<HealthSample>,
    joints: JointNames,
    refusable: u64,
}

impl Gateway {
    /// The gateway of a session's `bus`.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn new(
        bus: &Bus,
        scenario: &Scenario,
        joints: JointNames,
        planted: Planted,
    ) -> Result<Gateway, CreateError> {
        let ros = Bus::Memory(MemoryBus::new());
        let mut forwarder = Forwarder::default();
        forwarder.add_topics(&ros, bus, Stamp::Round, &joints, |topic| {
            comes_in(topic.authority, scenario)
        })?;
        Ok(Gateway {
            ros,
            forwarder,
            watch: InputWatch::planted(planted),
            meter: HealthMeter::new("gateway", 0, 1_000_000, Faults::default()),
            diagnostics: bus.publisher(topics::DIAGNOSTICS)?,
            joints,
            refusable: 0,
        })
    }

    /// One round, as the shipped gateway's.
    pub fn round(&mut self, now: Time) {
        let failed = self.forwarder.forward(now).failed;
        let mut health = NodeHealth {
            lost: failed,
            ..NodeHealth::default()
        };
        self.watch
            .note(|each| self.forwarder.inputs(each), &mut health);
        if let Some(sample) = self.meter.step(now, 0, 0, &health) {
            // Memory refuses nothing.
            let _ = self.diagnostics.publish(now, &sample);
        }
    }

    /// A number for each joint, zero behind the last one.
    fn each(&self, number: impl Fn(usize) -> f64) -> [f64; MAX_JOINTS] {
        let joints = self.joints.len();
        std::array::from_fn(|joint| match joint < joints {
            true => number(joint),
            false => 0.0,
        })
    }

    /// What came in and cannot be acted on.
    pub fn refusable(&self) -> u64 {
        self.refusable
    }

    /// A peer publishes what cannot be acted on, on every topic that comes in.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn garbage(
        &mut self,
        now: Time,
        garbage: Garbage,
        scenario: &Scenario,
    ) -> Result<(), CreateError> {
        let at = now.plus_nanos(-1);
        let (number, range) = match garbage {
            Garbage::NotANumber => (f64::NAN, false),
            Garbage::Infinite => (f64::INFINITY, false),
            Garbage::OutOfRange => (1e6, true),
            Garbage::ZeroStamp => (0.0, false),
        };
        let stamp = match garbage {
            Garbage::ZeroStamp => Time::INVALID,
            _ => now,
        };
        // A command without numbers has codes.
        let code = if range { 2 } else { 77 };
        let zero = !stamp.is_valid();
        let state = StateCommand(if zero { StateCommand::RESUME.0 } else { 77 });
        let state = StateCommandSample::new(stamp, state);
        let friction = FrictionCommand(if zero { 1 } else { code + 75 });
        let friction = FrictionCommandSample::new(stamp, friction);
        let law = LawCommandSample {
            stamp,
            law: Text::new(if zero { "wave" } else { "" }),
        };
        let channel = LinkCommandSample {
            round_trip: number,
            ..LinkCommandSample::initial(stamp)
        };
        let action = RecorderAction(if zero { 1 } else { 77 });
        let recorder = RecorderCommandSample {
            action,
            ..RecorderCommandSample::new(stamp, RecorderAction::MARK, "")
        };
        let joints = JointSample::empty(self.joints, stamp).with_position(self.each(|_| number));
        let pose = PoseSample {
            source: 0xbad,
            ..PoseSample::at(stamp, Frame::LEADER_BASE, [number, 0.0, 0.0])
        };
        let mut count = 0;
        let mut send = Send {
            ros: &self.ros,
            at,
            scenario,
            refusable: &mut count,
        };
        send.publish(topics::FOLLOWER_STATE_COMMAND, &state)?;
        send.publish(topics::LEADER_STATE_COMMAND, &state)?;
        send.publish(topics::FOLLOWER_FRICTION_COMMAND, &friction)?;
        send.publish(topics::LINK_LAW_COMMAND, &law)?;
        send.publish(topics::LINK_COMMAND, &channel)?;
        send.publish(topics::RECORDER_COMMAND, &recorder)?;
        send.publish(topics::FOLLOWER_SERVO_JP, &joints)?;
        send.publish(topics::LEADER_MEASURED_CP, &pose)?;
        self.refusable += count;
        Ok(())
    }

    /// A peer publishes valid commands on topics that could move the arm: those
    /// that the scenario does not let in, and those that never come in. `step`
    /// \[m\] is how far from the middle.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn stranger(
        &mut self,
        now: Time,
        tip: [f64; 3],
        scenario: &Scenario,
    ) -> Result<(), CreateError> {
        let at = now.plus_nanos(-1);
        let joints = JointSample::empty(self.joints, now)
            .with_position(self.each(|joint| 0.6 * (joint + 1) as f64));
        let torque =
            JointSample::empty(self.joints, now).with_effort(self.each(|joint| match joint % 2 {
                0 => 15.0,
                _ => -15.0,
            }));
        let pose = PoseSample::at(now, Frame::FOLLOWER_BASE, tip);
        let hand = PoseSample {
            source: 0xbad,
            ..PoseSample::at(now, Frame::LEADER_BASE, [0.02, 0.02, 0.0])
        };
        let force = WrenchSample::force(now, Frame::LEADER_BASE, [8.0, 0.0, 0.0]);
        let is_shut = |authority| comes_in(authority, scenario) == Forwarding::Not;
        if is_shut(topics::FOLLOWER_SERVO_JP.authority) {
            publish(&self.ros, at, topics::FOLLOWER_SERVO_JP, &joints)?;
        }
        if is_shut(topics::LEADER_MEASURED_CP.authority) {
            publish(&self.ros, at, topics::LEADER_MEASURED_CP, &hand)?;
        }
        publish(&self.ros, at, topics::FOLLOWER_SERVO_CP, &pose)?;
        publish(&self.ros, at, topics::FOLLOWER_SERVO_JF, &torque)?;
        publish(&self.ros, at, topics::LEADER_REFLECTED_CF, &force)?;
        publish(&self.ros, at, topics::LEADER_SETPOINT_CP, &hand)?;
        // Words that are no peer's to say.
        let mut send = Send {
            ros: &self.ros,
            at,
            scenario,
            refusable: &mut self.refusable,
        };
        for word in [StateCommand::ENABLE, StateCommand::RESUME] {
            let word = StateCommandSample::new(now, word);
            send.publish(topics::FOLLOWER_STATE_COMMAND, &word)?;
            send.publish(topics::LEADER_STATE_COMMAND, &word)?;
        }
        Ok(())
    }
}

/// Publishes on topics that come in, and counts what must be refused.
struct Send<'a> {
    ros: &'a Bus,
    at: Time,
    scenario: &'a Scenario,
    refusable: &'a mut u64,
}

impl Send<'_> {
    fn publish<M: Message>(&mut self, topic: Topic<M>, message: &M) -> Result<(), CreateError> {
        let refused = match comes_in(topic.authority, self.scenario) {
            Forwarding::Not => return Ok(()),
            Forwarding::Stops { .. } => message.check().is_err() || !message.stops(),
            _ => message.check().is_err(),
        };
        *self.refusable += u64::from(refused);
        publish(self.ros, self.at, topic, message)
    }
}

fn publish<M: Message>(
    bus: &Bus,
    at: Time,
    topic: Topic<M>,
    message: &M,
) -> Result<(), CreateError> {
    // Memory refuses nothing on the way in.
    let _ = bus.publisher(topic)?.publish(at, message);
    Ok(())
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::topics::{Authority, Visitor};

    use super::*;

    #[test]
    fn every_topic_that_may_come_in_gets_garbage() {
        struct MayComeIn(Vec<String>);
        impl Visitor for MayComeIn {
            fn topic<M: Message>(&mut self, topic: Topic<M>) {
                if topic.authority != Authority::Never {
                    self.0.push(topic.name.to_string());
                }
            }
        }
        let mut own = MayComeIn(Vec::new());
        topics::visit(&JointNames::numbered(2), &mut own).unwrap();
        own.0.sort();
        let mut known = [
            topics::FOLLOWER_STATE_COMMAND.name,
            topics::LEADER_STATE_COMMAND.name,
            topics::FOLLOWER_FRICTION_COMMAND.name,
            topics::LINK_LAW_COMMAND.name,
            topics::LINK_COMMAND.name,
            topics::RECORDER_COMMAND.name,
            topics::FOLLOWER_SERVO_JP.name,
            topics::LEADER_MEASURED_CP.name,
        ]
        .map(|name| name.to_string());
        known.sort();
        assert_eq!(own.0, known, "a new topic that comes in needs its garbage");
    }
}

//! Ports of an arm whose joints have names of their own.

use ferntast_bus::{Bus, CreateError, Depth, MemoryBus};
use ferntast_msgs::{
    Text, Time,
    sample::{
        Faults, FrictionStatusSample, JointNames, JointSample, LawCommandSample, TemperatureSample,
    },
    topics::{
        FOLLOWER_JOINT_FRICTION, FOLLOWER_JOINT_TEMPERATURE, FOLLOWER_MEASURED_JS, LINK_LAW_COMMAND,
    },
};

use super::{HealthMeter, Newest, Node, PerJoint, Ports, Runner, Ticking, ports};
use crate::bridge::forwarder::{Forwarder, Forwarding, Stamp};

const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

ports! {
    /// Topics of the node.
    WarmPorts for WarmNode;
    /// What it takes.
    input WarmInput {
        measured_js: Newest<JointSample> = FOLLOWER_MEASURED_JS,
        temperature: PerJoint<Newest<TemperatureSample>> = FOLLOWER_JOINT_TEMPERATURE,
    }
    /// What it gives.
    output WarmOutput {
        setpoint_js: JointSample = FOLLOWER_SETPOINT_JS,
        friction: PerJoint<FrictionStatusSample> = FOLLOWER_JOINT_FRICTION,
    }
}

/// Says the temperature of each joint that it hears as a friction.
pub struct WarmNode;

impl Node for WarmNode {
    type Input = WarmInput;
    type Output = WarmOutput;

    fn step(&mut self, now: Time, input: &WarmInput, output: &mut WarmOutput) {
        for (place, heard) in output.friction.iter_mut().zip(&input.temperature[..]) {
            *place = heard.fresh().map(|warm| {
                let mut sample = FrictionStatusSample::initial(now);
                sample.joint = Text::new("warm");
                sample.values[0] = warm.temperature;
                sample
            });
        }
    }
}

fn joints() -> JointNames {
    JointNames::new(["shoulder", "elbow", "wrist"]).unwrap()
}

#[test]
fn each_joint_has_topics_of_its_name() {
    let bus = Bus::Memory(MemoryBus::new());
    let ports = WarmPorts::connect(&bus, &joints()).unwrap();
    let mut heard = Vec::new();
    ports.counts(&mut |topic, _| heard.push(topic.to_owned()));
    let expected = [
        "/follower/measured_js",
        "/follower/shoulder/temperature",
        "/follower/elbow/temperature",
        "/follower/wrist/temperature",
    ];
    assert_eq!(heard, expected);
    assert_eq!(WarmPorts::inputs(&joints()).unwrap(), expected);
    let expected = [
        "/follower/setpoint_js",
        "/follower/shoulder/friction",
        "/follower/elbow/friction",
        "/follower/wrist/friction",
    ];
    assert_eq!(WarmPorts::outputs(&joints()).unwrap(), expected);

    let meter = HealthMeter::new("warm", 0, 1_000_000, Faults::default());
    let mut node = Runner::new(&bus, WarmNode, ports, meter).unwrap();
    let elbow = FOLLOWER_JOINT_TEMPERATURE.of("elbow").unwrap();
    let mut elbow = bus.publisher(elbow).unwrap();
    let told = FOLLOWER_JOINT_FRICTION.of_joints(&joints()).unwrap();
    let told = told.into_iter();
    let told = told.map(|topic| bus.subscriber(topic, Depth::Newest).unwrap());
    let mut told: Vec<_> = told.collect();
    elbow
        .publish(START, &TemperatureSample::new(START, 31.0))
        .unwrap();
    for tick in 1..3 {
        node.tick(START.plus_nanos(tick * 1_000_000), 0, 0);
    }
    let end = START.plus_nanos(3_000_000);
    let mut value = |joint: usize| {
        let own = told[joint].newest(end);
        own.map(|own| own.message.values[0])
    };
    assert_eq!([0, 1, 2].map(&mut value), [None, Some(31.0), None]);
}

#[test]
fn what_is_forwarded_goes_by_the_joints_too() {
    let (from, to) = (MemoryBus::new(), MemoryBus::new());
    let (from, to) = (Bus::Memory(from), Bus::Memory(to));
    let mut forwarder = Forwarder::default();
    let every = Forwarding::Every { queue: 4 };
    forwarder
        .add_topics(&from, &to, Stamp::Received, &joints(), |_| every)
        .unwrap();
    let wrist = FOLLOWER_JOINT_TEMPERATURE.of("wrist").unwrap();
    let mut sent = from.publisher(wrist).unwrap();
    let mut received = to.subscriber(wrist, Depth::Newest).unwrap();
    sent.publish(START, &TemperatureSample::new(START, 7.0))
        .unwrap();
    forwarder.forward(START.plus_nanos(1));
    let own = received.newest(START.plus_nanos(2)).unwrap();
    assert_eq!(own.message.temperature, 7.0);
}

#[test]
fn what_is_no_stream_is_looked_at_seldom() {
    let (from, to) = (MemoryBus::new(), MemoryBus::new());
    let (from, to) = (Bus::Memory(from), Bus::Memory(to));
    let mut forwarder = Forwarder::default().looking_seldom(5_000_000);
    let every = Forwarding::Every { queue: 4 };
    forwarder
        .add(FOLLOWER_MEASURED_JS, &from, &to, Stamp::Round, every)
        .unwrap();
    forwarder
        .add(LINK_LAW_COMMAND, &from, &to, Stamp::Round, every)
        .unwrap();
    let mut stream = from.publisher(FOLLOWER_MEASURED_JS).unwrap();
    let mut event = from.publisher(LINK_LAW_COMMAND).unwrap();
    let at = |millis: i64| START.plus_nanos(millis * 1_000_000);
    forwarder.forward(at(0));
    let law = Text::new("wave");
    let stamp = at(1);
    event
        .publish(stamp, &LawCommandSample { stamp, law })
        .unwrap();
    stream
        .publish(stamp, &JointSample::zero(joints(), stamp))
        .unwrap();
    let forwarded = [2, 4, 5, 6].map(|millis| forwarder.forward(at(millis)).messages);
    assert_eq!(forwarded, [1, 0, 1, 0]);
}

#[test]
fn a_joint_that_topics_cannot_name_is_refused() {
    let bus = Bus::Memory(MemoryBus::new());
    let joints = JointNames::new(["upper arm"]).unwrap();
    let Err(error) = WarmPorts::connect(&bus, &joints) else {
        panic!("a name with a space");
    };
    assert!(matches!(error, CreateError::Joint(_)), "{error}");
    let text = error.to_string();
    assert!(
        text.starts_with("joint \"upper arm\" cannot have"),
        "{text}"
    );
}

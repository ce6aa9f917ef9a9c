//! Bytes that are no message, put onto each way by its own raw interface.

use std::time::{Duration, Instant};

use ferntast_bus::Depth;
use ferntast_msgs::{
    Message, RosMessage, cdr, interface,
    ros::sensor_msgs::JointState,
    sample::JointSample,
    topics::{Delivery, Topic},
};
use iceoryx2::prelude::{FileName, NodeBuilder, SemanticString, SignalHandlingMode, ZeroCopySend};
use serde::{Serialize, Serializer, ser::SerializeTuple};
use zenoh::{Wait, qos::CongestionControl};

use crate::world::{Way, World, sample};

pub fn garbage(world: &World) {
    match world.way {
        // Nothing but samples goes in; the worst of them is all ones.
        Way::Memory => memory(world),
        Way::SharedMemory => shared_memory(world),
        Way::Dds => dds(world),
        Way::Zenoh => over_zenoh(world),
        Way::Mcap => crate::recording::garbage(world),
    }
}

/// Bodies of messages (after the header of four bytes) that are no joint states.
fn bad_bodies() -> Vec<Vec<u8>> {
    let good = body(&sample(0).to_ros());
    let mut bodies = vec![
        vec![],
        vec![0xff; 4],
        vec![0xff; 100],
        good[..good.len() / 2].to_vec(),
        // More than the padding that a transport may put back.
        good[..good.len() - 5].to_vec(),
    ];
    // Stamp, frame_id "" and then 4 294 967 295 names.
    let mut many = good.clone();
    many[16..20].copy_from_slice(&[0xff; 4]);
    bodies.push(many);
    // frame_id of 4 GiB.
    let mut long = good.clone();
    long[8..12].copy_from_slice(&[0xff; 4]);
    bodies.push(long);
    // A name that is not UTF-8.
    let at = good.windows(5).position(|bytes| bytes == b"joint").unwrap();
    let mut not_utf8 = good;
    not_utf8[at] = 0xc3;
    bodies.push(not_utf8);
    bodies
}

/// A joint state that is correct but for its length.
fn oversized() -> JointState {
    let mut ros = sample(0).to_ros();
    ros.header.frame_id = "x".repeat(cdr::MAX_LENGTH);
    ros
}

fn body(ros: &JointState) -> Vec<u8> {
    let mut bytes = Vec::new();
    ros.encode(&mut bytes).unwrap();
    bytes[4..].to_vec()
}

fn all_ones() -> JointSample {
    let mut bytes = [0xff_u8; size_of::<JointSample>()];
    // SAFETY: every bit pattern of a message is a value.
    unsafe { std::ptr::read_unaligned((&raw mut bytes).cast()) }
}

fn memory(world: &World) {
    let topic = world.topic("garbage", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(8)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    publisher.publish(world.tick(), &all_ones()).unwrap();
    let counts = reader.wait_for(|counts| counts.invalid == 1);
    assert_eq!(counts.invalid, 1);
}

/// What a program of another build might put into the same shared memory:
/// the right name with other content.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(8))]
struct Foreign<const N: usize>([u8; N]);

// SAFETY: bytes only. The name is a lie, which is the point.
unsafe impl<const N: usize> ZeroCopySend for Foreign<N> {
    unsafe fn type_name() -> &'static str {
        std::any::type_name::<JointSample>()
    }
}

/// The sample with the two numbers that go before it.
const SIZE: usize = size_of::<JointSample>() + 16;

fn shared_memory(world: &World) {
    let topic = world.topic("garbage", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(8)).unwrap();

    let mut config = iceoryx2::config::Config::default();
    config.global.prefix = FileName::new(format!("ferntast.{}.", world.name).as_bytes()).unwrap();
    let root = format!("/dev/shm/ferntast.{}", world.name);
    config
        .global
        .set_root_path(&iceoryx2::prelude::Path::new(root.as_bytes()).unwrap());
    let node = NodeBuilder::new()
        .config(&config)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<iceoryx2::prelude::ipc_threadsafe::Service>()
        .unwrap();
    let name = topic.name.as_str().try_into().unwrap();

    let same_size = node
        .service_builder(&name)
        .publish_subscribe::<Foreign<SIZE>>()
        .open()
        .unwrap();
    let port = same_size.publisher_builder().create().unwrap();
    port.send_copy(Foreign([0xff; SIZE])).unwrap();
    port.send_copy(Foreign([0; SIZE])).unwrap();
    let counts = reader.wait_for(|counts| counts.invalid == 2);
    assert_eq!(counts.invalid, 2);

    let oversized = node
        .service_builder(&name)
        .publish_subscribe::<Foreign<{ 64 * 1024 }>>()
        .open();
    assert!(oversized.is_err(), "another size is refused when opening");

    let mut publisher = world.participant().publisher(topic).unwrap();
    publisher.publish(world.tick(), &sample(1)).unwrap();
    assert_eq!(reader.next().unwrap().message, sample(1));
}

/// Goes into CDR as the bytes that it holds.
#[derive(Debug)]
struct Verbatim(Vec<u8>);

impl Serialize for Verbatim {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut bytes = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            bytes.serialize_element(byte)?;
        }
        bytes.end()
    }
}

fn dds(world: &World) {
    use ros2_client::{
        Context, ContextOptions, MessageTypeName, Name, NodeName, NodeOptions, QosProfile,
        qos::{History, WhenFull},
    };
    let topic = world.topic("garbage", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(64)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    world.meet(&mut publisher, &mut reader);

    let domain = u16::try_from(world.domain_id).unwrap();
    let context = Context::with_options(ContextOptions::new().domain_id(domain)).unwrap();
    let name = NodeName::new("/", "foreign").unwrap();
    let mut node = context.new_node(name, NodeOptions::new()).unwrap();
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Block)
        .history(History::KeepLast { depth: 64 });
    let raw_topic = node
        .create_topic(
            &Name::parse(&topic.name).unwrap(),
            MessageTypeName::new("sensor_msgs", "JointState"),
            &qos,
        )
        .unwrap();
    let raw = node.create_publisher::<Verbatim>(&raw_topic, None).unwrap();
    // Meets the reader: what is published before is nobody's.
    let good = body(&sample(7).to_ros());
    let mut met = false;
    for _ in 0..200 {
        raw.publish(Verbatim(good.clone())).unwrap();
        if reader.next_within(Duration::from_millis(50)).is_some() {
            met = true;
            break;
        }
    }
    assert!(met, "the foreign writer never met the reader");
    while reader.next_within(Duration::from_millis(300)).is_some() {}

    let bodies = bad_bodies();
    let bad = bodies.len() as u64;
    for body in bodies {
        raw.publish(Verbatim(body)).unwrap();
    }
    let mut oversized_body = Vec::new();
    encode_unbounded(&oversized(), &mut oversized_body);
    raw.publish(Verbatim(oversized_body)).unwrap();
    let counts = reader.wait_for(|counts| counts.refused() > bad);
    assert_eq!(counts.undecodable, bad, "{counts:?}");
    assert_eq!(counts.too_large, 1, "{counts:?}");
    raw.publish(Verbatim(good.clone())).unwrap();
    assert_eq!(reader.next().unwrap().message, sample(7));

    // The right bytes under another type's name.
    let other_topic = node
        .create_topic(
            &Name::parse(&topic.name).unwrap(),
            MessageTypeName::new("sensor_msgs", "JointStateOfSomebodyElse"),
            &qos,
        )
        .unwrap();
    let impostor = node
        .create_publisher::<Verbatim>(&other_topic, None)
        .unwrap();
    let start = Instant::now();
    while reader.counts().undecodable == bad && start.elapsed() < Duration::from_secs(10) {
        impostor.publish(Verbatim(good.clone())).unwrap();
        assert_eq!(reader.next_within(Duration::from_millis(50)), None);
    }
    assert!(reader.counts().undecodable > bad, "it was refused");
}

/// The body of a message of any length; ours refuse to encode one like that.
fn encode_unbounded(ros: &JointState, bytes: &mut Vec<u8>) {
    assert!(ros.encode(&mut Vec::new()).is_err());
    cdr_encoding::to_writer::<JointState, byteorder::LittleEndian, _>(bytes, ros).unwrap();
}

fn over_zenoh(world: &World) {
    let topic = world.topic("garbage", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(64)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    world.meet(&mut publisher, &mut reader);

    let session = world.stranger();
    let key = key::<JointSample>(world, topic);

    let mut payloads: Vec<Vec<u8>> = bad_bodies()
        .iter()
        .map(|body| [&[0, 1, 0, 0], body.as_slice()].concat())
        .collect();
    // No header, half a header, a header of another encoding, something left over.
    let good = [&[0, 1, 0, 0], body(&sample(7).to_ros()).as_slice()].concat();
    payloads.push(vec![]);
    payloads.push(vec![0, 1]);
    payloads.push([&[0, 7], &good[2..]].concat());
    payloads.push([good.as_slice(), &[0; 4]].concat());
    let bad = payloads.len() as u64;
    // By default Zenoh drops what comes behind a long message on a busy machine.
    let put = |payload| {
        let put = session.put(&key, payload);
        put.congestion_control(CongestionControl::Block)
    };
    for payload in payloads {
        put(payload).wait().unwrap();
    }
    let mut oversized_payload = vec![0, 1, 0, 0];
    encode_unbounded(&oversized(), &mut oversized_payload);
    put(oversized_payload).wait().unwrap();
    // An attachment that is none.
    let attachment = vec![0xff_u8; 5];
    put(good).attachment(attachment).wait().unwrap();
    let received = reader.next().unwrap();
    assert_eq!(received.message, sample(7));
    assert_ne!(received.source, 0);
    let counts = reader.counts();
    assert_eq!(counts.undecodable, bad, "{counts:?}");
    assert_eq!(counts.too_large, 1, "{counts:?}");
}

/// The topic's key as rmw_zenoh forms it.
fn key<M: Message>(world: &World, topic: Topic<M>) -> String {
    let interface = M::Ros::INTERFACE;
    let (package, kind) = interface.split_once("/msg/").unwrap();
    format!(
        "{}/{}/{package}::msg::dds_::{kind}_/{}",
        world.domain_id,
        topic.name.trim_start_matches('/'),
        interface::type_hash(interface).unwrap()
    )
}

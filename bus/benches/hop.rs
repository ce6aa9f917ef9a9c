//! How long a message takes from `publish` to the reader, on each way across,
//! and beside it a bare Zenoh ping-pong, with which the link's frames are compared.
//!
//! Two threads, each with a bus of its own, on one host. The reader spins, so
//! the numbers are those of the way, not of a timer. In memory, where time is
//! virtual, it is the cost of one publish and one read.

mod link_pair;

use std::{
    hint,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use ferntast_bus::{
    Bus, DdsBus, DdsConfig, Depth, MemoryBus, SharedMemoryBus, SharedMemoryConfig, ZenohBus,
    ZenohConfig, ZenohMode, frames::MAX_FRAME,
};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics::{Delivery, Topic, TopicName},
};
use zenoh::Wait;

const TOPIC: Topic<JointSample> = Topic::new(TopicName::constant("/bench/hop"), Delivery::Stream);
const HOPS: usize = 5_000;
const PERIOD: Duration = Duration::from_micros(500);

fn main() {
    println!(
        "{:<26} {:>12} {:>12} {:>8}",
        "way", "p50 [us]", "p99 [us]", "hops"
    );
    memory();
    let process = std::process::id();
    let session = format!("bench_{process}");
    hop("shared memory", || shared_memory(&session));
    if let Err(error) = SharedMemoryBus::clean_up(&session) {
        eprintln!("{error}");
    }
    hop("ROS 2 over DDS", || dds(1 + process % 99));
    let router = ZenohBus::open(&ZenohConfig {
        mode: ZenohMode::Router {
            listen: endpoint(process),
        },
        domain_id: 0,
        node_name: "router".into(),
        namespace: "/".into(),
    });
    match router {
        Ok(_router) => hop("ROS 2 over Zenoh, routed", || connected(process)),
        Err(error) => eprintln!("{error}"),
    }
    let bare = match bare_zenoh(process) {
        Ok(times) => print("bare Zenoh (half a ping)", times),
        Err(error) => {
            eprintln!("bare Zenoh: {error}");
            None
        }
    };
    for (way, kind, port) in [
        ("the link's frames, TCP", "tcp", 32_100),
        ("the link's frames, UDP", "udp", 34_200),
        ("the link's frames, QUIC", "quic", 38_400),
    ] {
        let endpoint = format!("{kind}/127.0.0.1:{}", port + process % 2000);
        let own = match link(&endpoint) {
            Ok(times) => print(way, times),
            Err(error) => {
                eprintln!("{way}: {error}");
                None
            }
        };
        if let (Some(own), Some(bare)) = (own, bare) {
            let [p50, p99] = [own.0 / bare.0, own.1 / bare.1];
            println!("{:<26} {p50:>12.2} {p99:>12.2}", "  to bare Zenoh as");
        }
    }
}

fn endpoint(process: u32) -> String {
    format!("tcp/127.0.0.1:{}", 20_000 + process % 10_000)
}

fn shared_memory(session: &str) -> Bus {
    let config = SharedMemoryConfig {
        session: session.into(),
    };
    Bus::SharedMemory(SharedMemoryBus::open(&config).expect("shared memory"))
}

fn dds(domain_id: u32) -> Bus {
    let config = DdsConfig {
        domain_id,
        node_name: "hop".into(),
        namespace: "/".into(),
    };
    Bus::Dds(DdsBus::open(&config).expect("DDS"))
}

fn connected(process: u32) -> Bus {
    let config = ZenohConfig {
        mode: ZenohMode::Connect {
            endpoint: endpoint(process),
        },
        domain_id: 0,
        node_name: "hop".into(),
        namespace: "/".into(),
    };
    Bus::Zenoh(ZenohBus::open(&config).expect("Zenoh"))
}

fn sample(number: u64) -> JointSample {
    JointSample::zero(JointNames::numbered(2), Time::from_nanos(number as i64 + 1))
}

/// Prints and gives median and 99th percentile [us].
fn print(way: &str, mut times: Vec<f64>) -> Option<(f64, f64)> {
    if times.is_empty() {
        println!("{way:<26} {:>12} {:>12} {:>8}", "-", "-", 0);
        return None;
    }
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "{way:<26} {:>12.3} {:>12.3} {:>8}",
        at(0.50),
        at(0.99),
        times.len()
    );
    Some((at(0.50), at(0.99)))
}

/// Batches, as one publish and read is shorter than the clock can tell.
fn memory() {
    const BATCH: usize = 1000;
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(TOPIC).expect("memory");
    let mut subscriber = bus.subscriber(TOPIC, Depth::Newest).expect("memory");
    let mut times = Vec::new();
    let mut now = 1;
    for _ in 0..1000 {
        let start = Instant::now();
        for _ in 0..BATCH {
            let message = sample(now as u64);
            publisher
                .publish(Time::from_nanos(now), &message)
                .expect("memory");
            now += 1;
            hint::black_box(subscriber.newest(Time::from_nanos(now)));
        }
        times.push(start.elapsed().as_secs_f64() * 1e6 / BATCH as f64);
    }
    let _ = print("memory (publish + read)", times);
}

/// One publishes every half millisecond, the other spins for it.
fn hop(way: &str, join: impl Fn() -> Bus) {
    let start = Instant::now();
    let sent = Arc::new(AtomicU64::new(0));
    let done = Arc::new(AtomicBool::new(false));
    let mut subscriber = join().subscriber(TOPIC, Depth::Newest).expect("subscriber");
    let mut publisher = join().publisher(TOPIC).expect("publisher");
    let reader = thread::spawn({
        let (sent, done) = (sent.clone(), done.clone());
        move || {
            let mut times = Vec::with_capacity(HOPS);
            while !done.load(Ordering::Acquire) {
                let Some(received) = subscriber.newest(Time::from_nanos(1)) else {
                    thread::yield_now();
                    continue;
                };
                let arrived = start.elapsed().as_nanos() as u64;
                // The stamp is when it was sent.
                let stamped = received.message.stamp.nanos() as u64;
                if sent.load(Ordering::Acquire) > 1000 {
                    times.push((arrived.saturating_sub(stamped)) as f64 * 1e-3);
                }
            }
            times
        }
    });
    for number in 0..HOPS as u64 + 1000 {
        sent.store(number, Ordering::Release);
        let message = sample(start.elapsed().as_nanos() as u64);
        publisher.publish(message.stamp, &message).expect("publish");
        thread::sleep(PERIOD);
    }
    thread::sleep(Duration::from_millis(100));
    done.store(true, Ordering::Release);
    let _ = print(way, reader.join().expect("reader"));
}

/// Half a round trip between two sessions joined by TCP.
fn bare_zenoh(process: u32) -> Result<Vec<f64>, zenoh::Error> {
    let endpoint = format!("tcp/127.0.0.1:{}", 30_001 + process % 2_000);
    let open = |key: &str| -> Result<zenoh::Session, zenoh::Error> {
        let mut config = zenoh::Config::default();
        config.insert_json5("scouting/multicast/enabled", "false")?;
        config.insert_json5(key, &format!("[{endpoint:?}]"))?;
        if key == "connect/endpoints" {
            config.insert_json5("listen/endpoints", "[]")?;
        }
        zenoh::open(config).wait()
    };
    let here = open("listen/endpoints")?;
    let there = open("connect/endpoints")?;
    let echo = there.declare_publisher("bench/pong").express(true).wait()?;
    let _answering = there
        .declare_subscriber("bench/ping")
        .callback(move |sample| {
            // A ping that gets no answer is missed by the other side.
            let _ = echo.put(sample.payload().clone()).wait();
        })
        .wait()?;
    let pong = here.declare_subscriber("bench/pong").wait()?;
    let ping = here.declare_publisher("bench/ping").express(true).wait()?;
    thread::sleep(Duration::from_millis(500));
    let mut times = Vec::with_capacity(HOPS);
    for _ in 0..HOPS {
        let start = Instant::now();
        ping.put([0_u8; 64].as_slice()).wait()?;
        if pong.recv_timeout(Duration::from_secs(1))?.is_some() {
            times.push(start.elapsed().as_secs_f64() * 1e6 / 2.0);
        }
    }
    Ok(times)
}

/// One way, from `send` to the stamp of arrival; the next when the last is there.
fn link(endpoint: &str) -> Result<Vec<f64>, String> {
    let start = Instant::now();
    let clock = move || Time::from_nanos(1 + start.elapsed().as_nanos() as i64);
    let [mut there, mut here] = link_pair::open(endpoint.into(), endpoint.into(), clock)?;
    let mut buffer = [0; MAX_FRAME];
    let mut hop = || -> Result<Option<f64>, String> {
        let sent = clock();
        here.sender
            .send(sent, &[0; 60])
            .map_err(|error| error.to_string())?;
        while clock().seconds_since(sent) < 0.5 {
            if let Some((_, arrived)) = there.receiver.receive(sent, &mut buffer) {
                return Ok(Some(arrived.seconds_since(sent) * 1e6));
            }
            thread::yield_now();
        }
        Ok(None)
    };
    let met = (0..20).try_fold(false, |met, _| Ok::<_, String>(met || hop()?.is_some()))?;
    if !met {
        return Err("the two ends did not meet".into());
    }
    let mut times = Vec::with_capacity(HOPS);
    for _ in 0..HOPS {
        times.extend(hop()?);
    }
    Ok(times)
}

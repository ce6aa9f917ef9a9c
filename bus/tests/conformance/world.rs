//! Where a case runs: a way across with names of its own, so that test runs
//! beside and after one another do not meet.

use std::{
    cell::Cell,
    net::TcpListener,
    process,
    sync::atomic::{AtomicU32, Ordering},
    thread,
    time::{Duration, Instant},
};

use ferntast_bus::{
    Bus, CreateError, DdsBus, DdsConfig, Depth, McapBus, MemoryBus, Publisher, Received,
    SharedMemoryBus, SharedMemoryConfig, Subscriber, SubscriberCounts, ZenohBus, ZenohConfig,
    ZenohMode,
};
use ferntast_msgs::{
    Message, Time,
    sample::{JointNames, JointSample},
    topics::{Delivery, Topic, TopicName},
};
use tempfile::TempDir;
use zenoh::Wait;

/// How long a message may take on a way that is not virtual.
const PATIENCE: Duration = Duration::from_secs(10);
/// After how long without a message none is on its way.
const QUIET: Duration = Duration::from_millis(300);
/// Between two looks.
const POLL: Duration = Duration::from_millis(1);

static WORLDS: AtomicU32 = AtomicU32::new(0);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Memory,
    SharedMemory,
    Dds,
    Zenoh,
    Mcap,
}

pub struct World {
    pub way: Way,
    /// Unique among all worlds of all processes.
    pub name: String,
    pub domain_id: u32,
    pub endpoint: String,
    now: Cell<i64>,
    memory: MemoryBus,
    recording: Option<(TempDir, McapBus)>,
    router: Option<ZenohBus>,
}

impl World {
    pub fn new(way: Way) -> World {
        let number = WORLDS.fetch_add(1, Ordering::Relaxed);
        let name = format!("w{}_{number}", process::id());
        // Topics carry the world's name, so that a domain may be shared.
        let domain_id = 1 + (process::id() + number) % 99;
        let endpoint = format!("tcp/127.0.0.1:{}", free_port());
        let recording = (way == Way::Mcap).then(|| {
            let directory = tempfile::tempdir().unwrap();
            let bus = McapBus::create(&directory.path().join("bag")).unwrap();
            (directory, bus)
        });
        let router = (way == Way::Zenoh).then(|| {
            ZenohBus::open(&ZenohConfig {
                mode: ZenohMode::Router {
                    listen: endpoint.clone(),
                },
                domain_id,
                node_name: format!("router_{name}"),
                namespace: "/".to_owned(),
            })
            .unwrap()
        });
        World {
            way,
            name,
            domain_id,
            endpoint,
            now: Cell::new(1_700_000_000_000_000_000),
            memory: MemoryBus::new(),
            recording,
            router,
        }
    }

    /// Whether time passes only by [`World::tick`].
    pub fn is_virtual(&self) -> bool {
        matches!(self.way, Way::Memory | Way::Mcap)
    }

    /// Time goes on by a millisecond.
    pub fn tick(&self) -> Time {
        self.now.set(self.now.get() + 1_000_000);
        self.now()
    }

    pub fn now(&self) -> Time {
        Time::from_nanos(self.now.get())
    }

    pub fn topic<M: Message>(&self, name: &str, delivery: Delivery) -> Topic<M> {
        let name = format!("/{}/{name}", self.name);
        Topic::new(TopicName::new(&name).unwrap(), delivery)
    }

    /// A Zenoh client of its own at the world's endpoint, as any program may be.
    pub fn stranger(&self) -> zenoh::Session {
        let mut config = zenoh::Config::default();
        for (key, value) in [
            ("mode", r#""client""#),
            ("connect/endpoints", &format!("[{:?}]", self.endpoint)),
            ("scouting/multicast/enabled", "false"),
        ] {
            config.insert_json5(key, value).unwrap();
        }
        zenoh::open(config).wait().unwrap()
    }

    /// A further participant, as a process of its own would be.
    pub fn participant(&self) -> Bus {
        match self.way {
            Way::Memory => Bus::Memory(self.memory.clone()),
            Way::SharedMemory => Bus::SharedMemory(
                SharedMemoryBus::open(&SharedMemoryConfig {
                    session: self.name.clone(),
                })
                .unwrap(),
            ),
            Way::Dds => Bus::Dds(
                DdsBus::open(&DdsConfig {
                    domain_id: self.domain_id,
                    node_name: self.name.clone(),
                    namespace: "/".into(),
                })
                .unwrap(),
            ),
            Way::Zenoh => Bus::Zenoh(
                ZenohBus::open(&ZenohConfig {
                    mode: ZenohMode::Connect {
                        endpoint: self.endpoint.clone(),
                    },
                    domain_id: self.domain_id,
                    node_name: self.name.clone(),
                    namespace: "/".to_owned(),
                })
                .unwrap(),
            ),
            Way::Mcap => Bus::Mcap(self.recording.as_ref().unwrap().1.clone()),
        }
    }

    pub fn reader<M: Message>(
        &self,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<Reader<'_, M>, CreateError> {
        let live = match self.way {
            // A recording is read once it is written, see `Reader::subscriber`.
            Way::Mcap => None,
            _ => Some(self.participant().subscriber(topic, depth)?),
        };
        Ok(Reader {
            world: self,
            topic,
            depth,
            joined: self.now(),
            subscriber: live,
        })
    }

    /// Publishes until the reader has got something, and reads until all has come.
    pub fn meet(&self, publisher: &mut Publisher<JointSample>, reader: &mut Reader<JointSample>) {
        if self.is_virtual() || self.way == Way::SharedMemory {
            return;
        }
        let start = Instant::now();
        let mut met = false;
        while !met {
            assert!(start.elapsed() < PATIENCE, "the two never met");
            publisher.publish(self.tick(), &sample(-1)).unwrap();
            let round = Instant::now();
            while !met && round.elapsed() < Duration::from_millis(50) {
                met = reader.look(|s, now| s.next(now)).is_some();
                thread::sleep(POLL);
            }
        }
        while reader.next_within(QUIET).is_some() {}
    }
}

impl Drop for World {
    fn drop(&mut self) {
        self.router = None;
        if self.way == Way::SharedMemory {
            // Nobody lives here any more; a failure would be another test's concern.
            let _ = SharedMemoryBus::clean_up(&self.name);
        }
    }
}

/// A subscriber with patience.
pub struct Reader<'w, M: Message> {
    world: &'w World,
    topic: Topic<M>,
    depth: Depth,
    joined: Time,
    subscriber: Option<Subscriber<M>>,
}

impl<M: Message> Reader<'_, M> {
    pub fn newest(&mut self) -> Option<Received<M>> {
        self.wait(PATIENCE, |s, now| s.newest(now))
    }

    pub fn next(&mut self) -> Option<Received<M>> {
        self.next_within(PATIENCE)
    }

    pub fn next_within(&mut self, patience: Duration) -> Option<Received<M>> {
        self.wait(patience, |s, now| s.next(now))
    }

    /// Whether nothing more comes.
    pub fn is_quiet(&mut self) -> bool {
        self.next_within(QUIET).is_none()
    }

    /// Lets pass the time that messages on their way need.
    pub fn settle(&mut self) {
        self.world.tick();
        if !self.world.is_virtual() {
            thread::sleep(QUIET);
        }
    }

    pub fn counts(&mut self) -> SubscriberCounts {
        *self.subscriber().counts()
    }

    /// Waits until the counts say so.
    pub fn wait_for(&mut self, what: impl Fn(&SubscriberCounts) -> bool) -> SubscriberCounts {
        let start = Instant::now();
        loop {
            let received = self.look(|s, now| s.next(now));
            assert_eq!(received.map(|r| r.message), None);
            let counts = self.counts();
            if what(&counts) || start.elapsed() > PATIENCE {
                return counts;
            }
            thread::sleep(POLL);
        }
    }

    pub fn look<T>(
        &mut self,
        look: impl FnOnce(&mut Subscriber<M>, Time) -> Option<T>,
    ) -> Option<T> {
        let now = self.world.tick();
        look(self.subscriber(), now)
    }

    fn wait<T>(
        &mut self,
        patience: Duration,
        mut look: impl FnMut(&mut Subscriber<M>, Time) -> Option<T>,
    ) -> Option<T> {
        let start = Instant::now();
        loop {
            if let Some(found) = self.look(&mut look) {
                return Some(found);
            }
            if self.world.is_virtual() || start.elapsed() > patience {
                return None;
            }
            thread::sleep(POLL);
        }
    }

    /// The subscriber; the first use closes a recording and opens it for
    /// reading, as of the time at which this reader joined.
    fn subscriber(&mut self) -> &mut Subscriber<M> {
        self.subscriber.get_or_insert_with(|| {
            let (directory, writer) = self.world.recording.as_ref().unwrap();
            writer.finish().unwrap();
            let bus = McapBus::open(&directory.path().join("bag")).unwrap();
            bus.advance(self.joined);
            Bus::Mcap(bus).subscriber(self.topic, self.depth).unwrap()
        })
    }
}

/// A sample that can be told from the others; all values differ.
pub fn sample(number: i32) -> JointSample {
    let x = f64::from(number);
    let stamp = Time::from_nanos(1_700_000_000_000_000_000 + i64::from(number));
    JointSample::empty(JointNames::numbered(2), stamp)
        .with_position([x, x + 0.25])
        .with_velocity([-x, 0.5])
        .with_effort([1e-9, x * 1e3])
}

pub fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

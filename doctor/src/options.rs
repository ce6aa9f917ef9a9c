//! What the doctor is asked to examine.

use std::path::PathBuf;
use std::time::Duration;

/// The middleware that carries the ROS 2 topics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RosMiddleware {
    /// DDS: `rmw_fastrtps_cpp`, `rmw_cyclonedds_cpp` and the like.
    Dds,
    /// Zenoh: `rmw_zenoh_cpp`.
    Zenoh,
}

/// An endpoint that a session is going to listen on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TcpEndpoint {
    /// What it is for, as a person reads it: `link`, `Zenoh router`.
    pub purpose: String,
    /// `tcp/HOST:PORT` or `HOST:PORT`.
    pub address: String,
}

/// Hardware behind the arm or the hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// What it is, as a person reads it: `the arm (feetech)`.
    pub purpose: String,
    /// Where it is.
    pub place: Place,
}

/// Where hardware is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// At a serial port, of this path.
    SerialPort(String),
    /// Behind a service that listens at `HOST:PORT`.
    Service(String),
    /// The files do not say it.
    NotDescribed {
        /// What they lack.
        why: String,
    },
}

/// What a session needs of the machine.
#[derive(Clone, Debug)]
pub struct DoctorOptions {
    /// The SCHED_FIFO priority of the 1 kHz loops, 1 to 99.
    pub real_time_priority: i32,
    /// The period of the loops whose wake-up is measured.
    pub wake_up_period: Duration,
    /// How long the wake-ups are measured, once with and once without
    /// real-time priority. At most [`DoctorOptions::LONGEST_MEASUREMENT`].
    pub wake_up_duration: Duration,
    /// Shared memory that a session takes \[bytes\].
    pub shared_memory_bytes: u64,
    /// How the names of all sessions' files in `/dev/shm` begin;
    /// a session's own name follows, up to the next dot. Empty: none is
    /// looked for.
    pub shared_memory_prefix: String,
    /// Where recordings go; need not exist yet.
    pub recording_folder: PathBuf,
    /// What a session records \[bytes/s\].
    pub recording_bytes_per_second: f64,
    /// How long a recording should fit on the disk.
    pub recording_duration: Duration,
    /// Where a session listens.
    pub tcp_endpoints: Vec<TcpEndpoint>,
    /// What the session reaches of hardware.
    pub devices: Vec<Device>,
    /// The middleware that carries the ROS 2 topics.
    pub middleware: RosMiddleware,
    /// The session's ROS domain; `None` takes `ROS_DOMAIN_ID`, or 0.
    pub ros_domain: Option<u32>,
    /// How long the caller looks for peers.
    pub peers_duration: Duration,
}

impl DoctorOptions {
    /// A longer [`DoctorOptions::wake_up_duration`] is cut to this.
    pub const LONGEST_MEASUREMENT: Duration = Duration::from_secs(60);
}

impl Default for DoctorOptions {
    /// A session on this host over DDS, recorded into `recordings`.
    fn default() -> DoctorOptions {
        DoctorOptions {
            real_time_priority: 40,
            wake_up_period: Duration::from_millis(1),
            wake_up_duration: Duration::from_millis(500),
            shared_memory_bytes: 64 << 20,
            shared_memory_prefix: "ferntast.".to_owned(),
            recording_folder: PathBuf::from("recordings"),
            recording_bytes_per_second: 1e6,
            recording_duration: Duration::from_secs(30 * 60),
            tcp_endpoints: Vec::new(),
            devices: Vec::new(),
            middleware: RosMiddleware::Dds,
            ros_domain: None,
            peers_duration: Duration::from_secs(3),
        }
    }
}

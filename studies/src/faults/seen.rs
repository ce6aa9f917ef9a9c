//! What is seen in a step: what was published, and what is true.

use ferntast_bus::{Bus, CreateError, Depth, Subscriber};
use ferntast_model::Joints;
use ferntast_msgs::{
    Message, Time,
    sample::{
        HealthSample, JointSample, LinkStatusSample, OperatingState, OperatingStateSample,
        PoseSample, WrenchSample,
    },
    topics::{self, Topic},
};

use super::{truth::Truth, wire::Arrivals};

/// The client that takes the master over, as sources are told apart.
pub const CLIENT: u64 = 0xa;

/// What a device says of its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceState {
    /// Its state; disabled while its process is dead.
    pub state: OperatingState,
    /// In the step before.
    pub before: OperatingState,
}

impl DeviceState {
    const NONE: DeviceState = DeviceState {
        state: OperatingState::DISABLED,
        before: OperatingState::DISABLED,
    };

    /// It follows commands.
    pub fn enabled(&self) -> bool {
        self.state == OperatingState::ENABLED
    }

    /// It holds.
    pub fn paused(&self) -> bool {
        self.state == OperatingState::PAUSED
    }

    /// It does so since this step.
    pub fn just_enabled(&self) -> bool {
        self.enabled() && self.before != OperatingState::ENABLED
    }

    /// It does not any more since this step.
    pub fn just_left(&self) -> bool {
        !self.enabled() && self.before == OperatingState::ENABLED
    }
}

/// What was refused, as told on `/diagnostics`, and when that was said last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    /// Since the node was started.
    pub refused: u64,
    /// \[step\]
    pub at: i64,
}

/// A step. Of messages those that were published in it.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Which \[steps since the start\].
    pub tick: i64,
    /// The arm's servo.
    pub follower: DeviceState,
    /// The master.
    pub leader: DeviceState,
    /// Motor torques \[Nm\].
    pub torque: Option<Joints<f64>>,
    /// Setpoint \[rad\], \[rad/s\].
    pub setpoint: Option<(Joints<f64>, Joints<f64>)>,
    /// What the arm measures, positions \[rad\].
    pub measured: Option<Joints<f64>>,
    /// When, by the clock of its host.
    pub measured_at: Time,
    /// The tip that the link commands \[m\].
    pub tip_command: Option<[f64; 3]>,
    /// The hand as its device measures it \[m\].
    pub hand: Option<[f64; 3]>,
    /// The hand as accepted \[m\].
    pub accepted_hand: Option<[f64; 3]>,
    /// Whether the link said what force it wants on the hand.
    pub reflected: bool,
    /// The force rendered to the hand \[N\].
    pub hand_force: Option<[f64; 3]>,
    /// What is true of the arm.
    pub truth: Truth,
    /// Torques of the motors, from their currents \[Nm\].
    pub driven: Joints<f64>,
    /// Frames to the arm.
    pub forth: Arrivals,
    /// Frames to the operator.
    pub back: Arrivals,
    /// What the ends of the link say that they refused: operator's, arm's.
    pub link_told: [Told; 2],
    /// What the gateways say: operator's, arm's.
    pub gateway_told: [Told; 2],
    /// Whether the servo was stepped.
    pub servo_stepped: bool,
    /// When it was stepped last \[step\].
    pub servo_last: i64,
    /// Whether it was stepped after it had not been, though it lived, for longer than a
    /// servo goes on after.
    pub servo_held_up: bool,
    /// When the servo, the arm's end of the link or their host was last not run
    /// though it lived \[step\].
    pub arm_side_stalled: i64,
    /// Whether the driver of the arm was.
    pub arm_stepped: bool,
}

/// The newest message of a topic.
struct Newest<M: Message>(Subscriber<M>);

impl<M: Message> Newest<M> {
    fn open(bus: &Bus, topic: Topic<M>) -> Result<Self, CreateError> {
        Ok(Newest(bus.subscriber(topic, Depth::Newest)?))
    }

    fn take(&mut self, now: Time) -> Option<M> {
        // Later than this step: what was published in it is visible.
        let received = self.0.newest(now.plus_nanos(1));
        received.map(|own| own.message)
    }
}

/// Taps on the arm's host.
pub struct ArmTaps {
    state: Newest<OperatingStateSample>,
    torque: Newest<JointSample>,
    setpoint: Newest<JointSample>,
    measured: Newest<JointSample>,
    tip_command: Newest<PoseSample>,
    link: Newest<LinkStatusSample>,
    health: Subscriber<HealthSample>,
}

impl ArmTaps {
    /// Taps on `bus`.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn open(bus: &Bus) -> Result<ArmTaps, CreateError> {
        Ok(ArmTaps {
            state: Newest::open(bus, topics::FOLLOWER_OPERATING_STATE)?,
            torque: Newest::open(bus, topics::FOLLOWER_SERVO_JF)?,
            setpoint: Newest::open(bus, topics::FOLLOWER_SETPOINT_JS)?,
            measured: Newest::open(bus, topics::FOLLOWER_MEASURED_JS)?,
            tip_command: Newest::open(bus, topics::FOLLOWER_SERVO_CP)?,
            link: Newest::open(bus, topics::LINK_FOLLOWER_STATUS)?,
            health: bus.subscriber(topics::DIAGNOSTICS, Depth::Queue(64))?,
        })
    }

    /// Reads what was published at `now`.
    pub fn read(&mut self, now: Time, seen: &mut Seen) {
        state(&mut self.state, now, &mut seen.follower);
        let count = seen.truth.position.count();
        let of = |places| Joints::from_places(count, places);
        seen.torque = self.torque.take(now).map(|own| of(own.effort));
        let setpoint = self.setpoint.take(now);
        seen.setpoint = setpoint.map(|own| (of(own.position), of(own.velocity)));
        let measured = self.measured.take(now);
        seen.measured = measured.map(|own| of(own.position));
        seen.measured_at = measured.map_or(seen.measured_at, |own| own.stamp);
        seen.tip_command = self.tip_command.take(now).map(|own| own.position);
        link(&mut self.link, now, seen.tick, &mut seen.link_told[1]);
        gateway(&mut self.health, now, seen.tick, &mut seen.gateway_told[1]);
    }
}

/// Taps on the operator's host.
pub struct OperatorTaps {
    state: Newest<OperatingStateSample>,
    hand: Subscriber<PoseSample>,
    accepted_hand: Newest<PoseSample>,
    reflected: Newest<WrenchSample>,
    force: Newest<WrenchSample>,
    link: Newest<LinkStatusSample>,
    health: Subscriber<HealthSample>,
}

impl OperatorTaps {
    /// Taps on `bus`.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn open(bus: &Bus) -> Result<OperatorTaps, CreateError> {
        Ok(OperatorTaps {
            state: Newest::open(bus, topics::LEADER_OPERATING_STATE)?,
            hand: bus.subscriber(topics::LEADER_MEASURED_CP, Depth::Queue(16))?,
            accepted_hand: Newest::open(bus, topics::LEADER_SETPOINT_CP)?,
            reflected: Newest::open(bus, topics::LEADER_REFLECTED_CF)?,
            force: Newest::open(bus, topics::LEADER_SERVO_CF)?,
            link: Newest::open(bus, topics::LINK_STATUS)?,
            health: bus.subscriber(topics::DIAGNOSTICS, Depth::Queue(64))?,
        })
    }

    /// Reads what was published at `now`.
    pub fn read(&mut self, now: Time, seen: &mut Seen) {
        state(&mut self.state, now, &mut seen.leader);
        // What other sources publish is not the hand.
        seen.hand = None;
        while let Some(own) = self.hand.next(now.plus_nanos(1)) {
            if own.message.source <= 1 || own.message.source == CLIENT {
                seen.hand = Some(own.message.position);
            }
        }
        seen.accepted_hand = self.accepted_hand.take(now).map(|own| own.position);
        seen.reflected = self.reflected.take(now).is_some();
        seen.hand_force = self.force.take(now).map(|own| own.force);
        link(&mut self.link, now, seen.tick, &mut seen.link_told[0]);
        gateway(&mut self.health, now, seen.tick, &mut seen.gateway_told[0]);
    }
}

fn state(tap: &mut Newest<OperatingStateSample>, now: Time, device: &mut DeviceState) {
    device.before = device.state;
    if let Some(own) = tap.take(now) {
        device.state = own.state;
    }
}

fn link(tap: &mut Newest<LinkStatusSample>, now: Time, tick: i64, told: &mut Told) {
    if let Some(own) = tap.take(now) {
        let kinds = [
            own.refused_length,
            own.refused_version,
            own.refused_session,
            own.refused_checksum,
            own.refused_time,
            own.refused_value,
            own.refused_replayed,
            own.refused_late,
        ];
        *told = Told {
            refused: kinds.iter().sum(),
            at: tick,
        };
    }
}

fn gateway(tap: &mut Subscriber<HealthSample>, now: Time, tick: i64, told: &mut Told) {
    while let Some(own) = tap.next(now.plus_nanos(1)) {
        if own.message.node.as_str() == "gateway" {
            *told = Told {
                refused: own.message.refused,
                at: tick,
            };
        }
    }
}

impl Seen {
    /// Whether the arm begins to follow commands anew in this step.
    pub fn begins(&self) -> bool {
        self.follower.just_enabled() || (self.follower.enabled() && self.servo_held_up)
    }

    /// Before the first step.
    pub fn first(truth: Truth) -> Seen {
        Seen {
            tick: -1,
            follower: DeviceState::NONE,
            leader: DeviceState::NONE,
            torque: None,
            setpoint: None,
            measured: None,
            measured_at: Time::from_nanos(0),
            tip_command: None,
            hand: None,
            accepted_hand: None,
            reflected: false,
            hand_force: None,
            truth,
            driven: truth.position.map(|_| 0.0),
            forth: Arrivals::default(),
            back: Arrivals::default(),
            link_told: [Told::default(); 2],
            gateway_told: [Told::default(); 2],
            servo_stepped: false,
            servo_last: 0,
            servo_held_up: false,
            arm_side_stalled: i64::MIN,
            arm_stepped: false,
        }
    }
}

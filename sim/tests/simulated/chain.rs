//! The whole chain without nodes or middleware: hand, master, delay law, frames
//! through the channel, servo, arm, and back.

use crate::common::{TICK, TICK_NS, rokviss};
use ferntast_control::delay::{
    FollowerEnd, FollowerInput, Law, LeaderEnd, LeaderInput, Motion, Packet, PositionForce,
    Received,
};
use ferntast_control::frame::{self, FRAME_LENGTH, LinkFrame, WIRE_LENGTH};
use ferntast_control::haptics::{HandCommand, Master, MasterConfig};
use ferntast_control::meter::{Arrival, LinkMeasurement, LinkMeter};
use ferntast_control::operating::{OperatingState, StateCommand};
use ferntast_control::servo::{Command, Measurement, Servo, ServoConfig, ServoInput, Target};
use ferntast_emulation::channel::{Blackout, Channel, ChannelConfig, LinkConfig};
use ferntast_emulation::hand::{Hand, ScriptedHand, ScriptedHandConfig};
use ferntast_model::Joints;
use ferntast_sim::arm::{ArmConfig, SimulatedArm};

const START: i64 = 1_700_000_000_000_000_000;

/// Reach to the lubricated edge, press, slide, let go.
const SCRIPT: &str = r#"
    [impedance]
    mass = 0.5
    damping = 50.0
    stiffness = 1000.0
    [script]
    start = [0.0, 0.0]
    phase = [
        { label = "wait", kind = "hold", duration = 0.5 },
        { label = "reach", kind = "reach", to = [0.0, -0.027], duration = 1.0 },
        { label = "press", kind = "reach", to = [0.0, -0.034], duration = 1.0 },
        { label = "hold", kind = "hold", duration = 1.5 },
        { label = "slide", kind = "reach", to = [-0.020, -0.034], duration = 1.5 },
        { label = "retreat", kind = "reach", to = [0.0, 0.0], duration = 1.0 },
    ]
"#;

/// One end's side of the link.
struct End {
    meter: LinkMeter,
    channel: Channel,
    sequence: u32,
    newest: Option<Packet>,
    fresh: bool,
}

impl End {
    /// `outgoing` is the channel that this end sends into.
    fn new(outgoing: ChannelConfig, seed: u64) -> End {
        End {
            meter: LinkMeter::new(),
            channel: Channel::new(outgoing, seed).expect("valid"),
            sequence: 0,
            newest: None,
            fresh: false,
        }
    }

    fn send(&mut self, now: i64, state: OperatingState, packet: Packet) {
        let frame = LinkFrame {
            sequence: self.sequence,
            stamp_ns: now,
            sent_ns: now,
            echo: self.meter.echo(now),
            hold: state != OperatingState::Enabled,
            state,
            arming: 0,
            law: 0,
            pace: 0,
            since_content: 0,
            packet,
            orientation: None,
        };
        let bytes = frame::encode(&frame);
        self.sequence += 1;
        self.meter.sent();
        // With room for the seal, which a channel of limited rate counts.
        let mut sealed = [0; WIRE_LENGTH];
        sealed[..FRAME_LENGTH].copy_from_slice(&bytes);
        self.channel.push(now, &sealed);
    }

    /// Receives what the other end sent.
    fn receive(&mut self, now: i64, other: &mut Channel) {
        let mut buffer = [0; WIRE_LENGTH];
        while let Some((_, arrived)) = other.pop(now, &mut buffer) {
            match frame::decode(&buffer[..FRAME_LENGTH], arrived, 0) {
                Ok(mut frame) => {
                    self.meter.synchronise(&mut frame, arrived);
                    if self.meter.received(&frame, arrived) == Arrival::Newest {
                        self.newest = Some(frame.packet);
                        self.fresh = true;
                    }
                }
                Err(error) => self.meter.refused(&error),
            }
        }
    }

    fn received(&mut self, now: i64) -> Option<Received> {
        let silence = self.meter.silence(now);
        let age = self.meter.measure(now).age;
        let round_trip = self.meter.round_trip().unwrap_or(0.0);
        let fresh = std::mem::take(&mut self.fresh);
        self.newest.map(|packet| Received {
            packet,
            fresh,
            silence,
            age,
            round_trip,
        })
    }
}

struct Chain {
    now: i64,
    hand: Hand,
    master: Master,
    leader: LeaderEnd,
    leader_link: End,
    follower: FollowerEnd,
    follower_link: End,
    servo: Servo,
    arm: SimulatedArm,
    torque: Joints<f64>,
    command: Option<Command>,
    force: [f64; 3],
}

/// What a tick looked like.
#[derive(Clone, Copy, Debug)]
struct Sight {
    normal_force: f64,
    hand_force: f64,
    state: OperatingState,
    at_leader: LinkMeasurement,
    at_follower: LinkMeasurement,
}

fn servo(config: &ArmConfig) -> Servo {
    Servo::planar(&config.joint, &config.arm, &ServoConfig::default()).expect("valid")
}

impl Chain {
    fn new(link: LinkConfig) -> Chain {
        let config = rokviss();
        let script: ScriptedHandConfig = toml::from_str(SCRIPT).expect("valid");
        let [x, y] = config.contour.nominal_tip;
        let law = Law::PositionForce(PositionForce {
            workspace_offset: [x, y, 0.0],
            ..PositionForce::default()
        });
        let mut master = Master::new(&MasterConfig::default()).expect("valid");
        master.command(StateCommand::Enable).expect("valid");
        Chain {
            now: START,
            hand: Hand::Scripted(Box::new(ScriptedHand::new(&script, 1).expect("valid"))),
            master,
            leader: law.leader(),
            leader_link: End::new(link.up, 2),
            follower: law.follower(),
            follower_link: End::new(link.down, 3),
            servo: servo(&config),
            arm: SimulatedArm::new(&config, 4).expect("valid"),
            torque: [0.0; 2].into(),
            command: None,
            force: [0.0; 3],
        }
    }

    fn tick(&mut self, state_command: Option<StateCommand>) -> Sight {
        self.now += TICK_NS;
        let now = self.now;
        let send = (now - START) % (2 * TICK_NS) == 0;

        let hand = self.hand.step(TICK, self.force);
        let offer = HandCommand {
            stamp_ns: now,
            source: 0,
            position: hand.position,
            orientation: None,
        };
        self.master.offer(now, &offer).expect("valid");

        self.leader_link
            .receive(now, &mut self.follower_link.channel);
        let received = self.leader_link.received(now);
        let connected = self.leader_link.meter.silence(now) <= 0.025;
        let motion = Motion {
            position: hand.position,
            velocity: hand.velocity,
        };
        let output = self.leader.step(
            TICK,
            &LeaderInput {
                hand: Some(motion),
                received,
                connected,
            },
        );
        self.force = self.master.step(now, TICK, Some(output.force)).force;

        self.follower_link
            .receive(now, &mut self.leader_link.channel);
        if send {
            self.leader_link
                .send(now, self.master.state(), output.packet);
        }
        let truth = self.arm.truth();
        let received = self.follower_link.received(now);
        let connected = self.follower_link.meter.silence(now) <= 0.025;
        let output = self.follower.step(
            TICK,
            &FollowerInput {
                tip: Some(Motion {
                    position: [truth.tip[0], truth.tip[1], 0.0],
                    ..Motion::default()
                }),
                contact_force: Some([truth.force[0], truth.force[1], 0.0]),
                received,
                connected,
            },
        );
        if let Some(command) = output.command {
            self.command = Some(Command {
                stamp_ns: now,
                target: Target::Tip(command.position),
            });
        }
        if send {
            self.follower_link
                .send(now, self.servo.state(), output.packet);
        }

        let measured = self.arm.measure();
        let servo = self.servo.step(
            now,
            &ServoInput {
                measurement: Some(Measurement {
                    stamp_ns: now,
                    position: measured.motor_position.into(),
                    velocity: measured.motor_velocity.into(),
                    torque: measured.joint_torque.into(),
                }),
                command: self.command,
                state_command,
            },
        );
        assert_eq!(servo.refused, None);
        self.arm.advance([self.torque[0], self.torque[1]], TICK);
        self.torque = servo.torque;
        Sight {
            normal_force: truth.normal_force,
            hand_force: self.force.iter().map(|own| own * own).sum::<f64>().sqrt(),
            state: servo.state,
            at_leader: self.leader_link.meter.measure(now),
            at_follower: self.follower_link.meter.measure(now),
        }
    }

    fn run(&mut self, ticks: usize) -> Vec<Sight> {
        (0..ticks).map(|_| self.tick(None)).collect()
    }
}

fn preset(text: &str) -> LinkConfig {
    toml::from_str(text).expect("valid")
}

fn range(sights: &[Sight], of: impl Fn(&Sight) -> f64) -> (f64, f64) {
    let values = sights.iter().map(of);
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), own| {
        (low.min(own), high.max(own))
    })
}

#[test]
fn over_rokviss_link_the_hand_feels_the_edge_and_the_contact_is_steady() {
    let link = preset(include_str!("../../../config/links/rokviss_20ms.toml"));
    let mut chain = Chain::new(link);
    chain.tick(Some(StateCommand::Enable));
    let sights = chain.run(7000);
    assert!(
        sights
            .iter()
            .all(|own| own.state == OperatingState::Enabled)
    );
    let held = &sights[3000..3999];
    let (low, high) = range(held, |own| own.normal_force);
    let (soft, hard) = range(held, |own| own.hand_force);
    println!("contact {low} … {high} N, hand {soft} … {hard} N");
    assert!(low > 10.0 && high < 120.0, "{low} … {high} N");
    assert!(high - low < 5.0, "it bounces: {low} … {high} N");
    assert!(soft > 0.5, "{soft} N");
    // Force on the hand is scaled contact force, what the limits allow.
    let scale = PositionForce::default().force_scale;
    assert!((hard - scale * high).abs() < 0.2 * scale * high, "{hard} N");
    assert_eq!(sights[6999].normal_force, 0.0);
    // Measured, not configured: exactly what the channel does.
    let end = sights[6999];
    assert_eq!(end.at_leader.round_trip, 0.020);
    assert_eq!(end.at_follower.round_trip, 0.020);
    assert_eq!((end.at_leader.delay, end.at_follower.delay), (0.010, 0.010));
    let lost = end.at_leader.lost + end.at_follower.lost;
    assert!((1..=20).contains(&lost), "{lost} of 7000");
}

#[test]
fn what_is_measured_is_what_was_injected() {
    for delay in [0.0, 0.010, 0.050, 0.300] {
        let one_way = ChannelConfig::with_delay(delay);
        let link = LinkConfig {
            up: one_way.clone(),
            down: one_way,
            ..LinkConfig::default()
        };
        let mut chain = Chain::new(link);
        chain.tick(Some(StateCommand::Enable));
        let end = chain.run(1500)[1499];
        assert_eq!(end.at_leader.round_trip, 2.0 * delay);
        assert_eq!(end.at_leader.jitter, 0.0);
        assert_eq!(end.at_leader.loss, 0.0);
    }
}

#[test]
fn a_blackout_holds_the_arm_within_30_ms_and_resume_brings_it_back() {
    let mut link = preset(include_str!("../../../config/links/rokviss_20ms.toml"));
    link.up.loss = None;
    link.up.blackout.push(Blackout {
        start: 2.0,
        duration: 0.5,
        period: 0.0,
    });
    let mut chain = Chain::new(link);
    chain.tick(Some(StateCommand::Enable));
    let sights = chain.run(4000);
    let paused = sights
        .iter()
        .position(|own| own.state == OperatingState::Paused)
        .expect("valid");
    // The last frame went in just before 2 s and was 10 ms on its way.
    let silence = paused as f64 * TICK - 2.010;
    assert!((0.022..=0.030).contains(&silence), "{silence} s");
    assert!(
        sights[paused..]
            .iter()
            .all(|own| own.state == OperatingState::Paused)
    );
    let tip = |chain: &Chain| chain.arm.truth().tip;
    let held = tip(&chain);
    let sight = chain.tick(Some(StateCommand::Resume));
    assert_eq!(sight.state, OperatingState::Enabled);
    let mut before = held;
    for _ in 0..4000 {
        let sight = chain.tick(None);
        assert_eq!(sight.state, OperatingState::Enabled);
        let now = tip(&chain);
        let step = (now[0] - before[0]).hypot(now[1] - before[1]);
        // Nowhere faster than the approach (0.2 rad/s a joint) or the hand.
        assert!(step < 0.25e-3, "{step} m in a tick");
        before = now;
    }
}

#[test]
fn a_hold_releases_what_it_presses() {
    let link = preset(include_str!("../../../config/links/rokviss_20ms.toml"));
    let mut chain = Chain::new(link);
    chain.tick(Some(StateCommand::Enable));
    let pressing = chain.run(3500)[3499].normal_force;
    chain.tick(Some(StateCommand::Pause));
    let sights = chain.run(1000);
    assert!(pressing > 25.0, "{pressing} N");
    // Friction of the gear would keep all of it.
    for (ms, sight) in sights.iter().enumerate().skip(150) {
        let force = sight.normal_force;
        assert!((0.0..=5.0).contains(&force), "{force} N after {ms} ms");
    }
}

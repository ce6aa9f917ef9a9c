//! What an end counts comes out as a message.

use ferntast_control::{
    delay::Law,
    frame::FRAME_LENGTH,
    haptics::MasterConfig,
    link::{FollowerLink, FollowerReadings, LeaderLink, StampedPosition},
    operating::OperatingState,
    switching::Laws,
};
use ferntast_emulation::hand::{Hand, ScriptedHand, ScriptedHandConfig};
use ferntast_msgs::{
    Time,
    sample::{
        self as own, ContactStateSample, Edge, Frame, JointNames, JointSample, LinkEnd,
        OperatingStateSample, PoseSample, StateCommand, StateCommandSample, WrenchSample,
    },
};

use ferntast_seal::{Established, PrivateKey, Refusal};

use super::{
    FollowerLinkInput, FollowerLinkNode, FollowerLinkOutput, FrameInput, LeaderLinkInput,
    LeaderLinkNode, LeaderLinkOutput,
};
use crate::master::{MasterInput, MasterNode, MasterOutput};
use crate::node::{Newest, Node, Output};

#[test]
fn the_status_says_every_10_ms_what_was_refused() {
    let link = FollowerLink::new(Laws::new(Law::default()), 0.0);
    let mut node = FollowerLinkNode::new(link, 7);
    // The first is of long ago, the second says a position that is not a number.
    let mut spoilt = [0; FRAME_LENGTH];
    spoilt[18..22].copy_from_slice(&f32::NAN.to_le_bytes());
    let frames = FrameInput::of([&[0; FRAME_LENGTH][..], &spoilt], Time::from_nanos(1));
    let mut input = FollowerLinkInput {
        frames,
        ..FollowerLinkInput::default()
    };
    input.frames.peer.refused.forged = 5;
    input.frames.peer.last_refusal = Some(Refusal::Forged);
    let mut output = FollowerLinkOutput::default();
    let mut told = Vec::new();
    for tick in 0..21 {
        output.clear();
        let now = Time::from_nanos(1_700_000_000_000_000_000 + tick * 1_000_000);
        node.step(now, &input, &mut output);
        told.extend(output.status);
    }
    assert_eq!(told.len(), 3);
    let last = told[2];
    assert_eq!((last.refused_checksum, last.refused_value), (5, 21));
    assert_eq!(
        (last.end, last.session, last.connected),
        (LinkEnd::FOLLOWER, 7, 0)
    );
    assert_eq!(last.law.as_str(), Law::default().name());
    assert_eq!(
        output.health.refused,
        21 + 5 + last.refused_time + last.refused_replayed
    );
}

const START: i64 = 1_700_000_000_000_000_000;

fn established(clock_offset_ns: i64) -> Established {
    Established {
        incarnation: 1,
        peer: PrivateKey::from_random([1; 32]).public(),
        clock_offset_ns,
    }
}

fn joints() -> JointNames {
    JointNames::new(["shoulder", "elbow"]).expect("valid")
}

/// An arm's end that shows its arm, and an operator's whose clock is 3 s behind.
#[test]
fn the_arm_is_shown_at_the_operator_s_end_with_when_it_was_so_by_the_clock_there() {
    let laws = || Laws::new(Law::default());
    let mut arm = FollowerLinkNode::new(FollowerLink::new(laws(), 0.0), 7).showing();
    let mut operator = LeaderLinkNode::new(LeaderLink::new(laws(), 0.0), 7, joints(), false);
    let one = JointNames::new(["alone"]).expect("valid");
    let mut wrong = LeaderLinkNode::new(LeaderLink::new(laws(), 0.0), 7, one, false);
    let ahead = 3_000_000_000;
    let there = |tick: i64| Time::from_nanos(START + ahead + tick * 1_000_000);
    let mut shown = Vec::new();
    for tick in 0..200 {
        let now = there(tick);
        let measured = JointSample::zero(joints(), now).with_position([0.1, -0.001 * tick as f64]);
        let contact = ContactStateSample {
            in_contact: 1,
            touches: 1,
            valid: 1,
            edge: Edge::UNLUBRICATED,
            normal_force: 8.0,
            ..ContactStateSample::initial(now)
        };
        let why = "commands fell silent";
        let paused = OperatingStateSample::new(now, own::OperatingState::PAUSED, why);
        let input = FollowerLinkInput {
            // Nothing is measured in the first tenth of a second.
            measured_js: newest(now, (tick >= 100).then_some(measured)),
            measured_cp: newest(
                now,
                Some(PoseSample::at(now, Frame::FOLLOWER_BASE, [0.3, 0.2, 0.0])),
            ),
            measured_cf: newest(
                now,
                Some(WrenchSample::force(
                    now,
                    Frame::FOLLOWER_BASE,
                    [0.0, -8.0, 0.0],
                )),
            ),
            contact_state: newest(now, Some(contact)),
            operating_state: newest(now, Some(paused)),
            ..FollowerLinkInput::default()
        };
        let mut sent = FollowerLinkOutput::default();
        arm.step(now, &input, &mut sent);
        let here = Time::from_nanos(START + tick * 1_000_000 + 500_000);
        let mut seen = LeaderLinkInput::default();
        let frames = sent.frame.frame.iter().map(|frame| &**frame);
        seen.frames = FrameInput::of(frames, here);
        seen.frames.peer.established = Some(established(ahead));
        if let Some(view) = sent.frame.view {
            seen.frames.see(&view, here);
        }
        let mut told = LeaderLinkOutput::default();
        operator.step(here, &seen, &mut told);
        if let Some(state) = told.arm_state.filter(|_| tick > 0) {
            let told = (state.state, state.reason.as_str());
            assert_eq!(told, (own::OperatingState::PAUSED, why));
        }
        let shows = told.arm_js.is_some();
        if let Some(js) = told.arm_js {
            let tick = (js.stamp.nanos() - START) as f64 / 1e6;
            assert!((js.position[1] + 0.001 * tick).abs() < 1e-6, "{js:?}");
            assert_eq!(js.joints, joints());
            let (cp, cf) = (told.arm_cp.expect("with it"), told.arm_cf.expect("with it"));
            assert!((cp.position[0] - 0.3).abs() < 1e-6 && cf.force == [0.0, -8.0, 0.0]);
            let contact = told.arm_contact.expect("with it");
            let told = (contact.in_contact, contact.edge, contact.normal_force);
            assert_eq!(told, (1, Edge::UNLUBRICATED, 8.0));
            shown.push(js);
        }
        let mut told = LeaderLinkOutput::default();
        wrong.step(here, &seen, &mut told);
        let words = told.health.message.as_str().contains("--arm differs");
        assert!(
            told.arm_js.is_none() && words == shows,
            "{}",
            told.health.message.as_str()
        );
    }
    // At 120 and at 160 ms; before, views said why.
    assert_eq!(shown.len(), 2);
}

fn newest<M>(now: Time, message: Option<M>) -> Newest<M> {
    Newest {
        message,
        received: now,
        fresh: true,
    }
}

/// Master and leader's end on a bus that takes a step, and an arm's end that sends
/// `force` \[N\] along x.
struct Operator {
    master: MasterNode,
    leader: LeaderLinkNode,
    arm: FollowerLink,
    into_master: MasterInput,
    into_leader: LeaderLinkInput,
    /// What the hand gave to the two-port \[J\], as hand and master have it.
    work: f64,
    hand: Option<[f64; 3]>,
    force: [f64; 3],
}

impl Operator {
    /// A master whose force changes by 100 N/s at most; without a `hand` a client is it.
    fn new(hand: Option<Hand>) -> Operator {
        let config = MasterConfig {
            force_rate_limit: 100.0,
            ..MasterConfig::default()
        };
        let laws = || Laws::new(Law::default());
        let mut into_master = MasterInput::default();
        let enable = StateCommandSample::new(Time::from_nanos(START), StateCommand::ENABLE);
        into_master.state_command.push(enable);
        Operator {
            master: MasterNode::new(&config, hand).expect("valid"),
            leader: LeaderLinkNode::new(LeaderLink::new(laws(), 0.0), 7, joints(), false),
            arm: FollowerLink::new(laws(), 0.0),
            into_master,
            into_leader: LeaderLinkInput::default(),
            work: 0.0,
            hand: None,
            force: [0.0; 3],
        }
    }

    /// One step; gives what the leader's end says of the energy that its port kept \[J\].
    fn step(&mut self, tick: i64, client: Option<[f64; 3]>, force: f64) -> Option<f64> {
        let now = Time::from_nanos(START + tick * 1_000_000);
        if let Some(position) = client {
            let pose = PoseSample {
                source: 5,
                ..PoseSample::at(now, Frame::LEADER_BASE, position)
            };
            self.into_master.measured_cp.push(pose);
        }
        let (mut felt, mut told) = (MasterOutput::default(), LeaderLinkOutput::default());
        self.master.step(now, &self.into_master, &mut felt);
        self.leader.step(now, &self.into_leader, &mut told);
        let tip = StampedPosition {
            stamp_ns: now.nanos(),
            position: Law::default().mapping().workspace_offset,
            silence: 0.0,
        };
        let arm = FollowerReadings {
            tip: Some(tip),
            contact_force: Some([force, 0.0, 0.0]),
            state: OperatingState::Enabled,
            told_to_stop: false,
        };
        if let Some(frame) = told.frame.frame {
            self.arm.arrived(&frame, now.nanos());
        }
        let sent = self.arm.step(now.nanos(), &arm).frame;

        // The hand as it is, under the force that was the same all the way.
        let hand = client.or(felt.own_hand.map(|own| own.position));
        if let (Some(hand), Some(before)) = (hand, self.hand) {
            let axes = self.force.iter().zip(hand.iter().zip(before));
            self.work -= axes.map(|(f, (now, then))| f * (now - then)).sum::<f64>();
        }
        self.hand = hand;
        self.force = felt.servo_cf.map(|own| own.force).expect("in every step");
        self.into_master = MasterInput {
            reflected_cf: newest(now, told.reflected_cf),
            ..MasterInput::default()
        };
        self.into_leader = LeaderLinkInput {
            setpoint_cp: newest(now, felt.setpoint_cp),
            servo_cf: newest(now, felt.servo_cf),
            operating_state: newest(now, felt.operating_state),
            frames: FrameInput::of(sent.as_slice().iter().map(|frame| &**frame), now),
            ..LeaderLinkInput::default()
        };
        told.status.map(|own| own.energy_in - own.energy_out)
    }

    /// Energy that the port kept by the leader's end and in truth \[J\], after 2 s under a force
    /// that goes on and off.
    fn run(&mut self, client: impl Fn(f64) -> Option<[f64; 3]>) -> (f64, f64) {
        let mut last = (0.0, 0.0);
        let mut work = 0.0;
        for tick in 0..2000 {
            let at = tick as f64 * 1e-3;
            let force = if (at * 2.5).fract() < 0.5 { -40.0 } else { 0.0 };
            if let Some(balance) = self.step(tick, client(at), force) {
                // The leader's end has the hand of the step before.
                last = (balance, work);
            }
            work = self.work;
        }
        last
    }
}

/// To and fro by 5 cm.
const SWAY: &str = r#"
[script]
phase = [{ label = "sway", kind = "sine", amplitude = [0.05, 0.0], frequency = 1.7, duration = 10.0 }]
"#;

/// A hand of its own, and a client's.
#[test]
fn the_status_counts_the_force_that_the_master_rendered() {
    let own: ScriptedHandConfig = toml::from_str(SWAY).expect("valid");
    let own = Hand::Scripted(Box::new(ScriptedHand::new(&own, 1).expect("valid")));
    let sway = |at: f64| Some([0.05 * (std::f64::consts::TAU * 1.7 * at).sin(), 0.0, 0.0]);
    for (what, (metered, work)) in [
        ("own", Operator::new(Some(own)).run(|_| None)),
        ("client", Operator::new(None).run(sway)),
    ] {
        assert!(work.abs() > 0.01, "{what}: nothing happened, {work} J");
        assert!(
            (metered - work).abs() < 1e-3 * work.abs(),
            "{what}: {metered} J of {work} J"
        );
    }
}

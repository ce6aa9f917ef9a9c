//! An arm as the hand: what its joints give in a simulated hand, when they give nothing, and what is
//! done with drives that know no torque.

use std::{cell::RefCell, rc::Rc};

use ferntast_config::{ArmFile, Axes, serial::Serial};
use ferntast_drivers::{
    Driver, DriverCommand, Measures, Reading,
    leader::{Device, HeldArm, LeaderInput, LeaderNode, LeaderOutput, SOURCE},
    simulated::load_arm,
};
use ferntast_emulation::hand::ScriptedHandConfig;
use ferntast_model::Joints;
use ferntast_msgs::{
    Message, Time,
    sample::{
        AuthoritySample, Frame, JointNames, OperatingState, OperatingStateSample, WrenchSample,
    },
};
use ferntast_nodes::node::{Newest, Node, NodeHealth, Output};

const TICK_NANOS: i64 = 1_000_000;
const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

fn axes(names: [&str; 3]) -> Axes {
    Axes::named(&names.map(String::from)).expect("axes")
}

fn serial(file: &ArmFile) -> &Serial {
    file.model.serial().expect("a serial arm")
}

/// What the master says.
#[derive(Clone, Copy)]
struct Says {
    state: OperatingState,
    holder: u64,
    force: Option<[f64; 3]>,
}

const HOLDS: Says = Says {
    state: OperatingState::ENABLED,
    holder: SOURCE,
    force: Some([2.0, -1.0, 3.0]),
};

struct Bench {
    node: LeaderNode,
    input: LeaderInput,
    now: Time,
}

impl Bench {
    fn new(device: Device, arm: &str, axes: Axes) -> Bench {
        let file = load_arm(arm).expect("an arm");
        let node = LeaderNode::new(device, serial(&file).arm.clone(), axes, true);
        Bench {
            node,
            input: LeaderInput::default(),
            now: START,
        }
    }

    /// A simulated arm in a hand that stays.
    fn held(arm: &str, axes: Axes) -> Bench {
        let file = load_arm(arm).expect("an arm");
        let hand = ScriptedHandConfig::default();
        let held = HeldArm::new(&file, serial(&file), axes, &hand, 1).expect("an arm");
        Bench::new(Device::Held(Box::new(held)), arm, axes)
    }

    /// So many milliseconds; gives the last output.
    fn run(&mut self, ticks: usize, says: Says) -> LeaderOutput {
        fn hear<M: Message>(place: &mut Newest<M>, now: Time, message: M) {
            *place = Newest {
                message: Some(message),
                received: now,
                fresh: true,
            };
        }
        let mut output = LeaderOutput::default();
        for _ in 0..ticks {
            self.now = self.now.plus_nanos(TICK_NANOS);
            let now = self.now;
            let authority = AuthoritySample {
                holder: says.holder,
                ..AuthoritySample::initial(now)
            };
            hear(&mut self.input.authority, now, authority);
            let mut state = OperatingStateSample::initial(now);
            state.state = says.state;
            hear(&mut self.input.state, now, state);
            if let Some(force) = says.force {
                let force = WrenchSample::force(now, Frame::LEADER_BASE, force);
                hear(&mut self.input.force, now, force);
            }
            output.clear();
            self.node.step(now, &self.input, &mut output);
        }
        output
    }

    /// The force of the hand on the tip, by the simulation's truth.
    fn grip(&self) -> [f64; 3] {
        match self.node.device() {
            Device::Held(held) => held.arm().truth().grip_force.into(),
            Device::Driven(_) => [f64::NAN; 3],
        }
    }
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn the_hand_holds_against_the_force_that_the_master_says() {
    // The tip of an arm of five joints turns as it gives way, which the hand resists as well.
    for (arm, axes, most) in [
        ("so101", axes(["x", "y", "z"]), 0.05),
        ("so101", axes(["-y", "x", "z"]), 0.05),
        ("ur5", axes(["x", "y", "z"]), 0.005),
    ] {
        let mut bench = Bench::held(arm, axes);
        bench.run(4000, HOLDS);
        let against = bench.grip().map(|own| -own);
        let wanted = axes.to_device([2.0, -1.0, 3.0]);
        let off = apart(against, wanted) / 14.0_f64.sqrt();
        println!("{arm}: {against:?} N of {wanted:?} N, {:.2} %", 100.0 * off);
        assert!(
            off < most,
            "{arm}: {against:?} N where {wanted:?} N are wanted"
        );
    }
}

#[test]
fn without_the_masters_word_there_is_the_arms_weight_alone() {
    for (what, says) in [
        (
            "disabled",
            Says {
                state: OperatingState::DISABLED,
                ..HOLDS
            },
        ),
        (
            "paused",
            Says {
                state: OperatingState::PAUSED,
                ..HOLDS
            },
        ),
        (
            "fault",
            Says {
                state: OperatingState::FAULT,
                ..HOLDS
            },
        ),
        (
            "another hand",
            Says {
                holder: SOURCE + 1,
                ..HOLDS
            },
        ),
        ("nobody", Says { holder: 0, ..HOLDS }),
        (
            "silence",
            Says {
                force: None,
                ..HOLDS
            },
        ),
    ] {
        let mut bench = Bench::held("so101", axes(["x", "y", "z"]));
        bench.run(2000, HOLDS);
        assert!(apart(bench.grip(), [0.0; 3]) > 3.0, "{what}");
        bench.run(2000, says);
        let left = apart(bench.grip(), [0.0; 3]);
        assert!(left < 0.05, "{what}: {left} N");
    }
}

/// Drives that a test looks at.
#[derive(Default)]
struct Seen {
    enabled: Vec<bool>,
    torque: Vec<f64>,
    silent: bool,
}

struct Drives {
    joints: JointNames,
    gives_torque: bool,
    seen: Rc<RefCell<Seen>>,
}

impl Driver for Drives {
    fn joints(&self) -> JointNames {
        self.joints
    }

    fn measures(&self) -> Measures {
        Measures::default()
    }

    fn gives_torque(&self) -> bool {
        self.gives_torque
    }

    fn enable(&mut self, enabled: bool) {
        self.seen.borrow_mut().enabled.push(enabled);
    }

    fn write(&mut self, command: &DriverCommand, _health: &mut NodeHealth) {
        self.seen.borrow_mut().torque = command.torque.to_vec();
    }

    fn read(&mut self, _health: &mut NodeHealth) -> Option<Reading> {
        let zero = Joints::from([0.0; 5]);
        (!self.seen.borrow().silent).then_some(Reading {
            position: zero,
            velocity: zero,
            joint_torque: None,
            motor_torque: None,
            temperature: None,
        })
    }
}

fn drives(gives_torque: bool) -> (Bench, Rc<RefCell<Seen>>) {
    let file = load_arm("so101").expect("an arm");
    let seen = Rc::new(RefCell::new(Seen::default()));
    let own = Drives {
        joints: serial(&file).joints,
        gives_torque,
        seen: seen.clone(),
    };
    let device = Device::Driven(Box::new(own));
    (Bench::new(device, "so101", axes(["x", "y", "z"])), seen)
}

#[test]
fn drives_that_know_no_torque_are_left_limp_and_that_is_told() {
    let (mut bench, seen) = drives(false);
    let output = bench.run(1000, HOLDS);
    assert!(output.measured_cp.is_some(), "the hand is there");
    assert!(output.health.message.as_str().contains("limp"));
    assert_eq!(seen.borrow().enabled, Vec::<bool>::new());
    assert!(seen.borrow().torque.iter().all(|own| *own == 0.0));
}

#[test]
fn joints_that_fall_silent_are_no_hand_and_get_no_torque() {
    let (mut bench, seen) = drives(true);
    let output = bench.run(1000, HOLDS);
    let pose = output.measured_cp.expect("the hand is there");
    assert_eq!((pose.source, pose.frame), (SOURCE, Frame::LEADER_BASE));
    assert!(seen.borrow().torque.iter().any(|own| own.abs() > 0.1));
    seen.borrow_mut().silent = true;
    // A bus that is slower than the node is not silent.
    let output = bench.run(20, HOLDS);
    assert!(output.measured_cp.is_none());
    assert_eq!(seen.borrow().enabled, [true]);
    bench.run(10, HOLDS);
    assert_eq!(seen.borrow().enabled, [true, false]);
    assert!(seen.borrow().torque.iter().all(|own| *own == 0.0));
    seen.borrow_mut().silent = false;
    bench.run(3, HOLDS);
    assert_eq!(seen.borrow().enabled, [true, false, true]);
}

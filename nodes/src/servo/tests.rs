//! The servo's friction feed-forward, told by messages.

use ferntast_msgs::sample::{Faults, FrictionCommand, FrictionSource};

use super::*;
use crate::node::{Newest, Output};

const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

struct Bench {
    node: ServoNode,
    now: Time,
    last: [Option<FrictionStatusSample>; 2],
    faults: Faults,
    words: Text<96>,
}

impl Bench {
    fn new() -> Self {
        let arm = ferntast_config::load_model_only("rokviss").unwrap();
        Self {
            node: ServoNode::new(&arm.model, &ServoConfig::default()).unwrap(),
            now: START,
            last: [None; 2],
            faults: Faults::default(),
            words: Text::EMPTY,
        }
    }

    /// Steps for `seconds`, with a command in the first step.
    fn run(
        &mut self,
        seconds: f64,
        command: Option<FrictionCommand>,
        twin: Option<TwinParametersSample>,
    ) {
        let mut command = command;
        self.faults = Faults::default();
        for _ in 0..(seconds * 1e3) as i64 {
            self.now = self.now.plus_nanos(1_000_000);
            let mut input = ServoInput::default();
            if let Some(twin) = twin {
                input.twin.push(twin);
            }
            if let Some(command) = command.take() {
                let sample = FrictionCommandSample::new(self.now, command);
                input.friction_command.push(sample);
            }
            let mut output = ServoOutput::default();
            output.clear();
            self.node.step(self.now, &input, &mut output);
            for (last, new) in self.last.iter_mut().zip(&output.friction[..]) {
                *last = new.or(*last);
            }
            self.faults.0 |= output.health.faults.0;
            self.words = output.health.message;
        }
    }

    /// A twin of joint 2 that found so many times the configured friction, now.
    fn twin(&self, factor: f64) -> TwinParametersSample {
        let mut twin = TwinParametersSample {
            joint: Text::new("joint_2"),
            ..TwinParametersSample::initial(self.now)
        };
        let configured = [12.372, 0.146, 163.301, -578.954, 547.449];
        for (i, (name, value)) in ["b0", "b0T", "b1", "b2", "b3"]
            .into_iter()
            .zip(configured)
            .enumerate()
        {
            twin.names[i] = Text::new(name);
            twin.values[i] = factor * value;
            twin.std_errors[i] = 0.01 * value.abs();
            twin.excitation[i] = 0.999;
            twin.count += 1;
        }
        twin
    }

    fn values(&self, joint: usize) -> Vec<f64> {
        let status = self.last[joint].unwrap();
        status.values[..status.len()].to_vec()
    }
}

#[test]
fn what_the_twin_found_is_taken_over_told_and_given_back() {
    let mut bench = Bench::new();
    bench.run(0.5, None, None);
    let configured = bench.values(1);
    let twin = bench.twin(1.2);
    bench.run(3.1, Some(FrictionCommand::TAKE_OVER), Some(twin));
    let status = bench.last[1].unwrap();
    assert_eq!(status.source, FrictionSource::TWIN);
    assert_eq!((status.commands, status.refused.as_str()), (1, ""));
    for (now, was) in bench.values(1).iter().zip(&configured) {
        assert!((now / was - 1.2).abs() < 1e-9);
    }
    assert!(bench.faults.is_empty() || !bench.faults.has(Fault::TakeOverRefused));
    // The other joint keeps its own.
    assert_eq!(bench.last[0].unwrap().source, FrictionSource::CONFIGURED);
    bench.run(3.1, Some(FrictionCommand::GIVE_BACK), None);
    assert_eq!(bench.values(1), configured);
    assert_eq!(bench.last[1].unwrap().source, FrictionSource::CONFIGURED);
    assert_eq!(bench.last[1].unwrap().commands, 2);
}

#[test]
fn what_must_not_be_taken_over_is_refused_with_a_reason() {
    let mut bench = Bench::new();
    bench.run(0.5, None, None);
    let configured = bench.values(1);
    let good = bench.twin(1.2);
    let mut old = good;
    old.stamp = START.plus_seconds(-10.0);
    let mut future = good;
    future.stamp = START.plus_seconds(3600.0);
    let far = bench.twin(1.9);
    let mut poor = good;
    poor.excitation = [0.1; 16];
    let mut unsure = good;
    unsure.std_errors = [1e4; 16];
    let mut third = good;
    third.joint = Text::new("joint_7");
    let mut strange = good;
    strange.count = 900;
    strange.values = [f64::NAN; 16];
    for (twin, reason) in [
        (None, "no twin"),
        (Some(third), "joint"),
        (Some(old), "s old"),
        (Some(future), "s old"),
        (Some(far), "b_0 = "),
        (Some(poor), "no friction parameter"),
        (Some(unsure), "no friction parameter"),
        (Some(strange), "no friction parameter"),
    ] {
        // Stamps are of now, but where they are meant to be wrong.
        let twin = twin.map(|mut twin| {
            if twin.stamp == good.stamp {
                twin.stamp = bench.now;
            }
            twin
        });
        bench.run(0.01, Some(FrictionCommand::TAKE_OVER), twin);
        let status = bench.last[1].unwrap();
        assert!(status.refused.as_str().contains(reason), "{status:?}");
        assert!(bench.faults.has(Fault::TakeOverRefused));
        assert!(bench.words.as_str().contains(reason), "{}", bench.words);
        assert_eq!(status.source, FrictionSource::CONFIGURED);
    }
    bench.run(3.0, None, None);
    assert_eq!(bench.values(1), configured);
}

#[test]
fn joint_states_of_other_joints_are_refused_and_in_another_order_are_not() {
    let mut bench = Bench::new();
    let step = |bench: &mut Bench, names: [&str; 2]| {
        bench.now = bench.now.plus_nanos(1_000_000);
        let joints = JointNames::new(names).unwrap();
        let input = ServoInput {
            measured_js: Newest {
                message: Some(JointSample::zero(joints, bench.now)),
                received: bench.now,
                fresh: true,
            },
            ..ServoInput::default()
        };
        let mut output = ServoOutput::default();
        output.clear();
        bench.node.step(bench.now, &input, &mut output);
        output.health
    };
    let health = step(&mut bench, ["joint_2", "joint_1"]);
    assert!(!health.faults.has(Fault::MeasurementInvalid));
    let health = step(&mut bench, ["joint_1", "elbow"]);
    assert!(health.faults.has(Fault::MeasurementInvalid));
    let needed = "joints joint_1, elbow where joint_1, joint_2 are needed";
    assert_eq!(health.message.as_str(), needed);
}

/// A client whose clock is ahead is told once, and does not lock out the link.
#[test]
fn a_command_of_a_time_to_come_stands_in_nobodys_way() {
    let now = START;
    let names = JointNames::new(["joint_1", "joint_2"]).unwrap();
    let joints = JointCount::new(2).unwrap();
    let tip = PoseSample::at(
        now,
        ferntast_msgs::sample::Frame::FOLLOWER_BASE,
        [0.2, 0.1, 0.0],
    );
    let mut ahead = JointSample::empty(names, now.plus_seconds(10.0));
    ahead.set_position(&[0.1, 0.2]);
    let of = |ahead: JointSample, fresh: bool, tip: Option<PoseSample>| {
        let input = ServoInput {
            servo_cp: Newest {
                message: tip,
                received: now,
                fresh: true,
            },
            servo_jp: Newest {
                message: Some(ahead),
                received: now,
                fresh,
            },
            ..ServoInput::default()
        };
        command(now, &input, Some(&ahead), joints)
    };
    let is_tip = |own: Option<Command>| matches!(own.map(|own| own.target), Some(Target::Tip(_)));
    let is_joints =
        |own: Option<Command>| matches!(own.map(|own| own.target), Some(Target::Joints(_)));
    // As it arrives it is judged, and refused for its time.
    assert!(is_joints(of(ahead, true, Some(tip))));
    assert!(is_tip(of(ahead, false, Some(tip))));
    assert!(of(ahead, false, None).is_none());
    // Within what clocks of one host may disagree by, the newer counts.
    ahead.stamp = now.plus_seconds(0.004);
    assert!(is_joints(of(ahead, false, Some(tip))));
    ahead.stamp = now.plus_seconds(-0.001);
    assert!(is_tip(of(ahead, false, Some(tip))));
}

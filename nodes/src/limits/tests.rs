//! What is near is reported, and only that.

use std::{cell::RefCell, rc::Rc};

use ferntast_bus::Depth;
use ferntast_config::{Loaded, load_model_only};
use ferntast_msgs::topics;

use super::*;
use crate::{
    graph::NodeRow,
    lockstep::VirtualTime,
    node::{Newest, Output, PerJoint},
    process::{Priority, SessionContext},
};

const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

fn model() -> Believed {
    load_model_only("rokviss").unwrap().model
}

/// A measurement in the middle of all ranges.
fn middle(now: Time) -> JointSample {
    let mut sample = JointSample::zero(model().joint_names(), now);
    for (position, joint) in sample.position.iter_mut().zip(model().joints()) {
        *position = 0.5 * (joint.position_lower + joint.position_upper);
    }
    sample
}

fn newest<M>(message: M) -> Newest<M> {
    Newest {
        message: Some(message),
        received: START,
        fresh: true,
    }
}

/// The joint at that place has that temperature \[degC\].
fn warm(joint: usize, temperature: f64) -> PerJoint<Newest<TemperatureSample>> {
    let mut all = PerJoint::default();
    all[joint] = newest(TemperatureSample::new(START, temperature));
    all
}

/// Severity and message of a step on that input.
fn told(input: &LimitsInput) -> (Level, String) {
    let mut node = LimitsNode::new(&model(), LimitsSection::default());
    let mut output = LimitsOutput::default();
    node.step(START, input, &mut output);
    let health = output.health();
    (health.level, health.message.to_string())
}

#[test]
fn an_arm_in_the_middle_is_well() {
    let input = LimitsInput {
        measured_js: newest(middle(START)),
        temperature: warm(0, 20.0),
    };
    assert_eq!(told(&input), (Level::OK, String::new()));
    assert_eq!(told(&LimitsInput::default()), (Level::OK, String::new()));
}

#[test]
fn what_is_near_is_told_with_its_margin() {
    let model = model();
    let mut sample = middle(START);
    sample.position[1] = model.joints()[1].position_upper - 0.05;
    let input = LimitsInput {
        measured_js: newest(sample),
        ..LimitsInput::default()
    };
    let (level, words) = told(&input);
    assert_eq!(level, Level::WARN);
    assert_eq!(words, "joint_2 is 0.05 rad from the end of its range");

    let mut sample = middle(START);
    let range = model.joints()[0].torque_sensor_range;
    sample.effort[0] = -0.9 * range;
    let input = LimitsInput {
        measured_js: newest(sample),
        ..LimitsInput::default()
    };
    let (level, words) = told(&input);
    assert_eq!(level, Level::WARN);
    assert!(words.starts_with("joint_1 bears"), "{words}");

    let input = LimitsInput {
        temperature: warm(1, 75.0),
        ..LimitsInput::default()
    };
    assert_eq!(
        told(&input),
        (Level::WARN, "joint_2 is at 75 °C".to_owned())
    );
}

/// Joints are found by their names, not by their places.
#[test]
fn a_sample_in_another_order_is_read_by_name() {
    let model = model();
    let mut reversed = JointSample::zero(JointNames::new(["joint_2", "joint_1"]).unwrap(), START);
    for (place, joint) in model.joints().iter().rev().enumerate() {
        reversed.position[place] = 0.5 * (joint.position_lower + joint.position_upper);
    }
    reversed.position[0] = model.joints()[1].position_upper - 0.05;
    let input = LimitsInput {
        measured_js: newest(reversed),
        ..LimitsInput::default()
    };
    assert_eq!(
        told(&input).1,
        "joint_2 is 0.05 rad from the end of its range"
    );
}

#[test]
fn an_old_measurement_says_nothing() {
    let mut sample = middle(START);
    sample.position[0] = 10.0;
    let mut input = LimitsInput {
        measured_js: newest(sample),
        ..LimitsInput::default()
    };
    input.measured_js.received = START.plus_seconds(-1.0);
    assert_eq!(told(&input).0, Level::OK);
}

/// In virtual time, from the arm's topic to `/diagnostics`.
#[test]
fn in_lockstep_the_warning_comes_and_goes() {
    let arm = load_model_only("rokviss").unwrap();
    let upper = arm.model.joints()[0].position_upper;
    let loaded = Loaded::without_operator(arm, Default::default(), 1);
    let row = NodeRow {
        period_nanos: 10_000_000,
        ..NodeRow::step::<LimitsPorts>("limits", "", Priority::Advice, make)
    };
    let mut time = VirtualTime::new(START).unwrap();
    time.add_nodes([&row], &SessionContext::in_virtual_time(loaded))
        .unwrap();
    let mut arm = time.bus().publisher(topics::FOLLOWER_MEASURED_JS).unwrap();
    let near = Rc::new(RefCell::new(false));
    let is_near = near.clone();
    time.add(move |now| {
        let mut sample = middle(now);
        if *is_near.borrow() {
            sample.position[0] = upper - 0.01;
        }
        arm.publish(now, &sample).unwrap();
    });
    let queue = Depth::Queue(64);
    let mut health = time.bus().subscriber(topics::DIAGNOSTICS, queue).unwrap();
    let mut last = |time: &VirtualTime| {
        let mut last = None;
        while let Some(received) = health.next(time.now()) {
            last = Some(received.message);
        }
        let last = last.unwrap();
        assert_eq!(last.node.as_str(), "limits");
        last.level
    };
    time.run(1.0);
    assert_eq!(last(&time), Level::OK);
    *near.borrow_mut() = true;
    time.run(1.0);
    assert_eq!(last(&time), Level::WARN);
    *near.borrow_mut() = false;
    time.run(1.0);
    assert_eq!(last(&time), Level::OK);
}

//! What is refused, and with which words; what is taken though it looks odd.

use std::borrow::Cow;

use ferntast_msgs::{
    InvalidMessage, Message, Text, Time,
    ros::diagnostic_msgs::KeyValue,
    sample::*,
    topics::{self, Topic, Visitor},
};

const STAMP: Time = Time::from_nanos(1_700_000_000_123_456_789);

/// Field and content of something that is not known.
fn known(result: Result<impl Message, InvalidMessage>) -> (&'static str, String) {
    match result {
        Err(InvalidMessage::Unknown { field, found, .. }) => (field, found),
        other => panic!("{other:?}"),
    }
}

#[test]
fn stamps_of_zero_before_1970_and_after_2038_are_refused() {
    let check = |nanos| JointSample::zero(JointNames::numbered(2), Time::from_nanos(nanos)).check();
    assert_eq!(check(0), Err(InvalidMessage::ZeroStamp));
    assert_eq!(check(-1), Err(InvalidMessage::ZeroStamp));
    assert_eq!(check(1), Ok(()));
    // 2^31 s: one more than an int32 holds.
    let nanos = 2_147_483_648_000_000_000;
    assert_eq!(check(nanos), Err(InvalidMessage::LateStamp { nanos }));
    assert_eq!(check(nanos - 1), Ok(()));
    let ros = JointSample::zero(JointNames::numbered(2), Time::INVALID).to_ros();
    assert_eq!(JointSample::from_ros(&ros), Err(InvalidMessage::ZeroStamp));
}

#[test]
fn joints_may_come_in_the_other_order() {
    let joints = JointNames::numbered(2);
    let sample = JointSample::empty(joints, STAMP)
        .with_position([0.1, 0.2])
        .with_effort([3.0, 4.0]);
    let mut ros = sample.to_ros();
    assert_eq!(ros.name, ["joint_1", "joint_2"]);
    assert_eq!((ros.velocity.len(), &ros.effort), (0, &vec![3.0, 4.0]));
    ros.name.reverse();
    ros.position.reverse();
    ros.effort.reverse();
    let reversed = JointSample::from_ros(&ros).unwrap();
    assert_eq!(reversed.position(), [0.2, 0.1]);
    let sorted = reversed.in_order_of(&joints).map(Cow::into_owned);
    assert_eq!(sorted, Some(sample));
    assert_eq!(reversed.in_order_of(&JointNames::numbered(3)), None);
    let others = JointNames::new(["joint_1", "elbow"]).unwrap();
    assert_eq!(reversed.in_order_of(&others), None);
}

#[test]
fn after_a_valid_one_a_joint_state_is_checked_alike() {
    let sample = |names: [&'static str; 2], position| {
        let joints = JointNames::new(names).unwrap();
        JointSample::empty(joints, STAMP).with_position(position)
    };
    let before = sample(["joint_1", "joint_2"], [0.1, 0.2]);
    before.check().unwrap();
    let late = JointSample {
        stamp: Time::INVALID,
        ..before
    };
    let unknown = JointSample {
        fields: JointFields(8),
        ..before
    };
    for own in [
        before,
        late,
        unknown,
        sample(["joint_1", "joint_2"], [0.1, f64::INFINITY]),
        sample(["joint_1", "elbow"], [0.1, 0.2]),
        sample(["joint_1", "elbow"], [0.1, f64::INFINITY]),
    ] {
        assert_eq!(own.check_after(&before), own.check());
    }
}

#[test]
fn a_joint_state_holds_one_to_eight_joints_of_any_names() {
    let names = ["a", "b", "c", "d", "e", "f", "g", "the sixteen byte"];
    for count in 1..=names.len() {
        let joints = JointNames::new(names[..count].iter().copied()).unwrap();
        let sample = JointSample::empty(joints, STAMP).with_effort([1.0; MAX_JOINTS]);
        let ros = sample.to_ros();
        assert_eq!((ros.name.len(), ros.effort.len()), (count, count));
        let back = JointSample::from_ros(&ros).unwrap();
        assert_eq!((back.joints, back.fields), (joints, JointFields::EFFORT));
        assert_eq!(back.effort[..count], sample.effort[..count]);
    }
}

#[test]
fn other_joints_and_lengths_are_refused() {
    let ros = JointSample::zero(JointNames::numbered(2), STAMP).to_ros();
    for names in [
        vec![],
        vec!["joint_1", "joint_1"],
        vec!["joint_1", "a joint whose name has 33 bytes!!"],
        vec!["", "joint_2"],
        vec!["1", "2", "3", "4", "5", "6", "7", "8", "9"],
    ] {
        let mut ros = ros.clone();
        ros.name = names.into_iter().map(String::from).collect();
        let found = ros.name.clone();
        let error = InvalidMessage::WrongJoints { found };
        assert_eq!(JointSample::from_ros(&ros), Err(error));
    }
    let wrong = |field, found, expected| {
        Err(InvalidMessage::WrongLength {
            field,
            found,
            expected,
        })
    };
    let mut names = ros.clone();
    names.name.push("joint_3".to_owned());
    assert_eq!(JointSample::from_ros(&names), wrong("position", 2, 3));
    let mut efforts = ros.clone();
    efforts.effort.pop();
    assert_eq!(JointSample::from_ros(&efforts), wrong("effort", 1, 2));
}

#[test]
fn numbers_that_are_not_finite_are_refused_by_field() {
    let refused = |result: Result<(), InvalidMessage>| match result {
        Err(InvalidMessage::NotFinite { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    let mut joint = JointSample::zero(JointNames::numbered(2), STAMP);
    joint.velocity[1] = f64::NAN;
    assert_eq!(refused(joint.check()), "velocity");
    let pose = PoseSample::at(STAMP, Frame::NONE, [0.0, f64::INFINITY, 0.0]);
    assert_eq!(refused(pose.check()), "pose.position");
    let wrench = WrenchSample::force(STAMP, Frame::CONTACT, [f64::NAN; 3]);
    assert_eq!(refused(wrench.check()), "wrench.force");
    let temperature = TemperatureSample::new(STAMP, f64::NEG_INFINITY);
    assert_eq!(refused(temperature.check()), "temperature");
    let mut link = LinkStatusSample::initial(STAMP);
    link.round_trip = f64::INFINITY;
    assert_eq!(refused(link.check()), "round_trip");
    let mut contact = ContactStateSample::initial(STAMP);
    contact.friction_coefficient_error = f64::NEG_INFINITY;
    assert_eq!(refused(contact.check()), "friction_coefficient_error");
    let mut health = HealthSample::new(STAMP, "servo");
    health.input_age = f64::INFINITY;
    assert_eq!(refused(health.check()), "input age [s]");
}

#[test]
fn what_was_not_measured_yet_is_valid() {
    let link = LinkStatusSample::initial(STAMP);
    assert!(link.round_trip.is_nan() && link.check().is_ok());
    assert!(link.to_ros().delay.is_nan());
    let contact = ContactStateSample::initial(STAMP);
    let ros = contact.to_ros();
    assert!(ros.friction_coefficient.is_nan());
    assert_eq!(ros.friction_coefficient_error, f64::INFINITY);
    let back = ContactStateSample::from_ros(&ros).unwrap();
    assert!(back.friction_coefficient.is_nan());
    let half = ContactStateSample {
        friction_coefficient_error: 0.1,
        ..contact
    };
    assert!(half.check().is_err(), "an error without a number");
    let health = HealthSample::new(STAMP, "servo");
    assert!(health.input_age.is_nan() && health.check().is_ok());
}

#[test]
fn orientations_have_norm_one() {
    let pose = |w| PoseSample {
        orientation: [0.0, 0.0, 0.0, w],
        ..PoseSample::at(STAMP, Frame::LEADER_BASE, [0.0; 3])
    };
    assert_eq!(pose(1.0009).check(), Ok(()));
    assert_eq!(pose(-0.9991).check(), Ok(()));
    assert_eq!(pose(0.0).check(), Ok(()), "none is known");
    for w in [1e-9, 0.9989, 1.0011] {
        assert_eq!(pose(w).check(), Err(InvalidMessage::NotUnit { norm: w }));
    }
}

#[test]
fn the_source_of_a_pose_is_not_on_the_wire() {
    let mut pose = PoseSample::at(STAMP, Frame::LEADER_BASE, [0.1, 0.2, 0.3]);
    pose.source = 7;
    let back = PoseSample::from_ros(&pose.to_ros()).unwrap();
    assert_eq!(back, PoseSample { source: 0, ..pose });
}

#[test]
fn the_reason_of_a_state_is_not_on_the_wire() {
    let state = OperatingStateSample::new(STAMP, OperatingState::FAULT, "joint 1 too hot");
    let back = OperatingStateSample::from_ros(&state.to_ros()).unwrap();
    let reason = Text::EMPTY;
    assert_eq!(back, OperatingStateSample { reason, ..state });
}

/// A sample with a code of 9 is refused, and so is what it is in ROS 2.
fn refused<M: Message>(sample: M, field: &str) {
    let checked = known(sample.check().map(|()| sample));
    assert_eq!(checked, (field, "9".to_owned()));
    assert_eq!(known(M::from_ros(&sample.to_ros())).0, field);
}

#[test]
fn codes_without_a_name_are_refused_on_both_sides() {
    refused(PoseSample::at(STAMP, Frame(9), [0.0; 3]), "header.frame_id");
    refused(
        WrenchSample::force(STAMP, Frame(9), [0.0; 3]),
        "header.frame_id",
    );
    refused(
        OperatingStateSample::new(STAMP, OperatingState(9), ""),
        "state",
    );
    refused(StateCommandSample::new(STAMP, StateCommand(9)), "string");
    let end = LinkEnd(9);
    let link = LinkStatusSample {
        end,
        ..LinkStatusSample::initial(STAMP)
    };
    refused(link, "end");
    let mut contact = ContactStateSample::initial(STAMP);
    contact.edge = Edge(9);
    refused(contact, "edge");
    let mut health = HealthSample::new(STAMP, "servo");
    health.level = Level(9);
    refused(health, "status.level");
}

#[test]
fn flags_and_sets_have_no_other_bits() {
    let mut state = OperatingStateSample::new(STAMP, OperatingState::ENABLED, "");
    state.is_busy = 2;
    let found = known(state.check().map(|()| state));
    assert_eq!(found, ("is_busy", "2".to_owned()));
    let mut joint = JointSample::zero(JointNames::numbered(2), STAMP);
    joint.fields.0 |= 8;
    assert_eq!(known(joint.check().map(|()| joint)).0, "fields");
    let mut health = HealthSample::new(STAMP, "servo");
    health.faults.0 = 1 << 63;
    assert_eq!(known(health.check().map(|()| health)).0, "fault");
}

#[test]
fn words_in_another_case_are_refused() {
    let mut command = StateCommandSample::new(STAMP, StateCommand::ENABLE).to_ros();
    command.string = "Enable".to_owned();
    let found = known(StateCommandSample::from_ros(&command));
    assert_eq!(found, ("string", "Enable".to_owned()));
}

#[test]
fn laws_have_names_of_at_most_24_bytes() {
    let nameless = LawCommandSample {
        stamp: STAMP,
        law: Text::EMPTY,
    };
    let found = known(nameless.check().map(|()| nameless));
    assert_eq!(found, ("string", String::new()));
    let mut command = nameless.to_ros();
    for bad in ["a_law_whose_name_is_far_too_long", "wave\0"] {
        command.string = bad.to_owned();
        let found = known(LawCommandSample::from_ros(&command));
        assert_eq!(found, ("string", bad.to_owned()));
    }
    command.string = "wave".to_owned();
    let law = LawCommandSample::from_ros(&command).map(|own| own.law);
    assert_eq!(law, Ok(Text::new("wave")));
}

#[test]
fn friction_is_told_of_a_joint_from_a_known_source() {
    let good = FrictionStatusSample {
        joint: Text::new("joint_2"),
        ..FrictionStatusSample::initial(STAMP)
    };
    assert_eq!(FrictionStatusSample::from_ros(&good.to_ros()), Ok(good));
    let nameless = FrictionStatusSample::initial(STAMP);
    assert_eq!(known(nameless.check().map(|()| nameless)).0, "joint");
    let mut status = good.to_ros();
    status.source = "guessed".to_owned();
    let found = known(FrictionStatusSample::from_ros(&status));
    assert_eq!(found, ("source", "guessed".to_owned()));
    let mut command = FrictionCommandSample::new(STAMP, FrictionCommand::TAKE_OVER).to_ros();
    assert_eq!(command.string, "take_over");
    command.string = "take_all".to_owned();
    let found = known(FrictionCommandSample::from_ros(&command));
    assert_eq!(found, ("string", "take_all".to_owned()));
}

#[test]
fn a_twin_s_lists_are_of_one_length_and_fit() {
    let known_sample = TwinParametersSample {
        count: 2,
        joint: Text::new("joint_2"),
        ..TwinParametersSample::initial(STAMP)
    };
    let good = known_sample.to_ros();
    assert_eq!(TwinParametersSample::from_ros(&good), Ok(known_sample));
    let mut short = good.clone();
    short.std_errors.pop();
    let mut long = good;
    for list in [
        &mut long.values,
        &mut long.off_line,
        &mut long.std_errors,
        &mut long.excitation,
    ] {
        list.resize(MAX_TWIN_PARAMETERS + 1, 0.0);
    }
    long.names.resize(MAX_TWIN_PARAMETERS + 1, String::new());
    for (bad, field) in [(short, "std_errors"), (long, "names")] {
        match TwinParametersSample::from_ros(&bad) {
            Err(InvalidMessage::WrongLength { field: found, .. }) => assert_eq!(found, field),
            other => panic!("{other:?}"),
        }
    }
    let mut many = known_sample;
    many.count = MAX_TWIN_PARAMETERS as u32 + 1;
    assert!(many.check().is_err());
}

#[test]
fn identities_are_hexadecimal() {
    let mut sample = AuthoritySample::initial(STAMP);
    sample.holder = 0xab;
    let mut ros = sample.to_ros();
    assert_eq!(
        (ros.holder.as_str(), ros.refused.as_str()),
        ("00000000000000ab", "")
    );
    ros.holder = "AB".to_owned();
    assert_eq!(AuthoritySample::from_ros(&ros), Ok(sample));
    for holder in ["+ab", "-1", "0xab", "10000000000000000", " ab"] {
        ros.holder = holder.to_owned();
        let found = known(AuthoritySample::from_ros(&ros));
        assert_eq!(found, ("holder", holder.to_owned()));
    }
}

#[test]
fn health_reads_as_people_write_it() {
    let mut health = HealthSample::new(STAMP, "servo");
    health.rate = 999.5;
    health.level = Level::WARN;
    health.faults = [Fault::TorqueSaturated, Fault::CommandSilent]
        .into_iter()
        .collect();
    let ros = health.to_ros();
    let status = &ros.status[0];
    assert_eq!((status.level, status.name.as_str()), (1, "ferntast: servo"));
    assert_eq!(status.hardware_id, "servo");
    let values: Vec<(&str, &str)> = status
        .values
        .iter()
        .map(|entry| (entry.key.as_str(), entry.value.as_str()))
        .collect();
    assert_eq!(
        values,
        [
            ("rate [Hz]", "999.5"),
            ("lateness p99 [s]", "0"),
            ("input age [s]", "NaN"),
            ("missed", "0"),
            ("refused", "0"),
            ("lost", "0"),
            ("process", "0"),
            ("fault", "command silent"),
            ("fault", "torque saturated"),
        ]
    );
}

#[test]
fn diagnostics_of_others_are_refused_and_new_keys_taken() {
    let health = HealthSample {
        input_age: 0.0,
        ..HealthSample::new(STAMP, "servo")
    };
    let ros = health.to_ros();
    let mut more = ros.clone();
    more.status[0].values.push(KeyValue::new("new", "?"));
    assert_eq!(HealthSample::from_ros(&more), Ok(health));
    let mut fault = ros.clone();
    fault.status[0]
        .values
        .push(KeyValue::new("fault", "hunger"));
    let found = known(HealthSample::from_ros(&fault));
    assert_eq!(found, ("fault", "hunger".to_owned()));
    let mut other = ros.clone();
    other.status[0].name = "camera".to_owned();
    assert_eq!(known(HealthSample::from_ros(&other)).0, "status.name");
    let mut missing = ros.clone();
    missing.status[0].values.remove(3);
    let found = known(HealthSample::from_ros(&missing));
    assert_eq!(found, ("missed", "(missing)".to_owned()));
    let mut two = ros.clone();
    two.status.push(ros.status[0].clone());
    assert!(matches!(
        HealthSample::from_ros(&two),
        Err(InvalidMessage::WrongLength { found: 2, .. })
    ));
}

#[test]
fn error_texts_list_every_name() {
    fn list<T>(all: &[T], name: impl Fn(&T) -> &'static str) -> String {
        all.iter().map(name).collect::<Vec<_>>().join(", ")
    }
    macro_rules! same {
        ($($code:ident)*) => {
            $(assert_eq!(list(&$code::ALL, |code| code.name().unwrap()), $code::KNOWN);)*
        };
    }
    same!(Edge FrictionCommand FrictionSource LinkEnd OperatingState RecorderAction StateCommand TwinVerdict);
    let levels: Vec<String> = Level::ALL
        .iter()
        .map(|level| format!("{} ({})", level.0, level.name().unwrap()))
        .collect();
    assert_eq!(levels.join(", "), Level::KNOWN);
    let frames = list(&Frame::ALL, |frame| frame.name().unwrap());
    assert_eq!(format!("(empty){frames}"), Frame::KNOWN);
    assert_eq!(list(&Fault::ALL, |fault| fault.name()), Fault::KNOWN);
}

#[test]
fn every_fault_has_a_bit_and_a_name_of_its_own() {
    for (index, fault) in Fault::ALL.into_iter().enumerate() {
        assert_eq!(fault as usize, index);
        assert_eq!(Fault::from_name(fault.name()), Some(fault));
        let mut faults = Faults::default();
        faults.set(fault);
        assert_eq!(faults.iter().collect::<Vec<_>>(), [fault]);
    }
}

#[test]
fn every_topic_is_named_once_and_carries_a_known_interface() {
    struct Names(Vec<(String, &'static str)>);
    impl Visitor for Names {
        fn topic<M: Message>(&mut self, topic: Topic<M>) {
            use ferntast_msgs::RosMessage;
            self.0.push((topic.name.into(), M::Ros::INTERFACE));
        }
    }
    let mut names = Names(Vec::new());
    let joints = JointNames::new(["joint_1", "elbow"]).unwrap();
    topics::visit(&joints, &mut names).unwrap();
    for (index, (name, interface)) in names.0.iter().enumerate() {
        assert!(name.starts_with('/'));
        assert!(names.0[..index].iter().all(|(other, _)| other != name));
        assert!(ferntast_msgs::interface::definition(interface).is_some());
    }
    let has = |name: &str, interface: &str| {
        let mut names = names.0.iter();
        names.any(|own| own.0 == name && own.1 == interface)
    };
    assert!(has("/link/status", "ferntast_msgs/msg/LinkStatus"));
    let temperature = "sensor_msgs/msg/Temperature";
    assert!(has("/follower/elbow/temperature", temperature));
}

#[test]
fn texts_are_cut_between_characters_and_at_a_zero_byte() {
    assert_eq!(Text::<4>::new("abcdef").as_str(), "abcd");
    assert_eq!(Text::<4>::new("abcé").as_str(), "abc");
    assert_eq!(Text::<4>::display("é".repeat(3)).as_str(), "éé");
    assert_eq!(Text::<3>::display("éé").as_str(), "é");
    assert_eq!(Text::<8>::display(1.5).as_str(), "1.5");
    assert_eq!(Text::<4>::new("ab\0c"), Text::<4>::new("ab"));
    assert!(Text::<4>::new("").is_empty());
}

#[test]
fn times_are_split_as_ros_2_splits_them() {
    assert_eq!(
        (STAMP.ros_sec(), STAMP.ros_nanosec()),
        (1_700_000_000, 123_456_789)
    );
    // rclcpp: seconds round down, nanoseconds count up from there.
    let before = Time::from_nanos(-1);
    assert_eq!((before.ros_sec(), before.ros_nanosec()), (-1, 999_999_999));
    assert_eq!(STAMP.plus_seconds(0.5).seconds_since(STAMP), 0.5);
    assert_eq!(Time::from_nanos(i64::MAX).ros_sec(), i32::MAX);
}

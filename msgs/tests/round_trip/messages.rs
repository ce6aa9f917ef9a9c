//! ROS 2 messages as others may send them: anything, or nearly right.

use ferntast_msgs::{
    Message,
    ros::{
        builtin_interfaces::Time,
        crtk_msgs,
        diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
        ferntast_msgs::{
            Authority, ContactState, FrictionStatus, LinkCommand, LinkStatus, RecorderCommand,
            RecorderStatus, TwinParameters,
        },
        geometry_msgs::{Pose, PoseStamped, Transform, TransformStamped, Wrench, WrenchStamped},
        sensor_msgs::{JointState, Temperature},
        std_msgs::{self, Header},
        tf2_msgs::TFMessage,
    },
    sample::{
        Edge, Fault, FrictionCommand, FrictionSource, LinkEnd, OperatingState, StateCommand,
        TwinVerdict,
    },
};
use proptest::{array::uniform3, collection::vec, prelude::*};

/// One of `words`, or anything.
fn word(words: Vec<&'static str>) -> impl Strategy<Value = String> {
    prop_oneof![
        3 => prop::sample::select(words).prop_map(String::from),
        1 => any::<String>(),
    ]
}

fn header() -> impl Strategy<Value = Header> {
    let stamp = (any::<i32>(), any::<u32>()).prop_map(|(sec, nanosec)| Time { sec, nanosec });
    let frame = word(vec!["", "follower_base", "leader_base", "contact"]);
    (stamp, frame).prop_map(|(stamp, frame_id)| Header { stamp, frame_id })
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -1.0..1.0, 1 => any::<f64>(), 1 => Just(f64::NAN)]
}

/// Joint states with joints too many, too few, twice, in any order.
pub fn joint() -> impl Strategy<Value = JointState> {
    let names = vec(word(vec!["joint_1", "joint_2"]), 0..4);
    let numbers = || vec(number(), 0..4);
    (header(), names, numbers(), numbers(), numbers()).prop_map(
        |(header, name, position, velocity, effort)| JointState {
            header,
            name,
            position,
            velocity,
            effort,
        },
    )
}

/// Poses with any orientation, of any length.
pub fn pose() -> impl Strategy<Value = PoseStamped> {
    let orientation = prop_oneof![
        Just([0.0, 0.0, 0.0, 1.0]),
        [number(), number(), number(), number()],
    ];
    (header(), uniform3(number()), orientation).prop_map(|(header, position, orientation)| {
        let pose = Pose {
            position: position.into(),
            orientation: orientation.into(),
        };
        PoseStamped { header, pose }
    })
}

/// Wrenches.
pub fn wrench() -> impl Strategy<Value = WrenchStamped> {
    (header(), uniform3(number()), uniform3(number())).prop_map(|(header, force, torque)| {
        let wrench = Wrench {
            force: force.into(),
            torque: torque.into(),
        };
        WrenchStamped { header, wrench }
    })
}

/// Temperatures.
pub fn temperature() -> impl Strategy<Value = Temperature> {
    (header(), number(), number()).prop_map(|(header, temperature, variance)| Temperature {
        header,
        temperature,
        variance,
    })
}

/// Operating states.
pub fn operating_state() -> impl Strategy<Value = crtk_msgs::OperatingState> {
    let states = OperatingState::ALL
        .into_iter()
        .flat_map(OperatingState::name);
    (
        header(),
        word(states.collect()),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(
            |(header, state, is_homed, is_busy)| crtk_msgs::OperatingState {
                header,
                state,
                is_homed,
                is_busy,
            },
        )
}

/// Texts, also longer than there is room for.
pub fn robot_description() -> impl Strategy<Value = std_msgs::String> {
    let long = (8000..9000_usize).prop_map(|length| "x".repeat(length));
    prop_oneof![any::<String>(), long].prop_map(|data| std_msgs::String { data })
}

/// Frames too many, too few, others, in any order.
pub fn transforms() -> impl Strategy<Value = TFMessage> {
    let frames = vec!["follower_base", "link_1", "link_2", "follower_tip"];
    let rotation = prop_oneof![
        Just([0.0, 0.0, 0.0, 1.0]),
        [number(), number(), number(), number()],
    ];
    let one = (header(), word(frames), uniform3(number()), rotation).prop_map(
        |(header, child_frame_id, translation, rotation)| TransformStamped {
            header,
            child_frame_id,
            transform: Transform {
                translation: translation.into(),
                rotation: rotation.into(),
            },
        },
    );
    let any = vec(one, 0..5).prop_map(|transforms| TFMessage { transforms });
    let nearly =
        (super::samples::transforms(), 0..3_usize, number()).prop_map(|(sample, which, number)| {
            let mut message = sample.to_ros();
            message.transforms[which].transform.rotation.x += number;
            message
        });
    prop_oneof![any, nearly]
}

/// State commands.
pub fn state_command() -> impl Strategy<Value = crtk_msgs::StringStamped> {
    let commands = StateCommand::ALL.into_iter().flat_map(StateCommand::name);
    (header(), word(commands.collect()))
        .prop_map(|(header, string)| crtk_msgs::StringStamped { header, string })
}

/// Law commands.
pub fn law_command() -> impl Strategy<Value = crtk_msgs::StringStamped> {
    (header(), word(vec!["wave", "tdpa", ""]))
        .prop_map(|(header, string)| crtk_msgs::StringStamped { header, string })
}

/// Contact states.
pub fn contact_state() -> impl Strategy<Value = ContactState> {
    let edges = Edge::ALL.into_iter().flat_map(Edge::name);
    let numbers = [number(), number(), number(), number()];
    (header(), word(edges.collect()), any::<[bool; 3]>(), numbers).prop_map(
        |(header, edge, [in_contact, valid, near_rest], numbers)| {
            let [normal_force, tangential_force, coefficient, error] = numbers;
            ContactState {
                header,
                in_contact,
                valid,
                near_rest,
                edge,
                normal_force,
                tangential_force,
                friction_coefficient: coefficient,
                friction_coefficient_error: error,
            }
        },
    )
}

/// Authorities.
pub fn authority() -> impl Strategy<Value = Authority> {
    let identity = || prop_oneof!["[+0-9a-fA-F]{0,18}", any::<String>()];
    (
        header(),
        identity(),
        identity(),
        any::<u64>(),
        any::<String>(),
    )
        .prop_map(
            |(header, holder, refused, refused_count, reason)| Authority {
                header,
                holder,
                refused,
                refused_count,
                reason,
            },
        )
}

/// Link states.
pub fn link_status() -> impl Strategy<Value = LinkStatus> {
    let ends = LinkEnd::ALL.into_iter().flat_map(LinkEnd::name);
    let words = (word(ends.collect()), any::<String>());
    (
        header(),
        words,
        any::<bool>(),
        number(),
        number(),
        any::<u64>(),
    )
        .prop_map(
            |(header, (end, law), connected, round_trip, jitter, sent)| LinkStatus {
                header,
                end,
                law,
                connected,
                round_trip,
                jitter,
                sent,
                ..LinkStatus::default()
            },
        )
}

/// Commands to the friction feed-forward, also unknown ones.
pub fn friction_command() -> impl Strategy<Value = crtk_msgs::StringStamped> {
    let commands = FrictionCommand::ALL
        .into_iter()
        .flat_map(FrictionCommand::name);
    (header(), word(commands.collect()))
        .prop_map(|(header, string)| crtk_msgs::StringStamped { header, string })
}

/// Friction fed forward with lists of any lengths, mostly the same.
pub fn friction_status() -> impl Strategy<Value = FrictionStatus> {
    let lists = (0..20_usize).prop_flat_map(|length| {
        let numbers = || vec(number(), length);
        (
            vec(any::<String>(), length),
            numbers(),
            numbers(),
            vec(number(), 0..20),
        )
    });
    let sources = FrictionSource::ALL
        .into_iter()
        .flat_map(FrictionSource::name);
    let words = (
        word(vec!["joint_1", "joint_2"]),
        word(sources.collect()),
        any::<String>(),
    );
    (header(), words, lists, any::<u64>(), 0..3).prop_map(
        |(header, (joint, source, refused), lists, commands, uneven)| {
            let (names, configured, values, other) = lists;
            FrictionStatus {
                header,
                joint,
                source,
                names,
                targets: if uneven == 0 { other } else { values.clone() },
                configured,
                values,
                commands,
                refused,
            }
        },
    )
}

/// Twins with lists of any lengths, mostly the same.
pub fn twin_parameters() -> impl Strategy<Value = TwinParameters> {
    let lists = (0..20_usize).prop_flat_map(|length| {
        let numbers = || vec(number(), length);
        (
            vec(any::<String>(), length),
            numbers(),
            numbers(),
            numbers(),
            vec(number(), 0..20),
        )
    });
    let verdicts = TwinVerdict::ALL.into_iter().flat_map(TwinVerdict::name);
    let words = (
        word(vec!["joint_1", "joint_2"]),
        word(verdicts.collect()),
        any::<String>(),
    );
    (header(), words, lists, number(), any::<bool>(), 0..3).prop_map(
        |(header, (joint, verdict, text), lists, number, out_of_band, uneven)| {
            let (names, values, off_line, std_errors, other) = lists;
            TwinParameters {
                header,
                joint,
                verdict,
                candidate: text.clone(),
                goes_with: text.clone(),
                changed: text,
                names,
                values,
                excitation: if uneven == 0 { other } else { off_line.clone() },
                off_line,
                std_errors,
                residual_rms: number,
                out_of_band,
                ..TwinParameters::default()
            }
        },
    )
}

/// Diagnostics, of ours and of others.
pub fn health() -> impl Strategy<Value = DiagnosticArray> {
    let keys = "rate [Hz],lateness p99 [s],input age [s],missed,refused,lost,process";
    let value = prop_oneof![
        any::<u32>().prop_map(|value| value.to_string()),
        number().prop_map(|value| value.to_string()),
        any::<String>(),
    ];
    let values = vec(value, 7).prop_map(move |values| {
        let pairs = keys.split(',').zip(values);
        pairs
            .map(|(key, value)| KeyValue::new(key, value))
            .collect()
    });
    let faults = Fault::ALL.map(Fault::name).to_vec();
    let fault = word(faults).prop_map(|fault| KeyValue::new("fault", fault));
    let name = word(vec!["ferntast: servo", "ferntast: ", "camera"]);
    let status = (any::<u8>(), name, any::<String>(), values, vec(fault, 0..3)).prop_map(
        |(level, name, message, mut values, faults): (_, _, _, Vec<KeyValue>, _)| {
            values.extend(faults);
            DiagnosticStatus {
                level,
                name,
                message,
                hardware_id: String::new(),
                values,
            }
        },
    );
    (header(), vec(status, 0..3)).prop_map(|(header, status)| DiagnosticArray { header, status })
}

/// Commands to the channel.
pub fn link_command() -> impl Strategy<Value = LinkCommand> {
    (header(), any::<f64>(), any::<f64>(), any::<f64>()).prop_map(
        |(header, round_trip, jitter, loss)| LinkCommand {
            header,
            round_trip,
            jitter,
            loss,
        },
    )
}

/// Commands to the recorder.
pub fn recorder_command() -> impl Strategy<Value = RecorderCommand> {
    let action = prop_oneof!["start|stop|mark", any::<String>()];
    (header(), action, any::<String>()).prop_map(|(header, action, label)| RecorderCommand {
        header,
        action,
        label,
    })
}

/// What the recorder does.
pub fn recorder_status() -> impl Strategy<Value = RecorderStatus> {
    (header(), any::<bool>(), any::<String>(), any::<u64>()).prop_map(
        |(header, recording, folder, messages)| RecorderStatus {
            header,
            recording,
            folder,
            messages,
        },
    )
}

//! ROS 2 messages as others may send them, of samples whose conversions are
//! written by hand: anything, or nearly right.

use ferntast_msgs::{
    Message,
    ros::{
        builtin_interfaces::Time,
        diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
        geometry_msgs::{Pose, PoseStamped, Transform, TransformStamped, Wrench, WrenchStamped},
        sensor_msgs::JointState,
        std_msgs::{self, Header},
        tf2_msgs::TFMessage,
    },
    sample::Fault,
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

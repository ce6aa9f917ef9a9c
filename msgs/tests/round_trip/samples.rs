//! Samples that are valid, of those whose conversions are written by hand, each
//! with a wide range of contents.

use ferntast_msgs::{Text, Time, sample::*};
use proptest::{array::uniform3, prelude::*};

/// Times that ROS 2 can hold.
fn time() -> impl Strategy<Value = Time> {
    (1..=i64::from(i32::MAX) * 1_000_000_000 + 999_999_999).prop_map(Time::from_nanos)
}

/// Any finite number, also the smallest and largest.
pub fn finite() -> impl Strategy<Value = f64> {
    use prop::num::f64;
    f64::NORMAL | f64::SUBNORMAL | f64::ZERO
}

fn finite_or_nan() -> impl Strategy<Value = f64> {
    prop_oneof![4 => finite(), 1 => Just(f64::NAN)]
}

fn frame() -> impl Strategy<Value = Frame> {
    prop::sample::select(Frame::ALL.as_slice())
}

fn text<const N: usize>() -> impl Strategy<Value = Text<N>> {
    any::<String>().prop_map(|text| Text::new(&text))
}

/// State or command of one to eight joints, with any of the quantities given.
pub fn joint() -> impl Strategy<Value = JointSample> {
    let numbers = || prop::collection::vec(finite(), MAX_JOINTS);
    let names = prop_oneof![
        (1..=MAX_JOINTS).prop_map(JointNames::numbered),
        prop::collection::hash_set("[a-zé]{1,8}", 1..=MAX_JOINTS)
            .prop_map(|names| JointNames::new(names.iter().map(String::as_str)).expect("names")),
    ];
    (time(), names, numbers(), numbers(), numbers(), 0..8u32).prop_map(
        |(stamp, joints, position, velocity, effort, fields)| {
            let fields = JointFields(fields);
            let given = |field, values: Vec<f64>| {
                std::array::from_fn(|joint| match fields.has(field) && joint < joints.len() {
                    true => values[joint],
                    false => 0.0,
                })
            };
            JointSample {
                position: given(JointFields::POSITION, position),
                velocity: given(JointFields::VELOCITY, velocity),
                effort: given(JointFields::EFFORT, effort),
                fields,
                ..JointSample::zero(joints, stamp)
            }
        },
    )
}

/// Any orientation.
fn orientation() -> impl Strategy<Value = [f64; 4]> {
    let part = || -1.0..1.0;
    [part(), part(), part(), part()]
        .prop_filter("no direction", |q: &[f64; 4]| {
            q.iter().any(|part| part.abs() > 0.01)
        })
        .prop_map(|q| {
            let norm = q.iter().map(|part| part * part).sum::<f64>().sqrt();
            q.map(|part| part / norm)
        })
}

/// Descriptions of any text.
pub fn robot_description() -> impl Strategy<Value = RobotDescriptionSample> {
    let urdf = text().prop_filter("no text", |urdf| !urdf.is_empty());
    urdf.prop_map(|urdf| RobotDescriptionSample { urdf })
}

/// Frames anywhere.
pub fn transforms() -> impl Strategy<Value = TransformsSample> {
    (
        time(),
        uniform3(uniform3(finite())),
        uniform3(orientation()),
    )
        .prop_map(|(stamp, translations, rotations)| {
            TransformsSample::planar(stamp, translations, rotations)
        })
}

/// Poses with any orientation.
pub fn pose() -> impl Strategy<Value = PoseSample> {
    (time(), frame(), uniform3(finite()), orientation()).prop_map(
        |(stamp, frame, position, orientation)| PoseSample {
            orientation,
            ..PoseSample::at(stamp, frame, position)
        },
    )
}

/// Forces with torques.
pub fn wrench() -> impl Strategy<Value = WrenchSample> {
    (time(), frame(), uniform3(finite()), uniform3(finite())).prop_map(
        |(stamp, frame, force, torque)| WrenchSample {
            torque,
            ..WrenchSample::force(stamp, frame, force)
        },
    )
}

/// How nodes are doing, with any set of faults.
pub fn health() -> impl Strategy<Value = HealthSample> {
    let faults = prop::sample::subsequence(Fault::ALL.as_slice(), 0..=Fault::ALL.len());
    let numbers = (finite(), finite(), finite_or_nan());
    (
        time(),
        numbers,
        any::<[u64; 3]>(),
        faults,
        text(),
        text(),
        any::<u32>(),
        0..4u8,
    )
        .prop_map(
            |(
                stamp,
                (rate, lateness_p99, input_age),
                counts,
                faults,
                node,
                message,
                process,
                level,
            )| {
                let [missed, refused, lost] = counts;
                HealthSample {
                    stamp,
                    rate,
                    lateness_p99,
                    input_age,
                    missed,
                    refused,
                    lost,
                    faults: faults.into_iter().collect(),
                    node,
                    message,
                    process,
                    level: Level(level),
                    reserved: [0; 3],
                }
            },
        )
}

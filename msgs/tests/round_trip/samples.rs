//! Samples that are valid, each with a wide range of contents.

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

/// State or command of the joints, with any of the quantities given.
pub fn joint() -> impl Strategy<Value = JointSample> {
    let pair = || [finite(), finite()];
    (time(), pair(), pair(), pair(), 0..8u32).prop_map(
        |(stamp, position, velocity, effort, fields)| {
            let fields = JointFields(fields);
            let given = |field, values| if fields.has(field) { values } else { [0.0; 2] };
            JointSample {
                position: given(JointFields::POSITION, position),
                velocity: given(JointFields::VELOCITY, velocity),
                effort: given(JointFields::EFFORT, effort),
                fields,
                ..JointSample::zero(stamp)
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
        .prop_map(|(stamp, translations, rotations)| TransformsSample {
            stamp,
            translations,
            rotations,
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

/// Temperatures.
pub fn temperature() -> impl Strategy<Value = TemperatureSample> {
    (time(), finite(), finite()).prop_map(|(stamp, temperature, variance)| TemperatureSample {
        variance,
        ..TemperatureSample::new(stamp, temperature)
    })
}

/// Contact states with identified friction, and without.
pub fn contact_state() -> impl Strategy<Value = ContactStateSample> {
    let friction = prop_oneof![(finite(), finite()), Just((0.0, f64::INFINITY)),];
    let edge = prop::sample::select(Edge::ALL.as_slice());
    (
        time(),
        finite(),
        finite(),
        friction,
        [0..2u8, 0..2, 0..2],
        edge,
    )
        .prop_map(
            |(stamp, normal_force, tangential_force, (coefficient, error), flags, edge)| {
                let [in_contact, valid, near_rest] = flags;
                ContactStateSample {
                    stamp,
                    normal_force,
                    tangential_force,
                    friction_coefficient: coefficient,
                    friction_coefficient_error: error,
                    in_contact,
                    valid,
                    near_rest,
                    edge,
                    reserved: [0; 4],
                }
            },
        )
}

/// Operating states; the reason, which ROS 2 does not carry, is empty.
pub fn operating_state() -> impl Strategy<Value = OperatingStateSample> {
    let state = prop::sample::select(OperatingState::ALL.as_slice());
    (time(), state, 0..2u8, 0..2u8).prop_map(|(stamp, state, is_homed, is_busy)| {
        OperatingStateSample {
            is_homed,
            is_busy,
            ..OperatingStateSample::new(stamp, state, "")
        }
    })
}

/// State commands.
pub fn state_command() -> impl Strategy<Value = StateCommandSample> {
    let command = prop::sample::select(StateCommand::ALL.as_slice());
    (time(), command).prop_map(|(stamp, command)| StateCommandSample::new(stamp, command))
}

/// Commands to the friction feed-forward.
pub fn friction_command() -> impl Strategy<Value = FrictionCommandSample> {
    let command = prop::sample::select(FrictionCommand::ALL.as_slice());
    (time(), command).prop_map(|(stamp, command)| FrictionCommandSample::new(stamp, command))
}

/// Friction fed forward, with any number of parameters.
pub fn friction_status() -> impl Strategy<Value = FrictionStatusSample> {
    let source = prop::sample::select(FrictionSource::ALL.as_slice());
    let lists = prop::collection::vec(
        (text(), [finite(), finite(), finite()]),
        0..=MOST_PARAMETERS,
    );
    (time(), 0..2u8, source, lists, any::<u64>(), text()).prop_map(
        |(stamp, joint, source, lists, commands, refused)| {
            let mut sample = FrictionStatusSample {
                source,
                commands,
                refused,
                count: lists.len() as u32,
                ..FrictionStatusSample::nothing(stamp, joint)
            };
            for (i, (name, [configured, value, target])) in lists.into_iter().enumerate() {
                sample.names[i] = name;
                sample.configured[i] = configured;
                sample.values[i] = value;
                sample.targets[i] = target;
            }
            sample
        },
    )
}

/// Law commands.
pub fn law_command() -> impl Strategy<Value = LawCommandSample> {
    (time(), "[a-z_]{1,24}").prop_map(|(stamp, law)| LawCommandSample {
        stamp,
        law: Text::new(&law),
    })
}

/// Authorities, held and not.
pub fn authority() -> impl Strategy<Value = AuthoritySample> {
    let identity = || prop_oneof![Just(0), any::<u64>()];
    (time(), identity(), identity(), any::<u64>(), text()).prop_map(
        |(stamp, holder, refused, refused_count, reason)| AuthoritySample {
            stamp,
            holder,
            refused,
            refused_count,
            reason,
        },
    )
}

/// What an end of the link measures, also before anything was measured.
pub fn link_status() -> impl Strategy<Value = LinkStatusSample> {
    let end = prop::sample::select(LinkEnd::ALL.as_slice());
    let measured = (
        finite_or_nan(),
        finite_or_nan(),
        any::<u16>(),
        0..2u8,
        text(),
    );
    let numbers = [finite(), finite(), finite(), finite(), finite(), finite()];
    (time(), end, measured, numbers, any::<[u64; 11]>()).prop_map(
        |(stamp, end, (round_trip, delay, session, connected, law), numbers, counts)| {
            let [jitter, loss, age, energy_in, energy_out, energy_dissipated] = numbers;
            let [
                sent,
                received,
                lost,
                length,
                version,
                session_count,
                checksum,
                time,
                value,
                replayed,
                late,
            ] = counts;
            LinkStatusSample {
                round_trip,
                delay,
                jitter,
                loss,
                age,
                energy_in,
                energy_out,
                energy_dissipated,
                sent,
                received,
                lost,
                refused: RefusedFrames {
                    length,
                    version,
                    session: session_count,
                    checksum,
                    time,
                    value,
                    replayed,
                    late,
                },
                law,
                session,
                connected,
                ..LinkStatusSample::idle(stamp, end)
            }
        },
    )
}

/// Twins with any number of parameters.
pub fn twin_parameters() -> impl Strategy<Value = TwinParametersSample> {
    let verdict = prop::sample::select(TwinVerdict::ALL.as_slice());
    let lists = prop::collection::vec(
        (text(), [finite(), finite(), finite(), finite()]),
        0..=MOST_PARAMETERS,
    );
    let numbers = [finite(), finite(), finite(), finite(), finite(), finite()];
    let texts = (text(), text(), text(), text());
    (time(), 0..2u8, 0..2u8, verdict, lists, numbers, texts).prop_map(
        |(stamp, joint, out_of_band, verdict, lists, numbers, texts)| {
            let [residual_rms, band, before, after, change_time, assessed_at] = numbers;
            let (changed, change_kind, candidate, goes_with) = texts;
            let mut sample = TwinParametersSample {
                residual_rms,
                band,
                change_before: before,
                change_after: after,
                change_time,
                assessed_at,
                changed,
                change_kind,
                candidate,
                goes_with,
                out_of_band,
                verdict,
                count: lists.len() as u32,
                ..TwinParametersSample::nothing(stamp, joint)
            };
            for (i, (name, [value, off_line, std_error, excitation])) in
                lists.into_iter().enumerate()
            {
                sample.names[i] = name;
                sample.values[i] = value;
                sample.off_line[i] = off_line;
                sample.std_errors[i] = std_error;
                sample.excitation[i] = excitation;
            }
            sample
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

/// Commands to the channel.
pub fn link_command() -> impl Strategy<Value = LinkCommandSample> {
    (time(), finite(), finite(), finite()).prop_map(|(stamp, round_trip, jitter, loss)| {
        LinkCommandSample {
            stamp,
            round_trip,
            jitter,
            loss,
        }
    })
}

/// Commands to the recorder.
pub fn recorder_command() -> impl Strategy<Value = RecorderCommandSample> {
    let action = prop::sample::select(RecorderAction::ALL.as_slice());
    (time(), action, text()).prop_map(|(stamp, action, label)| RecorderCommandSample {
        stamp,
        label,
        action,
        reserved: [0; 7],
    })
}

/// What the recorder does.
pub fn recorder_status() -> impl Strategy<Value = RecorderStatusSample> {
    (time(), any::<u64>(), text(), 0..2u8).prop_map(|(stamp, messages, folder, recording)| {
        RecorderStatusSample {
            stamp,
            messages,
            folder,
            recording,
            reserved: [0; 7],
        }
    })
}

//! What one joint tells, and whether that can be. Pure.

use serde::Serialize;

use super::{
    expected::{Expected, Torque},
    finding::{Finding, Severity},
    record::{Record, Seen},
};

/// Motion is looked at in pieces so long \[s\]: in which steps of an encoder average out.
const PIECE: f64 = 0.05;
/// A joint that goes less far in a piece stands \[rad\] or \[m\].
const STANDS: f64 = 1e-3;
/// It has to go so far before its velocity can be told \[rad\] or \[m\].
const TRAVEL: f64 = 0.02;
/// A velocity that fits so well, in parts of the change of position, is right \[-\].
const ALIKE: f64 = 0.2;
/// A joint that is slower is at rest \[rad/s\] or \[m/s\].
const REST: f64 = 0.02;
/// Of the motor's torque, what a sensor may be off by, and the friction of a gear \[-\].
const OFFSET: f64 = 0.02;
const FRICTION: f64 = 0.15;
/// Of the weight, what the model may be off by \[-\].
const MODEL: f64 = 0.15;

/// What was seen of one joint. Quantities that were not measured are `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointReport {
    /// Its name.
    pub name: String,
    /// Mean position \[rad\] or \[m\].
    pub position: f64,
    /// From the least to the most \[rad\] or \[m\].
    pub travel: f64,
    /// Largest speed \[rad/s\] or \[m/s\].
    pub speed: f64,
    /// Change of position for what its velocity comes to, 1 where both are right \[-\].
    pub change_per_velocity: Option<f64>,
    /// Mean torque at rest: behind the gear, or else the motor's \[Nm\] or \[N\].
    pub torque: Option<f64>,
    /// Mean weight that it carries there, by the model \[Nm\] or \[N\].
    pub weight: f64,
}

/// The way of a joint by its position, and by its velocity.
#[derive(Clone, Copy, Debug, Default)]
struct Ways {
    by_position: f64,
    by_velocity: f64,
    product: f64,
    square: f64,
}

impl Ways {
    fn of(seen: &[Seen], joint: usize) -> Ways {
        let mut ways = Ways::default();
        let Some(first) = seen.first() else {
            return ways;
        };
        let (mut begun, mut from, mut passed) = (first.at, first.reading.position[joint], 0.0);
        for pair in seen.windows(2) {
            let [before, now] = [&pair[0], &pair[1]];
            let velocity = 0.5 * (before.reading.velocity[joint] + now.reading.velocity[joint]);
            passed += velocity * (now.at - before.at);
            if now.at - begun < PIECE {
                continue;
            }
            let moved = now.reading.position[joint] - from;
            if moved.abs() > STANDS || passed.abs() > STANDS {
                ways.by_position += moved.abs();
                ways.by_velocity += passed.abs();
                ways.product += moved * passed;
                ways.square += passed * passed;
            }
            (begun, from, passed) = (now.at, now.reading.position[joint], 0.0);
        }
        ways
    }
}

/// Looks at one joint.
pub(super) fn look(
    expected: &Expected,
    record: &Record,
    joint: usize,
    findings: &mut Vec<Finding>,
) -> JointReport {
    let name = expected.names.get(joint).unwrap_or_default().to_owned();
    let positions = || record.of(joint, |own| Some(own.position));
    let least = positions().fold(f64::INFINITY, f64::min);
    let most = positions().fold(f64::NEG_INFINITY, f64::max);
    let speed = record.of(joint, |own| Some(own.velocity));
    let speed = speed.fold(0.0, |most: f64, own| most.max(own.abs()));
    let ways = Ways::of(&record.seen, joint);
    let mut found = Vec::new();
    let degrees = in_degrees(expected, joint, least, most);
    range(expected, joint, [least, most], degrees, &mut found);
    if !degrees {
        velocity(&ways, &mut found);
    }
    let (torque, weight) = at_rest(expected, record, joint);
    if let Some(torque) = torque.filter(|_| !degrees) {
        against_weight(expected, joint, torque, weight, &mut found);
        if most - least > TRAVEL && stands_still(record, joint) {
            found.push(Finding::new(
                Severity::Wrong,
                "torque_stuck",
                format!("its torque stays at {torque:.2} to the last digit while it moves: the sensor is stuck, or not read"),
            ));
        }
    }
    findings.extend(found.into_iter().map(|own| own.of(&name)));
    JointReport {
        name,
        position: positions().sum::<f64>() / record.seen.len() as f64,
        travel: most - least,
        speed,
        change_per_velocity: (ways.by_velocity > TRAVEL).then(|| ways.product / ways.square),
        torque,
        weight,
    }
}

/// Whether its positions would fit if they were degrees, and do not as they are.
fn in_degrees(expected: &Expected, joint: usize, least: f64, most: f64) -> bool {
    let [lower, upper] = expected.joints[joint].range;
    let fits = |least: f64, most: f64| least >= lower && most <= upper;
    !fits(least, most) && fits(least.to_radians(), most.to_radians())
}

fn range(
    expected: &Expected,
    joint: usize,
    [least, most]: [f64; 2],
    degrees: bool,
    found: &mut Vec<Finding>,
) {
    let own = &expected.joints[joint];
    let [lower, upper] = own.range;
    if least >= lower && most <= upper {
        return;
    }
    let why = match degrees {
        true => "it would fit in degrees: positions have to come in rad",
        false => "its zero, its sign or the file's limits are wrong",
    };
    found.push(Finding::new(
        Severity::Wrong,
        "position_range",
        format!("it is at {least:.3} … {most:.3}, outside of {lower:.3} … {upper:.3}: {why}"),
    ));
}

fn velocity(ways: &Ways, found: &mut Vec<Finding>) {
    let Ways {
        by_position,
        by_velocity,
        product,
        square,
    } = *ways;
    let wrong = |what, words: String| Finding::new(Severity::Wrong, what, words);
    if by_position > TRAVEL && by_velocity < 0.1 * by_position {
        found.push(wrong(
            "velocity_zero",
            format!("it went {by_position:.3} while its velocity says {by_velocity:.3}: velocity is not measured, or far too small"),
        ));
    } else if by_velocity > TRAVEL && by_position < 0.1 * by_velocity {
        found.push(wrong(
            "position_stuck",
            format!("by its velocity it went {by_velocity:.3}, its position changed by {by_position:.3}: position is stuck, or velocity in other units"),
        ));
    } else if by_velocity > TRAVEL {
        let ratio = product / square;
        if ratio < 0.0 {
            found.push(wrong(
                "velocity_sign",
                format!("position changes by {ratio:.2} times what its velocity says: one of their signs is wrong"),
            ));
        } else if (ratio - 1.0).abs() > ALIKE {
            found.push(wrong(
                "velocity_scale",
                format!("position changes by {ratio:.2} times what its velocity says: units or gear of one are wrong"),
            ));
        }
    } else {
        found.push(Finding::new(
            Severity::Open,
            "velocity",
            "it did not move: whether velocity and position agree is open (move it by hand, or check with --move)",
        ));
    }
}

/// Mean torque and weight at rest, or of all where it never rests.
fn at_rest(expected: &Expected, record: &Record, joint: usize) -> (Option<f64>, f64) {
    let rests = |own: &&Seen| own.reading.velocity.iter().all(|own| own.abs() < REST);
    let resting: Vec<&Seen> = record.seen.iter().filter(rests).collect();
    let of: Vec<&Seen> = match resting.is_empty() {
        true => record.seen.iter().collect(),
        false => resting,
    };
    // Weight changes slowly: some are enough.
    let every = (of.len() / 100).max(1);
    let some = of.iter().step_by(every);
    let count = some.clone().count() as f64;
    let weight = some.map(|own| expected.weight.at(&own.reading.position)[joint]);
    let torques: Vec<f64> = of
        .iter()
        .filter_map(|own| torque(&own.reading))
        .map(|own| own[joint])
        .collect();
    let mean = torques.iter().sum::<f64>() / torques.len() as f64;
    (
        (!torques.is_empty()).then_some(mean),
        weight.sum::<f64>() / count,
    )
}

/// The torque that there is.
fn torque(reading: &crate::driver::Reading) -> Option<ferntast_model::Joints<f64>> {
    reading.joint_torque.or(reading.motor_torque)
}

fn stands_still(record: &Record, joint: usize) -> bool {
    let mut torques = record.of(joint, torque);
    let first = torques.next();
    torques.all(|own| Some(own) == first)
}

fn against_weight(
    expected: &Expected,
    joint: usize,
    torque: f64,
    weight: f64,
    found: &mut Vec<Finding>,
) {
    let most = expected.joints[joint].torque;
    let (share, sensor) = match expected.torque {
        Torque::Joint => (OFFSET, "sensor"),
        Torque::Motor => (FRICTION, "motor"),
    };
    let allowed = MODEL * weight.abs() + share * most;
    if (torque - weight).abs() <= allowed {
        return;
    }
    let numbers = format!("its {sensor} tells {torque:.2} where the model's weight is {weight:.2}");
    let large = weight.abs() > allowed.max(0.05 * most);
    let (severity, what, why) =
        if large && torque * weight < 0.0 && torque.abs() > 0.3 * weight.abs() {
            (
                Severity::Wrong,
                "torque_sign",
                "the sign of the torque is wrong",
            )
        } else if large && torque.abs() < 0.1 * weight.abs() {
            match expected.torque {
                Torque::Joint => (
                    Severity::Wrong,
                    "torque_without_weight",
                    "the torque is not measured, or the weight is taken out of it already",
                ),
                Torque::Motor => (
                    Severity::Doubtful,
                    "torque_without_weight",
                    "is a brake on? With the drives on it has to carry that",
                ),
            }
        } else {
            (
                Severity::Doubtful,
                "torque_weight",
                "a load that the URDF does not know, a zero that is off, or other units?",
            )
        };
    found.push(Finding::new(severity, what, format!("{numbers}: {why}")));
}

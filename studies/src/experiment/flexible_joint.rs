//! The second paper's flexible joint on its bench: recorded, and read again.
//!
//! The bench speaks the arm's topics. Its motor is drive 1 and side 1 of the
//! joint, the brake is drive 2 and side 2:
//!
//! | number | where |
//! |---|---|
//! | θ, τ_s | `/follower/measured_js` position\[0\], effort\[0\] |
//! | q | `/follower/measured_js` position\[1\] |
//! | τ_m, commanded τ_b | `/follower/motor_js` effort\[0\], effort\[1\] |

use std::{collections::BTreeMap, path::Path};

use ferntast_bag::{BagOptions, BagReader};
use ferntast_benches::flexible_joint_bench::{self, FlexibleJointParameters, FlexibleJointRun};
use ferntast_bus::{Bus, McapBus, PublishError, Publisher};
use ferntast_identification::{
    Inertia, ModelSpec,
    experiments::flexible_joint::{FlexibleJointSignals, Inertias, Row, rows},
};
use ferntast_lab::{
    experiment::{Experiment, RECORD, Signals},
    recording,
};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics,
};

use super::{ExperimentError, IdentifyError};

/// One sample of so many of the bench's is recorded: 200 Hz.
const EVERY: usize = 5;
/// Keys of the recording's own record.
const MOTOR_INERTIA: &str = "motor_inertia";
const LOAD_INERTIA: &str = "load_inertia";

/// Runs the bench into the new rosbag2 directory `folder`.
///
/// # Errors
///
/// [`ExperimentError`].
pub fn record(
    folder: &Path,
    parameters: &FlexibleJointParameters,
    run: &FlexibleJointRun,
) -> Result<(), ExperimentError> {
    let error = |reason: String| ExperimentError::Recording {
        path: folder.to_owned(),
        reason,
    };
    let record: BTreeMap<String, String> = [
        ("mode", "experiment".to_owned()),
        ("experiment", "flexible_joint".to_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("seed", run.seed.to_string()),
        (MOTOR_INERTIA, parameters.motor_inertia.to_string()),
        (LOAD_INERTIA, parameters.load_inertia.to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into();
    let options = BagOptions {
        custom: [(RECORD.to_owned(), record)].into(),
        ..BagOptions::default()
    };
    let bag = McapBus::create_with(folder, options).map_err(|e| error(e.to_string()))?;
    let bus = Bus::Mcap(bag.clone());
    let mut measured = bus.publisher(topics::FOLLOWER_MEASURED_JS)?;
    let mut motor = bus.publisher(topics::FOLLOWER_MOTOR_JS)?;
    let log = flexible_joint_bench::record(parameters, run);
    for at in (0..log.position.len()).step_by(EVERY) {
        let time = at as f64 * flexible_joint_bench::LOG_PERIOD;
        let stamp = Time::from_nanos(super::MISSION_START * 1_000_000_000).plus_seconds(time);
        let empty = JointSample::empty(JointNames::numbered(2), stamp);
        let sides = empty
            .with_position([log.motor_position[at], log.position[at]])
            .with_effort([log.joint_torque[at]]);
        let drives = empty.with_effort([log.motor_torque[at], log.brake_torque[at]]);
        publish(&mut measured, &sides)
            .and_then(|()| publish(&mut motor, &drives))
            .map_err(|e| error(e.to_string()))?;
    }
    bag.finish().map_err(|e| error(e.to_string()))?;
    Ok(())
}

fn publish(
    publisher: &mut Publisher<JointSample>,
    sample: &JointSample,
) -> Result<(), PublishError> {
    publisher.publish(sample.stamp, sample)
}

/// Rows of the three regressions out of the recording at `folder`.
///
/// # Errors
///
/// A recording that cannot be read, or is not of this bench.
pub fn read(folder: &Path) -> Result<[Vec<Row>; 3], IdentifyError> {
    let empty = || IdentifyError::Empty {
        path: folder.to_owned(),
        what: "no flexible joint on its bench in it",
    };
    let inertias = inertias(folder)?.ok_or_else(empty)?;
    let measured = topics::FOLLOWER_MEASURED_JS.name;
    let motor = topics::FOLLOWER_MOTOR_JS.name;
    let extra = [
        ("q_link", format!("{measured}.position[1]")),
        ("brake", format!("{motor}.effort[1]")),
    ];
    let signals = Signals {
        position: format!("{measured}.position[0]"),
        motor_torque: format!("{motor}.effort[0]"),
        joint_torque: Some(format!("{measured}.effort[0]")),
        extra: extra.map(|(name, path)| (name.to_owned(), path)).into(),
        ..Signals::default()
    };
    let model = ModelSpec {
        inertia: Inertia::Given(inertias.motor),
        gear_ratio: None,
        effects: Vec::new(),
    };
    let experiment = Experiment::of_joint("flexible joint", folder, signals, model);
    let dataset = recording::load(&experiment)?.dataset;
    let session = dataset.sessions.first().ok_or_else(empty)?;
    let channel = |name: &str| session.extra.get(name).ok_or_else(empty);
    let signals = FlexibleJointSignals {
        period: session.period,
        motor_position: &session.position,
        position: channel("q_link")?,
        motor_torque: &session.motor_torque,
        joint_torque: session.joint_torque.as_ref().ok_or_else(empty)?,
        brake_torque: channel("brake")?,
    };
    Ok(rows(&signals, inertias))
}

/// What the recording says of the bench.
fn inertias(folder: &Path) -> Result<Option<Inertias>, IdentifyError> {
    let bag = BagReader::open(folder).map_err(|source| IdentifyError::Open {
        path: folder.to_owned(),
        reason: source.to_string(),
    })?;
    let number = |key: &str| -> Option<f64> { bag.metadata().get(RECORD)?.get(key)?.parse().ok() };
    Ok(number(MOTOR_INERTIA)
        .zip(number(LOAD_INERTIA))
        .map(|(motor, load)| Inertias { motor, load }))
}

//! The days of a recording of a session that ran with a twin.

use std::path::{Path, PathBuf};

use ferntast_bag::BagReader;
use ferntast_msgs::{
    sample::{TemperatureSample, TwinParametersSample},
    topics::{FOLLOWER_JOINT_TEMPERATURE, TWIN_PARAMETERS},
};

use crate::{aggregate::Aggregate, summary::DaySummary};

/// Why a recording has no days.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordedError {
    /// It cannot be read.
    #[error("{path}: {reason}", path = path.display())]
    Read {
        /// The recording.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// No twin said anything in it.
    #[error(
        "{path}: no twin says anything of a parameter in it; record with `ferntast session --twin joint.toml`, \
         or play it with one (`ferntast play … --twin joint.toml`)", path = path.display()
    )]
    NoTwin {
        /// The recording.
        path: PathBuf,
    },
}

/// The days of `robot`, whose recording is at `path`.
///
/// # Errors
///
/// [`RecordedError`].
pub fn days_of(path: &Path, robot: &str) -> Result<Vec<DaySummary>, RecordedError> {
    let bad = |reason: String| RecordedError::Read {
        path: path.to_owned(),
        reason,
    };
    let none = || RecordedError::NoTwin {
        path: path.to_owned(),
    };
    let bag = BagReader::open(path).map_err(|error| bad(error.to_string()))?;
    let mut all = Aggregate::default();
    let said = bag.messages::<TwinParametersSample>(&TWIN_PARAMETERS.name);
    for word in said.map_err(|_| none())? {
        all.said(
            robot,
            &word.map_err(|error| bad(error.to_string()))?.message,
        );
    }
    let topics: Vec<(String, String)> = bag
        .topics()
        .filter_map(|own| {
            let joint = FOLLOWER_JOINT_TEMPERATURE.joint_of(&own.name)?;
            Some((own.name.clone(), joint.to_owned()))
        })
        .collect();
    for (topic, joint) in topics {
        let told = bag.messages::<TemperatureSample>(&topic);
        for own in told.map_err(|error| bad(error.to_string()))? {
            let own = own.map_err(|error| bad(error.to_string()))?;
            all.temperature(robot, &joint, own.log_time, own.message.temperature);
        }
    }
    let days = all.take();
    match days.is_empty() {
        true => Err(none()),
        false => Ok(days),
    }
}

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
            let own = own.map_err(|error| bad(error.to_string()))?.message;
            // By its stamp, as the twin's words are: one that was played and recorded again has
            // another time in the log.
            all.temperature(robot, &joint, own.stamp, own.temperature);
        }
    }
    let days = all.take();
    match days.is_empty() {
        true => Err(none()),
        false => Ok(days),
    }
}

#[cfg(test)]
mod tests {
    use ferntast_bag::{BagOptions, BagWriter};
    use ferntast_msgs::{Text, Time};

    use super::*;

    /// A recording of what was played two days after it was: stamps are of then, the log's times
    /// of now.
    fn played(path: &Path, stamp: Time, logged: Time) {
        let mut writer = BagWriter::create(path, BagOptions::default()).expect("a new recording");
        let topic = FOLLOWER_JOINT_TEMPERATURE.of("joint_2").expect("a name");
        let temperatures = writer.topic(topic).expect("a topic");
        let own = TemperatureSample::new(stamp, 21.5);
        let written = writer.write(temperatures, logged, logged, &own);
        written.expect("it can be written");
        let words = writer.topic(TWIN_PARAMETERS).expect("a topic");
        let mut own = TwinParametersSample::initial(stamp);
        own.joint = Text::new("joint_2");
        own.count = 1;
        own.names[0] = Text::new("b0");
        (own.values[0], own.std_errors[0], own.excitation[0]) = (12.0, 0.1, 1.0);
        let written = writer.write(words, logged, logged, &own);
        written.expect("it can be written");
        writer.finish().expect("a whole recording");
    }

    #[test]
    fn temperature_and_parameters_are_of_the_day_that_they_are_stamped_with() {
        let name = format!("ferntast-fleet-played-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = std::fs::remove_dir_all(&path);
        let day = |number: i64| Time::from_nanos((number * 86_400 + 3_600) * 1_000_000_000);
        played(&path, day(2), day(4));
        let days = days_of(&path, "left");
        std::fs::remove_dir_all(&path).expect("it was made");
        let days = days.expect("days");
        assert_eq!(days.len(), 1, "{days:?}");
        assert_eq!(
            (days[0].day.as_str(), days[0].temperature),
            ("1970-01-03", Some(21.5))
        );
    }
}

//! What twins say, put together to days.

use std::collections::BTreeMap;

use ferntast_msgs::{Time, sample::TwinParametersSample};

use crate::summary::{DaySummary, ParameterOfDay, date};

/// Least excitation of a parameter that counts \[1\]: below it the motion told too little of it.
const LEAST_EXCITATION: f64 = 0.5;
const NANOS_A_DAY: i64 = 86_400_000_000_000;

#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.sum += value;
            self.count += 1.0;
        }
    }

    fn value(self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

#[derive(Clone, Debug, Default)]
struct Joint {
    temperature: Mean,
    words: u64,
    /// Values and standard errors.
    parameters: BTreeMap<String, (Mean, Mean)>,
}

/// Means of a day of one robot's joints, of what came in so far.
#[derive(Clone, Debug, Default)]
pub struct Aggregate {
    /// By day from 1970 on, robot, joint.
    joints: BTreeMap<(i64, String, String), Joint>,
}

impl Aggregate {
    /// A twin of `robot` said something.
    pub fn said(&mut self, robot: &str, own: &TwinParametersSample) {
        let joint = self.joint(robot, own.joint.as_str(), own.stamp);
        joint.words += 1;
        for i in 0..own.len() {
            let (value, error) = (own.values[i], own.std_errors[i]);
            // What has no error is a shape or a constant.
            if own.excitation[i] < LEAST_EXCITATION
                || !(error > 0.0 && error.is_finite() && value.is_finite())
            {
                continue;
            }
            let (values, errors) = joint
                .parameters
                .entry(own.names[i].to_string())
                .or_default();
            values.add(value);
            errors.add(error);
        }
    }

    /// A joint's temperature at `stamp` \[degC\].
    pub fn temperature(&mut self, robot: &str, joint: &str, stamp: Time, temperature: f64) {
        self.joint(robot, joint, stamp).temperature.add(temperature);
    }

    fn joint(&mut self, robot: &str, joint: &str, stamp: Time) -> &mut Joint {
        let day = stamp.nanos().div_euclid(NANOS_A_DAY);
        self.joints
            .entry((day, robot.to_owned(), joint.to_owned()))
            .or_default()
    }

    /// Takes out the days before that of `now`.
    pub fn take_before(&mut self, now: Time) -> Vec<DaySummary> {
        let today = now.nanos().div_euclid(NANOS_A_DAY);
        let later = self
            .joints
            .split_off(&(today, String::new(), String::new()));
        let done = std::mem::replace(&mut self.joints, later);
        summaries(done)
    }

    /// Takes out all that there is.
    pub fn take(&mut self) -> Vec<DaySummary> {
        summaries(std::mem::take(&mut self.joints))
    }
}

/// Of joints whose twins said something of a parameter.
fn summaries(joints: BTreeMap<(i64, String, String), Joint>) -> Vec<DaySummary> {
    let told = joints
        .into_iter()
        .filter(|(_, own)| !own.parameters.is_empty());
    told.map(|((day, robot, joint), own)| {
        let parameters = own
            .parameters
            .into_iter()
            .filter_map(|(name, (values, errors))| {
                let (value, std_error) = (values.value()?, errors.value()?);
                Some((name, ParameterOfDay { value, std_error }))
            });
        DaySummary {
            day: date(day),
            robot,
            joint,
            temperature: own.temperature.value(),
            samples: own.words,
            parameters: parameters.collect(),
        }
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_msgs::Text;

    fn word(stamp: Time, b0: f64, excitation: f64) -> TwinParametersSample {
        let mut own = TwinParametersSample::initial(stamp);
        own.joint = Text::new("joint_2");
        own.count = 3;
        for (i, (name, value, error)) in [("b0", b0, 0.1), ("b1", 160.0, 2.0), ("v_seen", 0.3, 0.0)]
            .iter()
            .enumerate()
        {
            own.names[i] = Text::new(name);
            own.values[i] = *value;
            own.std_errors[i] = *error;
            own.excitation[i] = if i == 1 { excitation } else { 1.0 };
        }
        own
    }

    #[test]
    fn a_day_is_the_mean_of_what_the_motion_told() {
        let day = |days: i64, seconds: i64| {
            Time::from_nanos(days * NANOS_A_DAY + seconds * 1_000_000_000)
        };
        let mut all = Aggregate::default();
        all.said("left", &word(day(2, 10), 12.0, 0.9));
        all.said("left", &word(day(2, 20), 13.0, 0.1));
        all.said("left", &word(day(3, 10), 14.0, 0.1));
        all.temperature("left", "joint_2", day(2, 15), 20.0);
        all.temperature("left", "joint_1", day(2, 15), 30.0);
        let done = all.take_before(day(3, 20));
        assert_eq!(done.len(), 1, "{done:?}");
        let own = &done[0];
        assert_eq!(
            (own.day.as_str(), own.samples, own.temperature),
            ("1970-01-03", 2, Some(20.0))
        );
        assert_eq!(own.parameters["b0"].value, 12.5);
        // Excited once only; v_seen is no estimate.
        assert_eq!(own.parameters["b1"].value, 160.0);
        assert_eq!(own.parameters.len(), 2);
        let rest = all.take();
        assert_eq!(rest.len(), 1);
        assert_eq!(rest[0].parameters.len(), 1);
        assert!(all.take().is_empty());
    }
}

//! What session and plant tell each other first: one line of JSON each way.

use ferntast_msgs::sample::JointNames;
use serde::{Deserialize, Serialize};

use super::error::PlantError;
use crate::driver::Measures;

/// The protocol's name and version, which both sides say.
pub const PROTOCOL: &str = "ferntast-plant";
/// See [`PROTOCOL`].
pub const VERSION: u32 = 1;

/// What the session says.
#[derive(Clone, Debug, Serialize)]
pub struct Greeting {
    /// [`PROTOCOL`].
    pub protocol: &'static str,
    /// [`VERSION`].
    pub version: u32,
    /// The arm's joints, from the base on.
    pub joints: Vec<String>,
    /// The time of a step \[s\].
    pub period_s: f64,
    /// For whatever a plant draws at random.
    pub seed: u64,
    /// What else is known of the arm: see docs/process_driver.md.
    pub arm: serde_json::Value,
}

impl Greeting {
    /// Of an arm of those joints.
    pub fn new(joints: &JointNames, period: f64, seed: u64, arm: serde_json::Value) -> Greeting {
        Greeting {
            protocol: PROTOCOL,
            version: VERSION,
            joints: joints.iter().map(String::from).collect(),
            period_s: period,
            seed,
            arm,
        }
    }
}

/// What the plant answers.
#[derive(Debug, Deserialize)]
struct Answer {
    protocol: String,
    version: u32,
    joints: Vec<String>,
    period_s: f64,
    #[serde(default)]
    measures: Vec<String>,
    #[serde(default)]
    truth: Vec<String>,
}

/// A list of numbers in a plant's record, after positions and velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// One of each joint.
    JointTorque,
    /// One of each joint.
    MotorTorque,
    /// One of each joint.
    Temperature,
    /// Three, of what is true.
    ContactForce,
    /// Three, of what is true.
    Tip,
    /// One, of what is true.
    ContactWork,
    /// One, of what is true.
    Energy,
}

const MEASURED: [(&str, Part); 3] = [
    ("joint_torque", Part::JointTorque),
    ("motor_torque", Part::MotorTorque),
    ("temperature", Part::Temperature),
];
const TRUE: [(&str, Part); 4] = [
    ("contact_force", Part::ContactForce),
    ("tip", Part::Tip),
    ("contact_work", Part::ContactWork),
    ("energy", Part::Energy),
];

impl Part {
    /// What it is called in messages.
    pub fn name(self) -> &'static str {
        let mut all = MEASURED.iter().chain(&TRUE);
        all.find(|(_, part)| *part == self)
            .map_or("", |(name, _)| name)
    }

    /// How many numbers it has, of an arm of `joints`.
    pub fn numbers(self, joints: usize) -> usize {
        match self {
            Part::JointTorque | Part::MotorTorque | Part::Temperature => joints,
            Part::ContactForce | Part::Tip => 3,
            Part::ContactWork | Part::Energy => 1,
        }
    }
}

/// What a plant's records look like.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// For each joint of the arm its place in the plant's lists.
    pub places: Vec<usize>,
    /// What follows positions and velocities.
    pub parts: Vec<Part>,
}

impl Layout {
    /// Of the plant's answer to `greeting`.
    ///
    /// # Errors
    ///
    /// An answer that is none, other joints, another step, something that is not known.
    pub fn of_answer(line: &str, greeting: &Greeting) -> Result<Layout, PlantError> {
        let refuse = |reason: String| PlantError::Greeting {
            // A program that talks on its output would fill the screen.
            line: line.chars().take(200).collect(),
            reason,
        };
        let answer: Answer =
            serde_json::from_str(line).map_err(|error| refuse(error.to_string()))?;
        if answer.protocol != PROTOCOL || answer.version != VERSION {
            return Err(refuse(format!(
                "it is not {PROTOCOL:?} in version {VERSION}"
            )));
        }
        let wanted = &greeting.joints;
        let place = |name: &String| answer.joints.iter().position(|own| own == name);
        let places: Option<Vec<usize>> = wanted.iter().map(place).collect();
        let same_count = answer.joints.len() == wanted.len();
        let Some(places) = places.filter(|_| same_count) else {
            return Err(PlantError::Joints {
                found: answer.joints.join(", "),
                wanted: wanted.join(", "),
            });
        };
        if (answer.period_s - greeting.period_s).abs() > 1e-9 {
            return Err(PlantError::Period {
                found: answer.period_s,
                wanted: greeting.period_s,
            });
        }
        let known = |names: &[String], known: &[(&str, Part)]| {
            let each = names.iter().map(|name| {
                let found = known.iter().find(|(own, _)| own == name);
                found.map(|(_, part)| *part).ok_or_else(|| {
                    let known: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
                    PlantError::Unknown {
                        name: name.clone(),
                        known: known.join(", "),
                    }
                })
            });
            each.collect::<Result<Vec<Part>, PlantError>>()
        };
        let mut parts = known(&answer.measures, &MEASURED)?;
        parts.extend(known(&answer.truth, &TRUE)?);
        Ok(Layout { places, parts })
    }

    /// How many numbers a record of the plant has.
    pub fn numbers(&self) -> usize {
        let joints = self.places.len();
        let parts: usize = self.parts.iter().map(|part| part.numbers(joints)).sum();
        2 * joints + parts
    }

    /// What is measured beside positions and velocities.
    pub fn measures(&self) -> Measures {
        Measures {
            joint_torque: self.parts.contains(&Part::JointTorque),
            motor_torque: self.parts.contains(&Part::MotorTorque),
            temperature: self.parts.contains(&Part::Temperature),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(answer: &str) -> Result<Layout, String> {
        let joints = JointNames::new(["a", "b", "c"]).unwrap();
        let greeting = Greeting::new(&joints, 0.001, 1, serde_json::Value::Null);
        Layout::of_answer(answer, &greeting).map_err(|error| error.to_string())
    }

    const GOOD: &str = r#"{"protocol": "ferntast-plant", "version": 1, "joints": ["c", "a", "b"],
        "period_s": 0.001, "measures": ["motor_torque"], "truth": ["tip"], "note": "more"}"#;

    #[test]
    fn joints_may_come_in_another_order() {
        let layout = of(GOOD).unwrap();
        assert_eq!(layout.places, [1, 2, 0]);
        assert_eq!(layout.numbers(), 3 + 3 + 3 + 3);
        let measures = layout.measures();
        assert!(measures.motor_torque && !measures.joint_torque && !measures.temperature);
    }

    #[test]
    fn what_does_not_fit_is_refused_in_words() {
        let wrong = [
            ("hello", "hello", "answered the greeting with"),
            (
                "ferntast-plant",
                "other",
                "it is not \"ferntast-plant\" in version 1",
            ),
            ("\"version\": 1", "\"version\": 2", "in version 1"),
            (
                r#"["c", "a", "b"]"#,
                r#"["c", "a", "x"]"#,
                "has the joints c, a, x where a, b, c are needed",
            ),
            (
                r#"["c", "a", "b"]"#,
                r#"["c", "a", "b", "d"]"#,
                "c, a, b, d where",
            ),
            ("0.001", "0.002", "steps by 0.002 s where 0.001 s"),
            (
                "motor_torque",
                "colour",
                "\"colour\", which is not known; known are joint_torque",
            ),
        ];
        for (from, to, words) in wrong {
            let answer = match from {
                "hello" => to.to_owned(),
                _ => GOOD.replace(from, to),
            };
            let told = of(&answer).unwrap_err();
            assert!(told.contains(words), "{told}");
        }
    }
}

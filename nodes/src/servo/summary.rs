//! The friction that is fed forward, in the result of a command.

use std::fmt;

use ferntast_model::friction::{self, JointType};
use ferntast_msgs::sample::FrictionStatusSample;
use serde::Serialize;

/// The friction that is fed forward at one joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrictionSummary {
    /// Its name.
    pub joint: String,
    /// `configured` or `twin`.
    pub source: String,
    /// Why the last command was refused; `null` where it was not.
    pub refused: Option<String>,
    /// The parameters.
    pub parameters: Vec<FrictionParameter>,
}

/// A parameter of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrictionParameter {
    /// Name in the arm's file.
    pub name: String,
    /// By the arm's file.
    pub configured: f64,
    /// In use now.
    pub value: f64,
    /// What the value is, or is on its way to.
    pub target: f64,
}

impl FrictionSummary {
    /// Of a message on `/follower/{joint}/friction`.
    pub fn of(sample: &FrictionStatusSample) -> Self {
        let parameters = (0..sample.len()).map(|i| FrictionParameter {
            name: sample.names[i].to_string(),
            configured: sample.configured[i],
            value: sample.values[i],
            target: sample.targets[i],
        });
        Self {
            joint: sample.joint.to_string(),
            source: sample.source.name().unwrap_or_default().to_owned(),
            refused: (!sample.refused.is_empty()).then(|| sample.refused.to_string()),
            parameters: parameters.collect(),
        }
    }
}

/// Unit of the parameter that is called so in an arm's file.
fn unit_of(key: &str) -> Option<&'static str> {
    let effects = friction::of_joint();
    let mut parameters = effects.flat_map(|own| own.row.coefficients.iter().chain(own.row.shape));
    let found = parameters.find(|own| own.key == key);
    found.map(|own| own.unit.of(JointType::Revolute))
}

impl fmt::Display for FrictionSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "friction  {}: {}", self.joint, self.source)?;
        for own in &self.parameters {
            write!(f, ", {} {:.4}", own.name, own.target)?;
            if own.target != own.configured {
                write!(f, " (configured {:.4})", own.configured)?;
            }
            match unit_of(&own.name) {
                None | Some("1") => {}
                Some(unit) => write!(f, " {unit}")?,
            }
        }
        match &self.refused {
            Some(reason) => write!(f, "; last command refused: {reason}"),
            None => Ok(()),
        }
    }
}

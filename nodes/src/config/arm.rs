//! An arm's file as the nodes have it.

use ferntast_control::estimator::EstimatorParameters;
use ferntast_model::{ArmModel, arm::ArmParameters, contour::Contour, joint::JointParameters};
use serde::{
    Deserialize, Serialize,
    de::{DeserializeOwned, Error as _},
};
use serde_json::value::{RawValue, to_raw_value};

use super::ConfigError;

/// Loads the arm `name`, shipped or a file, as the driver of the arm reads it.
pub type LoadArm = fn(&str) -> Result<ArmFile, ConfigError>;

/// What servo and estimator believe of an arm, and its file as a whole, of
/// which only the arm's driver reads the rest. As JSON it is the whole file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Box<RawValue>", into = "Box<RawValue>")]
pub struct ArmFile {
    /// Links, joints and contour.
    pub model: ArmModel,
    /// Contact-force estimator.
    pub estimator: EstimatorParameters,
    whole: Box<RawValue>,
}

/// The sections of the file that nodes read.
#[derive(Deserialize)]
struct Sections {
    arm: ArmParameters,
    joint: Vec<JointParameters>,
    contour: Contour,
    estimator: EstimatorParameters,
}

impl ArmFile {
    /// Of a file that the arm's driver has read and checked.
    ///
    /// # Errors
    ///
    /// The file has no JSON form.
    pub fn new(
        model: ArmModel,
        estimator: EstimatorParameters,
        whole: &impl Serialize,
    ) -> Result<ArmFile, ConfigError> {
        Ok(ArmFile {
            model,
            estimator,
            whole: to_raw_value(whole).map_err(ConfigError::Arm)?,
        })
    }

    /// The whole file, for the arm's driver.
    ///
    /// # Errors
    ///
    /// It is one of another driver.
    pub fn whole<T: DeserializeOwned>(&self) -> Result<T, ConfigError> {
        serde_json::from_str(self.whole.get()).map_err(ConfigError::Arm)
    }
}

impl TryFrom<Box<RawValue>> for ArmFile {
    type Error = serde_json::Error;

    fn try_from(whole: Box<RawValue>) -> Result<ArmFile, serde_json::Error> {
        let Sections {
            arm,
            joint,
            contour,
            estimator,
        } = serde_json::from_str(whole.get())?;
        let links = arm.joints_of_links(&joint);
        links.map_err(serde_json::Error::custom)?;
        Ok(ArmFile {
            model: ArmModel {
                arm,
                joint,
                contour,
            },
            estimator,
            whole,
        })
    }
}

impl From<ArmFile> for Box<RawValue> {
    fn from(file: ArmFile) -> Box<RawValue> {
        file.whole
    }
}

/// Loads an arm without a driver; what only a driver reads is not checked.
#[cfg(test)]
pub fn load_model_only(name: &str) -> Result<ArmFile, ConfigError> {
    let file: serde_json::Value = super::load(super::ARM, name, |_| Ok(()))?;
    let whole = to_raw_value(&file).map_err(ConfigError::Arm)?;
    ArmFile::try_from(whole).map_err(ConfigError::Arm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_json_is_the_whole_file_byte_for_byte() {
        let file = load_model_only("rokviss").unwrap();
        let text = serde_json::to_string(&file).unwrap();
        assert_eq!(text, file.whole.get());
        assert!(text.contains("\"truth\""), "{text}");
        let again: ArmFile = serde_json::from_str(&text).unwrap();
        assert_eq!(again.model, file.model);
        assert_eq!(again.estimator, file.estimator);
        assert_eq!(serde_json::to_string(&again).unwrap(), text);
    }

    #[test]
    fn an_arm_with_a_joint_too_many_is_refused() {
        let file = load_model_only("rokviss").unwrap();
        let mut whole: serde_json::Value = file.whole().unwrap();
        let joints = whole["joint"].as_array_mut().unwrap();
        joints.push(joints[0].clone());
        let error = serde_json::from_value::<ArmFile>(whole).unwrap_err();
        let words = error.to_string();
        assert!(
            words.contains("joint has 3 entries where 2 are needed"),
            "{words}"
        );
    }

    #[test]
    fn a_file_without_a_section_that_nodes_need_is_refused() {
        let error = serde_json::from_str::<ArmFile>(r#"{"truth": {}}"#).unwrap_err();
        assert!(error.to_string().contains("arm"), "{error}");
    }
}

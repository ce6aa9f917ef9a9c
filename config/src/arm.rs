//! An arm's file as the nodes have it.

use ferntast_control::estimator::EstimatorParameters;
use ferntast_model::{ArmModel, arm::ArmParameters, contour::Contour, joint::JointParameters};
use ferntast_msgs::sample::JointNames;
use serde::{
    Deserialize, Serialize,
    de::{DeserializeOwned, Error as _},
};
use serde_json::value::{RawValue, to_raw_value};

use super::{
    ConfigError, joint_names,
    serial::{Serial, SerialFile},
};

/// Loads the arm `name`, shipped or a file, as the driver of the arm reads it.
pub type LoadArm = fn(&str) -> Result<ArmFile, ConfigError>;

/// What servo and estimator believe of an arm, and its file as a whole, of
/// which only the arm's driver reads the rest. As JSON it is the whole file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Box<RawValue>", into = "Box<RawValue>")]
pub struct ArmFile {
    /// Links, joints and what they can touch.
    pub model: Believed,
    /// Contact-force estimator.
    pub estimator: EstimatorParameters,
    whole: Box<RawValue>,
}

/// What is believed of an arm.
#[derive(Clone, Debug)]
pub enum Believed {
    /// Two links in a plane, in closed form, and a contour.
    Planar(Box<ArmModel>),
    /// A serial arm in space out of a URDF.
    Serial(Box<Serial>),
}

impl Believed {
    /// The joints, from the base on.
    pub fn joints(&self) -> &[JointParameters] {
        match self {
            Believed::Planar(model) => &model.joint,
            Believed::Serial(serial) => serial.arm.joints(),
        }
    }

    /// The joints' names.
    pub fn joint_names(&self) -> JointNames {
        match self {
            Believed::Planar(model) => joint_names(model),
            Believed::Serial(serial) => serial.joints,
        }
    }

    /// Whether it has the joints to turn its tool as it likes.
    pub fn turns_tool(&self) -> bool {
        self.serial().is_some_and(|own| own.arm.turns_tool())
    }

    /// The model of two links in a plane, where it is one.
    pub fn planar(&self) -> Option<&ArmModel> {
        match self {
            Believed::Planar(model) => Some(model),
            Believed::Serial(_) => None,
        }
    }

    /// The serial arm, where it is one.
    pub fn serial(&self) -> Option<&Serial> {
        match self {
            Believed::Planar(_) => None,
            Believed::Serial(serial) => Some(serial),
        }
    }
}

impl From<ArmModel> for Believed {
    fn from(model: ArmModel) -> Believed {
        Believed::Planar(Box::new(model))
    }
}

/// The sections of a planar arm's file that nodes read.
#[derive(Deserialize)]
struct Sections {
    arm: ArmParameters,
    joint: Vec<JointParameters>,
    contour: Contour,
    estimator: EstimatorParameters,
}

/// What tells the file of a serial arm from that of a planar one.
#[derive(Deserialize)]
struct IsSerial {
    #[serde(rename = "urdf")]
    _urdf: String,
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
            model: model.into(),
            estimator,
            whole: to_raw_value(whole).map_err(ConfigError::Arm)?,
        })
    }

    /// Of a serial arm.
    ///
    /// # Errors
    ///
    /// What is wrong with it; a number that JSON cannot hold.
    pub fn serial(file: &SerialFile) -> Result<ArmFile, ConfigError> {
        let believed = file
            .believed()
            .map_err(|error| (file.name.as_str(), error))?;
        Ok(ArmFile {
            model: Believed::Serial(Box::new(believed)),
            estimator: file.estimator,
            whole: to_raw_value(file).map_err(ConfigError::Arm)?,
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
        if let Ok(IsSerial { .. }) = serde_json::from_str(whole.get()) {
            let file: SerialFile = serde_json::from_str(whole.get())?;
            let believed = file.believed().map_err(serde_json::Error::custom)?;
            return Ok(ArmFile {
                model: Believed::Serial(Box::new(believed)),
                estimator: file.estimator,
                whole,
            });
        }
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
            }
            .into(),
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
///
/// # Errors
///
/// What is wrong, in which file, and how to correct it.
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
        assert_eq!(again.model.planar(), file.model.planar());
        assert!(again.model.planar().is_some());
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

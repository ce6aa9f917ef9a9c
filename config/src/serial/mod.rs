//! Arms out of URDF files: what is believed of one, and how a session is fitted to it.
//!
//! A file that the user writes says little ([`file`]); what it leaves out comes from the URDF
//! ([`defaults`]). The nodes get all of it, with the URDF's text, as [`SerialFile`].

mod defaults;
mod file;
mod task;

use ferntast_control::{estimator::EstimatorParameters, servo::ServoConfig};
use ferntast_model::{
    ParameterError,
    joint::JointParameters,
    rigid_body::Placement,
    serial_arm::{Plane, SerialArm},
};
use ferntast_msgs::sample::JointNames;
use ferntast_urdf::Robot;
use serde::{Deserialize, Serialize};

pub use file::load_serial;
pub(super) use task::fit;

/// A serial arm's file with nothing left out.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SerialFile {
    /// What the arm is called.
    pub name: String,
    /// Text of the URDF file.
    pub urdf: String,
    /// The link in whose frame it stands.
    pub base: String,
    /// The link whose frame is the tip.
    pub tip: String,
    /// Acceleration of gravity, base frame \[m/s²\].
    pub gravity: [f64; 3],
    /// Where it likes to be \[rad\] or \[m\].
    pub home: Vec<f64>,
    /// The joints as they are believed, from the base on.
    pub joint: Vec<JointParameters>,
    /// What its tip can touch, as it is believed.
    pub surface: Vec<Plane>,
    /// Contact-force estimator.
    pub estimator: EstimatorParameters,
    /// The servo's tuning, where the scenario gives none.
    pub servo: ServoConfig,
    /// What only the arm's driver reads; what is believed where nothing is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<serde_json::Value>,
    /// What drivers of hardware read, each the section of its name: `[driver.ros2]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driver: Option<serde_json::Value>,
}

/// What is believed of a serial arm, and what its frames are called.
#[derive(Clone, Debug)]
pub struct Serial {
    /// What the arm is called.
    pub name: String,
    /// Its mechanics.
    pub arm: SerialArm,
    /// Its joints' names.
    pub joints: JointNames,
    /// The link that each joint carries.
    pub links: Vec<String>,
    /// The servo's tuning, where the scenario gives none.
    pub servo: ServoConfig,
}

impl SerialFile {
    /// What is believed of the arm.
    ///
    /// # Errors
    ///
    /// What is wrong with the URDF, or with a value.
    pub fn believed(&self) -> Result<Serial, SerialError> {
        let robot = Robot::read(self.urdf.as_bytes())?;
        let arm = robot.between(&self.base, &self.tip)?;
        let joints = JointNames::new(arm.joints.iter().map(String::as_str));
        let joints = joints.map_err(|_| SerialError::JointNames(arm.joints.join(", ")))?;
        if let Some(link) = arm.links.iter().find(|own| own.len() > LONGEST_LINK_NAME) {
            return Err(SerialError::LinkName(link.clone()));
        }
        self.estimator
            .validate()
            .map_err(|error| error.within("estimator"))?;
        self.servo
            .validate()
            .and_then(|()| self.servo.joints(arm.chain.count()).map(drop))
            .map_err(|error| error.within("servo"))?;
        Ok(Serial {
            name: self.name.clone(),
            arm: SerialArm::new(
                arm.chain,
                self.joint.clone(),
                self.gravity,
                &self.home,
                self.surface.clone(),
            )?,
            joints,
            links: arm.links,
            servo: self.servo.clone(),
        })
    }
}

/// As few digits as are read back from JSON without a change: a session's file, or a
/// recording, has the same number then.
fn written(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// The longest name of a frame in `/tf` \[byte\].
const LONGEST_LINK_NAME: usize = 48;

impl Serial {
    /// The frames of the links and the tip at joint positions `q`, each in the one before it:
    /// the frame that it is in, its name, and where it is there. The base is `follower_base`,
    /// the tip `follower_tip`.
    ///
    /// # Panics
    ///
    /// `q` has not one value for each joint.
    pub fn frames(
        &self,
        q: &ferntast_model::Joints<f64>,
    ) -> impl Iterator<Item = (&str, &str, Placement)> {
        let links = self.arm.chain().link_placements(q);
        let tip = self.arm.chain().forward(q);
        let names = self.links.iter().map(String::as_str);
        let children = names.clone().chain([TIP_FRAME]);
        let parents = [BASE_FRAME].into_iter().chain(names);
        let mut before = Placement::identity();
        let placed = links.into_iter().chain([tip]);
        parents
            .zip(children)
            .zip(placed)
            .map(move |((parent, child), own)| {
                let within = before.inverse().then(&own);
                before = own;
                (parent, child, within)
            })
    }
}

/// The frame that the arm stands in.
pub const BASE_FRAME: &str = "follower_base";
/// The frame of the tip.
pub const TIP_FRAME: &str = "follower_tip";

/// Why there is no arm in a file.
#[derive(Debug, thiserror::Error)]
pub enum SerialError {
    /// The URDF is none.
    #[error(transparent)]
    Read(#[from] ferntast_urdf::ReadError),
    /// It has no such arm.
    #[error(transparent)]
    Arm(#[from] ferntast_urdf::ArmError),
    /// A value is out of its bounds.
    #[error(transparent)]
    Value(#[from] ParameterError),
    /// Names that messages have no room for.
    #[error("the joints {0}: give each a name of its own of 1 to 32 bytes")]
    JointNames(String),
    /// A frame that `/tf` has no room for.
    #[error("link \"{0}\": its name is longer than {LONGEST_LINK_NAME} bytes; shorten it")]
    LinkName(String),
    /// An entry about a joint that there is not.
    #[error("[[joint]] \"{name}\": the arm has no such joint; it has {known}")]
    NoSuchJoint {
        /// The name.
        name: String,
        /// What there is.
        known: String,
    },
    /// A section that does not say which joint it is about.
    #[error(
        "[[joint]] number {0} (from 1) has no name; add name = \"…\", one of the URDF's joints"
    )]
    NoName(usize),
    /// A section with a key or type that is wrong.
    #[error("[{section}]: {message}")]
    Section {
        /// Which.
        section: String,
        /// What is wrong.
        message: String,
    },
}

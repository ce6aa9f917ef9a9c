//! Why a result does not go on.

use std::{io, path::PathBuf};

use ferntast_lab::work::WorkError;
use ferntast_urdf::ReadError;

/// Why what was identified is not written for another program.
#[derive(Debug, thiserror::Error)]
pub enum IdentifiedError {
    /// The experiment cannot be fitted.
    #[error(transparent)]
    Work(#[from] WorkError),
    /// It is about a contact.
    #[error(
        "{0}: it is about a contact, and these forms are of joints; give the experiment of a joint or an arm"
    )]
    Contact(String),
    /// Torques are not torques.
    #[error(
        "{title}: its motor torque is in {unit}, and {to} takes Nm; say in [signals] what one {unit} is, as in motor_torque = \"/drive.current[0].@mul(8.4)\", and leave the unit out"
    )]
    DriveUnit {
        /// The experiment.
        title: String,
        /// What stands for the torque.
        unit: &'static str,
        /// Who it goes to.
        to: &'static str,
    },
    /// An option that is of another form.
    #[error("{option} goes with --to {with}")]
    Option {
        /// The option.
        option: &'static str,
        /// What it goes with.
        with: &'static str,
    },
    /// A name for one joint where there are more.
    #[error("{0}: its joints have names; --joint is for the experiment of a single joint")]
    Named(String),
    /// A bandwidth that is none.
    #[error("--servo-hz {0}: give a bandwidth of 0.1 … 200 Hz")]
    Servo(f64),
    /// The driver of Universal Robots is told of six joints.
    #[error(
        "{title}: number of joints {joints}, and the driver of Universal Robots takes six; give the experiment of the whole arm ([arm])"
    )]
    NotSix {
        /// The experiment.
        title: String,
        /// How many it has.
        joints: usize,
    },
    /// Two experiments that do not go together.
    #[error(
        "{title}: its joints are {found}, those of the other experiment {wanted}; name two experiments of one arm"
    )]
    OtherJoints {
        /// The experiment given second.
        title: String,
        /// Its joints.
        found: String,
        /// Those of the first.
        wanted: String,
    },
    /// A URDF that cannot be read.
    #[error("{path}: {source}")]
    Urdf {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ReadError,
    },
    /// A URDF without the joint.
    #[error("{path}: it has no joint {joint}; its joints are {known}")]
    NoJoint {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// Those that it has.
        known: String,
    },
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

//! What a user says of files that are to become an experiment.

use std::path::PathBuf;

use ferntast_identification::JointType;

use crate::{experiment::Join, guess::Role, unit::Unit};

/// What a user says of one signal: `COLUMN` or `COLUMN:UNIT`.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// Column or message path.
    pub column: String,
    /// Its unit, if said.
    pub unit: Option<String>,
}

impl Said {
    /// Reads `COLUMN` or `COLUMN:UNIT`; what is behind the last colon is a unit only
    /// where it is a known one.
    #[must_use]
    pub fn parse(text: &str) -> Said {
        match text.rsplit_once(':') {
            Some((column, unit)) if Unit::parse(unit).is_some() => Said {
                column: column.to_owned(),
                unit: Some(unit.to_owned()),
            },
            _ => Said {
                column: text.to_owned(),
                unit: None,
            },
        }
    }
}

/// The arm that recordings are of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OfArm {
    /// Its URDF.
    pub urdf: PathBuf,
    /// Its joints from the base on; none: all of the URDF's arm.
    pub joints: Vec<String>,
    /// Torque at each joint for a unit of what is recorded as its motor's, gear included
    /// \[Nm/A\] and the like; none: torques are recorded.
    pub drive_gain: Option<Vec<f64>>,
}

/// What is to become of which files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Tables, MCAP files, folders.
    pub files: Vec<PathBuf>,
    /// What was said of signals. Of an arm a column may be a name with `{joint}` in it, an array
    /// of messages, or a list of columns with commas between.
    pub said: Vec<(Role, Said)>,
    /// What was said of single joints of an arm.
    pub of_joint: Vec<(Role, String, Said)>,
    /// Extra signals by name.
    pub extra: Vec<(String, Said)>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows in a second, where there is no time.
    pub rate_hz: Option<f64>,
    /// How files with different columns are joined.
    pub join: Option<Join>,
    /// Kind of joint, or a contact; else a joint as the units say.
    pub joint: Option<JointType>,
    /// The arm, where it is about a whole one.
    pub arm: Option<OfArm>,
    /// Whether the tip's coordinates say where on a contour a contact is.
    pub by_tip: bool,
    /// Corners of that contour \[m\].
    pub contour: Option<Vec<[f64; 2]>>,
    /// The experiment file; else beside the first recording.
    pub output: Option<PathBuf>,
    /// Whether a file that is there may be written over.
    pub force: bool,
}

impl Request {
    pub(super) fn said(&self, role: Role) -> Option<&Said> {
        let mut said = self.said.iter().rev();
        let found = said.find(|(own, _)| own.key() == role.key());
        found.map(|(_, said)| said)
    }

    /// Whether it is about a contact.
    pub(super) fn is_contact(&self) -> bool {
        self.joint.is_some_and(JointType::is_contact) && self.arm.is_none()
    }
}

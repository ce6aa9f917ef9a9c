//! What the twin of a joint says.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{ferntast_msgs::TwinParameters, std_msgs::Header},
};

use super::{
    JOINT_NAMES, checks,
    lists::{self, MOST_PARAMETERS, Numbers},
};

/// What the lab says of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct TwinVerdict(pub u8);

impl TwinVerdict {
    /// Too little came in yet.
    pub const PENDING: TwinVerdict = TwinVerdict(0);
    /// What is left is noise.
    pub const COMPLETE: TwinVerdict = TwinVerdict(1);
    /// An effect of the catalogue is missing.
    pub const MISSING: TwinVerdict = TwinVerdict(2);
    /// Something is missing that the catalogue does not have.
    pub const UNEXPLAINED: TwinVerdict = TwinVerdict(3);

    /// Every verdict.
    pub const ALL: [TwinVerdict; 4] = [
        TwinVerdict::PENDING,
        TwinVerdict::COMPLETE,
        TwinVerdict::MISSING,
        TwinVerdict::UNEXPLAINED,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "pending, complete, missing, unexplained";

    /// The name on the wire; `None` for a code that is no verdict.
    pub fn name(self) -> Option<&'static str> {
        match self {
            TwinVerdict::PENDING => Some("pending"),
            TwinVerdict::COMPLETE => Some("complete"),
            TwinVerdict::MISSING => Some("missing"),
            TwinVerdict::UNEXPLAINED => Some("unexplained"),
            _ => None,
        }
    }

    /// The verdict of that name.
    pub fn from_name(name: &str) -> Option<TwinVerdict> {
        TwinVerdict::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// The parameters of a joint's model as they are now, and whether the model
/// holds. `ferntast_msgs/msg/TwinParameters` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct TwinParametersSample {
    /// When the samples that it is about were measured.
    pub stamp: Time,
    /// Names of the parameters, as in the lab; those after `count` are empty.
    pub names: [Text<24>; MOST_PARAMETERS],
    /// Values now.
    pub values: Numbers,
    /// Values as identified from the experiment's recordings.
    pub off_line: Numbers,
    /// Standard errors of the values now.
    pub std_errors: Numbers,
    /// 0 where the motion told nothing of a parameter, towards 1 where it told all \[1\].
    pub excitation: Numbers,
    /// Root mean square of the latest residuals \[Nm\].
    pub residual_rms: f64,
    /// Standard deviation of the residual off line \[Nm\].
    pub band: f64,
    /// The changed parameter's value before.
    pub change_before: f64,
    /// The changed parameter's value after.
    pub change_after: f64,
    /// When half of the way was done, after the twin's first sample \[s\].
    pub change_time: f64,
    /// When the verdict was given, after the twin's first sample \[s\].
    pub assessed_at: f64,
    /// Parameter that moved away from its value off line; empty where none did.
    pub changed: Text<24>,
    /// How it moved: step or drift; empty where none did.
    pub change_kind: Text<8>,
    /// The missing effect; empty without one.
    pub candidate: Text<32>,
    /// Signals that the residual depends on most; empty where it depends on none.
    pub goes_with: Text<64>,
    /// Parameters in the lists.
    pub count: u32,
    /// Which joint, from 0.
    pub joint: u8,
    /// 1 while the residual is out of its band.
    pub out_of_band: u8,
    /// What the lab says.
    pub verdict: TwinVerdict,
    /// Keeps the layout free of implicit padding.
    pub reserved: u8,
}

checks::no_padding!(
    TwinParametersSample: Time, [Text<24>; MOST_PARAMETERS], Numbers, Numbers, Numbers, Numbers,
    f64, f64, f64, f64, f64, f64, Text<24>, Text<8>, Text<32>, Text<64>, u32, u8, u8, TwinVerdict, u8
);

impl TwinParametersSample {
    /// A twin of joint `joint` (from 0) that knows nothing yet.
    pub const fn nothing(stamp: Time, joint: u8) -> TwinParametersSample {
        TwinParametersSample {
            stamp,
            names: [Text::EMPTY; MOST_PARAMETERS],
            values: [0.0; MOST_PARAMETERS],
            off_line: [0.0; MOST_PARAMETERS],
            std_errors: [0.0; MOST_PARAMETERS],
            excitation: [0.0; MOST_PARAMETERS],
            residual_rms: 0.0,
            band: 0.0,
            change_before: 0.0,
            change_after: 0.0,
            change_time: 0.0,
            assessed_at: 0.0,
            changed: Text::EMPTY,
            change_kind: Text::EMPTY,
            candidate: Text::EMPTY,
            goes_with: Text::EMPTY,
            count: 0,
            joint,
            out_of_band: 0,
            verdict: TwinVerdict::PENDING,
            reserved: 0,
        }
    }

    /// Parameters in the lists, never more than there is room for.
    pub fn len(&self) -> usize {
        (self.count as usize).min(MOST_PARAMETERS)
    }

    /// Whether the lists are empty.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Name of the joint.
    fn joint_name(&self) -> Option<&'static str> {
        JOINT_NAMES.get(usize::from(self.joint)).copied()
    }

    /// The four lists of numbers by name.
    fn lists(&self) -> [(&'static str, &Numbers); 4] {
        [
            ("values", &self.values),
            ("off_line", &self.off_line),
            ("std_errors", &self.std_errors),
            ("excitation", &self.excitation),
        ]
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for TwinParametersSample {
    type Ros = TwinParameters;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> TwinParameters {
        let length = self.len();
        let list = |numbers: &Numbers| numbers.iter().take(length).copied().collect();
        let names = self.names.iter().take(length);
        TwinParameters {
            header: Header::new(self.stamp, ""),
            joint: checks::wire_name(self.joint_name(), self.joint),
            names: names.map(|name| name.as_str().to_owned()).collect(),
            values: list(&self.values),
            off_line: list(&self.off_line),
            std_errors: list(&self.std_errors),
            excitation: list(&self.excitation),
            residual_rms: self.residual_rms,
            band: self.band,
            out_of_band: self.out_of_band != 0,
            changed: self.changed.as_str().to_owned(),
            change_kind: self.change_kind.as_str().to_owned(),
            change_before: self.change_before,
            change_after: self.change_after,
            change_time: self.change_time,
            verdict: checks::wire_name(self.verdict.name(), self.verdict.0),
            assessed_at: self.assessed_at,
            candidate: self.candidate.as_str().to_owned(),
            goes_with: self.goes_with.as_str().to_owned(),
        }
    }

    fn from_ros(ros: &TwinParameters) -> Result<TwinParametersSample, InvalidMessage> {
        let joint = checks::joint(&ros.joint)?;
        let verdict = TwinVerdict::from_name(&ros.verdict)
            .ok_or_else(|| checks::unknown("verdict", &ros.verdict, TwinVerdict::KNOWN))?;
        let count = ros.names.len();
        lists::count(count)?;
        let mut names = [Text::EMPTY; MOST_PARAMETERS];
        for (place, name) in names.iter_mut().zip(&ros.names) {
            *place = Text::new(name);
        }
        let sample = TwinParametersSample {
            stamp: ros.header.time(),
            names,
            values: lists::numbers("values", &ros.values, count)?,
            off_line: lists::numbers("off_line", &ros.off_line, count)?,
            std_errors: lists::numbers("std_errors", &ros.std_errors, count)?,
            excitation: lists::numbers("excitation", &ros.excitation, count)?,
            residual_rms: ros.residual_rms,
            band: ros.band,
            change_before: ros.change_before,
            change_after: ros.change_after,
            change_time: ros.change_time,
            assessed_at: ros.assessed_at,
            changed: Text::new(&ros.changed),
            change_kind: Text::new(&ros.change_kind),
            candidate: Text::new(&ros.candidate),
            goes_with: Text::new(&ros.goes_with),
            count: count as u32,
            joint,
            out_of_band: ros.out_of_band.into(),
            verdict,
            reserved: 0,
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        let count = self.count as usize;
        lists::count(count)?;
        for (field, numbers) in self.lists() {
            checks::finite(field, &numbers[..count])?;
        }
        for (field, value) in [
            ("residual_rms", self.residual_rms),
            ("band", self.band),
            ("change_before", self.change_before),
            ("change_after", self.change_after),
            ("change_time", self.change_time),
            ("assessed_at", self.assessed_at),
        ] {
            checks::finite(field, &[value])?;
        }
        checks::flag("out_of_band", self.out_of_band)?;
        checks::code("joint", self.joint_name(), self.joint, checks::KNOWN_JOINTS)?;
        checks::code(
            "verdict",
            self.verdict.name(),
            self.verdict.0,
            TwinVerdict::KNOWN,
        )
    }
}

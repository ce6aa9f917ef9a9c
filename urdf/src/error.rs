//! What can be wrong with a file, or with what is asked of it.

use ferntast_model::{MAX_JOINTS, rigid_body::ChainError};

/// Why a file is no robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// Its bytes are no text.
    #[error(
        "line {line} is not UTF-8 text; give a URDF file (XML), not a compressed or binary one"
    )]
    NotText {
        /// Number from 1.
        line: usize,
    },
    /// Its text is no XML.
    #[error("not readable as XML: {what}; mend the file there")]
    Xml {
        /// With line and column.
        what: String,
    },
    /// Another kind of XML.
    #[error(
        "line {line}: the file begins with <{found}> where a URDF begins with <robot>; give a URDF file"
    )]
    NoRobot {
        /// Number from 1.
        line: usize,
        /// The outermost element.
        found: String,
    },
    /// A macro that is still to be expanded.
    #[error(
        "line {line}: <{element}> is a macro of xacro; expand the file first: xacro FILE > arm.urdf"
    )]
    Xacro {
        /// Number from 1.
        line: usize,
        /// Its name.
        element: String,
    },
    /// An attribute or element that has to be there is not.
    #[error("line {line}: <{element}> has no {missing}; add it")]
    Missing {
        /// Number from 1.
        line: usize,
        /// Where it should be.
        element: String,
        /// What is missing.
        missing: &'static str,
    },
    /// Numbers that cannot be read, or too few or many of them, or infinite.
    #[error(
        "line {line}: {attribute}=\"{value}\" of <{element}> is not {wanted}; give {wanted}, separated by spaces"
    )]
    Numbers {
        /// Number from 1.
        line: usize,
        /// Where they are.
        element: String,
        /// Under which name.
        attribute: &'static str,
        /// What stands there.
        value: String,
        /// "3 finite numbers".
        wanted: String,
    },
    /// An orientation in a form that is not read.
    #[error("line {line}: quat_xyzw is not read; give the orientation as rpy=\"roll pitch yaw\"")]
    Quaternion {
        /// Number from 1.
        line: usize,
    },
    /// A mass below zero.
    #[error("line {line}: link \"{link}\" has a mass of {mass} kg; it cannot be negative")]
    NegativeMass {
        /// Number from 1.
        line: usize,
        /// The link.
        link: String,
        /// \[kg\].
        mass: f64,
    },
    /// A type that URDF does not have.
    #[error(
        "line {line}: joint \"{joint}\" is of type \"{found}\"; URDF has revolute, continuous, prismatic, fixed, floating and planar"
    )]
    JointType {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
        /// What stands there.
        found: String,
    },
    /// Two of one name.
    #[error("line {line}: there is another {what} \"{name}\"; give each a name of its own")]
    Twice {
        /// Number from 1.
        line: usize,
        /// "link" or "joint".
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A joint names a link that is not there.
    #[error(
        "line {line}: joint \"{joint}\" names the link \"{link}\", which is not in the file{nearest}"
    )]
    NoSuchLink {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
        /// The link.
        link: String,
        /// Ready for a message, or empty.
        nearest: String,
    },
    /// Two joints carry one link.
    #[error(
        "link \"{link}\" is the child of \"{first}\" and, in line {line}, of \"{second}\": a loop; URDF is a tree, take one of the joints out"
    )]
    Loop {
        /// Number from 1.
        line: usize,
        /// The link.
        link: String,
        /// One joint.
        first: String,
        /// The other one.
        second: String,
    },
    /// Joints that lead back to where they begin.
    #[error(
        "line {line}: joint \"{joint}\" is part of a loop: its child leads back to its parent; URDF is a tree, take one of the joints out"
    )]
    Circle {
        /// Number from 1.
        line: usize,
        /// A joint of it.
        joint: String,
    },
}

/// Why a part of a robot is no arm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// No link of that name.
    #[error("there is no link \"{link}\"{nearest}")]
    NoSuchLink {
        /// The name.
        link: String,
        /// Ready for a message, or empty.
        nearest: String,
    },
    /// No joint of that name.
    #[error("there is no joint \"{joint}\"{nearest}")]
    NoSuchJoint {
        /// The name.
        joint: String,
        /// Ready for a message, or empty.
        nearest: String,
    },
    /// No way down from the base to the tip.
    #[error("link \"{tip}\" is not below link \"{base}\"{hint}")]
    NotBelow {
        /// The base.
        base: String,
        /// The tip.
        tip: String,
        /// What to do.
        hint: &'static str,
    },
    /// A list of joints whose order is not that from the base to the tip.
    #[error(
        "joint \"{joint}\" is not below joint \"{before}\"; list the joints of one arm in order from its base to its tip"
    )]
    Order {
        /// The joint.
        joint: String,
        /// The one before it in the list.
        before: String,
    },
    /// A joint between those of the list that moves too.
    #[error(
        "joint \"{joint}\" (line {line}) moves too, between \"{before}\" and \"{after}\"; add it to the list, or make it fixed"
    )]
    LeftOut {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
        /// The joint before it in the list.
        before: String,
        /// The joint after it in the list.
        after: String,
    },
    /// A joint of the list that does not move.
    #[error("joint \"{joint}\" (line {line}) is fixed; leave it out of the list")]
    Fixed {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
    },
    /// A list of no joints.
    #[error("the list of joints is empty; name the arm's joints in order from its base to its tip")]
    EmptyList,
    /// Several arms, and nobody said which.
    #[error(
        "link \"{link}\" carries {} joints that move ({}); say which arm is meant, by a base and a tip",
        joints.len(), joints.join(", ")
    )]
    Ambiguous {
        /// The link.
        link: String,
        /// The joints.
        joints: Vec<String>,
    },
    /// Nothing moves.
    #[error(
        "between \"{base}\" and \"{tip}\" no joint moves; choose a base and a tip with the arm between them"
    )]
    NoJoints {
        /// The base.
        base: String,
        /// The tip.
        tip: String,
    },
    /// Nine or more.
    #[error(
        "{count} joints, from \"{first}\" to \"{last}\", where an arm has at most {MAX_JOINTS}; choose a base further out or a tip further in"
    )]
    TooManyJoints {
        /// How many.
        count: usize,
        /// The first.
        first: String,
        /// The last.
        last: String,
    },
    /// A body that floats freely.
    #[error(
        "joint \"{joint}\" (line {line}) is floating, and an arm stands on a fixed base; choose a link below it as the base"
    )]
    Floating {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
    },
    /// A joint of three degrees of freedom.
    #[error(
        "joint \"{joint}\" (line {line}) is planar, which is not supported; write it as two prismatic joints and a revolute one"
    )]
    Planar {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
    },
    /// A joint that follows another one.
    #[error(
        "joint \"{joint}\" (line {line}) mimics joint \"{of}\", which is not supported within an arm; end the arm before it, or take <mimic> out"
    )]
    Mimic {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
        /// The one that it follows.
        of: String,
    },
    /// Its axis has no direction.
    #[error(
        "the <axis> of joint \"{joint}\" (line {line}) has length 0; give a direction such as \"0 0 1\""
    )]
    NoAxis {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
    },
    /// No ends where URDF wants them.
    #[error(
        "joint \"{joint}\" (line {line}) has no <limit>; add lower and upper, or make it continuous"
    )]
    NoLimit {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
    },
    /// The lower end is above the upper one.
    #[error(
        "joint \"{joint}\" (line {line}) has the limits lower={lower} and upper={upper}, upside down; exchange them"
    )]
    Limits {
        /// Number from 1.
        line: usize,
        /// The joint.
        joint: String,
        /// \[rad\] or \[m\].
        lower: f64,
        /// \[rad\] or \[m\].
        upper: f64,
    },
    /// A moving link without mass.
    #[error(
        "link \"{link}\" (line {line}), which joint \"{joint}\" moves, has no mass, nor has what is fixed to it; add <inertial> with mass and inertia"
    )]
    NoInertia {
        /// Number from 1.
        line: usize,
        /// The link.
        link: String,
        /// The joint that moves it.
        joint: String,
    },
    /// Values that together make no chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

//! An arm in space and what its tip can touch, as pages draw it. Lengths \[m\], angles \[rad\].

use ferntast_model::shape::Shape;
use serde::{Deserialize, Serialize};

/// What is drawn of an arm. The page moves it by the joint positions of the snapshots.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SpatialView {
    /// The joints, from the base on.
    pub joints: Vec<JointView>,
    /// The tip, in the frame of the last joint's link.
    pub tip: FrameView,
    /// Where the arm likes to be.
    pub home: Vec<f64>,
    /// What its links look like, as far as the arm's file tells.
    pub shapes: Vec<LinkShape>,
    /// What the tip can touch.
    pub things: Vec<ThingView>,
}

/// A frame, seen from another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameView {
    /// Its origin.
    pub at: [f64; 3],
    /// Its orientation as unit quaternion x, y, z, w.
    pub turn: [f64; 4],
}

impl Default for FrameView {
    fn default() -> Self {
        FrameView {
            at: [0.0; 3],
            turn: [0.0, 0.0, 0.0, 1.0],
        }
    }
}

/// A joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct JointView {
    /// The frame of the link that it carries while it is at zero, in that of the one before.
    pub frame: FrameView,
    /// Unit vector along which it turns or slides, in the frame of its link.
    pub axis: [f64; 3],
    /// It slides.
    pub slides: bool,
}

/// A part of a link's looks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LinkShape {
    /// Of which link: 0 is the base, n what the n-th joint carries.
    pub link: usize,
    /// Its frame, in the link's.
    pub frame: FrameView,
    /// What is there.
    #[serde(flatten)]
    pub solid: SolidView,
}

/// A shape about the origin of its frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SolidView {
    /// A box.
    Box {
        /// Lengths of its edges.
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its length.
        length: f64,
    },
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
}

/// Something to touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThingView {
    /// What it is called.
    pub name: String,
    /// Its shape and place, base frame.
    pub shape: Shape,
}

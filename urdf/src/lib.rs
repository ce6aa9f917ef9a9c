//! Arms out of URDF files.
//!
//! [`Robot::read`] takes a file's bytes: links and joints, a tree. [`Robot::between`] and
//! [`Robot::of_joints`] make of a part of it the [`Chain`](ferntast_model::rigid_body::Chain)
//! that dynamics and kinematics work on. [`edit`] puts other friction and masses into a file.
//!
//! Of a URDF, `<link>` with `<inertial>` and `<joint>` count, and for pictures the boxes,
//! cylinders and balls of `<visual>` and `<collision>`; meshes, colours, transmissions and
//! plugins are not looked at. What hangs on a link of the chain moves
//! with it: what is fixed to it, and what another joint carries, as if that joint were held
//! at position zero (a gripper's fingers).
//!
//! The crate `roxmltree` reads the XML, since it knows the line of each element, which the
//! crate `urdf-rs` does not tell, and brings one dependency (`memchr`) instead of three XML
//! readers and `regex`.

mod arm;
mod document;
pub mod edit;
mod error;
mod looks;
mod robot;
mod solid;

pub use arm::Arm;
pub use error::{ArmError, ReadError};
pub use robot::{Joint, JointType, Limit, Link, Robot};
pub use solid::{Placed, Solid};

/// Of `names` the one most like `wanted`, for a message: `; did you mean "…"?`.
fn did_you_mean<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> String {
    // Comparing takes the product of the lengths.
    const LONGEST: usize = 200;
    let nearest = names
        .filter(|name| name.len() <= LONGEST && wanted.len() <= LONGEST)
        .min_by_key(|name| strsim::damerau_levenshtein(wanted, name));
    match nearest {
        Some(name) => format!("; did you mean \"{name}\"?"),
        None => String::new(),
    }
}

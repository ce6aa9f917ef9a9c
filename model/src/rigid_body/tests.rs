//! The chain against ROKVISS's closed form, and against what has to hold of any arm.

mod arms;
mod inverse_kinematics;
mod laws;
mod rokviss;

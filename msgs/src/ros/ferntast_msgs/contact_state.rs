//! `ferntast_msgs/msg/ContactState`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// The contact as estimated from joint torques.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// When it was measured; no frame.
    pub header: Header,
    /// In contact.
    pub in_contact: bool,
    /// The forces can be used.
    pub valid: bool,
    /// The tangential force is undefined: the motor turns, the tip still rests.
    pub near_rest: bool,
    /// Which edge: none, lubricated, unlubricated or spring.
    pub edge: String,
    /// Normal force \[N\], ≥ 0 pushes the tip out of the surface.
    pub normal_force: f64,
    /// Tangential force \[N\], positive when it opposes the tip's motion.
    pub tangential_force: f64,
    /// Friction coefficient \[-\]; NaN before it is identified.
    pub friction_coefficient: f64,
    /// Standard error of the coefficient \[-\]; infinite before it is identified.
    pub friction_coefficient_error: f64,
}

impl RosMessage for ContactState {
    const INTERFACE: &'static str = "ferntast_msgs/msg/ContactState";
}

//! Physics of the arm, its joints and its contact: pure functions of state and parameters.
//!
//! This is what servo, estimator and identification *believe*. The simulated
//! arm has a truth of its own.
//!
//! Joint quantities are on the joint side of the gear; base frame, joint
//! angles and signs are those of `ARCHITECTURE.md`. [`ArmModel`] gathers the
//! parameters of a whole arm.

pub mod arm;
pub mod contact;
pub mod contour;
pub mod friction;
pub mod joint;
pub mod joints;
pub mod kinematics;
mod parameter;
pub mod recursive_least_squares;
pub mod rigid_body;
pub mod section;
pub mod serial_arm;
pub mod shape;

pub use joints::{JointCount, Joints, MAX_JOINTS};
pub use nalgebra::{Matrix2, Vector2};
pub use parameter::{ParameterError, check};
pub use section::{Bounded, Section};

parameters! {
    /// Everything that is believed of one arm and the contour it works on:
    /// the sections `[arm]`, `[[joint]]` (one a link) and `[contour]` of a file in
    /// `config/arms/`.
    pub struct ArmModel {
        /// Links and gravity.
        pub arm: arm::ArmParameters [section],
        /// The joints, from the base on: one for each link.
        pub joint: Vec<joint::JointParameters> [section],
        /// Edges and springs, and the nominal tip point between them.
        pub contour: contour::Contour [section],
    }
    check ArmModel::joints_are_those_of_the_links;
}

impl ArmModel {
    fn joints_are_those_of_the_links(&self) -> Result<(), ParameterError> {
        self.arm.joints_of_links(&self.joint).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = include_str!("../../config/arms/rokviss.toml");

    /// The sections of an arm's file that this crate knows.
    fn parse(text: &str) -> Result<ArmModel, toml::de::Error> {
        let mut file: toml::Table = toml::from_str(text)?;
        file.retain(|section, _| ["arm", "joint", "contour"].contains(&section));
        file.try_into()
    }

    #[test]
    fn the_shipped_arm_is_valid() {
        parse(SHIPPED).unwrap().validate().unwrap();
    }

    #[test]
    fn unknown_keys_and_wrong_counts_are_refused() {
        let misspelt = parse(&SHIPPED.replace("center_of_mass", "centre_of_mass"));
        assert!(misspelt.unwrap_err().to_string().contains("centre_of_mass"));
        let mut model = parse(SHIPPED).unwrap();
        model.joint.push(model.joint[0].clone());
        for (joints, found) in [(&model.joint[..], 3), (&model.joint[..1], 1), (&[], 0)] {
            let model = ArmModel {
                joint: joints.to_vec(),
                ..model.clone()
            };
            let error = model.validate().unwrap_err();
            assert_eq!(
                error.to_string(),
                format!(
                    "joint has {found} entries where 2 are needed: one for each link in the \
                     section [arm]"
                )
            );
        }
    }

    #[test]
    fn a_value_out_of_bounds_is_named_with_its_place() {
        let mut model = parse(SHIPPED).unwrap();
        model.joint[1].stiffness = 0.0;
        let error = model.validate().unwrap_err();
        assert_eq!(
            error.to_string(),
            "joint[1].stiffness = 0 Nm/rad is outside 10 … 1000000 Nm/rad; set it within these bounds"
        );
    }
}

//! How far the tip gives way to a force while the servo holds it.

use super::ServoConfig;
use ferntast_model::serial_arm::SerialArm;
use ferntast_model::{ArmModel, JointCount, Matrix2, ParameterError, Vector2};
use nalgebra::Matrix3;

/// Compliance of the tip at the joint positions `q` \[rad\], base frame
/// \[m/N\]: J K⁻¹ Jᵀ with servo and gear of each joint one behind the other,
/// 1/K = 1/k_P + 1/k (Salisbury 1980, "Active stiffness control of a
/// manipulator in Cartesian coordinates", IEEE CDC).
///
/// # Errors
///
/// [`ParameterError::WrongCount`]: model or tuning are not of one joint a link.
pub fn tip_compliance(
    model: &ArmModel,
    servo: &ServoConfig,
    q: &Vector2<f64>,
) -> Result<Matrix2<f64>, ParameterError> {
    let joints = model.arm.joints_of_links(&model.joint)?;
    let tuning = servo.joints(JointCount::new(joints.len())?)?;
    let jacobian = model.arm.kinematics().jacobian(q);
    let each =
        Vector2::from_fn(|joint, _| 1.0 / tuning[joint].stiffness + 1.0 / joints[joint].stiffness);
    Ok(jacobian * Matrix2::from_diagonal(&each) * jacobian.transpose())
}

/// Stiffness of the tip in its stiffest direction at the contour's nominal
/// point \[N/m\]; `None` where the arm does not reach that, or the tuning is of
/// another number of joints.
pub fn stiffest(model: &ArmModel, servo: &ServoConfig) -> Option<f64> {
    let contour = &model.contour;
    let tip = Vector2::from(contour.nominal_tip);
    let kinematics = model.arm.kinematics();
    let q = kinematics.inverse(&tip, contour.nominal_elbow).ok()?;
    let compliance = tip_compliance(model, servo, &q).ok()?;
    let least = compliance.symmetric_eigenvalues().min();
    (least > 0.0).then(|| 1.0 / least)
}

/// The same of a serial arm, at home.
pub fn stiffest_serial(arm: &SerialArm, servo: &ServoConfig) -> Option<f64> {
    let tuning = servo.joints(arm.count()).ok()?;
    let jacobian = arm.chain().jacobian(arm.home());
    let mut compliance = Matrix3::zeros();
    for (joint, own) in arm.joints().iter().enumerate() {
        let lever = jacobian.fixed_view::<3, 1>(0, joint);
        let gives = 1.0 / tuning[joint].stiffness + 1.0 / own.stiffness;
        compliance += lever * lever.transpose() * gives;
    }
    let least = compliance.symmetric_eigenvalues().min();
    (least > 0.0).then(|| 1.0 / least)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{arm, joint};
    use super::*;
    use ferntast_model::contour::Contour;
    use ferntast_model::kinematics::Elbow;

    fn model() -> ArmModel {
        ArmModel {
            arm: arm(),
            joint: vec![joint(), joint()],
            contour: Contour {
                nominal_tip: [0.35, 0.02],
                nominal_elbow: Elbow::Positive,
                edge: Vec::new(),
                spring: Vec::new(),
            },
        }
    }

    #[test]
    fn a_bent_elbow_gives_way_by_each_joint_and_its_lever() {
        let (model, servo) = (model(), ServoConfig::default());
        let q = Vector2::new(0.3, 1.1);
        let compliance = tip_compliance(&model, &servo, &q).unwrap();
        // By hand: a force F on the tip turns joint i by τᵢ/Kᵢ, τ = Jᵀ F.
        let force = Vector2::new(3.0, -2.0);
        let jacobian = model.arm.kinematics().jacobian(&q);
        let torque = jacobian.tr_mul(&force);
        let mut turned = Vector2::zeros();
        for joint in 0..2 {
            turned[joint] = torque[joint] / servo.stiffness[joint]
                + torque[joint] / model.joint[joint].stiffness;
        }
        assert!((compliance * force - jacobian * turned).norm() < 1e-15);
    }

    #[test]
    fn no_direction_is_stiffer_than_the_stiffest() {
        let (model, servo) = (model(), ServoConfig::default());
        let most = stiffest(&model, &servo).unwrap();
        let contour = &model.contour;
        let tip = Vector2::from(contour.nominal_tip);
        let kinematics = model.arm.kinematics();
        let q = kinematics.inverse(&tip, contour.nominal_elbow).unwrap();
        let compliance = tip_compliance(&model, &servo, &q).unwrap();
        let along = |angle: f64| {
            let direction = Vector2::new(angle.cos(), angle.sin());
            1.0 / direction.dot(&(compliance * direction))
        };
        let found = (0..3600).map(|step| along(f64::from(step) * 1e-3));
        let found = found.fold(0.0, f64::max);
        assert!(
            found <= most * (1.0 + 1e-12) && found > 0.999 * most,
            "{found} {most}"
        );
    }
}

//! What has to hold of any chain, in any state.

use nalgebra::{SVector, Vector3};
use proptest::prelude::*;

use super::arms::{any_chain_and_state, joint, seven_joints};
use crate::rigid_body::{Chain, JointKind, MassMatrix, Placement, PositionLimits};
use crate::{Joints, MAX_JOINTS};

fn column(joints: &Joints<f64>) -> SVector<f64, MAX_JOINTS> {
    joints.into_places(0.0).into()
}

/// Moved along a velocity for a time.
fn after(q: &Joints<f64>, qd: &Joints<f64>, time: f64) -> Joints<f64> {
    Joints::from_fn(q.count(), |joint| q[joint] + time * qd[joint])
}

proptest! {
    #[test]
    fn torques_are_linear_in_the_inertial_parameters((chain, (q, qd, qdd, gravity)) in any_chain_and_state()) {
        let torques = chain.inverse_dynamics(&q, &qd, &qdd, &gravity);
        let regressor = chain.torque_regressor(&q, &qd, &qdd, &gravity);
        let linear = regressor * chain.inertial_parameters()
            + column(chain.armature()).component_mul(&column(&qdd));
        let scale = 1.0 + column(&torques).norm();
        prop_assert!((column(&torques) - linear).norm() < 1e-12 * scale);
    }

    #[test]
    fn an_acceleration_takes_the_mass_matrix_times_it((chain, (q, qd, qdd, gravity)) in any_chain_and_state()) {
        let none = Joints::filled(q.count(), 0.0);
        let with = column(&chain.inverse_dynamics(&q, &qd, &qdd, &gravity));
        let without = column(&chain.inverse_dynamics(&q, &qd, &none, &gravity));
        let mass = chain.mass_matrix(&q);
        let scale = 1.0 + with.norm() + without.norm();
        prop_assert!((with - without - mass * column(&qdd)).norm() < 1e-12 * scale);
        prop_assert!((mass - mass.transpose()).norm() == 0.0);
    }

    #[test]
    fn an_arm_at_rest_carries_its_weight((chain, (q, _, _, gravity)) in any_chain_and_state()) {
        let none = Joints::filled(q.count(), 0.0);
        let held = column(&chain.inverse_dynamics(&q, &none, &none, &gravity));
        let weight = column(&chain.weight_in(&chain.posture(&q), &gravity));
        prop_assert!((held - weight).norm() <= 1e-12 * (1.0 + held.norm()));
    }

    #[test]
    fn kinetic_energy_is_half_the_mass_matrix_between_velocities((chain, (q, qd, _, _)) in any_chain_and_state()) {
        let direct = chain.kinetic_energy(&q, &qd);
        let rate = column(&qd);
        let quadratic = 0.5 * rate.dot(&(chain.mass_matrix(&q) * rate));
        prop_assert!(direct >= 0.0 && (direct - quadratic).abs() < 1e-12 * (1.0 + direct));
    }

    /// What the torques do is what the arm gains: Ṁ − 2C is skew symmetric.
    #[test]
    fn without_gravity_the_work_of_the_torques_is_the_gain_in_energy((chain, (q, qd, qdd, _)) in any_chain_and_state()) {
        let torques = chain.inverse_dynamics(&q, &qd, &qdd, &Vector3::zeros());
        let power = column(&torques).dot(&column(&qd));
        let step = 1e-6;
        let energy = |time: f64| {
            let moved = Joints::from_fn(q.count(), |joint| {
                q[joint] + time * qd[joint] + 0.5 * time * time * qdd[joint]
            });
            chain.kinetic_energy(&moved, &after(&qd, &qdd, time))
        };
        let gain = (energy(step) - energy(-step)) / (2.0 * step);
        prop_assert!((power - gain).abs() < 1e-6 * (1.0 + power.abs() + energy(0.0) * 10.0));
    }

    #[test]
    fn the_jacobian_is_the_tips_motion((chain, (q, qd, _, _)) in any_chain_and_state()) {
        let step = 1e-6;
        let (tip, jacobian) = chain.forward_and_jacobian(&q);
        let (before, behind) = (chain.forward(&after(&q, &qd, -step)), chain.forward(&after(&q, &qd, step)));
        let velocity = (behind.translation - before.translation) / (2.0 * step);
        let spin = (behind.rotation - before.rotation) / (2.0 * step) * tip.rotation.transpose();
        let motion = jacobian * column(&qd);
        prop_assert!((motion.fixed_rows::<3>(0) - velocity).norm() < 1e-7 * (1.0 + velocity.norm()));
        let turning = Vector3::new(spin.m32, spin.m13, spin.m21);
        prop_assert!((motion.fixed_rows::<3>(3) - turning).norm() < 1e-7 * (1.0 + turning.norm()));
    }

    /// Gravity in the base frame is a base that is accelerated upwards.
    #[test]
    fn holding_still_takes_the_slope_of_potential_energy((chain, (q, qd, _, gravity)) in any_chain_and_state()) {
        let none = Joints::filled(q.count(), 0.0);
        let height = |q: &Joints<f64>| {
            let placed = chain.link_placements(q);
            let mut energy = 0.0;
            for (placement, inertia) in placed.iter().zip(chain.inertias().iter()) {
                let moment = placement.rotation * inertia.first_moment + placement.translation * inertia.mass;
                energy -= gravity.dot(&moment);
            }
            energy
        };
        let step = 1e-6;
        let slope = (height(&after(&q, &qd, step)) - height(&after(&q, &qd, -step))) / (2.0 * step);
        let held = column(&chain.inverse_dynamics(&q, &none, &none, &gravity)).dot(&column(&qd));
        prop_assert!((held - slope).abs() < 1e-6 * (1.0 + held.abs() + gravity.norm()));
    }

    /// Links of half the inertia take half the torques.
    #[test]
    fn torques_are_those_of_the_links_given((chain, (q, qd, qdd, gravity)) in any_chain_and_state()) {
        let bare = chain.clone().with_armature(&Joints::filled(chain.count(), 0.0)).unwrap();
        let half = bare.inertias().map(|whole| {
            crate::rigid_body::LinkInertia::from_parameters(&whole.parameters().map(|value| 0.5 * value))
        });
        let light = bare.clone().with_inertias(&half).unwrap();
        let each = |chain: &Chain| chain.inverse_dynamics(&q, &qd, &qdd, &gravity);
        for (whole, half) in each(&bare).iter().zip(each(&light).iter()) {
            prop_assert!((0.5 * whole - half).abs() < 1e-12 * (1.0 + whole.abs()));
        }
    }

    /// A link that is cut in two, with its halves fixed to each other, is the same link.
    #[test]
    fn what_is_fixed_together_moves_as_one((chain, (q, qd, qdd, gravity)) in any_chain_and_state()) {
        let inertias = chain.inertias();
        let place = Placement::from_roll_pitch_yaw(Vector3::new(0.3, 0.2, 0.1), [0.3, 0.2, 0.1]);
        let cut = inertias.map(|whole| {
            let half = crate::rigid_body::LinkInertia::from_parameters(&whole.parameters().map(|value| 0.5 * value));
            half + half.placed(&place).placed(&place.inverse())
        });
        for (whole, cut) in inertias.iter().zip(cut.iter()) {
            prop_assert!((whole.rotational - cut.rotational).norm() < 1e-12);
            prop_assert!((whole.first_moment - cut.first_moment).norm() < 1e-13);
        }
        let torques = chain.inverse_dynamics(&q, &qd, &qdd, &gravity);
        prop_assert!(torques.iter().all(|torque| torque.is_finite()));
    }
}

#[test]
fn a_lift_carries_its_weight_and_nothing_turns() {
    let lift = joint(
        JointKind::Prismatic,
        Placement::identity(),
        Vector3::new(0.0, 0.0, 2.0),
    );
    let chain = Chain::new(&[lift], Placement::identity()).unwrap();
    let (q, qd, qdd) = (
        Joints::from([0.7]),
        Joints::from([1.0]),
        Joints::from([2.0]),
    );
    let force = chain.inverse_dynamics(&q, &qd, &qdd, &Vector3::new(0.0, 0.0, -10.0));
    // 1.5 kg against gravity and for the acceleration; 0.1 kg of armature without weight.
    assert!((force[0] - (1.5 * 12.0 + 0.1 * 2.0)).abs() < 1e-12);
    let tip = chain.forward(&q);
    assert_eq!(tip.translation, Vector3::new(0.0, 0.0, 0.7));
    let mut wanted = MassMatrix::zeros();
    wanted[(0, 0)] = 1.6;
    assert!((chain.mass_matrix(&q) - wanted).norm() < 1e-15);
}

#[test]
fn joints_that_cannot_be_are_refused_in_words() {
    let good = joint(JointKind::Revolute, Placement::identity(), Vector3::z());
    let told = |joints: &[_]| {
        Chain::new(joints, Placement::identity())
            .unwrap_err()
            .to_string()
    };
    assert!(told(&[]).starts_with("0 joints where 1 to 8 are needed"));
    assert!(told(&[good; 9]).starts_with("9 joints"));
    let mut bad = good;
    bad.axis = Vector3::zeros();
    assert!(told(&[good, bad]).contains("axis of joint 2"));
    bad = good;
    bad.link.mass = -1.0;
    assert!(told(&[bad]).contains("the link's mass of joint 1 (from 1) is -1"));
    bad = good;
    bad.limits = PositionLimits {
        lower: 1.0,
        upper: -1.0,
    };
    assert!(told(&[bad]).contains("exchange the limits"));
    bad = good;
    bad.placement.rotation *= 1.1;
    assert!(told(&[bad]).contains("no rotation"));
    bad = good;
    bad.link.first_moment.x = f64::NAN;
    assert!(told(&[bad]).contains("not finite"));
    let armature = Joints::from([0.1; 7]);
    assert!(seven_joints().with_armature(&armature).is_ok());
    assert!(
        seven_joints()
            .with_armature(&Joints::from([0.1; 6]))
            .is_err()
    );
    let negative = Joints::from([-0.1; 7]);
    assert!(seven_joints().with_armature(&negative).is_err());
}

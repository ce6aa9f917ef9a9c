//! A second arm as the master: where its tip is, and what its joints give.
//!
//! The tip is held by the hand. What the joints give is
//!
//! τ = g(q) + s Jᵀ(q) F
//!
//! with the weight g of the arm's links, the force F on the hand and the Jacobian J of the tip: by
//! virtual work the tip pushes the hand with F where the arm is at rest, and the power of the
//! second term is F·v at every speed (B. Siciliano, L. Sciavicco, L. Villani, G. Oriolo, Robotics:
//! Modelling, Planning and Control, Springer 2009, section 3.8; from memory, the equation's number
//! not checked). What the arm's own inertia and friction take is not made up for: the hand
//! feels it.
//!
//! Weight comes first: what a motor has left of its torque is for the force, which is made weaker
//! by the share 0 ≤ s ≤ 1 as a whole where one motor has not enough, so that it keeps its
//! direction. It fades in whenever it begins, and ends at once. An arm that runs faster than its
//! joints may was let go of by its hand: the force ends.

use ferntast_model::Joints;
use ferntast_model::rigid_body::Vector3;
use ferntast_model::serial_arm::SerialArm;

/// In this time the force fades in [s].
const FORCE_RAMP: f64 = 0.5;
/// Share of their limits of speed below which joints count as held again [-].
const HELD_AGAIN: f64 = 0.5;
/// No hand is meant to feel more along an axis [N].
const LARGEST: f64 = 1e6;

/// Where the hand is, base frame of the leader arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeaderHand {
    /// The tip less where it is at home \[m\].
    pub position: [f64; 3],
    /// How the tip is turned: quaternion x, y, z, w.
    pub orientation: [f64; 4],
}

/// What the joints are to give.
#[derive(Clone, Copy, Debug)]
pub struct LeaderTorques {
    /// What the motors are to give, joint side \[Nm\] or \[N\]; each within its limit.
    pub torque: Joints<f64>,
    /// The force that the tip pushes the hand with by that, at rest, base frame \[N\].
    pub force: [f64; 3],
    /// A motor's limit makes the force weaker, or lets the arm sink.
    pub limited: bool,
    /// The arm ran away: nobody holds it, and there is no force.
    pub let_go: bool,
}

/// An arm that is the master.
#[derive(Clone, Debug)]
pub struct LeaderArm {
    arm: SerialArm,
    /// The tip at home \[m\].
    middle: Vector3<f64>,
    /// How far the force has faded in, 0 … 1.
    share: f64,
    let_go: bool,
}

impl LeaderArm {
    /// The arm, held by nobody.
    pub fn new(arm: SerialArm) -> LeaderArm {
        LeaderArm {
            middle: arm.home_tip().translation,
            arm,
            share: 0.0,
            let_go: false,
        }
    }

    /// The hand where its joints are at `q` \[rad\] or \[m\].
    ///
    /// # Panics
    ///
    /// `q` has not one value for each joint.
    pub fn hand(&self, q: &Joints<f64>) -> LeaderHand {
        let tip = self.arm.chain().forward(q);
        LeaderHand {
            position: (tip.translation - self.middle).into(),
            orientation: tip.quaternion(),
        }
    }

    /// Its joints are not heard: the force fades in anew once they are.
    pub fn release(&mut self) {
        self.share = 0.0;
    }

    /// What the joints are to give `dt` \[s\] after the step before, at `q` \[rad\] or \[m\] and as fast as
    /// `qd` \[rad/s\] or \[m/s\]. `force` is what the hand is to feel, base frame \[N\]; `None` where
    /// it holds nothing: then there is the weight alone. One that is not finite, or beyond all hands, counts as none.
    ///
    /// # Panics
    ///
    /// `q` or `qd` has not one value for each joint.
    pub fn torques(
        &mut self,
        dt: f64,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        force: Option<[f64; 3]>,
    ) -> LeaderTorques {
        let count = self.arm.count();
        let posture = self.arm.chain().posture(q);
        let (_, jacobian) = self.arm.chain().forward_and_jacobian_in(&posture);
        let linear = jacobian.fixed_rows::<3>(0);
        let wanted = self.fade(dt, qd, force);
        let weight = self.arm.weight_in(&posture);
        let pull = Joints::from_fn(count, |joint| linear.column(joint).dot(&wanted));
        let limits = self.arm.joints();
        let (mut share, mut limited) = (1.0_f64, false);
        let carried = Joints::from_fn(count, |joint| {
            let limit = limits[joint].motor_torque_limit;
            let own = weight[joint].clamp(-limit, limit);
            let room = limit - own * pull[joint].signum();
            if pull[joint].abs() > room {
                share = share.min(room / pull[joint].abs());
            }
            limited |= own != weight[joint];
            own
        });
        limited |= share < 1.0;
        let torque = Joints::from_fn(count, |joint| {
            let limit = limits[joint].motor_torque_limit;
            (carried[joint] + share * pull[joint]).clamp(-limit, limit)
        });
        LeaderTorques {
            torque,
            force: (wanted * share).into(),
            limited,
            let_go: self.let_go,
        }
    }

    /// The force as far as it has faded in.
    fn fade(&mut self, dt: f64, qd: &Joints<f64>, force: Option<[f64; 3]>) -> Vector3<f64> {
        let mut speeds = self.arm.joints().iter().zip(qd.iter());
        let fastest = match self.let_go {
            true => HELD_AGAIN,
            false => 1.0,
        };
        // Not what is no number, either.
        self.let_go = !speeds.all(|(joint, speed)| speed.abs() <= fastest * joint.velocity_limit);
        let force =
            force.filter(|own| own.iter().all(|value| value.abs() <= LARGEST) && !self.let_go);
        let Some(force) = force else {
            self.share = 0.0;
            return Vector3::zeros();
        };
        self.share = (self.share + dt / FORCE_RAMP).min(1.0);
        Vector3::from(force) * self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::friction::FrictionParameters;
    use ferntast_model::joint::JointParameters;
    use ferntast_model::rigid_body::{
        Chain, ChainJoint, JointKind, LinkInertia, Matrix3, Placement, PositionLimits,
    };
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    const TICK: f64 = 1e-3;
    /// Ticks in which a force has faded in.
    const FADED: u32 = 501;
    const LIMIT: f64 = 6.0;
    const FASTEST: f64 = 3.0;

    /// Three joints that turn and one that shifts, on links of 0.2 m and 0.3 kg.
    fn arm(limit: f64) -> SerialArm {
        let joint = |kind, axis, height: f64| ChainJoint {
            kind,
            placement: Placement::from_roll_pitch_yaw(
                Vector3::new(0.2, 0.0, height),
                [0.3, 0.1, 0.0],
            ),
            axis,
            armature: 0.0,
            limits: PositionLimits::NONE,
            link: LinkInertia {
                mass: 0.3,
                first_moment: Vector3::new(0.03, 0.003, 0.0),
                rotational: Matrix3::from_diagonal(&Vector3::new(0.002, 0.005, 0.005)),
            },
        };
        let links = [
            joint(JointKind::Revolute, Vector3::z(), 0.1),
            joint(JointKind::Revolute, Vector3::y(), 0.0),
            joint(JointKind::Prismatic, Vector3::x(), 0.0),
            joint(JointKind::Revolute, Vector3::y(), -0.05),
        ];
        let mut tip = Placement::identity();
        tip.translation = Vector3::new(0.15, 0.0, 0.02);
        let parameters = JointParameters {
            motor_inertia: 0.01,
            gear_ratio: 100.0,
            stiffness: 1e6,
            damping: 0.0,
            motor_constant: 10.0,
            motor_torque_limit: limit,
            torque_sensor_range: 2.0 * limit,
            position_lower: -3.0,
            position_upper: 3.0,
            velocity_limit: FASTEST,
            friction: FrictionParameters {
                speed_range: [0.01, FASTEST],
                effects: BTreeMap::new(),
            },
        };
        SerialArm::new(
            Chain::new(&links, tip).unwrap(),
            vec![parameters; links.len()],
            [0.0, 0.0, -9.81],
            &[0.0; 4],
            Vec::new(),
        )
        .unwrap()
    }

    /// What it gives once the force has faded in.
    fn faded(arm: &SerialArm, q: [f64; 4], qd: [f64; 4], force: [f64; 3]) -> LeaderTorques {
        let mut leader = LeaderArm::new(arm.clone());
        let mut last = leader.torques(TICK, &q.into(), &qd.into(), Some(force));
        for _ in 1..FADED {
            last = leader.torques(TICK, &q.into(), &qd.into(), Some(force));
        }
        last
    }

    #[test]
    fn without_a_hand_it_carries_its_own_weight_and_nothing_else() {
        let arm = arm(LIMIT);
        let mut leader = LeaderArm::new(arm.clone());
        let q = Joints::from([0.3, -0.4, 0.1, 0.9]);
        let rest = Joints::from([0.0; 4]);
        for force in [None, Some([f64::NAN, 1.0, 0.0]), Some([f64::INFINITY; 3])] {
            let step = leader.torques(TICK, &q, &rest, force);
            assert_eq!(step.torque, arm.weight(&q));
            assert_eq!(
                (step.force, step.limited, step.let_go),
                ([0.0; 3], false, false)
            );
        }
    }

    #[test]
    fn the_hand_is_where_the_tip_is_from_home() {
        let leader = LeaderArm::new(arm(LIMIT));
        assert_eq!(leader.hand(&[0.0; 4].into()).position, [0.0; 3]);
        // The joint that shifts, along its own axis: two roll-pitch turns of its frame behind the base.
        let moved = leader.hand(&[0.0, 0.0, 0.05, 0.0].into()).position;
        let way = moved.iter().map(|own| own * own).sum::<f64>().sqrt();
        assert!((way - 0.05).abs() < 1e-12, "{way}");
    }

    #[test]
    fn the_force_fades_in_ends_at_once_and_begins_anew() {
        let mut leader = LeaderArm::new(arm(100.0));
        let (q, rest) = (Joints::from([0.1; 4]), Joints::from([0.0; 4]));
        let mut before = 0.0;
        for tick in 1..=FADED {
            let force = leader.torques(TICK, &q, &rest, Some([0.0, 2.0, 0.0])).force[1];
            let share = (f64::from(tick) * TICK / FORCE_RAMP).min(1.0);
            assert!(
                (force - 2.0 * share).abs() < 1e-9 && force >= before,
                "{force}"
            );
            before = force;
        }
        assert_eq!(leader.torques(TICK, &q, &rest, None).force, [0.0; 3]);
        let again = leader.torques(TICK, &q, &rest, Some([0.0, 2.0, 0.0])).force[1];
        assert!((again - 2.0 * TICK / FORCE_RAMP).abs() < 1e-9, "{again}");
    }

    #[test]
    fn one_that_runs_away_gets_no_force_until_it_is_held() {
        let mut leader = LeaderArm::new(arm(100.0));
        let q = Joints::from([0.1; 4]);
        let mut at = |speed: f64| {
            let step = leader.torques(
                1.0,
                &q,
                &[0.0, speed, 0.0, 0.0].into(),
                Some([1.0, 0.0, 0.0]),
            );
            (step.let_go, step.force[0])
        };
        assert_eq!(at(0.99 * FASTEST), (false, 1.0));
        assert_eq!(at(-1.01 * FASTEST), (true, 0.0));
        assert_eq!(at(0.6 * FASTEST), (true, 0.0));
        assert_eq!(at(0.4 * FASTEST), (false, 1.0));
        assert_eq!(at(f64::NAN), (true, 0.0));
    }

    fn state() -> impl Strategy<Value = [f64; 4]> {
        proptest::array::uniform4(-1.5..1.5f64)
    }

    proptest! {
        /// τ·q̇ = F·v, with v from the tip's positions and not from the Jacobian.
        #[test]
        fn what_the_motors_do_beside_the_weight_is_what_the_hand_gets(
            q in state(), qd in state(), force in proptest::array::uniform3(-20.0..20.0f64), limit in 2.0..200.0f64,
        ) {
            let arm = arm(limit);
            let step = faded(&arm, q, qd, force);
            let weight = arm.weight(&q.into());
            prop_assume!(weight.iter().all(|own| own.abs() < limit));
            let motors: f64 = (0..4).map(|joint| (step.torque[joint] - weight[joint]) * qd[joint]).sum();
            let half = 1e-5;
            let at = |time: f64| {
                let q: [f64; 4] = std::array::from_fn(|joint| q[joint] + time * qd[joint]);
                arm.chain().forward(&q.into()).translation
            };
            let velocity = (at(half) - at(-half)) / (2.0 * half);
            let hand = velocity.dot(&Vector3::from(step.force));
            prop_assert!((motors - hand).abs() < 1e-6, "{motors} W, {hand} W");
        }

        /// Every motor within its limit, the weight before the force, and the force no stronger than
        /// wanted and along it.
        #[test]
        fn whatever_is_wanted_no_motor_is_asked_for_more_than_it_has(
            q in state(), qd in state(), force in proptest::array::uniform3(any::<f64>()), limit in 0.1..20.0f64,
        ) {
            let arm = arm(limit);
            let step = faded(&arm, q, qd, force);
            prop_assert!(step.torque.iter().all(|own| own.abs() <= limit));
            let given = Vector3::from(step.force);
            prop_assert!(given.iter().all(|own| own.is_finite()));
            let wanted = Vector3::from(force);
            let counts = force.iter().all(|own| own.abs() <= LARGEST);
            prop_assert!(counts || given == Vector3::zeros());
            if counts {
                prop_assert!(given.norm() <= wanted.norm() * (1.0 + 1e-9));
                prop_assert!(given.cross(&wanted).norm() <= 1e-9 * given.norm() * wanted.norm());
                prop_assert!(given.dot(&wanted) >= 0.0);
            }
            let weight = arm.weight(&q.into());
            if weight.iter().any(|own| own.abs() > limit) {
                prop_assert!(step.limited);
            } else if counts && given.norm() < 0.99 * wanted.norm() {
                // Then a motor is at its limit.
                prop_assert!(step.limited);
                let most = step.torque.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
                prop_assert!(most > limit * (1.0 - 1e-6), "{most} of {limit}");
            }
        }
    }
}

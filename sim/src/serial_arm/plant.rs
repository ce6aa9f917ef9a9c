//! The equations of motion of motors, gears, links and contact, and their integration.
//!
//! Motor side: J θ̈ = τ_m − τ − τ_F. Gear: τ = K (θ − q) + D (θ̇ − q̇), or θ = q where it is
//! rigid. Link side: M(q) q̈ + C(q, q̇) q̇ + g(q) = τ + Jᵀ F.
//!
//! One substep takes positions, masses, gravity and contact half a step ahead, and the
//! gears by the implicit midpoint rule, which keeps the energy of a spring however stiff it
//! is: with v̄ = q̇ in the middle and m = 2 J / h, κ = h K / 2 + D, β = 1 / (m + κ), B = κ β,
//!
//! θ̇ in the middle = β (m θ̇ + τ_m − K (θ − q) − τ_F) + B v̄,
//! (2 M / h + B m) v̄ = 2 M / h q̇ − C q̇ − g + Jᵀ F + m β K (θ − q) + B (m θ̇ + τ_m − τ_F).
//!
//! A rigid gear is the limit β = 0, B = 1. What friction acts on is the velocity at the end
//! of the step, so that rest is exact ([`super::braking`]).

use ferntast_model::{
    JointCount, Joints,
    rigid_body::{Chain, Jacobian, MassMatrix, Placement, Posture, Vector3, Vector6},
};

use super::{braking::Braking, cholesky::Factor, drive::Drive, grip::Grip, world::Object};
use crate::arm::Gear;

/// State and parameters of the mechanics.
#[derive(Clone, Debug)]
pub(super) struct Plant {
    /// Links without motors.
    chain: Chain,
    gravity: Vector3<f64>,
    pub(super) drives: Joints<Drive>,
    pub(super) objects: Vec<Object>,
    tip_radius: f64,
    /// Since the start \[s\].
    pub(super) time: f64,
    /// Link positions q and velocities q̇.
    pub(super) q: Joints<f64>,
    pub(super) qd: Joints<f64>,
    /// Motor positions θ and velocities θ̇.
    pub(super) theta: Joints<f64>,
    pub(super) thetad: Joints<f64>,
    /// Joint torques τ at the end of the last step.
    pub(super) joint_torque: Joints<f64>,
    /// Friction torques of the last step.
    friction: Joints<f64>,
    /// q̈ of the last step.
    qdd: Joints<f64>,
    /// Force \[N\] and moment \[Nm\] on the tip at the last substep, base frame.
    pub(super) wrench: Vector6<f64>,
    /// Work that the contact did on the tip since the start \[J\].
    pub(super) contact_work: f64,
    /// Work that the motors' torques did \[J\].
    pub(super) motor_work: f64,
    /// The hand that holds the tip.
    pub(super) grip: Option<Grip>,
    /// Its force \[N\] and moment \[Nm\] on the tip at the last substep, base frame.
    pub(super) grip_wrench: Vector6<f64>,
}

impl Plant {
    /// The arm at rest at `q`, the gears loaded by gravity. `chain` is without motors.
    pub(super) fn new(
        chain: Chain,
        gravity: Vector3<f64>,
        drives: Joints<Drive>,
        tip_radius: f64,
        q: Joints<f64>,
    ) -> Plant {
        let zero = Joints::filled(chain.count(), 0.0);
        let weight = chain.inverse_dynamics(&q, &zero, &zero, &gravity);
        let theta = Joints::from_fn(chain.count(), |joint| {
            let wound = drives[joint].stiffness.map_or(0.0, |k| weight[joint] / k);
            q[joint] + wound
        });
        Plant {
            chain,
            gravity,
            drives,
            objects: Vec::new(),
            tip_radius,
            time: 0.0,
            q,
            qd: zero,
            theta,
            thetad: zero,
            joint_torque: weight,
            friction: zero,
            qdd: zero,
            wrench: Vector6::zeros(),
            contact_work: 0.0,
            motor_work: 0.0,
            grip: None,
            grip_wrench: Vector6::zeros(),
        }
    }

    pub(super) fn count(&self) -> JointCount {
        self.q.count()
    }

    /// From now on that is the friction of a drive; none leaves nothing of the last step's.
    pub(super) fn set_friction(&mut self, joint: usize, friction: Option<Gear>) {
        self.drives[joint].friction = friction;
        if friction.is_none() {
            self.friction[joint] = 0.0;
        }
    }

    pub(super) fn tip(&self) -> Placement {
        self.chain.forward(&self.q)
    }

    /// Velocity \[m/s\] and angular velocity \[rad/s\] of the tip.
    pub(super) fn tip_velocity(&self) -> Vector6<f64> {
        twist(&self.chain.jacobian(&self.q), &self.qd)
    }

    /// Kinetic, elastic and potential energy of all parts \[J\].
    pub(super) fn energy(&self) -> f64 {
        let tip = self.tip().translation;
        let placements = self.chain.link_placements(&self.q);
        let inertias = self.chain.inertias();
        let links = placements.iter().zip(inertias.iter());
        let height: Vector3<f64> = links
            .map(|(place, link)| place.rotation * link.first_moment + place.translation * link.mass)
            .sum();
        let drives: f64 = (0..self.q.len())
            .map(|joint| {
                let drive = &self.drives[joint];
                let wound = self.theta[joint] - self.q[joint];
                let elastic = 0.5 * drive.stiffness.unwrap_or(0.0) * wound * wound;
                elastic + 0.5 * drive.inertia * self.thetad[joint] * self.thetad[joint]
            })
            .sum();
        let objects = self.objects.iter();
        let contact: f64 = objects
            .map(|object| object.energy(self.time, &tip, self.tip_radius))
            .sum();
        drives + contact + self.chain.kinetic_energy(&self.q, &self.qd) - self.gravity.dot(&height)
    }

    /// Moves on by `dt` \[s\] with `motor_torque` \[Nm\] and gears at `temperature` \[degC\];
    /// adds to the `heat` of friction \[J\] of each joint.
    pub(super) fn substep(
        &mut self,
        motor_torque: &Joints<f64>,
        temperature: &Joints<f64>,
        dt: f64,
        heat: &mut Joints<f64>,
    ) {
        let (count, half) = (self.count(), 0.5 * dt);
        let middle = Joints::from_fn(count, |joint| self.q[joint] + half * self.qd[joint]);
        let posture = self.chain.posture(&middle);
        let (contact, jacobian) = self.touch(&posture, dt);
        // Coriolis torques are quadratic in q̇: taken with the velocity that is to be
        // expected in the middle.
        let expected = Joints::from_fn(count, |joint| self.qd[joint] + half * self.qdd[joint]);
        let rest = Joints::filled(count, 0.0);
        let bias = self
            .chain
            .inverse_dynamics_in(&posture, &expected, &rest, &self.gravity);
        let mut matrix: MassMatrix = self.chain.mass_matrix_in(&posture);
        matrix *= 2.0 / dt;
        let mut right = Joints::from_fn(count, |joint| {
            let along: f64 = (0..count.get())
                .map(|other| matrix[(joint, other)] * self.qd[other])
                .sum();
            along + contact[joint] - bias[joint]
        });

        let hold = self
            .grip
            .as_ref()
            .map(|grip| grip.hold(&self.chain, &posture));
        if let Some(hold) = &hold {
            hold.add(&mut matrix, &mut right);
        }

        // With friction as it was in the last step; the motors' velocities without the links'.
        let shares = self.drives.map(|own| own.share(dt));
        let mut motor = rest;
        for joint in 0..count.get() {
            let share = &shares[joint];
            let wound = self.theta[joint] - self.q[joint];
            let spring = self.drives[joint].stiffness.unwrap_or(0.0) * wound;
            let driven =
                share.momentum * self.thetad[joint] + motor_torque[joint] - self.friction[joint];
            motor[joint] = share.own * (driven - spring);
            right[joint] += share.momentum * share.own * spring + share.follows * driven;
            matrix[(joint, joint)] += share.follows * share.momentum;
        }
        let factor = Factor::new(&matrix, count);
        let mut link = factor.solve(&right);
        for joint in 0..count.get() {
            motor[joint] += shares[joint].follows * link[joint];
        }
        if self.drives.iter().any(|drive| drive.friction.is_some()) {
            let braking = Braking {
                factor: &factor,
                shares: &shares,
                drives: &self.drives,
                load: &self.joint_torque,
                temperature,
                dt,
                before: &self.thetad,
            };
            braking.brake(&mut self.friction, &mut motor, &mut link);
        }
        self.grip_wrench = hold.map_or(Vector6::zeros(), |hold| hold.wrench(&link));

        let mut along = rest;
        for joint in 0..count.get() {
            let drive = &self.drives[joint];
            let (turned, moved) = (dt * motor[joint], dt * link[joint]);
            heat[joint] += self.friction[joint] * turned;
            self.motor_work += motor_torque[joint] * turned;
            along[joint] = moved;
            let (motor_before, link_before) = (self.thetad[joint], self.qd[joint]);
            self.q[joint] += moved;
            self.qd[joint] = 2.0 * link[joint] - link_before;
            self.qdd[joint] = (self.qd[joint] - link_before) / dt;
            match drive.stiffness {
                Some(stiffness) => {
                    self.theta[joint] += turned;
                    self.thetad[joint] = 2.0 * motor[joint] - motor_before;
                    self.joint_torque[joint] = stiffness * (self.theta[joint] - self.q[joint])
                        + drive.damping * (self.thetad[joint] - self.qd[joint]);
                }
                None => {
                    self.theta[joint] = self.q[joint];
                    self.thetad[joint] = self.qd[joint];
                    self.joint_torque[joint] = motor_torque[joint]
                        - self.friction[joint]
                        - drive.inertia * self.qdd[joint];
                }
            }
        }
        self.time += dt;
        // As the integration has it: the force in the middle, over the whole way.
        self.contact_work += self.wrench.dot(&twist(&jacobian, &along));
    }

    /// What the contact does to the joints in the `posture` half a step ahead.
    fn touch(&mut self, posture: &Posture, dt: f64) -> (Joints<f64>, Jacobian) {
        let count = self.count();
        if self.objects.is_empty() {
            return (Joints::filled(count, 0.0), Jacobian::zeros());
        }
        let (tip, jacobian) = self.chain.forward_and_jacobian_in(posture);
        let twist = twist(&jacobian, &self.qd);
        let (velocity, turning) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let velocity_at = |lever: &Vector3<f64>| velocity + turning.cross(lever);
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        let time = self.time + 0.5 * dt;
        for object in &mut self.objects {
            let touch = object.step(time, dt, &tip.translation, self.tip_radius, velocity_at);
            force += touch.force;
            moment += (touch.normal * -self.tip_radius).cross(&touch.force);
        }
        self.wrench.fixed_rows_mut::<3>(0).copy_from(&force);
        self.wrench.fixed_rows_mut::<3>(3).copy_from(&moment);
        let torques = Joints::from_fn(count, |joint| jacobian.column(joint).dot(&self.wrench));
        (torques, jacobian)
    }

    /// The stiffest that the tip can vibrate on a surface of `stiffness` \[N/m\] with the
    /// joints at `q`: ω² \[1/s²\]. Motors count with the link where they are rigid with it.
    pub(super) fn contact_rate(&self, q: &Joints<f64>, stiffness: f64) -> f64 {
        let count = self.count();
        let mut matrix = self.chain.mass_matrix(q);
        for (joint, drive) in self.drives.iter().enumerate() {
            if drive.stiffness.is_none() {
                matrix[(joint, joint)] += drive.inertia;
            }
        }
        let factor = Factor::new(&matrix, count);
        let jacobian = self.chain.jacobian(q);
        // The trace bounds the largest eigenvalue.
        let mobility: f64 = (0..3)
            .map(|axis| {
                let row = Joints::from_fn(count, |joint| jacobian[(axis, joint)]);
                let moved = factor.solve(&row);
                row.iter()
                    .zip(moved.iter())
                    .map(|(a, b)| a * b)
                    .sum::<f64>()
            })
            .sum();
        stiffness * mobility
    }

    pub(super) fn chain(&self) -> &Chain {
        &self.chain
    }
}

/// J q̇.
fn twist(jacobian: &Jacobian, qd: &Joints<f64>) -> Vector6<f64> {
    let mut twist = Vector6::zeros();
    for (joint, rate) in qd.iter().enumerate() {
        twist += jacobian.column(joint) * *rate;
    }
    twist
}

//! The equations of motion of motors, gears, links and contact, and their integration.
//!
//! Motor side, equation (2): J θ̈ = τ_m − τ − τ_F.
//! Elasticity: τ = K (θ − q) + K₃ (θ − q)³ + D (θ̇ − q̇).
//! Link side, equation (5): M(q) q̈ + C(q, q̇) q̇ + g(q) = τ + Jᵀ F.
//!
//! One substep drifts half a step with the old velocities, changes the
//! velocities by the forces there, and drifts the other half with the new
//! ones (Strang splitting). Without friction and damping this is symplectic
//! but for the small Coriolis term: energy is kept to second order and does
//! not creep. Friction is applied to the velocities last, so rest is exact.

use super::JOINTS;
use super::contact::Front;
use super::elasticity::Elasticity;
use super::friction::{Braking, Gear, brake};
use super::parameters::ArmConfig;
use ferntast_model::Vector2;
use ferntast_model::arm::{Arm, solve_symmetric};
use ferntast_model::contour::Surface;

/// One joint's mechanics.
#[derive(Clone, Copy, Debug)]
struct Joint {
    motor_inertia: f64,
    damping: f64,
    elasticity: Elasticity,
    gear: Gear,
}

/// State and parameters of the mechanics.
#[derive(Clone, Debug)]
pub(super) struct Plant {
    arm: Arm,
    joints: [Joint; JOINTS],
    pub(super) fronts: Vec<Front>,
    /// Link positions q \[rad\].
    pub(super) q: Vector2<f64>,
    /// Link velocities q̇ \[rad/s\].
    pub(super) qd: Vector2<f64>,
    /// Motor positions θ \[rad\].
    pub(super) theta: Vector2<f64>,
    /// Motor velocities θ̇ \[rad/s\].
    pub(super) thetad: Vector2<f64>,
    /// Force on the tip at the last substep \[N\], base frame.
    pub(super) force: Vector2<f64>,
    /// Work that the contact did on the tip since the start \[J\].
    pub(super) contact_work: f64,
    /// How far the contour is from its place \[m\], base frame.
    pub(super) shift: Vector2<f64>,
    /// How fast it moves \[m/s\].
    pub(super) shift_velocity: Vector2<f64>,
}

impl Plant {
    /// The arm at rest at its start position, the gears loaded by gravity.
    pub(super) fn new(config: &ArmConfig) -> Self {
        let truth = &config.truth;
        let arm = Arm::new(truth.arm.as_ref().unwrap_or(&config.arm));
        let contour = truth.contour.as_ref().unwrap_or(&config.contour);
        let q = Vector2::from(truth.start_position);
        let gravity = arm.gravity(&q);
        let day = truth.environment.day;
        let tip = arm.kinematics().forward(&q);
        let fronts = contour
            .features()
            .into_iter()
            .map(|feature| {
                let surface = match feature.surface {
                    Surface::Lubricated => truth.surface.lubricated,
                    Surface::Unlubricated => truth.surface.unlubricated,
                    Surface::Spring => truth.surface.spring.surface(feature.contact.stiffness),
                };
                Front::new(feature, surface.on_day(day), &tip)
            })
            .collect();
        let joints = truth.joint.each_ref().map(|joint| Joint {
            motor_inertia: joint.motor_inertia,
            damping: joint.damping,
            elasticity: joint.elasticity(),
            gear: joint.friction.on_day(day),
        });
        let theta = Vector2::from_fn(|joint, _| {
            q[joint] + joints[joint].elasticity.wound_by(gravity[joint])
        });
        Self {
            arm,
            joints,
            fronts,
            q,
            qd: Vector2::zeros(),
            theta,
            thetad: Vector2::zeros(),
            force: Vector2::zeros(),
            contact_work: 0.0,
            shift: Vector2::zeros(),
            shift_velocity: Vector2::zeros(),
        }
    }

    pub(super) fn tip(&self) -> Vector2<f64> {
        self.arm.kinematics().forward(&self.q)
    }

    pub(super) fn tip_velocity(&self) -> Vector2<f64> {
        self.arm.kinematics().jacobian(&self.q) * self.qd
    }

    /// Joint torques τ that the torque sensors feel \[Nm\].
    pub(super) fn joint_torque(&self) -> Vector2<f64> {
        Vector2::from_fn(|joint, _| {
            let parameters = &self.joints[joint];
            parameters
                .elasticity
                .torque(self.theta[joint] - self.q[joint])
                + parameters.damping * (self.thetad[joint] - self.qd[joint])
        })
    }

    /// Kinetic, elastic and potential energy of all parts \[J\].
    pub(super) fn energy(&self) -> f64 {
        let tip = self.tip() - self.shift;
        let joints: f64 = (0..JOINTS)
            .map(|joint| {
                let parameters = &self.joints[joint];
                let wound = self.theta[joint] - self.q[joint];
                0.5 * parameters.motor_inertia * self.thetad[joint].powi(2)
                    + parameters.elasticity.energy(wound)
            })
            .sum();
        let contact: f64 = self.fronts.iter().map(|front| front.energy(&tip)).sum();
        joints
            + contact
            + self.arm.kinetic_energy(&self.q, &self.qd)
            + self.arm.potential_energy(&self.q)
    }

    /// Moves on by `dt` \[s\] with `motor_torque` \[Nm\] and gears at
    /// `temperature` \[degC\]; gives the heat of friction \[J\] of each joint.
    pub(super) fn substep(
        &mut self,
        motor_torque: &Vector2<f64>,
        temperature: [f64; JOINTS],
        dt: f64,
    ) -> [f64; JOINTS] {
        let half = 0.5 * dt;
        let before = self.q;
        self.q += self.qd * half;
        self.theta += self.thetad * half;
        self.shift += self.shift_velocity * half;

        let torque = self.joint_torque();
        let posture = self.arm.posture(&self.q);
        let velocity = posture.jacobian * self.qd - self.shift_velocity;
        let tip = posture.tip - self.shift;
        self.force = self
            .fronts
            .iter_mut()
            .map(|front| front.step(&tip, &velocity, dt))
            .sum();
        let drive = torque + posture.jacobian.tr_mul(&self.force);
        // Coriolis torques are quadratic in q̇: taken once with the velocity
        // at the beginning, once with the one in the middle.
        let accelerated = |qd| solve_symmetric(&posture.inertia, &(drive - posture.bias(qd)));
        let middle = self.qd + accelerated(&self.qd) * half;
        self.qd += accelerated(&middle) * dt;

        let motors = std::array::from_fn(|joint| {
            let parameters = &self.joints[joint];
            let inertia = parameters.motor_inertia;
            Braking {
                gear: &parameters.gear,
                velocity: self.thetad[joint] + (motor_torque[joint] - torque[joint]) * dt / inertia,
                inertia,
                load: torque[joint],
                temperature: temperature[joint],
            }
        });
        let braked = brake(motors, dt);
        let heat = std::array::from_fn(|joint| {
            let (free, braked) = (motors[joint].velocity, braked[joint]);
            0.5 * motors[joint].inertia * (free * free - braked * braked)
        });
        self.thetad = braked.into();

        self.q += self.qd * half;
        self.theta += self.thetad * half;
        self.shift += self.shift_velocity * half;
        // As the integration has it: the force in the middle, over the whole way.
        self.contact_work += self.force.dot(&(posture.jacobian * (self.q - before)));
        heat
    }
}

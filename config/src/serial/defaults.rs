//! What an arm's file leaves out, from its URDF.
//!
//! A URDF tells geometry, inertias, and limits of position, torque and speed. Motors, gears
//! and gains it does not tell: they are assumed from the torque that a joint gives and the
//! inertia that it moves, so that a session can begin.

use std::collections::BTreeMap;

use ferntast_control::{
    estimator::{EstimatorParameters, Form, MotorCurrentParameters, Uncertainty},
    servo::ServoConfig,
};
use ferntast_model::{
    Joints, ParameterError,
    friction::FrictionParameters,
    joint::JointParameters,
    rigid_body::{Chain, JointKind, Vector3},
    serial_arm::Plane,
};
use ferntast_urdf::Arm;

use super::{SerialError, written};

/// Where a joint without ends, or with ends further out, may be: ± \[rad\] or \[m\].
const FARTHEST: f64 = 6.2;
/// Motor and gear of a joint that gives 1 Nm \[kg m²\]: 0.2 kg m² with 90 Nm.
const INERTIA_BY_TORQUE: f64 = 0.0022;
/// So stiff a gear counts as rigid \[Nm/rad\].
pub(super) const RIGID: f64 = 1e6;
/// Speed of a joint whose URDF tells none \[rad/s\].
const SPEED: f64 = 1.5;
/// How many times what it carries a joint can give, whose URDF tells no torque \[-\].
const STRENGTH: f64 = 3.0;
/// Where the servo's gain crosses that of the inertia \[rad/s\]: 10 Hz.
const STIFF: f64 = 60.0;
/// Of its torque, a joint presses with so much at most \[-\].
const PRESSING: f64 = 0.3;
/// How far the table is from the tip at home \[m\].
const TABLE_APART: f64 = 0.03;

/// What is assumed, joint by joint.
pub(super) struct Defaults {
    pub(super) gravity: [f64; 3],
    pub(super) home: Vec<f64>,
    pub(super) joint: Vec<JointParameters>,
}

impl Defaults {
    /// Of `arm`, with gravity and home as far as they are given.
    pub(super) fn new(
        arm: &Arm,
        gravity: Option<[f64; 3]>,
        home: Option<Vec<f64>>,
    ) -> Result<Defaults, SerialError> {
        let gravity = gravity.unwrap_or([0.0, 0.0, -9.80665]);
        let count = arm.chain.count();
        let ends = arm.chain.limits().map(|own| {
            let within = |end: f64| end.clamp(-FARTHEST, FARTHEST);
            [within(own.lower), within(own.upper)]
        });
        let home = match home {
            Some(home) => {
                count.check("arm.home", home.len())?;
                home
            }
            None => posture(&arm.chain, &ends).map(|own| written(*own)).to_vec(),
        };
        let rest = Joints::filled(count, 0.0);
        let at_home = Joints::from_slice(&home)?;
        let weight = arm
            .chain
            .inverse_dynamics(&at_home, &rest, &rest, &Vector3::from(gravity));
        let joint = (0..count.get()).map(|joint| {
            let given = |own: Option<f64>| own.filter(|value| value.is_finite() && *value > 0.0);
            let torque = given(arm.efforts[joint])
                .unwrap_or(STRENGTH * weight[joint].abs() + 10.0)
                .clamp(0.5, 5e3);
            let torque = written(torque);
            let speed = given(arm.velocities[joint]).unwrap_or(SPEED).min(10.0);
            JointParameters {
                motor_inertia: written((INERTIA_BY_TORQUE * torque).clamp(1e-3, 100.0)),
                gear_ratio: 100.0,
                stiffness: RIGID,
                damping: 0.0,
                motor_constant: 10.0,
                motor_torque_limit: torque,
                torque_sensor_range: written(1.5 * torque),
                position_lower: ends[joint][0],
                position_upper: ends[joint][1],
                velocity_limit: speed,
                friction: FrictionParameters {
                    speed_range: [0.01, speed],
                    effects: BTreeMap::new(),
                },
            }
        });
        Ok(Defaults {
            gravity,
            joint: joint.collect(),
            home,
        })
    }

    /// Gains that go with the inertia that each joint moves at home.
    pub(super) fn servo(&self, arm: &Arm) -> Result<ServoConfig, ParameterError> {
        let home = Joints::from_slice(&self.home)?;
        let mass = arm.chain.mass_matrix(&home);
        let each = |value: &dyn Fn(usize, &JointParameters) -> f64| {
            let joints = self.joint.iter().enumerate();
            let values = joints.map(|(joint, own)| written(value(joint, own)));
            values.collect::<Vec<f64>>()
        };
        let moved = |joint: usize, own: &JointParameters| mass[(joint, joint)] + own.motor_inertia;
        let slowest = self.joint.iter().map(|own| own.velocity_limit);
        let slowest = slowest.fold(f64::INFINITY, f64::min);
        let reach = written(reach(&arm.chain));
        let own = ServoConfig::default();
        Ok(ServoConfig {
            workspace_lower: [-reach; 2],
            workspace_upper: [reach; 2],
            acceleration_limit: each(&|joint, own| {
                (0.5 * own.motor_torque_limit / moved(joint, own)).clamp(1.0, 40.0)
            }),
            approach_speed: own.approach_speed.min(slowest),
            stiffness: each(&|joint, own| STIFF * STIFF * moved(joint, own)),
            damping: each(&|joint, own| 2.0 * STIFF * moved(joint, own)),
            pressing_limit: each(&|_, own| PRESSING * own.motor_torque_limit),
            hold_stiffness: each(&|joint, own| 0.25 * STIFF * STIFF * moved(joint, own)),
            hold_damping: each(&|joint, own| STIFF * moved(joint, own)),
            ..own
        })
    }

    /// The estimator as it is for any arm.
    pub(super) fn estimator(&self) -> EstimatorParameters {
        EstimatorParameters {
            form: Form::Direct,
            cut_off: 40.0,
            contact_on: 2.0,
            contact_off: 1.0,
            contact_distance: 0.004,
            rest_speed: 0.001,
            rest_travel: 0.0005,
            singularity: 0.05,
            friction_memory: 10.0,
            longest_gap: 0.05,
            zeroing_time: 2.0,
            calibration_time: 0.0,
            uncertainty: Uncertainty::default(),
            motor_current: MotorCurrentParameters::default(),
        }
    }

    /// A table below the tip at home; without gravity a wall before it.
    pub(super) fn table(&self, arm: &Arm) -> Plane {
        let home = Joints::from_fn(arm.chain.count(), |joint| self.home[joint]);
        let tip = arm.chain.forward(&home).translation;
        let up = (-Vector3::from(self.gravity)).try_normalize(1e-3);
        let (name, normal) = match up {
            Some(up) => ("table", up),
            None => ("wall", -Vector3::x()),
        };
        Plane {
            name: name.to_owned(),
            point: (tip - normal * TABLE_APART).map(written).into(),
            normal: normal.map(written).into(),
            stiffness: 2e4,
            damping: 100.0,
            friction: 0.3,
        }
    }
}

/// Farthest that the tip can be from the base \[m\], or a little more.
fn reach(chain: &Chain) -> f64 {
    let zero = Joints::filled(chain.count(), 0.0);
    let mut before = Vector3::zeros();
    let mut reach = 0.0;
    for (joint, placed) in chain.link_placements(&zero).iter().enumerate() {
        reach += (placed.translation - before).norm();
        before = placed.translation;
        if chain.kinds()[joint] == JointKind::Prismatic {
            let limits = chain.limits()[joint];
            reach += limits.lower.abs().max(limits.upper.abs()).min(FARTHEST);
        }
    }
    reach += (chain.forward(&zero).translation - before).norm();
    (1.1 * reach).clamp(0.1, 10.0)
}

/// A posture in the middle of the joints' ranges from which the tip can move every way: the
/// middle itself if it is such a one, or else the best of some around it.
fn posture(chain: &Chain, ends: &Joints<[f64; 2]>) -> Joints<f64> {
    const TRIED: u64 = 400;
    const GOOD: f64 = 0.15;
    let middle = ends.map(|[lower, upper]| 0.5 * (lower + upper));
    let mobility = |q: &Joints<f64>| mobility(chain, q);
    if mobility(&middle) >= GOOD {
        return middle;
    }
    let mut best = (mobility(&middle), middle);
    for attempt in 0..TRIED {
        let q = Joints::from_fn(chain.count(), |joint| {
            // Points of a lattice that fill the box evenly (Weyl; the square roots of primes).
            const PRIMES: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
            let share = ((attempt + 1) as f64 * PRIMES[joint].sqrt()).fract() - 0.5;
            let [lower, upper] = ends[joint];
            middle[joint] + share * (0.8 * (upper - lower)).min(3.2)
        });
        let found = mobility(&q);
        if found > best.0 {
            best = (found, q);
        }
    }
    best.1
}

/// How well the tip can move every way that so many joints can move it: the least singular
/// value of its Jacobian, lengths by half a metre.
fn mobility(chain: &Chain, q: &Joints<f64>) -> f64 {
    let mut jacobian = chain.jacobian(q);
    for (row, mut values) in jacobian.row_iter_mut().enumerate() {
        if row < 3 {
            values *= 2.0;
        } else if chain.count().get() < 6 {
            values *= 0.0;
        }
    }
    let product = jacobian * jacobian.transpose();
    let mut squares: [f64; 6] = product.symmetric_eigenvalues().into();
    squares.sort_by(|a, b| b.total_cmp(a));
    let rank = match chain.count().get() {
        joints if joints < 6 => joints.min(3),
        _ => 6,
    };
    squares[rank - 1].max(0.0).sqrt()
}

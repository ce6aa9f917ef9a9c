//! Contact forces from joint torques: equations (5) and (6).
//!
//! The torque sensors sit behind the gears, so gear friction does not get
//! into the estimate. The link-side position is q = θ − τ/K; all channels go
//! through the same causal filter, which also gives q̇ and q̈; then
//!
//! Jᵀ F = M(q) q̈ + C(q, q̇) q̇ + g(q) − τ,  F = F_N ∇Φ − F_T ṙ/|ṙ|.
//!
//! Which surface is touched follows from geometry; that it is touched, from
//! the normal force, with hysteresis.

mod coefficient;
mod filter;
mod parameters;

pub use coefficient::{Coefficient, CoefficientEstimator};
pub use filter::DerivativeFilter;
pub use parameters::EstimatorParameters;

use ferntast_model::arm::Arm;
use ferntast_model::contour::{Feature, Surface, nearest};
use ferntast_model::joint::JointParameters;
use ferntast_model::{ArmModel, JOINTS, ParameterError, Vector2};

/// What the estimator needs of a measurement, joint side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointMeasurement {
    /// Motor positions θ \[rad\].
    pub motor_position: [f64; JOINTS],
    /// Joint torques τ at the torque sensors \[Nm\].
    pub joint_torque: [f64; JOINTS],
}

/// What is known of tip and contact. Always finite, but for the error of a
/// coefficient that is not identified, which is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEstimate {
    /// Link-side positions q \[rad\], newest, not filtered.
    pub position: [f64; JOINTS],
    /// Link-side velocities q̇ \[rad/s\], filtered.
    pub velocity: [f64; JOINTS],
    /// Stylus tip r_ee \[m\], base frame, newest, not filtered.
    pub tip: [f64; 2],
    /// Velocity of the tip \[m/s\], base frame, filtered.
    pub tip_velocity: [f64; 2],
    /// Force of the surroundings on the tip \[N\], base frame, filtered; also
    /// without contact, where it shows the estimator's noise.
    pub force: [f64; 2],
    /// The same in the contact frame \[N\]: along the tangent (normal turned
    /// by −90°), and along the normal; zero without contact.
    pub contact_force: [f64; 2],
    /// Normal force F_N ≥ 0 \[N\]; zero without contact.
    pub normal_force: f64,
    /// Tangential force F_T \[N\], positive against the tip's motion; zero
    /// without contact. Near rest the last direction of motion is taken,
    /// so it may become negative (Fig. 16).
    pub tangential_force: f64,
    /// The surface touched.
    pub surface: Option<Surface>,
    /// Its index in [`Contour::features`](ferntast_model::contour::Contour::features).
    pub feature: Option<usize>,
    /// b_0T of equation (6) of the surface touched, or touched last.
    pub friction: Coefficient,
    /// The tip touches a surface.
    pub in_contact: bool,
    /// The forces can be used.
    pub valid: bool,
    /// In contact, and the tip rests or turns: the direction of F_T is not defined.
    pub near_rest: bool,
    /// The tip touches two surfaces at once: `force` holds, its split does not.
    pub corner: bool,
    /// The arm is too near its singularity to tell forces.
    pub singular: bool,
    /// A torque sensor is, or was a moment ago, at the end of its range.
    pub saturated: bool,
    /// The measurement or the time step was not usable; the rest is from before.
    pub input_invalid: bool,
}

impl ContactEstimate {
    /// Nothing is known.
    pub const UNKNOWN: ContactEstimate = ContactEstimate {
        position: [0.0; JOINTS],
        velocity: [0.0; JOINTS],
        tip: [0.0; 2],
        tip_velocity: [0.0; 2],
        force: [0.0; 2],
        contact_force: [0.0; 2],
        normal_force: 0.0,
        tangential_force: 0.0,
        surface: None,
        feature: None,
        friction: Coefficient::UNKNOWN,
        in_contact: false,
        valid: false,
        near_rest: false,
        corner: false,
        singular: false,
        saturated: false,
        input_invalid: false,
    };
}

/// Share of the torque sensor's range that counts as its end.
const SATURATION: f64 = 0.995;

/// Beyond these a measurement is broken, whatever the arm.
const LARGEST_POSITION: f64 = 1e3;
const LARGEST_TORQUE: f64 = 1e6;

/// How far behind the front of a feature the tip is still taken to push it \[m\].
const REACH: f64 = 0.1;

/// How the tip moves, base frame.
struct Motion {
    /// Newest position \[m\].
    tip: Vector2<f64>,
    /// Filtered velocity \[m/s\], as late as the forces.
    velocity: Vector2<f64>,
    /// Velocity \[m/s\] predicted over the filter's delay.
    present_velocity: Vector2<f64>,
}

/// Estimates contact forces step by step.
#[derive(Clone, Debug)]
pub struct ContactEstimator {
    arm: Arm,
    joints: [JointParameters; JOINTS],
    features: Vec<Feature>,
    parameters: EstimatorParameters,
    positions: [DerivativeFilter; JOINTS],
    torques: [DerivativeFilter; JOINTS],
    /// One a surface: lubricated, unlubricated.
    coefficients: [CoefficientEstimator; 2],
    last: ContactEstimate,
    /// Time since the filters were last moved on \[s\].
    gap: f64,
    /// Time until the filters have forgotten a start or a saturation \[s\].
    settling: f64,
    unsaturated_for: f64,
    /// Way slid since the last turn or rest \[m\].
    travel: f64,
    /// Direction of the last motion along the tangent: ±1.
    direction: f64,
    started: bool,
}

impl ContactEstimator {
    /// An estimator that believes `model`.
    ///
    /// # Errors
    ///
    /// The first parameter that is out of bounds.
    pub fn new(model: &ArmModel, parameters: &EstimatorParameters) -> Result<Self, ParameterError> {
        model.validate()?;
        parameters
            .validate()
            .map_err(|error| error.within("estimator"))?;
        Ok(Self {
            arm: Arm::new(&model.arm),
            joints: model.joint.clone(),
            features: model.contour.features(),
            parameters: *parameters,
            positions: [DerivativeFilter::new(parameters.cut_off); JOINTS],
            torques: [DerivativeFilter::new(parameters.cut_off); JOINTS],
            coefficients: Default::default(),
            last: ContactEstimate::UNKNOWN,
            gap: 0.0,
            settling: 0.0,
            unsaturated_for: f64::INFINITY,
            travel: 0.0,
            direction: 1.0,
            started: false,
        })
    }

    /// Time that the filters take to forget \[s\].
    fn settling_time(&self) -> f64 {
        1.0 / self.parameters.cut_off
    }

    /// Takes in a measurement `dt` \[s\] after the last one.
    ///
    /// Never fails: with an unusable measurement or time step it gives what
    /// it gave before, marked as invalid.
    pub fn step(&mut self, dt: f64, measurement: &JointMeasurement) -> ContactEstimate {
        let passes = dt > 0.0 && dt.is_finite();
        if !(passes && is_usable(measurement)) {
            self.gap += if passes { dt } else { 0.0 };
            self.last.input_invalid = true;
            self.last.valid = false;
            return self.last;
        }
        let step = self.gap + dt;
        self.gap = 0.0;
        let link = self.filter(step, measurement);
        let saturated = self.watch_saturation(step, measurement);

        let channel = |read: fn(&DerivativeFilter) -> f64, from: &[DerivativeFilter; JOINTS]| {
            Vector2::new(read(&from[0]), read(&from[1]))
        };
        let q = channel(DerivativeFilter::value, &self.positions);
        let qd = channel(DerivativeFilter::first, &self.positions);
        let qdd = channel(DerivativeFilter::second, &self.positions);
        let torque = channel(DerivativeFilter::value, &self.torques);

        let kinematics = *self.arm.kinematics();
        let external = self.arm.inverse_dynamics(&q, &qd, &qdd) - torque;
        let force = kinematics.tip_force(&q, &external, self.parameters.singularity);
        let singular = force.is_none();
        let force = force.unwrap_or_else(Vector2::zeros);
        let tip = kinematics.forward(&link);
        let tip_velocity = kinematics.jacobian(&q) * qd;

        let mut estimate = ContactEstimate {
            position: link.into(),
            velocity: qd.into(),
            tip: tip.into(),
            tip_velocity: tip_velocity.into(),
            force: force.into(),
            friction: self.last.friction,
            singular,
            saturated,
            valid: !singular && !saturated && self.settling <= 0.0,
            ..ContactEstimate::UNKNOWN
        };
        // All is seen late by the filter's delay; where the tip is by now:
        let acceleration = kinematics.jacobian(&q) * qdd + kinematics.jacobian_rate(&q, &qd) * qd;
        let motion = Motion {
            tip,
            velocity: tip_velocity,
            present_velocity: tip_velocity + acceleration * self.positions[0].delay(),
        };
        self.split(step, &motion, &force, &mut estimate);
        self.last = estimate;
        estimate
    }

    /// Filters all channels; gives the newest link-side position \[rad\].
    fn filter(&mut self, dt: f64, measurement: &JointMeasurement) -> Vector2<f64> {
        let anew = !self.started || dt > self.parameters.longest_gap;
        self.settling = if anew {
            self.settling_time()
        } else {
            (self.settling - dt).max(0.0)
        };
        self.started = true;
        let mut link = Vector2::zeros();
        for joint in 0..JOINTS {
            let torque = measurement.joint_torque[joint];
            link[joint] =
                self.joints[joint].link_position(measurement.motor_position[joint], torque);
            if anew {
                self.positions[joint].reset(link[joint]);
                self.torques[joint].reset(torque);
            } else {
                self.positions[joint].step(link[joint], dt);
                self.torques[joint].step(torque, dt);
            }
        }
        link
    }

    /// Whether a sensor's end of range is still in the filters.
    fn watch_saturation(&mut self, dt: f64, measurement: &JointMeasurement) -> bool {
        let at_end = (0..JOINTS).any(|joint| {
            let range = self.joints[joint].torque_sensor_range;
            measurement.joint_torque[joint].abs() >= SATURATION * range
        });
        self.unsaturated_for = if at_end {
            0.0
        } else {
            self.unsaturated_for + dt
        };
        self.unsaturated_for < self.settling_time()
    }

    /// Finds the surface touched, and splits the force along it.
    fn split(
        &mut self,
        dt: f64,
        motion: &Motion,
        force: &Vector2<f64>,
        estimate: &mut ContactEstimate,
    ) {
        let parameters = self.parameters;
        let tip = &motion.tip;
        let near = nearest(&self.features, tip, REACH)
            .filter(|near| near.distance <= parameters.contact_distance);
        let threshold = if self.last.in_contact {
            parameters.contact_off
        } else {
            parameters.contact_on
        };
        let touched = near.and_then(|near| {
            let feature = self.features.get(near.index)?;
            (force.dot(&feature.normal) > threshold).then_some((near.index, *feature))
        });
        let Some((index, feature)) = touched else {
            self.travel = 0.0;
            return;
        };
        let sliding = motion.velocity.dot(&feature.tangent());
        let (normal, tangential) = (force.dot(&feature.normal), force.dot(&feature.tangent()));
        let turned = sliding * self.direction < 0.0;
        if sliding.abs() < parameters.rest_speed || turned || self.last.feature != Some(index) {
            self.travel = 0.0;
        } else {
            self.travel += sliding.abs() * dt;
        }
        if sliding.abs() >= parameters.rest_speed {
            self.direction = sliding.signum();
        }
        let present = motion.present_velocity.dot(&feature.tangent());
        let stopping = present * self.direction < parameters.rest_speed;
        estimate.in_contact = true;
        estimate.surface = Some(feature.surface);
        estimate.feature = Some(index);
        estimate.contact_force = [tangential, normal];
        estimate.normal_force = normal;
        estimate.tangential_force = -tangential * self.direction;
        estimate.near_rest = stopping || self.travel <= parameters.rest_travel;
        estimate.corner = self.features.iter().enumerate().any(|(other, f)| {
            other != index && f.faces(tip) && (-REACH..=0.0).contains(&f.distance(tip))
        });
        self.identify(dt, feature.surface, estimate);
    }

    /// Equation (6), where the tip slides.
    fn identify(&mut self, dt: f64, surface: Surface, estimate: &mut ContactEstimate) {
        let slot = match surface {
            Surface::Lubricated => 0,
            Surface::Unlubricated => 1,
            // The head of a spring gives way: equation (6) is not about it.
            Surface::Spring => return,
        };
        let coefficient = &mut self.coefficients[slot];
        if estimate.valid && !estimate.near_rest && !estimate.corner {
            coefficient.step(
                estimate.normal_force,
                estimate.tangential_force,
                dt,
                self.parameters.friction_memory,
                self.parameters.cut_off,
            );
        }
        estimate.friction = coefficient.coefficient();
    }
}

/// Whether the numbers are such as an arm can give.
fn is_usable(measurement: &JointMeasurement) -> bool {
    // NaN fails both comparisons.
    measurement
        .motor_position
        .iter()
        .all(|position| position.abs() <= LARGEST_POSITION)
        && measurement
            .joint_torque
            .iter()
            .all(|torque| torque.abs() <= LARGEST_TORQUE)
}

#[cfg(test)]
mod tests;

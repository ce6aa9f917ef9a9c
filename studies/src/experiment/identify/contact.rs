//! A contact as the estimator told it, and its friction.

use std::path::Path;

use ferntast_control::estimator::{
    ERRORS, Push, SelfCalibration, independent_gains, sensor_errors, split_errors,
};
use ferntast_identification::{
    experiments::contact_friction::{ContactFriction, SystematicError, contact_friction},
    numerics::filter::Kernel,
};
use ferntast_lab::{
    experiment::{Experiment, Signals, data_folder},
    recording,
};
use ferntast_model::{
    Vector2,
    arm::Arm,
    contour::{Feature, Surface},
    joint::JointParameters,
};
use ferntast_msgs::topics;
use ferntast_sim::arm::{ArmConfig, JOINTS};
use serde::Serialize;

use super::{
    IdentifyError, arm_of,
    systematic::{Source, zero_after_zeroing},
};

/// A contact in a recording, by the estimator's own topics.
#[derive(Clone, Debug, Default)]
pub struct Contact {
    /// Sampling period \[s\].
    pub period: f64,
    /// F_N \[N\].
    pub normal: Vec<f64>,
    /// Force on the tip along the tangent, x of the contact frame \[N\].
    pub tangential: Vec<f64>,
    /// Velocity of the tip along the tangent, from the motors' positions
    /// alone \[m/s\]: with elastic joints it turns before the tip does.
    pub velocity: Vec<f64>,
    /// F_T of equation (5), positive when it opposes the motion \[N\].
    pub opposing: Vec<f64>,
    /// Sliding in contact, not near rest.
    pub usable: Vec<bool>,
    /// In contact, near rest or not.
    pub in_contact: Vec<bool>,
    /// What torque sensors and contour may have wrong of both forces all the time.
    pub systematic: Vec<SystematicError>,
    /// Force on the tip along tangent and normal by the recorded torque sensors, whatever form
    /// the estimator had \[N\].
    pub by_sensors: Vec<[f64; 2]>,
    /// What sliding tells of them.
    pub calibration: Option<ContactCalibration>,
}

/// What sliding to and fro along one edge tells of torque sensors and contour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactCalibration {
    /// By how much sensor 1 has more gain than sensor 2 \[-\], and its standard error. Gain of
    /// both together nothing here tells: it scales all forces alike.
    pub gain_ratio: f64,
    /// Standard error of it.
    pub gain_ratio_error: f64,
    /// How far the edge is turned from where it is believed to be, about z \[rad\].
    pub turn: f64,
    /// Standard error of it \[rad\].
    pub turn_error: f64,
}

impl Contact {
    /// Reads the contact with `surface` out of the recording at `path`.
    ///
    /// # Errors
    ///
    /// A recording that cannot be read, or that the estimator did not run in.
    pub fn read(path: &Path, surface: Surface) -> Result<Contact, IdentifyError> {
        let arm = arm_of(path)?;
        let measured = topics::FOLLOWER_MEASURED_JS.name;
        let state = topics::FOLLOWER_CONTACT_STATE.name;
        let force = topics::FOLLOWER_CONTACT_CF.name;
        let mut experiment = Experiment::open(path, &data_folder())?
            .into_iter()
            .nth(1)
            .ok_or_else(|| IdentifyError::Empty {
                path: path.to_owned(),
                what: "it has no second joint",
            })?;
        let extra = [
            ("theta_1", format!("{measured}.position[0]")),
            ("torque_1", format!("{measured}.effort[0]")),
            ("normal", format!("{state}.normal_force")),
            ("opposing", format!("{state}.tangential_force")),
            ("near_rest", format!("{state}.near_rest")),
            ("in_contact", format!("{state}.in_contact")),
            ("valid", format!("{state}.valid")),
            ("tangential", format!("{force}.wrench.force.x")),
        ];
        experiment.signals = Signals {
            extra: extra.map(|(name, path)| (name.to_owned(), path)).into(),
            ..experiment.signals
        };
        let dataset = recording::load(&experiment)?.dataset;
        let edge = arm
            .contour
            .features()
            .into_iter()
            .find(|feature| feature.surface == surface);
        let (Some(session), Some(edge)) = (dataset.sessions.first(), edge) else {
            return Err(IdentifyError::Empty {
                path: path.to_owned(),
                what: "no contact in it; record it with `ferntast experiment contact`",
            });
        };
        let channel = |name: &str| session.extra.get(name).cloned().unwrap_or_default();
        let (first, near, touching, valid) = (
            channel("theta_1"),
            channel("near_rest"),
            channel("in_contact"),
            channel("valid"),
        );
        let kinematics = *Arm::new(&arm.arm).kinematics();
        let along: Vec<f64> = first
            .iter()
            .zip(&session.position)
            .map(|(&q1, &q2)| edge.along(&kinematics.forward(&Vector2::new(q1, q2))))
            .collect();
        let slope = Kernel::gaussian(1.0, 1, session.period);
        let is = |channel: &[f64], at: usize| channel.get(at).is_some_and(|value| *value > 0.5);
        let rows = 0..session.len();
        let velocity = slope.everywhere(&along);
        let (torque_1, torque_2) = (channel("torque_1"), session.joint_torque.clone());
        let torque_2 = torque_2.unwrap_or_default();
        let measured = Measured {
            arm: &arm,
            edge: &edge,
            position: [&first, &session.position],
            torque: [&torque_1, &torque_2],
            velocity: &velocity,
            in_contact: rows.clone().map(|at| is(&touching, at)).collect(),
        };
        let usable: Vec<bool> = rows
            .clone()
            .map(|at| {
                is(&touching, at) && is(&valid, at) && !near.get(at).is_some_and(|n| *n > 0.0)
            })
            .collect();
        Ok(Contact {
            systematic: measured.systematic(),
            by_sensors: measured.by_sensors(),
            calibration: measured.calibration(&usable, session.period),
            period: session.period,
            normal: channel("normal"),
            tangential: channel("tangential"),
            opposing: channel("opposing"),
            velocity,
            usable,
            in_contact: rows.map(|at| is(&touching, at)).collect(),
        })
    }

    /// Equation (6) fitted where the tip slides.
    pub fn friction(&self) -> Option<ContactFriction> {
        contact_friction(&self.opposing, &self.normal, &self.usable, &self.systematic)
    }
}

/// Memory of what sliding tells \[s\]: all of it counts alike.
const WHOLE_RECORDING: f64 = 1e5;

/// What is measured of both joints in a contact, sample by sample.
struct Measured<'a> {
    arm: &'a ArmConfig,
    edge: &'a Feature,
    /// θ \[rad\].
    position: [&'a [f64]; JOINTS],
    /// τ \[Nm\].
    torque: [&'a [f64]; JOINTS],
    /// Along the tangent \[m/s\].
    velocity: &'a [f64],
    in_contact: Vec<bool>,
}

/// The arm at one sample.
struct Posture {
    /// q \[rad\].
    link: Vector2<f64>,
    /// What the torque sensors feel \[Nm\].
    felt: Vector2<f64>,
}

impl Measured<'_> {
    /// With `torque` of both joints \[Nm\] at sample `at`.
    fn posture(&self, torque: &[Vec<f64>; JOINTS], at: usize) -> Posture {
        let joints: &[JointParameters] = &self.arm.joint;
        let felt = Vector2::from_fn(|joint, _| torque[joint].get(at).copied().unwrap_or(0.0));
        let link = Vector2::from_fn(|joint, _| {
            let theta = self.position[joint].get(at).copied().unwrap_or(0.0);
            let own = joints.get(joint);
            own.map_or(theta, |own| own.link_position(theta, felt[joint]))
        });
        Posture { link, felt }
    }

    /// Torques without the noise that is quicker than the estimator's filter \[Nm\].
    fn smooth_torque(&self) -> [Vec<f64>; JOINTS] {
        let smooth = Kernel::gaussian(2.0, 0, 1.0);
        self.torque.map(|torque| smooth.everywhere(torque))
    }

    /// Force along tangent and normal \[N\], sample by sample.
    fn by_sensors(&self) -> Vec<[f64; 2]> {
        let believed = Arm::new(&self.arm.arm);
        let kinematics = *believed.kinematics();
        let torque = self.smooth_torque();
        let (normal, tangent) = (self.edge.normal, self.edge.tangent());
        (0..self.velocity.len())
            .map(|at| {
                let Posture { link, felt } = self.posture(&torque, at);
                let contact = believed.gravity(&link) - felt;
                let singularity = self.arm.estimator.singularity;
                let force = kinematics.tip_force(&link, &contact, singularity);
                force.map_or([0.0; 2], |force| [force.dot(&tangent), force.dot(&normal)])
            })
            .collect()
    }

    /// By the `usable` samples, `period` \[s\] apart.
    fn calibration(&self, usable: &[bool], period: f64) -> Option<ContactCalibration> {
        let believed = Arm::new(&self.arm.arm);
        let kinematics = *believed.kinematics();
        let estimator = &self.arm.estimator;
        let torque = self.smooth_torque();
        let free: Vec<usize> = (0..usable.len())
            .take_while(|&at| !self.in_contact[at])
            .collect();
        let zero = free
            .iter()
            .fold(Vector2::zeros(), |sum: Vector2<f64>, &at| {
                let posture = self.posture(&torque, at);
                sum + posture.felt - believed.gravity(&posture.link)
            })
            / free.len().max(1) as f64;
        let mut own = SelfCalibration::new(estimator.uncertainty, 1);
        for at in (0..usable.len()).filter(|&at| usable[at]) {
            let Posture { link, felt } = self.posture(&torque, at);
            let felt = felt - zero;
            let force =
                |torque: Vector2<f64>| kinematics.tip_force(&link, &torque, estimator.singularity);
            let by_ratio = Vector2::new(0.5 * felt.x, -0.5 * felt.y);
            let (Some(force), Some(by_ratio)) =
                (force(believed.gravity(&link) - felt), force(by_ratio))
            else {
                continue;
            };
            let push = Push {
                feature: self.edge,
                tip: kinematics.forward(&link),
                force,
                by_ratio,
                direction: self.velocity[at].signum(),
                dt: period,
                alike: 0.5 / estimator.cut_off,
            };
            own.slide(0, WHOLE_RECORDING, &push);
        }
        let (ratio, turn) = (own.calibration().ratio, own.turn(0)?);
        Some(ContactCalibration {
            gain_ratio: ratio.value,
            gain_ratio_error: ratio.error,
            turn: turn.value,
            turn_error: turn.error,
        })
    }

    /// Zeros, gains, the contour's turn (in the estimator's own order), then hysteresis.
    fn systematic(&self) -> Vec<SystematicError> {
        let believed = Arm::new(&self.arm.arm);
        let kinematics = *believed.kinematics();
        let (estimator, uncertainty) = (&self.arm.estimator, self.arm.estimator.uncertainty);
        let torque = self.smooth_torque();
        let zeros = [0, 1].map(|joint: usize| {
            let free = (0..torque[joint].len()).take_while(|&at| !self.in_contact[at]);
            let free: Vec<f64> = free.map(|at| torque[joint][at]).collect();
            zero_after_zeroing(estimator, &free)
        });
        let trails = [0, 1].map(|joint: usize| {
            let trail = Source::Hysteresis(joint).change(self.torque[joint], &uncertainty);
            trail.unwrap_or_default()
        });
        let mut all = vec![SystematicError::default(); ERRORS + JOINTS];
        for at in 0..self.velocity.len() {
            let Posture { link, felt } = self.posture(&torque, at);
            let contact = believed.gravity(&link) - felt;
            let singularity = estimator.singularity;
            let sensors = sensor_errors(
                &kinematics,
                &link,
                &zeros.into(),
                &independent_gains(&contact, uncertainty.torque_gain),
                singularity,
            );
            let (normal, tangent) = (self.edge.normal, self.edge.tangent());
            let force = kinematics
                .tip_force(&link, &contact, singularity)
                .unwrap_or_else(Vector2::zeros);
            let direction = self.velocity[at].signum();
            let split = split_errors(
                &sensors,
                &normal,
                &tangent,
                [force.dot(&tangent), force.dot(&normal)],
                direction,
                uncertainty.contour_turn,
            );
            let hysteresis = [0, 1].map(|joint: usize| {
                let mut alone = Vector2::zeros();
                alone[joint] = trails[joint].get(at).copied().unwrap_or(0.0);
                let force = kinematics.tip_force(&link, &alone, singularity);
                let force = force.unwrap_or_else(Vector2::zeros);
                [force.dot(&normal), -direction * force.dot(&tangent)]
            });
            for (error, [normal, tangential]) in
                all.iter_mut().zip(split.into_iter().chain(hysteresis))
            {
                error.normal.push(normal);
                error.tangential.push(tangential);
            }
        }
        all
    }
}

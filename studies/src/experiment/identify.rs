//! What the recording of an experiment says, through the lab.

use std::{collections::BTreeMap, path::Path};

use ferntast_bus::mcap::BagReader;
use ferntast_identification::{
    Dataset, RecordedSession, Term,
    data::Inertia,
    design::Design,
    experiments::{
        contact_friction::{self, ContactFriction},
        damping::{self, Average, Sample},
        stiffness::{self, Stiffness},
    },
    fit::{Parameter, fit},
    prepare,
};
use ferntast_lab::{
    experiment::{Experiment, RECORD, Signals, data_folder},
    recording,
};
use ferntast_model::{Vector2, arm::Arm, contour::Surface};
use ferntast_msgs::topics;
use ferntast_sim::arm::ArmConfig;
use serde::Serialize;

use super::IdentifyError;

/// Effects of the linear model, equation (3).
pub const LINEAR: &[&str] = &["coulomb", "load_coulomb", "viscous"];
/// Effects of the cubic model, equation (4).
pub const CUBIC: &[&str] = &[
    "coulomb",
    "load_coulomb",
    "viscous",
    "quadratic_viscous",
    "cubic_viscous",
];
/// Equation (4) without load, as for the sinusoidal trajectory.
pub const CUBIC_UNLOADED: &[&str] = &["coulomb", "viscous", "quadratic_viscous", "cubic_viscous"];

/// A joint's friction as identified.
#[derive(Clone, Debug, Serialize)]
pub struct Friction {
    /// b0, b0T, b1, b2, b3 by name, as far as they are in the model.
    pub parameters: BTreeMap<String, Parameter>,
    /// Parameters that the motion does not excite.
    pub not_excited: Vec<String>,
    /// RMS of the torque left \[Nm\].
    pub rms: f64,
}

impl Friction {
    /// A parameter's value; 0 where the model has none of that name.
    pub fn value(&self, name: &str) -> f64 {
        self.parameters.get(name).map_or(0.0, |found| found.value)
    }

    /// Its standard error.
    pub fn error(&self, name: &str) -> Option<f64> {
        self.parameters.get(name).and_then(|found| found.std_error)
    }

    /// Viscous part of equation (4) at `speed` ≥ 0 \[rad/s\], in its three terms \[Nm\].
    pub fn viscous(&self, speed: f64) -> [f64; 3] {
        [
            self.value("b1") * speed,
            self.value("b2") * speed * speed,
            self.value("b3") * speed.powi(3),
        ]
    }

    /// Equation (4) at `speed` ≥ 0 \[rad/s\] under the load `torque` \[Nm\].
    pub fn torque(&self, speed: f64, torque: f64) -> f64 {
        let coulomb = self.value("b0") + self.value("b0T") * torque.abs();
        coulomb + self.viscous(speed).iter().sum::<f64>()
    }
}

/// One joint's signals in a recording.
#[derive(Clone, Debug)]
pub struct JointData {
    experiment: Experiment,
    /// The signals.
    pub dataset: Dataset,
    /// Mean temperature \[degC\].
    pub temperature: Option<f64>,
}

impl JointData {
    /// Reads joint `joint` (1 or 2) out of the recording at `path`.
    ///
    /// # Errors
    ///
    /// A recording that cannot be read, or is not of ours.
    pub fn read(path: &Path, joint: usize) -> Result<JointData, IdentifyError> {
        let empty = |what| IdentifyError::Empty {
            path: path.to_owned(),
            what,
        };
        let experiments = Experiment::open(path, &data_folder())?;
        let experiment = experiments
            .into_iter()
            .nth(joint.saturating_sub(1))
            .ok_or_else(|| empty("it has no such joint"))?;
        let dataset = recording::load(&experiment)?.dataset;
        let temperatures: Vec<f64> = dataset
            .sessions
            .iter()
            .filter_map(|session| session.temperature.as_ref())
            .flatten()
            .copied()
            .collect();
        let mean = temperatures.iter().sum::<f64>() / temperatures.len().max(1) as f64;
        Ok(JointData {
            experiment,
            dataset,
            temperature: (!temperatures.is_empty()).then_some(mean),
        })
    }

    /// Fits friction with the `effects` named, inertia as known.
    ///
    /// # Errors
    ///
    /// Data that the model cannot be fitted to.
    pub fn friction(&self, path: &Path, effects: &[&str]) -> Result<Friction, IdentifyError> {
        let mut spec = self.experiment.model.clone();
        spec.effects = effects
            .iter()
            .map(|effect| Term::Catalogue((*effect).to_owned()))
            .collect();
        let prepared = prepare(&self.dataset, &spec).map_err(|source| IdentifyError::Fit {
            path: path.to_owned(),
            source,
        })?;
        let found = fit(&prepared, &Design::new(&prepared));
        Ok(Friction {
            parameters: found.parameters,
            not_excited: found.not_excited,
            rms: found.train,
        })
    }

    /// The damping torque, sample by sample.
    pub fn samples(&self) -> Vec<Sample> {
        let inertia = match self.experiment.model.inertia {
            Inertia::Given(inertia) => inertia,
            Inertia::Fit => 0.0,
        };
        damping::samples(&self.dataset, inertia)
    }
}

/// Mean damping in ranges of speed \[deg/s\].
pub fn averages(samples: &[Sample], ranges: &[[f64; 2]]) -> Vec<Option<Average>> {
    let ranges: Vec<[f64; 2]> = ranges
        .iter()
        .map(|range| range.map(f64::to_radians))
        .collect();
    damping::averages(samples, &ranges)
}

/// The arm that a recording was made with, as it was believed.
fn arm_of(path: &Path) -> Result<ArmConfig, IdentifyError> {
    let empty = |what| IdentifyError::Empty {
        path: path.to_owned(),
        what,
    };
    let bag = BagReader::open(path).map_err(|source| IdentifyError::Open {
        path: path.to_owned(),
        reason: source.to_string(),
    })?;
    bag.metadata()
        .get(RECORD)
        .and_then(|record| record.get("arm"))
        .and_then(|text| serde_json::from_str(text).ok())
        .ok_or_else(|| {
            empty(
                "it does not say which arm it was made with; record it with `ferntast experiment`",
            )
        })
}

/// Stiffness of joint 2 from the recording of a saw-tooth at `path`. What
/// gives way of the edge itself is taken off by its believed stiffness k: with
/// the lever ℓ = ∇Φᵀ ∂r/∂q_2 its compliance at the joint is 1/(k ℓ²).
///
/// # Errors
///
/// A recording that cannot be read, or has no saw-tooth.
pub fn stiffness(path: &Path) -> Result<Stiffness, IdentifyError> {
    let data = JointData::read(path, 2)?;
    let other = JointData::read(path, 1)?;
    let arm = arm_of(path)?;
    let empty = IdentifyError::Empty {
        path: path.to_owned(),
        what: "no torque against a fixed tip; record it with `ferntast experiment stiffness`",
    };
    let (Some(session), Some(first)) = (
        data.dataset.sessions.first(),
        other.dataset.sessions.first(),
    ) else {
        return Err(empty);
    };
    let Some(torque) = &session.joint_torque else {
        return Err(empty);
    };
    let most = (0..torque.len()).max_by(|&a, &b| torque[a].abs().total_cmp(&torque[b].abs()));
    let Some(most) = most else {
        return Err(empty);
    };
    let at = |session: &RecordedSession| session.position.get(most).copied().unwrap_or_default();
    let posture = Vector2::new(at(first), at(session));
    let normal = arm
        .contour
        .features()
        .into_iter()
        .find(|feature| feature.surface == Surface::Unlubricated);
    let compliance = normal.map_or(0.0, |edge| {
        let jacobian = Arm::new(&arm.arm).kinematics().jacobian(&posture);
        let lever = edge.normal.dot(&jacobian.column(1));
        1.0 / (edge.contact.stiffness * lever * lever).max(1e-9)
    });
    stiffness::stiffness(&session.position, torque, compliance).ok_or(empty)
}

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
            ("q_1", format!("{measured}.position[0]")),
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
            channel("q_1"),
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
        let slope =
            ferntast_identification::numerics::filter::Kernel::gaussian(1.0, 1, session.period);
        let is = |channel: &[f64], at: usize| channel.get(at).is_some_and(|value| *value > 0.5);
        let rows = 0..session.len();
        Ok(Contact {
            period: session.period,
            normal: channel("normal"),
            tangential: channel("tangential"),
            opposing: channel("opposing"),
            velocity: slope.everywhere(&along),
            usable: rows
                .clone()
                .map(|at| {
                    is(&touching, at) && is(&valid, at) && !near.get(at).is_some_and(|n| *n > 0.0)
                })
                .collect(),
            in_contact: rows.map(|at| is(&touching, at)).collect(),
        })
    }

    /// Equation (6) fitted where the tip slides.
    pub fn friction(&self) -> Option<ContactFriction> {
        contact_friction::contact_friction(&self.opposing, &self.normal, &self.usable)
    }
}

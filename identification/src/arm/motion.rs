//! Positions of all joints thinned and differentiated: the states that the rigid bodies'
//! torques are functions of.

use ferntast_model::Joints;

use super::data::{ArmDataset, ArmSession};
use crate::data::{Dataset, JointType, RecordedSession};
use crate::numerics::filter::thin;
use crate::signals::Filters;

/// States of all joints at the working rate.
pub(super) struct States {
    pub(super) q: Vec<Joints<f64>>,
    pub(super) qd: Vec<Joints<f64>>,
    pub(super) qdd: Vec<Joints<f64>>,
}

/// The recordings at the working rate, with their states.
pub(super) struct Motion {
    /// Thinned.
    pub(super) sessions: Vec<ArmSession>,
    pub(super) states: Vec<States>,
    /// How many of these are fitted; the others are held out.
    pub(super) fitted: usize,
}

impl Motion {
    /// Thins and differentiates; each joint is smoothed as its own noise needs.
    pub(super) fn new(dataset: &ArmDataset, kinds: impl Fn(usize) -> JointType) -> Self {
        let filters: Vec<Filters> = (0..dataset.joints.len())
            .map(|joint| {
                let own = |session: &ArmSession| RecordedSession {
                    period: session.period,
                    position: session.position.get(joint).cloned().unwrap_or_default(),
                    ..RecordedSession::default()
                };
                let joint = Dataset {
                    sessions: dataset.sessions.iter().map(own).collect(),
                    held_out: dataset.held_out.iter().map(own).collect(),
                    joint: kinds(joint),
                    filter: dataset.filter,
                };
                Filters::at_cut_off(&joint, 1.0)
            })
            .collect();
        let thinned = |session: &ArmSession| {
            let by = (filters.first()).map_or(1, |filters| filters.thinning(session.period));
            let all = |signals: &[Vec<f64>]| signals.iter().map(|own| thin(own, by)).collect();
            ArmSession {
                name: session.name.clone(),
                start: session.start,
                into_recording: session.into_recording,
                conditions: session.conditions.clone(),
                period: session.period * by as f64,
                position: all(&session.position),
                motor_torque: all(&session.motor_torque),
            }
        };
        let all = dataset.sessions.iter().chain(&dataset.held_out);
        let sessions: Vec<ArmSession> = all.map(thinned).collect();
        Self {
            states: sessions
                .iter()
                .map(|session| States::new(session, &filters))
                .collect(),
            sessions,
            fitted: dataset.sessions.len(),
        }
    }
}

impl States {
    fn new(session: &ArmSession, filters: &[Filters]) -> Self {
        let derivatives: Vec<[Vec<f64>; 3]> = (session.position.iter().zip(filters))
            .map(|(position, filters)| {
                let kernels = filters.state_kernels(filters.state, session.period);
                kernels.map(|kernel| kernel.everywhere(position))
            })
            .collect();
        let samples = session.position.first().map_or(0, Vec::len);
        let order = |order: usize| -> Vec<Joints<f64>> {
            let at = |sample: usize| {
                let values: Vec<f64> = (derivatives.iter())
                    .map(|own| own[order].get(sample).copied().unwrap_or(0.0))
                    .collect();
                Joints::from_slice(&values).ok()
            };
            (0..samples).filter_map(at).collect()
        };
        Self {
            q: order(0),
            qd: order(1),
            qdd: order(2),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.q.len()
    }
}

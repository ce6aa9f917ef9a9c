//! Positions of all joints thinned and differentiated: the states that the rigid bodies'
//! torques are functions of.

use ferntast_model::Joints;

use super::data::{ArmDataset, ArmSession};
use super::soft_gears::Winding;
use crate::data::{Dataset, JointType, RecordedSession};
use crate::numerics::filter::thin;
use crate::signals::Filters;

/// States of all joints at the working rate.
#[derive(Clone)]
pub(super) struct States {
    pub(super) q: Vec<Joints<f64>>,
    pub(super) qd: Vec<Joints<f64>>,
    pub(super) qdd: Vec<Joints<f64>>,
}

/// The recordings at the working rate, with their states.
pub(super) struct Motion {
    /// Thinned.
    pub(super) sessions: Vec<ArmSession>,
    /// Of each joint.
    filters: Vec<Filters>,
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
            filters,
            fitted: dataset.sessions.len(),
        }
    }

    /// States of the links where gears are wound up by `windings`.
    pub(super) fn states_behind(&self, windings: &[Winding]) -> Vec<States> {
        let sessions = self.sessions.iter().enumerate();
        let each = sessions.map(|(number, session)| {
            let mut behind = session.clone();
            for own in windings {
                let wound = own.by_session.get(number).into_iter().flatten();
                let positions = behind.position.get_mut(own.joint).into_iter().flatten();
                positions.zip(wound).for_each(|(q, wound)| *q -= wound);
            }
            States::new(&behind, &self.filters)
        });
        each.collect()
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

    /// The same with velocity and acceleration of one joint from `other`.
    pub(super) fn with_motion_of(mut self, joint: usize, other: &States) -> States {
        let qd = self.qd.iter_mut().zip(&other.qd);
        let qdd = self.qdd.iter_mut().zip(&other.qdd);
        qd.chain(qdd)
            .for_each(|(own, other)| own[joint] = other[joint]);
        self
    }

    pub(super) fn len(&self) -> usize {
        self.q.len()
    }
}

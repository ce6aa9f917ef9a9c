//! Links behind soft gears, which are not where their motors are.
//!
//! A gear that is soft in the model of its joint winds up under the torque of the links: by y/M, y of
//! [`load_elasticity`](mod@crate::effects) and M the mean inertia that the joint turns. The other
//! joints feel the links where they are, swings and all; the joint itself has the winding in its own
//! model. Inertias are those of the links as they are believed, without the effects of the arm.

use ferntast_model::friction::Unmeasured;
use ferntast_model::rigid_body::Chain;

use super::joint::ArmJoint;
use super::motion::States;
use crate::data::Term;
use crate::effects;

/// Whether an effect moves links from where the motors of their joints are, which the other joints feel.
pub(super) fn moves_links(effect: &Term) -> bool {
    let own = effects::find(effect.name());
    own.is_some_and(|own| own.row().of_unmeasured == Some(Unmeasured::Load))
}

/// Inertias \[kg m²\] or \[kg\] of the links that each joint turns, the others held.
pub(super) struct TurnedInertias {
    /// Of each joint, over all recordings.
    mean: Vec<f64>,
    /// Over the mean, by session, joint and sample \[-\].
    relative: Vec<Vec<Vec<f64>>>,
}

impl TurnedInertias {
    /// In the postures of all recordings, without armatures.
    pub(super) fn new(chain: &Chain, recordings: &[States]) -> Self {
        let joints = chain.count().get();
        let of_links = |states: &States| {
            let mut all = vec![Vec::with_capacity(states.len()); joints];
            for q in &states.q {
                let mass = chain.mass_matrix(q);
                for (joint, own) in all.iter_mut().enumerate() {
                    own.push(mass[(joint, joint)] - chain.armature()[joint]);
                }
            }
            all
        };
        let mut relative: Vec<Vec<Vec<f64>>> = recordings.iter().map(of_links).collect();
        let samples: usize = recordings.iter().map(States::len).sum();
        let mean = (0..joints).map(|joint| {
            let sum: f64 = relative.iter().flat_map(|own| &own[joint]).sum();
            let mean = sum / samples.max(1) as f64;
            let each = relative.iter_mut().flat_map(|own| &mut own[joint]);
            each.for_each(|own| *own = if mean > 0.0 { *own / mean } else { 1.0 });
            mean
        });
        Self {
            mean: mean.collect(),
            relative,
        }
    }

    /// Of joint number `joint` over its mean, at every sample of a session \[-\].
    pub(super) fn relative(&self, session: usize, joint: usize) -> Option<&[f64]> {
        let of_joint = self.relative.get(session)?.get(joint)?;
        Some(of_joint)
    }

    /// How far the gear of joint number `at` is wound up, at every sample of each recording
    /// \[rad\] or \[m\]; `None` where it is stiff in the joint's model.
    pub(super) fn winding(&self, at: usize, joint: &ArmJoint) -> Option<Winding> {
        let prepared = &joint.prepared;
        let mean = self.mean.get(at).filter(|mean| **mean > 0.0)?;
        let of_term = prepared.terms.iter().find_map(|term| {
            let sessions = prepared.sessions.iter().chain(&prepared.held_out);
            let wound = sessions.map(|own| term.effect.winding(&term.shape, &own.points));
            wound.collect::<Option<Vec<Vec<f64>>>>()
        });
        let mut by_session = of_term?;
        let each = by_session.iter_mut().flatten();
        each.for_each(|own| *own /= mean);
        Some(Winding {
            joint: at,
            by_session,
        })
    }
}

/// How far one joint's gear is wound up.
pub(super) struct Winding {
    /// Number of the joint.
    pub(super) joint: usize,
    /// At every sample of each session \[rad\] or \[m\].
    pub(super) by_session: Vec<Vec<f64>>,
}

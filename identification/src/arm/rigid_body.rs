//! The torques that an arm's links take, with what effects of the arm change in bodies, gravity and
//! where joints are.

use ferntast_model::Joints;
use ferntast_model::rigid_body::{Chain, LINK_PARAMETERS, LinkInertia, Regressor, Vector3};

use super::motion::States;

/// Links, zeros of joints and gravity, corrected.
#[derive(Clone)]
pub(super) struct RigidBody<'a> {
    chain: &'a Chain,
    /// In the base frame \[m/s²\].
    pub(super) gravity: Vector3<f64>,
    /// Ten inertial parameters for each link, from the base on.
    pub(super) parameters: Vec<f64>,
    /// What is added to each joint's position \[rad\] or \[m\].
    pub(super) zeros: Vec<f64>,
}

impl<'a> RigidBody<'a> {
    pub(super) fn new(chain: &'a Chain, gravity: Vector3<f64>) -> Self {
        let inertias = chain.inertias();
        Self {
            chain,
            gravity,
            parameters: inertias.iter().flat_map(|own| own.parameters()).collect(),
            zeros: vec![0.0; chain.count().get()],
        }
    }

    /// How many joints.
    pub(super) fn joints(&self) -> usize {
        self.chain.count().get()
    }

    /// Regressor rows of each joint at one sample.
    pub(super) fn regressor(&self, states: &States, at: usize) -> Regressor {
        let q = farther(&states.q[at], &self.zeros);
        let (qd, qdd) = (&states.qd[at], &states.qdd[at]);
        self.chain.torque_regressor(&q, qd, qdd, &self.gravity)
    }

    /// What `gravity` alone takes of each joint, at rest at every sample \[Nm\].
    pub(super) fn weights(&self, states: &States, gravity: &Vector3<f64>) -> Vec<Vec<f64>> {
        let rest = Joints::filled(self.chain.count(), 0.0);
        self.taken(states, gravity, |_| (&rest, &rest))
    }

    /// τ of each joint at every sample, without armatures \[Nm\].
    pub(super) fn torques(&self, states: &States) -> Vec<Vec<f64>> {
        self.taken(states, &self.gravity, |at| {
            (&states.qd[at], &states.qdd[at])
        })
    }

    /// What the links take of each joint where they are, with the velocities and accelerations of `motion`.
    fn taken<'s>(
        &self,
        states: &States,
        gravity: &Vector3<f64>,
        motion: impl Fn(usize) -> (&'s Joints<f64>, &'s Joints<f64>),
    ) -> Vec<Vec<f64>> {
        let mut torques = vec![Vec::with_capacity(states.len()); self.joints()];
        let ready = Ready {
            gravity: *gravity,
            ..self.ready()
        };
        for at in 0..states.len() {
            let (qd, qdd) = motion(at);
            let own = ready.torques_at(&states.q[at], qd, qdd);
            for (torque, own) in torques.iter_mut().zip(own.iter()) {
                torque.push(*own);
            }
        }
        torques
    }

    /// With these links and no armatures.
    pub(super) fn ready(&self) -> Ready<'_> {
        let count = self.chain.count();
        let links = Joints::from_fn(count, |at| self.link(at));
        let chain = self.chain.clone().with_inertias(&links);
        let chain = chain.and_then(|own| own.with_armature(&Joints::filled(count, 0.0)));
        Ready {
            // There is one of each for every joint.
            chain: chain.unwrap_or_else(|_| self.chain.clone()),
            gravity: self.gravity,
            zeros: &self.zeros,
        }
    }

    /// One link.
    pub(super) fn link(&self, link: usize) -> LinkInertia {
        let first = Self::first_of(link);
        let own = self.parameters.get(first..first + LINK_PARAMETERS);
        let own = own.and_then(|own| <[f64; LINK_PARAMETERS]>::try_from(own).ok());
        own.map_or_else(LinkInertia::zero, |own| LinkInertia::from_parameters(&own))
    }

    /// Number of the first parameter of a link.
    pub(super) const fn first_of(link: usize) -> usize {
        LINK_PARAMETERS * link
    }
}

/// Links and gravity as they are, to be moved.
pub(super) struct Ready<'a> {
    chain: Chain,
    gravity: Vector3<f64>,
    zeros: &'a [f64],
}

impl Ready<'_> {
    /// What the links take of each joint in one motion \[Nm\].
    pub(super) fn torques_at(
        &self,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
    ) -> Joints<f64> {
        let q = farther(q, self.zeros);
        self.chain.inverse_dynamics(&q, qd, qdd, &self.gravity)
    }
}

/// Where joints are whose positions say q \[rad\] or \[m\].
fn farther(q: &Joints<f64>, zeros: &[f64]) -> Joints<f64> {
    let mut q = *q;
    let each = q.iter_mut().zip(zeros);
    each.for_each(|(own, zero)| *own += zero);
    q
}

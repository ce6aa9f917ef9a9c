//! The torques that an arm's links take, with what effects of the arm change.

use ferntast_model::Joints;
use ferntast_model::rigid_body::{Chain, LINK_PARAMETERS, LinkInertia, Regressor, Vector3};

use super::motion::States;

/// Links and gravity, corrected.
#[derive(Clone)]
pub(super) struct RigidBody<'a> {
    chain: &'a Chain,
    /// In the base frame \[m/s²\].
    pub(super) gravity: Vector3<f64>,
    /// Ten inertial parameters for each link, from the base on.
    pub(super) parameters: Vec<f64>,
}

impl<'a> RigidBody<'a> {
    pub(super) fn new(chain: &'a Chain, gravity: Vector3<f64>) -> Self {
        let inertias = chain.inertias();
        Self {
            chain,
            gravity,
            parameters: inertias.iter().flat_map(|own| own.parameters()).collect(),
        }
    }

    /// How many joints.
    pub(super) fn joints(&self) -> usize {
        self.chain.count().get()
    }

    /// Regressor rows of each joint at one sample, in the gravity given.
    pub(super) fn regressor(
        &self,
        states: &States,
        at: usize,
        gravity: &Vector3<f64>,
    ) -> Regressor {
        let (q, qd, qdd) = (&states.q[at], &states.qd[at], &states.qdd[at]);
        self.chain.torque_regressor(q, qd, qdd, gravity)
    }

    /// What `gravity` alone takes of each joint, at rest \[Nm\].
    pub(super) fn weight(&self, states: &States, at: usize, gravity: &Vector3<f64>) -> Vec<f64> {
        let rest = Joints::filled(self.chain.count(), 0.0);
        let rows = (self.chain).torque_regressor(&states.q[at], &rest, &rest, gravity);
        self.torque_of(&rows)
    }

    fn torque_of(&self, rows: &Regressor) -> Vec<f64> {
        let of = |joint: usize| {
            let parameters = self.parameters.iter().enumerate();
            parameters.map(|(at, own)| rows[(joint, at)] * own).sum()
        };
        (0..self.joints()).map(of).collect()
    }

    /// τ of each joint at every sample, without armatures \[Nm\].
    pub(super) fn torques(&self, states: &States) -> Vec<Vec<f64>> {
        let mut torques = vec![Vec::with_capacity(states.len()); self.joints()];
        for at in 0..states.len() {
            let rows = self.regressor(states, at, &self.gravity);
            for (torque, own) in torques.iter_mut().zip(self.torque_of(&rows)) {
                torque.push(own);
            }
        }
        torques
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

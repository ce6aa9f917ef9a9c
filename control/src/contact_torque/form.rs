//! The forms of equation (5): how motion and joint torques tell the torque of the
//! contact, Jᵀ F.

use super::{
    DerivativeFilter, filtered_motion::FilteredMotion, links::Links, observer::MomentumObserver,
};
use ferntast_model::{JointCount, Joints};
use serde::{Deserialize, Serialize};

/// How the contact's torque is found from joint torques and motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// Equation (5) as it stands, with the filtered acceleration:
    /// Jᵀ F = M(q) q̈ + C(q, q̇) q̇ + g(q) − τ.
    #[default]
    Direct,
    /// The momentum p = M(q) q̇ is observed: what changes it and is neither
    /// joint torque nor ∂L/∂q is the contact. Needs no acceleration.
    MomentumObserver,
    /// As direct, with joint torques by the motors' currents in place of torque sensors:
    /// see [`TorqueByMotorCurrent`](crate::estimator::TorqueByMotorCurrent).
    MotorCurrent,
}

/// Link positions and joint torques of all joints, filtered alike.
#[derive(Clone, Copy, Debug)]
struct Channels {
    positions: Joints<DerivativeFilter>,
    torques: Joints<DerivativeFilter>,
}

impl Channels {
    fn new(joints: JointCount, filter: DerivativeFilter) -> Self {
        Self {
            positions: Joints::filled(joints, filter),
            torques: Joints::filled(joints, filter),
        }
    }

    /// Both lists of filters with what goes into each.
    fn each<'a>(
        &'a mut self,
        position: &'a Joints<f64>,
        torque: &'a Joints<f64>,
    ) -> impl Iterator<Item = (&'a mut DerivativeFilter, f64)> {
        let positions = self.positions.iter_mut().zip(position.iter().copied());
        positions.chain(self.torques.iter_mut().zip(torque.iter().copied()))
    }
}

/// With half the delay of one of `cut_off` \[Hz\], where something as late comes behind it.
pub(crate) fn half_as_late(cut_off: f64) -> DerivativeFilter {
    DerivativeFilter::new(2.0 * cut_off)
}

/// Filters all channels alike and computes the torque of the contact.
#[derive(Clone, Debug)]
pub(crate) struct TorqueOfContact {
    channels: Channels,
    observer: Option<MomentumObserver>,
    /// How late the motion is, and how late everything is [s].
    motion_delay: f64,
    delay: f64,
}

impl TorqueOfContact {
    /// Each form with the same delay, which `cut_off` \[Hz\] decides on.
    ///
    /// The observer is itself a low-pass of first order. It gets the cut-off
    /// asked for, and the filters before it twice that: their delays, 1/ω and
    /// 2/(2ω), add up to the 2/ω that the direct form's filters have. Torques by motor
    /// currents come through filters of their own: those and these have twice the cut-off.
    pub(crate) fn new(form: Form, cut_off: f64, joints: JointCount) -> Self {
        let (filter, observer) = match form {
            Form::Direct => (DerivativeFilter::new(cut_off), None),
            Form::MomentumObserver => (
                half_as_late(cut_off),
                Some(MomentumObserver::new(cut_off, joints)),
            ),
            Form::MotorCurrent => (half_as_late(cut_off), None),
        };
        let delay = DerivativeFilter::new(cut_off).delay();
        Self {
            channels: Channels::new(joints, filter),
            motion_delay: match observer {
                None => delay,
                Some(_) => filter.delay(),
            },
            observer,
            delay,
        }
    }

    /// How late everything is \[s\].
    pub(crate) fn delay(&self) -> f64 {
        self.delay
    }

    /// Starts again, at rest at link positions `position` \[rad\] under `torque` \[Nm\].
    pub(crate) fn reset(
        &mut self,
        links: &impl Links,
        position: &Joints<f64>,
        torque: &Joints<f64>,
    ) {
        for (filter, value) in self.channels.each(position, torque) {
            filter.reset(value);
        }
        if let Some(observer) = &mut self.observer {
            observer.reset(links, position, torque);
        }
    }

    /// Takes in link positions \[rad\] and joint torques \[Nm\], `dt` \[s\] after the last ones.
    pub(crate) fn step(&mut self, dt: f64, position: &Joints<f64>, torque: &Joints<f64>) {
        for (filter, value) in self.channels.each(position, torque) {
            filter.step(value, dt);
        }
    }

    /// Motion and torque of the contact, after [`step`](Self::step) or
    /// [`reset`](Self::reset).
    pub(crate) fn motion(&mut self, links: &impl Links, dt: f64) -> FilteredMotion {
        let channels = &self.channels;
        let channel =
            |read: fn(&DerivativeFilter) -> f64, from: &Joints<DerivativeFilter>| from.map(read);
        let position = channel(DerivativeFilter::value, &channels.positions);
        let velocity = channel(DerivativeFilter::first, &channels.positions);
        let acceleration = channel(DerivativeFilter::second, &channels.positions);
        let torque = channel(DerivativeFilter::value, &channels.torques);
        let present_velocity = Joints::from_fn(velocity.count(), |joint| {
            velocity[joint] + acceleration[joint] * self.motion_delay
        });
        match &mut self.observer {
            None => {
                let needed = links.inverse_dynamics(&position, &velocity, &acceleration);
                FilteredMotion {
                    position,
                    velocity,
                    present_velocity,
                    contact_torque: Joints::from_fn(needed.count(), |joint| {
                        needed[joint] - torque[joint]
                    }),
                }
            }
            Some(observer) => FilteredMotion {
                present_velocity,
                ..observer.step(links, dt, &position, &velocity, &torque)
            },
        }
    }
}

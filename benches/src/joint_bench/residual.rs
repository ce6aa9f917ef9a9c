//! What a model leaves unexplained on a bench recording, by equation (2):
//! τ_m − J q̈ − τ − τ_F.
//!
//! For the author of a test: parameters are the true ones and nothing is
//! fitted. The lab has its own, which fits.

use super::{BenchRecording, BenchSession};
use crate::bench::{differentiate, rms, smooth};

/// Slower than this, the sign of the velocity is not known \[rad/s\].
const REST: f64 = 0.008;
/// Entries on either side of rest that do not count either.
const AROUND_REST: usize = 9;

/// Residual of one session over its log entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Filtered position \[rad\].
    pub position: Vec<f64>,
    /// Its derivative \[rad/s\].
    pub velocity: Vec<f64>,
    /// Its second derivative \[rad/s²\].
    pub acceleration: Vec<f64>,
    /// Filtered τ_m − J q̈ − τ − τ_F \[Nm\].
    pub torque: Vec<f64>,
    /// False near rest and within 0.1 s of it.
    pub used: Vec<bool>,
}

/// Friction of equation (4) that the believed model has, with true parameters.
struct Friction {
    b0: f64,
    b0t: f64,
    b1: f64,
    b2: f64,
    b3: f64,
}

impl Friction {
    fn of(recording: &BenchRecording) -> Self {
        let value = |id: &str, name: &str| {
            if recording.believed.effects.contains(&id) {
                recording.joint_parameter(name)
            } else {
                0.0
            }
        };
        Friction {
            b0: value("coulomb", "b0"),
            b0t: value("load_coulomb", "b0T"),
            b1: value("viscous", "b1"),
            b2: value("quadratic_viscous", "b2"),
            b3: value("cubic_viscous", "b3"),
        }
    }

    fn torque(&self, velocity: f64, load: f64) -> f64 {
        let coulomb = (self.b0 + self.b0t * load.abs()) * velocity.signum();
        coulomb + velocity * (self.b1 + velocity.abs() * self.b2 + velocity * velocity * self.b3)
    }
}

fn used(velocity: &[f64]) -> Vec<bool> {
    let count = velocity.len();
    let mut used = vec![true; count];
    for index in 0..count {
        let reversal = index > 0 && velocity[index] * velocity[index - 1] <= 0.0;
        if reversal || velocity[index].abs() < REST {
            let to = (index + AROUND_REST).min(count);
            used[index.saturating_sub(AROUND_REST)..to].fill(false);
        }
    }
    // Filter and differences are not at home at the ends.
    let edge = AROUND_REST.min(count);
    used[..edge].fill(false);
    used[count - edge..].fill(false);
    used
}

impl BenchRecording {
    fn residual(&self, position: &[f64], motor_torque: &[f64], joint_torque: &[f64]) -> Residual {
        let friction = Friction::of(self);
        let position = smooth(position);
        let velocity = differentiate(&position);
        let acceleration = differentiate(&velocity);
        let (motor, joint) = (smooth(motor_torque), smooth(joint_torque));
        // Friction is filtered like the rest, so that its step is no spike.
        let believed: Vec<f64> = velocity
            .iter()
            .zip(&joint)
            .map(|(&velocity, &load)| friction.torque(velocity, load))
            .collect();
        let believed = smooth(&believed);
        let torque = (0..position.len())
            .map(|index| {
                let inertial = self.believed.inertia * acceleration[index];
                motor[index] - inertial - joint[index] - believed[index]
            })
            .collect();
        Residual {
            used: used(&velocity),
            position,
            velocity,
            acceleration,
            torque,
        }
    }

    /// Residual of the believed model, with true parameters, on what was logged.
    pub fn believed_residual(&self, session: &BenchSession) -> Residual {
        self.residual(
            &session.position,
            &session.motor_torque,
            &session.joint_torque,
        )
    }

    /// The hidden effects' own part of it: without noise and without what
    /// parameters scatter by between sessions.
    pub fn own_part(&self, session: &BenchSession) -> Residual {
        let truth = &session.truth;
        let mut own = self.residual(&truth.position, &truth.motor_torque, &truth.joint_torque);
        for (torque, scatter) in own.torque.iter_mut().zip(smooth(&truth.scatter)) {
            *torque -= scatter;
        }
        own
    }

    /// rms \[Nm\] over all sessions of `part`, which gives one value a log entry.
    fn rms_of(&self, part: impl Fn(&BenchSession) -> (Vec<f64>, Vec<bool>)) -> f64 {
        rms(self.sessions.iter().flat_map(|session| {
            let (torque, used) = part(session);
            torque
                .into_iter()
                .zip(used)
                .filter_map(|(torque, used)| used.then_some(torque))
        }))
    }

    /// rms \[Nm\] of the believed model's residual, with true parameters.
    pub fn believed_rms(&self) -> f64 {
        self.rms_of(|session| {
            let residual = self.believed_residual(session);
            (residual.torque, residual.used)
        })
    }

    /// rms \[Nm\] that the true model, with its nominal parameters, leaves:
    /// noise and scatter between sessions. Low-pass at 8 Hz, rest and reversals masked.
    pub fn reference_rms(&self) -> f64 {
        self.rms_of(|session| {
            let residual = self.believed_residual(session);
            let own = self.own_part(session);
            let rest = residual.torque.iter().zip(&own.torque);
            (rest.map(|(all, own)| all - own).collect(), residual.used)
        })
    }

    /// rms \[Nm\] of the filtered sensor noise.
    pub fn noise_rms(&self) -> f64 {
        self.rms_of(|session| {
            let residual = self.believed_residual(session);
            let truth = &session.truth;
            let exact = self.residual(&truth.position, &truth.motor_torque, &truth.joint_torque);
            let noise = residual.torque.iter().zip(&exact.torque);
            (noise.map(|(all, exact)| all - exact).collect(), exact.used)
        })
    }

    /// ρ: rms of the hidden effects' own part over the rms of the filtered
    /// sensor noise; infinite without noise. A fit of the believed model takes
    /// a share of the own part away.
    pub fn visibility(&self) -> f64 {
        let own = self.rms_of(|session| {
            let own = self.own_part(session);
            (own.torque, own.used)
        });
        own / self.noise_rms()
    }
}

//! The arm behind its servo, as the tip shows it: a mass that a spring and a
//! damper pull to where it is commanded, the same along both axes.

use super::TICK;
use super::environment::{Environment, Surface};
use super::follower::{Follower, TipCommand, TrueTip};
use ferntast_control::link::{FollowerReadings, StampedPosition};
use ferntast_control::operating::OperatingState;
use ferntast_model::parameters;

/// The tip is sent no further from the surface than this [m].
const WORKSPACE: f64 = 0.5;

/// Steps of the dynamics in a tick of the laws.
const SUBSTEPS: u32 = 4;

parameters! {
    /// The servo: mass, natural frequency, damping ratio. By default its spring has
    /// 6.75 kN/m: a stiff position servo of a light arm; presses with up to 67 N.
    #[derive(Copy)]
    pub struct TipParameters {
        /// Mass at the tip \[kg\].
        pub mass: f64 [1e-3..=100.0, "kg"] = 0.3,
        /// Natural frequency \[rad/s\].
        pub frequency: f64 [1.0..=1000.0, "rad/s"] = 150.0,
        /// Damping ratio \[-\].
        pub damping_ratio: f64 [0.0..=10.0, "-"] = 1.0,
        /// How far the servo's spring lets itself be stretched \[m\]: bounds how
        /// hard the tip presses.
        pub reach: f64 [1e-4..=1.0, "m"] = 0.01,
    }
}

/// The tip with what it touches, from the surface's origin on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    parameters: TipParameters,
    surface: Surface,
    origin: [f64; 2],
    position: [f64; 2],
    velocity: [f64; 2],
    command: [f64; 2],
    /// Of the contact on the tip [N].
    force: [f64; 2],
    /// Of the contact on the tip [J].
    work: f64,
    now_ns: i64,
}

impl Tip {
    /// At rest at `position` \[m\] from the surface's `origin`.
    pub(super) fn new(
        parameters: TipParameters,
        environment: Environment,
        origin: [f64; 2],
        position: [f64; 2],
    ) -> Self {
        Tip {
            parameters,
            surface: Surface::new(environment),
            origin,
            position,
            velocity: [0.0; 2],
            command: position,
            force: [0.0; 2],
            work: 0.0,
            now_ns: 0,
        }
    }

    /// Moves on by `dt` \[s\]; the surface began to move `time` \[s\] ago.
    fn advance(&mut self, dt: f64, time: f64) {
        let TipParameters {
            mass,
            frequency,
            damping_ratio,
            reach,
        } = self.parameters;
        let stiffness = mass * frequency * frequency;
        let damping = 2.0 * damping_ratio * mass * frequency;
        let part = dt / f64::from(SUBSTEPS);
        for k in 0..SUBSTEPS {
            let axes = self.position.iter_mut().zip(&mut self.velocity);
            for ((position, velocity), (command, force)) in
                axes.zip(self.command.iter().zip(&self.force))
            {
                let stretch = (command - *position).clamp(-reach, reach);
                let pull = stiffness * stretch + force;
                // Implicit in the damper.
                *velocity = (mass * *velocity + part * pull) / (mass + part * damping);
                *position += part * *velocity;
                self.work += force * part * *velocity;
            }
            let since = time + f64::from(k + 1) * part;
            self.force = self.surface.step(part, since, self.position, self.velocity);
        }
    }
}

impl Follower for Tip {
    fn step(&mut self, now_ns: i64, since: f64, command: Option<TipCommand>) {
        if let Some(command) = command {
            self.command = [0, 1].map(|axis: usize| {
                (command.position[axis] - self.origin[axis]).clamp(-WORKSPACE, WORKSPACE)
            });
        }
        self.now_ns = now_ns;
        self.advance(TICK, since);
    }

    fn truth(&self) -> TrueTip {
        TrueTip {
            position: self.position,
            force: self.force,
            work: self.work,
        }
    }

    fn readings(&self) -> FollowerReadings {
        let [x, y] = [0, 1].map(|axis: usize| self.origin[axis] + self.position[axis]);
        FollowerReadings {
            tip: Some(StampedPosition {
                stamp_ns: self.now_ns,
                position: [x, y, 0.0],
                silence: 0.0,
            }),
            contact_force: Some([self.force[0], self.force[1], 0.0]),
            state: OperatingState::Enabled,
            told_to_stop: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_where_it_is_told_and_presses_by_springs_in_series() {
        let mut tip = Tip::new(
            TipParameters::default(),
            Environment::HardWall,
            [0.3, 0.0],
            [-0.01, 0.0],
        );
        let to = |x, y| {
            Some(TipCommand {
                made_ns: 1,
                position: [0.3 + x, y, 0.0],
            })
        };
        for _ in 0..1000 {
            tip.step(1, -1.0, to(-0.002, 0.001));
        }
        assert!((tip.position[0] + 0.002).abs() < 1e-9, "{tip:?}");
        assert!((tip.position[1] - 0.001).abs() < 1e-9, "{tip:?}");
        for _ in 0..1000 {
            tip.step(1, -1.0, to(0.004, 0.001));
        }
        // 4 mm · 6750 · 20000 / 26750.
        let expected = 0.004 * 6750.0 * 20_000.0 / 26_750.0;
        assert!((tip.force[0] + expected).abs() < 1e-3 * expected, "{tip:?}");
    }

    #[test]
    fn it_presses_no_harder_than_it_may() {
        let mut tip = Tip::new(
            TipParameters::default(),
            Environment::HardWall,
            [0.3, 0.0],
            [-0.01, 0.0],
        );
        let to = |x, y| {
            Some(TipCommand {
                made_ns: 1,
                position: [0.3 + x, y, 0.0],
            })
        };
        for _ in 0..2000 {
            tip.step(1, -1.0, to(0.5, 0.0));
        }
        assert!((tip.force[0] + 67.5).abs() < 0.1, "{tip:?}");
    }
}

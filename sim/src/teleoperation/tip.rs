//! The arm behind its servo, as the tip shows it: a mass that a spring and a
//! damper pull to where it is commanded, the same along both axes.

use super::environment::{Environment, Surface};
use ferntast_model::parameters;

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

/// The tip with what it touches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    parameters: TipParameters,
    surface: Surface,
    pub position: [f64; 2],
    pub velocity: [f64; 2],
    /// Of the contact on the tip [N].
    pub force: [f64; 2],
}

impl Tip {
    /// At rest at `position` \[m\].
    pub(super) fn new(
        parameters: TipParameters,
        environment: Environment,
        position: [f64; 2],
    ) -> Self {
        Tip {
            parameters,
            surface: Surface::new(environment),
            position,
            velocity: [0.0; 2],
            force: [0.0; 2],
        }
    }

    /// Moves on by `dt` \[s\] towards `command` \[m\]; the surface began to
    /// move `time` \[s\] ago.
    pub(super) fn step(&mut self, dt: f64, time: f64, command: [f64; 2]) {
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
                axes.zip(command.iter().zip(&self.force))
            {
                let stretch = (command - *position).clamp(-reach, reach);
                let pull = stiffness * stretch + force;
                // Implicit in the damper.
                *velocity = (mass * *velocity + part * pull) / (mass + part * damping);
                *position += part * *velocity;
            }
            let since = time + f64::from(k + 1) * part;
            self.force = self.surface.step(part, since, self.position, self.velocity);
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
            [-0.01, 0.0],
        );
        for _ in 0..1000 {
            tip.step(1e-3, -1.0, [-0.002, 0.001]);
        }
        assert!((tip.position[0] + 0.002).abs() < 1e-9, "{tip:?}");
        assert!((tip.position[1] - 0.001).abs() < 1e-9, "{tip:?}");
        for _ in 0..1000 {
            tip.step(1e-3, -1.0, [0.004, 0.001]);
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
            [-0.01, 0.0],
        );
        for _ in 0..2000 {
            tip.step(1e-3, -1.0, [0.5, 0.0]);
        }
        assert!((tip.force[0] + 67.5).abs() < 0.1, "{tip:?}");
    }
}

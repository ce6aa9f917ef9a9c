//! How a scripted hand turns: to and fro about one axis.

use ferntast_model::parameters;

parameters! {
    /// Turning to and fro.
    #[derive(Copy)]
    pub struct TurnParameters {
        /// How far it turns, as a rotation vector, leader base frame \[rad\].
        pub amplitude: [f64; 3] [-3.0..=3.0, "rad"],
        /// Time from there to there again \[s\].
        pub period: f64 [0.1..=3600.0, "s"],
    }
}

/// A hand that turns; as it begins it is not turned.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    parameters: TurnParameters,
    time: f64,
}

impl Turn {
    /// At its beginning.
    pub fn new(parameters: TurnParameters) -> Turn {
        Turn {
            parameters,
            time: 0.0,
        }
    }

    /// Moves on by `dt` \[s\]; gives the orientation as quaternion x, y, z, w.
    pub fn step(&mut self, dt: f64) -> [f64; 4] {
        self.time += dt;
        let phase = std::f64::consts::TAU * self.time / self.parameters.period;
        let [x, y, z] = self.parameters.amplitude.map(|own| own * phase.sin());
        let angle = (x * x + y * y + z * z).sqrt();
        // sin(angle/2)/angle, also at zero.
        let share = match angle < 1e-9 {
            true => 0.5,
            false => (0.5 * angle).sin() / angle,
        };
        [x * share, y * share, z * share, (0.5 * angle).cos()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_turns_as_far_as_it_says_and_back() {
        let mut turn = Turn::new(TurnParameters {
            amplitude: [0.0, 0.3, 0.4],
            period: 4.0,
        });
        let mut after = |steps: u32| (0..steps).fold([0.0; 4], |_, _| turn.step(1e-3));
        let [x, y, z, w] = after(1000);
        let half = 0.25_f64;
        assert!((y - 0.6 * half.sin()).abs() < 1e-9 && (z - 0.8 * half.sin()).abs() < 1e-9);
        assert!(x == 0.0 && (w - half.cos()).abs() < 1e-9);
        let [_, y, _, w] = after(1000);
        assert!(y.abs() < 1e-9 && (w - 1.0).abs() < 1e-9);
    }
}

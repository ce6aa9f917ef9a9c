//! A joint swings freely: the paper's trajectory "sinusoidal" (Fig. 9).

use super::{Program, Seen, Target, advance};
use ferntast_model::{ParameterError, check};
use ferntast_sim::arm::JOINTS;
use std::f64::consts::TAU;

/// q = q_0 + A sin(2π f t), one frequency after the other.
#[derive(Clone, Debug)]
pub struct SineMotion {
    center: [f64; JOINTS],
    amplitude: [f64; JOINTS],
    /// Frequency [Hz] and begin of each piece [s].
    pieces: Vec<(f64, f64)>,
    duration: f64,
    current: usize,
}

impl SineMotion {
    /// Swings around `center` \[rad\] with `amplitude` \[rad\], whole periods of
    /// each of `frequencies` \[Hz\] for about `time_per_frequency` \[s\].
    ///
    /// # Errors
    ///
    /// A number out of its bounds, or no frequency at all.
    pub fn new(
        center: [f64; JOINTS],
        amplitude: [f64; JOINTS],
        frequencies: &[f64],
        time_per_frequency: f64,
    ) -> Result<Self, ParameterError> {
        check(
            "number of frequencies",
            frequencies.len() as f64,
            1.0,
            100.0,
            "-",
        )?;
        check("time_per_frequency", time_per_frequency, 0.5, 1000.0, "s")?;
        for &value in &amplitude {
            check("amplitude", value, -1.0, 1.0, "rad")?;
        }
        let (mut pieces, mut now): (Vec<(f64, f64)>, f64) = (Vec::new(), 0.0);
        for &frequency in frequencies {
            check("frequency", frequency, 0.01, 5.0, "Hz")?;
            let periods = (time_per_frequency * frequency).round().max(1.0);
            pieces.push((frequency, now));
            now += periods / frequency;
        }
        Ok(SineMotion {
            center,
            amplitude,
            pieces,
            duration: now,
            current: 0,
        })
    }
}

impl Program for SineMotion {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn target(&mut self, time: f64, _: f64, _: &Seen) -> Target {
        advance(&self.pieces, &mut self.current, time, |piece| piece.1);
        let sine = self
            .pieces
            .get(self.current)
            .map_or(0.0, |(frequency, start)| {
                (TAU * frequency * (time - start)).sin()
            });
        Target::Joints([0, 1].map(|joint: usize| self.center[joint] + sine * self.amplitude[joint]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_swings_with_its_amplitude_and_ends_in_the_middle() {
        let mut motion = SineMotion::new([0.0, 1.5], [0.1, -0.2], &[0.2, 0.5], 4.0).unwrap();
        assert!((motion.duration() - 9.0).abs() < 1e-9);
        let mut most = 0.0_f64;
        let mut last = 1.5;
        for k in 0..=9000 {
            let Target::Joints([first, second]) =
                motion.target(k as f64 * 1e-3, 1e-3, &Seen::default())
            else {
                continue;
            };
            assert!((first + 0.5 * (second - 1.5)).abs() < 1e-12);
            assert!(
                (second - last).abs() < 0.2 * TAU * 0.5 * 1e-3 + 1e-9,
                "no jump"
            );
            last = second;
            most = most.max(second - 1.5);
        }
        assert!((most - 0.2).abs() < 1e-6 && (last - 1.5).abs() < 1e-6);
    }
}

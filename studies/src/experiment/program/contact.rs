//! The tip slides along an edge, a sinusoid, while the normal force is held
//! (section "Contact dynamics experiments", Figs. 16 and 17).

use super::{Program, Seen, Target, advance};
use ferntast_model::{ParameterError, Vector2, check, contour::Feature};
use std::f64::consts::TAU;

/// Time to go to the surface and to press \[s\].
const APPROACH: f64 = 1.0;
const SETTLE: f64 = 1.5;
/// The tip waits that far off the surface \[m\].
const HOVER: f64 = 0.002;
/// Bandwidth of the loop that holds the normal force \[rad/s\].
const BANDWIDTH: f64 = 6.0;
/// Deepest command behind the surface \[m\].
const DEEPEST: f64 = 0.008;

/// One piece of the motion: a frequency at a normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// F_N that is held \[N\].
    pub force: f64,
    /// Frequency of sliding \[Hz\].
    pub frequency: f64,
}

/// Sinusoids along an edge, each at a constant normal force.
///
/// The depth z of the command behind the surface follows ż = (ω/k)(F − F_N),
/// with k the stiffness from command to force and ω the bandwidth.
#[derive(Clone, Debug)]
pub struct ContactMotion {
    edge: Feature,
    /// Middle of the motion along the edge [m], from the edge's middle.
    along: f64,
    amplitude: f64,
    /// Stiffness from the commanded depth to the force [N/m].
    stiffness: f64,
    /// Each with the time at which it begins [s].
    pieces: Vec<(Press, f64)>,
    duration: f64,
    current: usize,
    depth: f64,
}

impl ContactMotion {
    /// Along `edge` around `along` \[m\] with `amplitude` \[m\]; whole periods of
    /// each of `presses` for about `time_per_press` \[s\].
    ///
    /// # Errors
    ///
    /// A number out of its bounds, or nothing to do.
    pub fn new(
        edge: Feature,
        along: f64,
        amplitude: f64,
        stiffness: f64,
        presses: &[Press],
        time_per_press: f64,
    ) -> Result<Self, ParameterError> {
        check("number of presses", presses.len() as f64, 1.0, 100.0, "-")?;
        check("amplitude", amplitude, 1e-3, 0.1, "m")?;
        check("stiffness", stiffness, 1.0, 1e7, "N/m")?;
        check("time_per_press", time_per_press, 0.5, 1000.0, "s")?;
        let room = edge.half_length - amplitude;
        check(
            "middle of the motion along the edge",
            along,
            -room,
            room,
            "m",
        )?;
        let (mut pieces, mut now) = (Vec::new(), APPROACH + SETTLE);
        for press in presses {
            check("force", press.force, 1.0, 100.0, "N")?;
            check("frequency", press.frequency, 0.01, 2.0, "Hz")?;
            let periods = (time_per_press * press.frequency).round().max(1.0);
            pieces.push((*press, now));
            now += periods / press.frequency;
        }
        Ok(ContactMotion {
            edge,
            along,
            amplitude,
            stiffness,
            pieces,
            duration: now,
            current: 0,
            depth: -HOVER,
        })
    }
}

impl Program for ContactMotion {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn target(&mut self, time: f64, dt: f64, seen: &Seen) -> Target {
        advance(&self.pieces, &mut self.current, time, |piece| piece.1);
        let mut along = self.along;
        if let Some((press, start)) = self.pieces.get(self.current) {
            if time >= *start {
                // A sine that begins in the middle of the way.
                along += self.amplitude * (TAU * press.frequency * (time - start)).sin();
            }
            if time > APPROACH {
                let missing = press.force - seen.normal_force;
                self.depth =
                    (self.depth + BANDWIDTH / self.stiffness * missing * dt).clamp(-HOVER, DEEPEST);
            }
        }
        let tip: Vector2<f64> =
            self.edge.center + self.edge.tangent() * along - self.edge.normal * self.depth;
        Target::Tip([tip.x, tip.y])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::contact::ContactParameters;
    use ferntast_model::contour::{EdgeParameters, Surface};

    fn floor() -> Feature {
        EdgeParameters {
            surface: Surface::Lubricated,
            from: [-0.1, 0.0],
            to: [0.1, 0.0],
            contact: ContactParameters {
                stiffness: 2e4,
                damping: 0.0,
                friction: 0.0,
            },
        }
        .feature()
    }

    #[test]
    fn it_slides_its_amplitude_and_holds_the_force() {
        let press = Press {
            force: 20.0,
            frequency: 0.5,
        };
        let mut motion = ContactMotion::new(floor(), 0.01, 0.02, 1e4, &[press], 6.0).unwrap();
        let steps = (motion.duration() * 1e3) as usize;
        let (mut seen, mut least, mut most) = (Seen::default(), f64::MAX, f64::MIN);
        for k in 0..steps {
            let time = k as f64 * 1e-3;
            let Target::Tip([x, y]) = motion.target(time, 1e-3, &seen) else {
                continue;
            };
            // A surface at y = 0 behind a servo: 1e4 N/m in all.
            seen.normal_force = (-1e4 * y).max(0.0);
            (least, most) = (least.min(x), most.max(x));
            if time < APPROACH {
                assert!(y > 0.001, "not yet at the surface");
            }
            if time > APPROACH + SETTLE + 0.5 {
                assert!((seen.normal_force - 20.0).abs() < 0.5, "{time} s");
            }
        }
        assert!((least + 0.01).abs() < 1e-4 && (most - 0.03).abs() < 1e-4);
    }

    #[test]
    fn a_motion_beyond_the_edge_is_refused() {
        let press = Press {
            force: 20.0,
            frequency: 0.5,
        };
        assert!(ContactMotion::new(floor(), 0.09, 0.02, 1e4, &[press], 6.0).is_err());
        assert!(ContactMotion::new(floor(), 0.0, 0.02, 1e4, &[], 6.0).is_err());
    }
}

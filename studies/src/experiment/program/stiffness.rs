//! Joint 2 presses the tip against an edge: the torque rises slowly and falls
//! fast, a saw-tooth (Fig. 15).

use super::{Program, Seen, Target};
use ferntast_model::{ParameterError, check};
use ferntast_sim::arm::JOINTS;

/// Rise and fall of one tooth \[s\].
const RISE: f64 = 4.0;
const FALL: f64 = 1.0;

/// Saw-teeth of the commanded position into the surface; what the servo's
/// stiffness makes of them are saw-teeth of torque.
#[derive(Clone, Debug)]
pub struct StiffnessMotion {
    /// Joint positions just off the surface [rad].
    free: [f64; JOINTS],
    /// Joint positions just on it [rad].
    touch: [f64; JOINTS],
    /// How far joint 2's command goes beyond, with its sign [rad].
    depth: f64,
    teeth: u32,
}

impl StiffnessMotion {
    /// From `free` to `touch` \[rad\], then `teeth` times `depth` \[rad\] further with joint 2 alone.
    ///
    /// # Errors
    ///
    /// A depth or a number of teeth out of bounds.
    pub fn new(
        free: [f64; JOINTS],
        touch: [f64; JOINTS],
        depth: f64,
        teeth: u32,
    ) -> Result<Self, ParameterError> {
        check("depth", depth, -0.05, 0.05, "rad")?;
        check("teeth", f64::from(teeth), 1.0, 1000.0, "-")?;
        Ok(StiffnessMotion {
            free,
            touch,
            depth,
            teeth,
        })
    }
}

impl Program for StiffnessMotion {
    fn duration(&self) -> f64 {
        2.0 + f64::from(self.teeth) * (RISE + FALL)
    }

    fn target(&mut self, time: f64, _: f64, _: &Seen) -> Target {
        let near = (time / 2.0).clamp(0.0, 1.0);
        let mut joints = [0, 1]
            .map(|joint: usize| self.free[joint] + near * (self.touch[joint] - self.free[joint]));
        let phase = (time - 2.0).max(0.0) % (RISE + FALL);
        let share = if phase < RISE {
            phase / RISE
        } else {
            1.0 - (phase - RISE) / FALL
        };
        joints[1] += share * self.depth;
        Target::Joints(joints)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn teeth_rise_slowly_and_fall_fast_with_joint_2_alone() {
        let mut motion = StiffnessMotion::new([0.1, 1.0], [0.11, 0.98], -0.01, 3).unwrap();
        let mut at = |time: f64| match motion.target(time, 1e-3, &Seen::default()) {
            Target::Joints(joints) => joints,
            Target::Tip(_) => [f64::NAN; 2],
        };
        assert_eq!(at(0.0), [0.1, 1.0]);
        for (time, depth) in [
            (2.0, 0.0),
            (4.0, 0.005),
            (6.0, 0.01),
            (6.5, 0.005),
            (9.0, 0.005),
        ] {
            let [first, second] = at(time);
            assert_eq!(first, 0.11);
            assert!(
                (second - (0.98 - depth)).abs() < 1e-12,
                "{time} s: {second}"
            );
        }
        assert_eq!(motion.duration(), 17.0);
        assert!(StiffnessMotion::new([0.0; 2], [0.0; 2], 0.2, 3).is_err());
    }
}

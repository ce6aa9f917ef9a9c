//! What presses is limited.

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// What presses may be 20 Nm, and the friction that is fed forward as much \[Nm\].
const PRESSING: f64 = 40.0;
/// A joint stands, and so does its setpoint, at less than this \[rad/s\].
const STANDS: f64 = 0.02;
/// For so long: then what damps and what accelerates is over \[steps\].
const LASTING: u32 = 30;

/// A joint that stands where its setpoint stands presses no harder than the limit of what
/// presses, however far the setpoint is beyond a surface.
#[derive(Default)]
pub struct PressingLimited {
    /// For how long each joint has stood \[steps\].
    stood: [u32; 2],
    /// Sum of its torques meanwhile \[Nm\].
    sum: [f64; 2],
}

impl Invariant for PressingLimited {
    fn name(&self) -> &'static str {
        "pressing_limited"
    }

    fn step(&mut self, seen: &Seen, _: &Log, _: &Facts) -> Option<String> {
        let (torque, (_, setpoint)) = seen.torque.zip(seen.setpoint)?;
        for joint in 0..2 {
            let speed = setpoint[joint]
                .abs()
                .max(seen.truth.motor_velocity[joint].abs());
            if !seen.follower.enabled() || speed > STANDS {
                (self.stood[joint], self.sum[joint]) = (0, 0.0);
                continue;
            }
            self.stood[joint] += 1;
            self.sum[joint] += torque[joint];
            if self.stood[joint] < LASTING {
                continue;
            }
            let mean = self.sum[joint] / f64::from(self.stood[joint]);
            (self.stood[joint], self.sum[joint]) = (0, 0.0);
            if mean.abs() > PRESSING {
                return Some(format!(
                    "joint {} presses with {mean:.1} Nm, {PRESSING} Nm are allowed",
                    joint + 1
                ));
            }
        }
        None
    }
}

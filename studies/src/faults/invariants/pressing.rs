//! What presses is limited.

use ferntast_model::{Joints, MAX_JOINTS};

use super::{
    super::{body::STANDS, facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// For so long: then what damps and what accelerates is over \[steps\].
const LASTING: u32 = 30;

/// A joint that stands where its setpoint stands presses no harder than the limit of what
/// presses, however far the setpoint is beyond a surface.
#[derive(Default)]
pub struct PressingLimited {
    /// For how long each joint has stood \[steps\].
    stood: [u32; MAX_JOINTS],
    /// Sum of its torques meanwhile \[Nm\].
    sum: [f64; MAX_JOINTS],
    /// Where the servo last measured the joints \[rad\].
    measured: Option<Joints<f64>>,
}

impl Invariant for PressingLimited {
    fn name(&self) -> &'static str {
        "pressing_limited"
    }

    fn step(&mut self, seen: &Seen, _: &Log, facts: &Facts) -> Option<String> {
        // What is measured in this step is acted on in the next.
        let measured = self.measured;
        self.measured = seen.measured.or(measured);
        let (torque, (_, setpoint)) = seen.torque.zip(seen.setpoint)?;
        let weight = facts.body.weight(&measured?);
        for joint in 0..torque.len() {
            let speed = setpoint[joint]
                .abs()
                .max(seen.truth.motor_velocity[joint].abs());
            if !seen.follower.enabled() || speed > STANDS {
                (self.stood[joint], self.sum[joint]) = (0, 0.0);
                continue;
            }
            self.stood[joint] += 1;
            self.sum[joint] += torque[joint] - weight[joint];
            if self.stood[joint] < LASTING {
                continue;
            }
            let mean = self.sum[joint] / f64::from(self.stood[joint]);
            (self.stood[joint], self.sum[joint]) = (0, 0.0);
            let most = facts.body.pressing(joint);
            if mean.abs() > most {
                return Some(format!(
                    "joint {} presses with {mean:.1} Nm, {most:.1} Nm are allowed",
                    joint + 1
                ));
            }
        }
        None
    }
}

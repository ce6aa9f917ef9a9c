//! Motion and torque begin where they are.

use ferntast_model::Joints;

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// Distance of the setpoint from the measured position at the start \[rad\]: what
/// the arm moves in the step between.
const POSITION: f64 = 2e-3;
/// For so long after the start torques are watched \[steps\].
const WATCHED: i64 = 30;

/// On every enabling, and after the servo was held up, the setpoint begins at the measured position, and the torque
/// at the torque before.
#[derive(Default)]
pub struct NoJump {
    measured: Option<Joints<f64>>,
    torque: Option<Joints<f64>>,
    began: Option<i64>,
}

impl NoJump {
    fn judge(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        if seen.begins() {
            self.began = Some(seen.tick);
            let (setpoint, _) = seen.setpoint?;
            // A sensor that is wrong moves where it begins.
            if let Some(measured) = self.measured.filter(|_| seen.tick > log.sensor_wrong) {
                for joint in 0..setpoint.len() {
                    let far = (setpoint[joint] - measured[joint]).abs();
                    if far > POSITION {
                        return Some(format!(
                            "the setpoint of joint {} began {far:.4} rad from where it was measured",
                            joint + 1
                        ));
                    }
                }
            }
        }
        let began = self.began.filter(|began| seen.tick - began <= WATCHED)?;
        if !seen.follower.enabled() || seen.tick <= log.sensor_wrong.saturating_add(5) {
            return None;
        }
        let (before, now) = (self.torque?, seen.torque?);
        for joint in 0..now.len() {
            let step = (now[joint] - before[joint]).abs();
            if step > facts.jump[joint] {
                return Some(format!(
                    "the torque of joint {} changed by {step:.2} Nm in a step, {} ms after enabling",
                    joint + 1,
                    seen.tick - began
                ));
            }
        }
        None
    }
}

impl Invariant for NoJump {
    fn name(&self) -> &'static str {
        "no_jump"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let told = self.judge(seen, log, facts);
        self.measured = seen.measured.or(self.measured);
        self.torque = seen.torque;
        told
    }
}

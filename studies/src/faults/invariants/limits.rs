//! Limits of force and speed, at the arm and in the hand.

use std::collections::VecDeque;

use ferntast_model::MAX_JOINTS;

use super::{
    super::{body::Speeds, facts::Facts, log::Log, seen::Seen, truth::length},
    Invariant,
};

/// Rounding \[-\].
const ROUNDING: f64 = 1.0 + 1e-6;
/// How long the servo may take to see that a joint is too fast, and the joint to
/// lose speed then \[steps\].
const REACTION: i64 = 10;
/// Force on the tip that is always allowed \[-\]: what presses at most, and two fifths more for
/// what impact there is at the speed of a contact that is sought.
const CONTACT: f64 = 1.4;
/// While a measurement is wrong there is no telling a joint whose sensor is stuck from
/// one that stands: it comes to a surface as fast as it is driven, which is bounded by
/// itself. What it presses with stays. A tenth for what the formula leaves out.
const BLIND_MARGIN: f64 = 1.1;
/// And where a joint is not where the servo believes, its lever is another \[-\].
const BLIND_LEAST: f64 = 1.925;
/// For so long after it was wrong \[steps\].
const BLIND: i64 = 500;
/// How long an impact lasts \[steps\].
const IMPACT_LASTS: usize = 100;

/// Torques, speeds and places of the setpoint stay within the arm's limits.
pub struct ArmLimits;

impl Invariant for ArmLimits {
    fn name(&self) -> &'static str {
        "arm_limits"
    }

    fn step(&mut self, seen: &Seen, _: &Log, facts: &Facts) -> Option<String> {
        for joint in 0..facts.torque.len() {
            let number = joint + 1;
            if let Some(torque) = seen.torque.map(|own| own[joint])
                && exceeds(torque.abs(), facts.torque[joint] * ROUNDING)
            {
                let limit = facts.torque[joint];
                return Some(format!(
                    "{torque:.2} Nm at joint {number}, {limit} Nm are allowed"
                ));
            }
            let Some((position, velocity)) = seen.setpoint else {
                continue;
            };
            if !seen.follower.enabled() {
                continue;
            }
            let (place, speed) = (position[joint], velocity[joint]);
            if exceeds(speed.abs(), facts.setpoint_speed[joint] * ROUNDING) {
                let limit = facts.setpoint_speed[joint];
                return Some(format!(
                    "the setpoint of joint {number} goes at {speed:.3} rad/s, {limit} are allowed"
                ));
            }
            let [lower, upper] = facts.joint_limits[joint];
            if !(lower..=upper).contains(&place) {
                return Some(format!(
                    "the setpoint of joint {number} is at {place:.3} rad, outside {lower} … {upper}"
                ));
            }
        }
        if let Some((position, _)) = seen.setpoint.filter(|_| seen.follower.enabled()) {
            let tip = facts.body.tip(&position);
            let [lower, upper] = facts.workspace;
            // The way between two commands leaves the box by the arc of the joints.
            let margin = 0.02;
            for axis in 0..2 {
                if tip[axis] < lower[axis] - margin || tip[axis] > upper[axis] + margin {
                    return Some(format!(
                        "the setpoint's tip is at ({:.3}, {:.3}) m, outside the workspace",
                        tip[0], tip[1]
                    ));
                }
            }
        }
        None
    }
}

/// The tip never presses harder than this, and no joint stays too fast.
#[derive(Default)]
pub struct ContactForce {
    fast: [i64; MAX_JOINTS],
    /// Of the last steps.
    speeds: VecDeque<Speeds>,
}

impl Invariant for ContactForce {
    fn name(&self) -> &'static str {
        "contact_force_and_speed"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let truth = &seen.truth;
        let force = truth.pressing();
        let blind = seen.tick.saturating_sub(BLIND) < log.sensor_wrong;
        if self.speeds.len() == IMPACT_LASTS {
            self.speeds.pop_front();
        }
        let setpoint = seen.setpoint.map(|(_, velocity)| fastest(&velocity));
        self.speeds.push_back(Speeds {
            motors: truth.motor_velocity.iter().map(|own| own.abs()).sum(),
            tip: length(truth.tip_velocity),
            setpoint: setpoint.unwrap_or(0.0),
        });
        let most = |part: fn(&Speeds) -> f64| self.speeds.iter().map(part).fold(0.0, f64::max);
        let speeds = Speeds {
            motors: most(|own| own.motors),
            tip: most(|own| own.tip),
            setpoint: most(|own| own.setpoint),
        };
        let [pressing, hit] = facts.body.contact(&truth.position, truth.force, &speeds);
        let allowed = match blind {
            false => (CONTACT * pressing).max(hit),
            true => (BLIND_LEAST * pressing).max(BLIND_MARGIN * hit),
        };
        if exceeds(force, allowed) {
            return Some(format!(
                "{force:.1} N on the tip, {allowed:.1} N are allowed"
            ));
        }
        for joint in 0..truth.motor_velocity.len() {
            let speed = truth.motor_velocity[joint];
            // Of a joint whose sensor is stuck nobody knows its speed: friction bounds it.
            let margin = if blind { BLIND_MARGIN } else { 1.0 };
            let too_fast = exceeds(speed.abs(), margin * facts.overspeed[joint]);
            self.fast[joint] = if too_fast { self.fast[joint] + 1 } else { 0 };
            if self.fast[joint] > REACTION && seen.follower.enabled() {
                return Some(format!(
                    "joint {} turns at {speed:.2} rad/s and is still driven",
                    joint + 1
                ));
            }
        }
        None
    }
}

/// The force on the hand stays below its limit and grows no faster than allowed;
/// letting go at once is safe.
#[derive(Default)]
pub struct HandLimits {
    before: Option<[f64; 3]>,
}

impl Invariant for HandLimits {
    fn name(&self) -> &'static str {
        "hand_limits"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let Some(force) = seen.hand_force else {
            self.before = None;
            return None;
        };
        let length = |own: [f64; 3]| own.iter().map(|part| part * part).sum::<f64>().sqrt();
        let before = self.before.replace(force);
        let own = length(force);
        if exceeds(own, facts.hand_force * ROUNDING) {
            let limit = facts.hand_force;
            return Some(format!("{own:.2} N on the hand, {limit} N are allowed"));
        }
        if own > 0.0 && !seen.leader.enabled() {
            return Some(format!(
                "{own:.2} N on the hand of a master that is not enabled"
            ));
        }
        let before = before?;
        let change = length([0, 1, 2].map(|axis: usize| force[axis] - before[axis]));
        // A step after a stall or a jump of the clock counts as up to 20 ms.
        let quiet = seen.tick - log.operator_side_stalled > 2;
        // The clock of the host may go a little faster.
        let allowed = facts.hand_force_change * 1.001;
        (own > 0.0 && change > allowed && quiet).then(|| {
            format!("the force on the hand changed by {change:.2} N in a step, {allowed:.2} N are allowed")
        })
    }
}

/// The largest of these speeds.
fn fastest(velocity: &[f64]) -> f64 {
    velocity.iter().fold(0.0, |most, own| own.abs().max(most))
}

/// Whether `value` is beyond `limit`, or no number.
fn exceeds(value: f64, limit: f64) -> bool {
    value.is_nan() || value > limit
}

//! What the laws claim of energy.

use ferntast_control::delay::Guarantee;

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// Energy that may leave beyond what entered \[J\], at the hand's scale: what the
/// servo's spring and the moving arm hold, and the share of friction that is fed
/// forward.
const ALLOWANCE: f64 = 0.15;
/// After an enabling, a fault or a change of law the balance begins anew \[steps\].
const SETTLED: i64 = 400;

/// Of a law that claims passivity no more energy leaves at the two ports, hand and
/// tip, than entered: true forces and velocities, while nothing is started, stopped
/// or changed.
#[derive(Default)]
pub struct Energy {
    hand: Option<[f64; 3]>,
    force: [f64; 3],
    /// Left less entered \[J\], and its least so far.
    left: f64,
    least: f64,
    since: i64,
}

impl Invariant for Energy {
    fn name(&self) -> &'static str {
        "energy"
    }

    fn step(&mut self, seen: &Seen, log: &Log, facts: &Facts) -> Option<String> {
        let before = self.hand;
        self.hand = seen.hand.or(before);
        let force = std::mem::replace(&mut self.force, seen.hand_force.unwrap_or([0.0; 3]));
        let claims = match facts.guarantee {
            Guarantee::Nothing => false,
            Guarantee::ByItsBooksWhileConnected | Guarantee::ByItsBooks | Guarantee::Passive => {
                !log.law_switched
            }
        };
        let both = seen.follower.enabled() && seen.leader.enabled();
        if !claims || !both || log.sensor_wrong == i64::MAX {
            self.since = seen.tick;
        }
        if seen.follower.just_enabled() || seen.leader.just_enabled() {
            self.since = seen.tick;
        }
        let begin = self.since.max(log.disturbed).max(log.sensor_wrong);
        let begin = begin.saturating_add(SETTLED);
        if seen.tick <= begin {
            self.left = 0.0;
            self.least = 0.0;
            return None;
        }
        let (before, now) = (before?, seen.hand?);
        let at_hand: f64 = (0..3)
            .map(|axis| force[axis] * (now[axis] - before[axis]))
            .sum();
        let truth = &seen.truth;
        let power: f64 = (0..3)
            .map(|axis| -truth.force[axis] * truth.tip_velocity[axis])
            .sum();
        self.left += at_hand + facts.mapping.power_scale() * power * 1e-3;
        self.least = self.least.min(self.left);
        let gained = self.left - self.least;
        (gained > ALLOWANCE).then(|| {
            format!(
                "{gained:.3} J left more than entered within {} ms",
                seen.tick - begin
            )
        })
    }
}

//! A gap between the motor and the gear with its load.

use ferntast_model::friction::{ANGLE, AtReversal, Contrast, ONE, Proposal};

use super::{Effect, Facts, Memory, Point, free, logarithmic, row, sign};

row!(
    Backlash,
    id: "backlash",
    equation: "in the gap τ_m = J q̈: τ and τ_F do not reach the motor",
    source: "dead zone (play) between bodies with dry friction",
    coefficients: &[free("c", ONE)],
    shape: &[free("gap", ANGLE), free("bend", ANGLE)],
    shows_as: "jump after reversal of load",
    excited_by: "reversals of the load at low speed",
    shown_by: Proposal::SlowReversals,
    contrasts: &[Contrast::SlowReversals],
    confusable_with: &["presliding_hysteresis"],
    at_reversal: Some(AtReversal::Gap),
    needs_prediction: true,
);

/// Indices of the memory: friction that reaches the motor \[Nm\]; place in the
/// gap \[rad\] from its middle; whether the motor is in it; whether begun.
const FRICTION: usize = 0;
const PLACE: usize = 1;
const FREE: usize = 2;
const BEGUN: usize = 3;

/// Smallest torque through the teeth, as a share of friction, whose sign shows on
/// which side they touch.
const MIN_TOOTH_TORQUE: f64 = 0.2;

/// State at the start of a session: the motor torque goes through the teeth. Without
/// any, the motor is assumed in the middle of a gap of twice `half` \[rad\].
fn begin(point: &Point, half: f64) -> Memory {
    let most = point.friction_predicted.abs();
    let through = point.motor_torque;
    let friction = (through - point.load).clamp(-most, most);
    match through.abs() > MIN_TOOTH_TORQUE * most {
        true => [friction, sign(through) * half, 0.0, 1.0],
        false => [friction, 0.0, 1.0, 1.0],
    }
}

/// Speed \[rad/s\] at which the load pulls a gear that nothing drives: friction at
/// that speed balances the load, which it cannot hold at rest.
fn gear_speed(point: &Point) -> f64 {
    let most = point.friction_predicted.abs();
    let slope = (most - point.friction_level) / point.velocity.abs();
    let beyond = point.load.abs() - point.friction_level;
    match slope > 0.0 {
        true => (beyond / slope).max(0.0),
        false => 0.0,
    }
}

impl Effect for Backlash {
    row!(methods);

    // The gear stands still until the torque through its teeth, τ + F, leaves
    // τ ± τ_F. As the motor turns back, F falls towards −τ_F over the travel `bend`
    // (Dahl's law; teeth are no stiffer than that), is −τ while the motor crosses
    // the gap, and falls on behind it. A load that friction cannot hold at rest pulls
    // the gear behind the motor, so fast that friction holds it then: it may
    // follow all the way, and there is no gap.
    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let ([c], [gap, bend, ..]) = (columns, shape) else {
            return;
        };
        if point.velocity == 0.0 {
            *c = memory[FRICTION] - point.friction_predicted;
            return;
        }
        let half = 0.5 * gap;
        let most = point.friction_predicted.abs();
        let mut step = point.velocity * point.period;
        if memory[BEGUN] == 0.0 {
            *memory = begin(point, half);
        }
        let sliding = point.sign() * most;
        let bent = |friction: f64, travel: f64| {
            sliding + (friction - sliding) * (-travel.abs() / bend.max(1e-12)).exp()
        };
        let gear = -sign(point.load) * gear_speed(point);
        if memory[FREE] == 0.0 {
            let side = sign(memory[PLACE]);
            let next = bent(memory[FRICTION], step);
            if (next + point.load) * side >= 0.0 {
                memory[FRICTION] = next;
            } else {
                // The tooth has come off: the rest of the step is in the gap.
                let left = (sliding + point.load) / (sliding - memory[FRICTION]);
                let used = if left > 0.0 { -bend * left.ln() } else { 0.0 };
                step -= used.clamp(0.0, step.abs()).copysign(step);
                memory[FREE] = 1.0;
            }
        }
        if memory[FREE] != 0.0 {
            let place = memory[PLACE] + step - gear * point.period;
            memory[FRICTION] = (-point.load).clamp(-most, most);
            memory[PLACE] = place.clamp(-half, half);
            if place.abs() >= half {
                memory[FREE] = 0.0;
                memory[FRICTION] = bent(memory[FRICTION], place - memory[PLACE]);
            }
        }
        *c = memory[FRICTION] - point.friction_predicted;
    }

    // Where the teeth meet again, the torque on the motor depends on the inertia of
    // a gear whose speed is not measured.
    fn undetermined_samples(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let mut memory = Memory::default();
        let mut meets = Vec::new();
        for (at, point) in points.iter().enumerate() {
            let was_free = memory[FREE] != 0.0;
            self.evaluate(shape, point, &mut memory, &mut [0.0]);
            if was_free && memory[FREE] == 0.0 {
                meets.push(at);
            }
        }
        meets
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [gaps, bends] = [0, 1].map(|at| self.bounds(facts)[at]);
        logarithmic(gaps[0], gaps[1], 16)
            .into_iter()
            .flat_map(|gap| {
                logarithmic(bends[0], bends[1], 3)
                    .into_iter()
                    .map(move |bend| vec![gap, bend])
            })
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let travel = facts.travel();
        vec![
            [0.004 * travel, 0.15 * travel],
            [0.0005 * travel, 0.006 * travel],
        ]
    }

    // All of the torque is missing in the gap, not a part of it.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (0.3..1.7).contains(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Friction \[Nm\] that reaches the motor at samples 1 mrad apart; a gap of
    /// 20 mrad, friction of 10 Nm at rest and 100 Nm s/rad beyond.
    fn reaches(motor_torque: f64, load: f64, velocities: impl Iterator<Item = f64>) -> Vec<f64> {
        let effect = Backlash::default();
        let mut memory = Memory::default();
        velocities
            .map(|velocity: f64| {
                let friction = 10.0 * sign(velocity) + 100.0 * velocity;
                let point = Point {
                    period: 1e-3 / velocity.abs(),
                    velocity,
                    motor_torque,
                    load,
                    friction_predicted: friction,
                    friction_level: 10.0,
                    ..Point::default()
                };
                let mut column = [0.0];
                effect.evaluate(&[0.02, 1e-4], &point, &mut memory, &mut column);
                column[0] + friction
            })
            .collect()
    }

    #[test]
    fn a_session_begins_on_the_side_of_the_motor_torque() {
        let forward = || std::iter::repeat_n(0.05, 30);
        let in_the_gap = reaches(0.0, 0.0, forward());
        assert!(in_the_gap[..9].iter().all(|f| *f == 0.0));
        assert!(in_the_gap[11..].iter().all(|f| (f - 15.0).abs() < 0.1));
        let driving = reaches(10.0, 0.0, forward());
        assert!(driving[1..].iter().all(|f| (f - 15.0).abs() < 0.1));
    }

    #[test]
    fn a_gap_is_crossed_under_the_load_alone() {
        let there_and_back = || std::iter::repeat_n(0.05, 30).chain(std::iter::repeat_n(-0.05, 30));
        let held = reaches(20.0, 6.0, there_and_back());
        assert!(held[32..49].iter().all(|f| *f == -6.0), "{held:?}");
        assert!(held[53..].iter().all(|f| (f + 15.0).abs() < 0.1));
        // The load pulls the gear back at (14 − 10)/100 = 0.04 rad/s, hardly slower
        // than the motor: a gap opens, and is not crossed.
        let creeping = reaches(20.0, 14.0, there_and_back());
        assert!(creeping[32..].iter().all(|f| *f == -14.0), "{creeping:?}");
        // At 0.08 rad/s it follows.
        let follows = reaches(30.0, 18.0, there_and_back());
        assert!(follows[32..].iter().all(|f| (f + 15.0).abs() < 0.1));
    }
    #[test]
    fn samples_are_undetermined_where_the_teeth_meet_again() {
        let point = |velocity: f64| Point {
            period: 1e-3 / 0.05,
            velocity,
            motor_torque: 20.0 * velocity,
            friction_predicted: 20.0 * sign(velocity),
            friction_level: 20.0,
            ..Point::default()
        };
        // From the middle of a gap of 20 mrad, 1 mrad a sample; back after 30.
        let points: Vec<Point> = (0..60)
            .map(|at| point(if at < 30 { 0.05 } else { -0.05 }))
            .collect();
        let meets = Backlash::default().undetermined_samples(&[0.02, 1e-5], &points);
        let [first, second] = meets[..] else {
            panic!("{meets:?}");
        };
        assert!((8..=11).contains(&first) && (48..=51).contains(&second));
    }
}

//! A gap between the motor and a load that nobody measures.
//!
//! Behind the gap are a share s of the inertia, friction, and the weight and springs that the
//! model has. What the teeth transmit while they touch,
//! τ_z = s J q̈ + s r τ_R + G, with τ_R friction and G weight and springs, pushes in one direction
//! only: where it changes its sign the load goes on by itself, J s ẇ = −(s r τ_R(w) + G), and
//! the motor is rid of τ_z until it has crossed the gap. With an inert load that is when the motor
//! slows down, before it turns back. Nordin and Gutman 2002, "Controlling mechanical systems with
//! backlash – a survey", Automatica 38 (dead zone between two inertias, with stiff teeth).

use ferntast_model::friction::{ANGLE, ONE, Proposal, Unmeasured};

use super::{Effect, Facts, Memory, Point, are_shares, combinations, free, logarithmic, row, sign};

row!(
    LoadBacklash,
    id: "load_backlash",
    equation: "in the gap τ_m lacks s (J q̈ + r τ_R + g G): inertia, friction, weight and springs of the load behind it",
    source: "Nordin and Gutman 2002, dead zone between two inertias",
    coefficients: &[free("inertia_share", ONE)],
    shape: &[free("gap", ANGLE), free("friction_ratio", ONE), free("weight_ratio", ONE)],
    shows_as: "jump where the load changes from driven to driving",
    excited_by: "slowing down and turning back",
    shown_by: Proposal::SlowReversals,
    confusable_with: &["load_elasticity", "backlash", "presliding_hysteresis", "load_stribeck"],
    shows_at_reversals: true,
    needs_prediction: true,
    of_unmeasured: Some(Unmeasured::Load),
);

/// Indices of the memory: place in the gap \[rad\] from its middle; speed of the load \[rad/s\];
/// whether the teeth are off; whether begun.
const PLACE: usize = 0;
const SPEED: usize = 1;
const FREE: usize = 2;
const BEGUN: usize = 3;

/// Teeth may strike so much before they are thought to, and ring for so long after it \[s\].
const EARLY: f64 = 0.02;
const RINGS: f64 = 0.06;

/// What the teeth transmit, per share of the inertia, and its parts \[Nm\].
struct Load {
    /// Size of r τ_R.
    friction: f64,
    /// g G.
    weight: f64,
    /// All of it, while the teeth touch.
    transmitted: f64,
}

impl Load {
    fn at(shape: &[f64], point: &Point) -> Option<Load> {
        let [_, friction_ratio, weight_ratio] = *shape else {
            return None;
        };
        let inertial = point.inertia * point.acceleration;
        let friction = friction_ratio * point.friction_beside_load();
        let weight = weight_ratio * point.weight_and_springs();
        Some(Load {
            friction: friction.abs(),
            weight,
            transmitted: inertial + friction + weight,
        })
    }

    /// Speed \[rad/s\] after `period` \[s\] of a load that nothing drives, per share of
    /// `inertia` \[kg m²\].
    fn coast(&self, speed: f64, inertia: f64, period: f64) -> f64 {
        let direction = if speed == 0.0 {
            -sign(self.weight)
        } else {
            sign(speed)
        };
        let held = self.weight.abs() <= self.friction;
        if speed == 0.0 && held {
            return 0.0;
        }
        let next = speed - (direction * self.friction + self.weight) / inertia * period;
        // Friction stops it, and does not turn it round.
        match held && next * speed <= 0.0 {
            true => 0.0,
            false => next,
        }
    }
}

/// What the motor lacks at a sample, per share of the inertia \[Nm\].
fn lacking(shape: &[f64], point: &Point, memory: &mut Memory) -> f64 {
    let Some(load) = Load::at(shape, point).filter(|_| point.inertia > 0.0) else {
        return 0.0;
    };
    let half = 0.5 * shape[0];
    if memory[BEGUN] == 0.0 {
        // At rest nothing tells on which side the teeth touch.
        if load.transmitted == 0.0 {
            return 0.0;
        }
        *memory = [half * sign(load.transmitted), point.velocity, 0.0, 1.0];
    }
    if memory[FREE] == 0.0 {
        memory[SPEED] = point.velocity;
        if load.transmitted * memory[PLACE] >= 0.0 {
            return 0.0;
        }
        memory[FREE] = 1.0;
        return -load.transmitted;
    }
    memory[SPEED] = load.coast(memory[SPEED], point.inertia, point.period);
    memory[PLACE] += (point.velocity - memory[SPEED]) * point.period;
    if memory[PLACE].abs() < half {
        return -load.transmitted;
    }
    // The teeth strike: the load takes over the speed of the motor.
    memory[PLACE] = half * sign(memory[PLACE]);
    memory[FREE] = 0.0;
    point.inertia * (point.velocity - memory[SPEED]) / point.period - load.transmitted
}

impl Effect for LoadBacklash {
    row!(methods);

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        if let [column] = columns {
            *column = lacking(shape, point, memory);
        }
    }

    // What the teeth transmit as they strike and ring depends on their stiffness.
    fn undetermined_samples(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let mut memory = Memory::default();
        let mut side = 0.0;
        let mut strikes = Vec::new();
        for point in points {
            lacking(shape, point, &mut memory);
            if memory[FREE] == 0.0 {
                // Across the gap: those that touch where they came off do not strike.
                if side * memory[PLACE] < 0.0 {
                    strikes.push(point.time);
                }
                side = memory[PLACE];
            }
        }
        let mut strikes = strikes.into_iter().peekable();
        let mut rings = Vec::new();
        for (at, point) in points.iter().enumerate() {
            while strikes.next_if(|own| own + RINGS < point.time).is_some() {}
            if strikes.peek().is_some_and(|own| own - EARLY <= point.time) {
                rings.push(at);
            }
        }
        rings
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        let friction_ratios = vec![0.2, 0.6, 1.4];
        combinations(&[logarithmic(low, high, 12), friction_ratios, vec![1.2, 2.4]])
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let travel = facts.travel();
        vec![[0.0005 * travel, 0.08 * travel], [0.0, 4.0], [1.0, 10.0]]
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        are_shares(coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::column_of;

    const PERIOD: f64 = 1e-4;
    const INERTIA: f64 = 0.9;
    /// Friction that slows the load down by 2 rad/s² where all of it is behind the gap \[Nm\].
    const FRICTION: f64 = 1.8;

    /// A motor at 1 rad/s that slows down by `deceleration` \[rad/s²\] from 0.1 s on, for 0.1 s.
    fn points(deceleration: f64) -> Vec<Point> {
        (0..2000)
            .map(|at| {
                let time = f64::from(at) * PERIOD;
                let slowing = (time - 0.1).max(0.0);
                let acceleration = if slowing > 0.0 { -deceleration } else { 0.0 };
                Point {
                    period: PERIOD,
                    time,
                    velocity: 1.0 - deceleration * slowing,
                    acceleration,
                    load: INERTIA * acceleration,
                    friction_predicted: FRICTION,
                    inertia: INERTIA,
                    ..Point::default()
                }
            })
            .collect()
    }

    fn column(shape: &[f64], points: &[Point]) -> Vec<f64> {
        column_of(&LoadBacklash::default(), shape, points)
    }

    /// The load goes ahead by ½ (A − f) t², with A the motor's deceleration and f the load's own: a
    /// gap of 10 mrad takes √(2 · 0.01 / (4 − 2)) = 0.1 s, one of 5 mrad 0.0707 s.
    #[test]
    fn an_inert_load_crosses_the_gap_as_the_motor_slows_down() {
        let points = points(4.0);
        let column = column(&[0.005, 1.0, 1.0], &points);
        let missing: Vec<usize> = (0..points.len()).filter(|at| column[*at] != 0.0).collect();
        let (first, last) = (missing[0], missing[missing.len() - 1]);
        assert!((0.1..0.1003).contains(&points[first].time));
        let crossing = points[last].time - 0.1;
        assert!((crossing - 0.0707).abs() < 0.0005, "{crossing} s");
        // In between all that the teeth would transmit: J q̈ and friction.
        let expected = INERTIA * 4.0 - FRICTION;
        assert!((column[first + 100] - expected).abs() < 1e-9);
        // What the load keeps of its momentum it gives back in the strike.
        let impulse: f64 = column.iter().map(|own| own * PERIOD).sum();
        assert!(impulse.abs() < 1e-3 * INERTIA, "{impulse} Nms");
        let rings = LoadBacklash::default().undetermined_samples(&[0.005, 1.0, 1.0], &points);
        let times =
            [rings[0], rings[rings.len() - 1]].map(|at| points[at].time - points[last].time);
        assert!((times[0] + EARLY).abs() < 2.0 * PERIOD && times[1] > 0.02);
    }

    #[test]
    fn a_recording_that_begins_at_rest_begins_when_something_moves() {
        let moving = points(4.0);
        let rest = Point {
            period: PERIOD,
            inertia: INERTIA,
            ..Point::default()
        };
        let resting = [vec![rest; 100], moving.clone()].concat();
        let shape = [0.005, 1.0, 1.0];
        let expected = column(&shape, &moving);
        assert!(expected.iter().any(|own| *own != 0.0));
        assert_eq!(column(&shape, &resting)[100..], expected);
    }

    #[test]
    fn a_load_that_friction_slows_down_as_fast_stays_on_its_side() {
        assert!(
            column(&[0.005, 1.0, 1.0], &points(1.9))
                .iter()
                .all(|own| *own == 0.0)
        );
        // Nor does one whose weight presses it on: 4 Nm against the motor.
        let mut pressed = points(4.0);
        pressed.iter_mut().for_each(|own| own.load += 4.0);
        pressed
            .iter_mut()
            .for_each(|own| own.friction_predicted += 4.0);
        assert!(
            column(&[0.005, 1.0, 1.0], &pressed)
                .iter()
                .all(|own| *own == 0.0)
        );
    }
}

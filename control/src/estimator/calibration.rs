//! Gains of the torque sensors and turn of the contour, found while the tip slides.
//!
//! What tells them (δ: turn of an edge about z; g₁, g₂: gains less 1; ε = g₁ − g₂;
//! c = (g₁ + g₂)/2):
//!
//! * **The way of the tip** along an edge tells δ, by encoders alone: the distance
//!   Φ + F_N/k from the believed edge grows by δ with the place along it.
//! * **To and fro** friction has the same size, F_t = ∓μ F_n, so that the middle of both forces
//!   is along the true normal. Gains that differ turn forces as the posture has it: with δ by the
//!   way, ε and μ are two unknowns of two directions, on one edge already. Both edges, and the
//!   postures along each, overdetermine them.
//! * **A spring of known stiffness** pushed in and let go tells c: F_n over its way.
//!
//! What nothing of this tells: c without a spring. A common gain scales all forces alike; no
//! direction, no ratio of forces, so neither b_0T, changes. On the ground the arm's known weight
//! tells it, and in orbit the motors' currents, by a motor constant that is no better known.
//!
//! The residual r = F_t′ + s μ F_n′ (s: direction of sliding; ′: by ε and δ) is bilinear in what is
//! looked for, so that sums of products of eight numbers hold all samples. Least squares by
//! Gauss-Newton's method; what is stated of gains and turn ([`Uncertainty`](super::Uncertainty))
//! is their prior, so that nothing is moved that the motion does not tell, and nothing at all
//! where nothing is stated.

use super::Uncertainty;
use crate::low_pass_share;
use ferntast_model::contour::Feature;
use ferntast_model::{Matrix2, Vector2};
use nalgebra::{SMatrix, SVector};

/// Numbers that a residual is bilinear in: F_t, T, F_n, N, and s times each; T and N are
/// ∂F/∂ε along tangent and normal.
const TERMS: usize = 8;
type Terms = SVector<f64, TERMS>;

/// Rounds of Gauss-Newton's method.
const ROUNDS: usize = 6;
/// How well the stiffness k of an edge is taken to be known [-]: it enters by the change of F_N.
const EDGE_STIFFNESS: f64 = 0.2;
/// Least standard deviation of a force [N] and of a place [m]: models are no better.
const LEAST_FORCE: f64 = 0.02;
const LEAST_PLACE: f64 = 2e-6;
/// Least standard deviation of a turn [rad]: an arm bends, and its links are not as long as believed.
const LEAST_TURN: f64 = 1e-3;
/// Least standard error of ε [-]: hysteresis of the sensors goes with the direction of sliding, too.
const LEAST_RATIO: f64 = 5e-3;
/// A slope is told by a way of at least so long [m].
const LEAST_WAY: f64 = 1e-3;
/// Sliding from one solution to the next \[s\].
const PERIOD: f64 = 0.05;
/// Time constant with which what is in use follows what was found \[s\]: no force jumps.
const LEAD: f64 = 0.3;

/// A value with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibrated {
    /// Most likely value.
    pub value: f64,
    /// Its standard error; what is stated beforehand, while nothing was found.
    pub error: f64,
}

/// What sliding tells of torque sensors and contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// ε: by how much the first sensor's gain is more than the second's \[-\].
    pub ratio: Calibrated,
    /// c: gain of both, less 1 \[-\].
    pub common: Calibrated,
}

impl Calibration {
    /// Errors of the joints' torques \[Nm\] by c and by ε, one standard error each.
    pub(super) fn errors(&self, felt: &Vector2<f64>) -> [Vector2<f64>; 2] {
        let half = 0.5 * self.ratio.error;
        [
            felt * self.common.error,
            Vector2::new(half * felt.x, -half * felt.y),
        ]
    }

    /// Gain of each sensor \[-\].
    pub fn gains(&self) -> [Calibrated; 2] {
        [0.5, -0.5].map(|half| Calibrated {
            value: 1.0 + self.common.value + half * self.ratio.value,
            error: self.common.error.hypot(half * self.ratio.error),
        })
    }
}

/// One sample of a tip that pushes against a feature of the contour.
#[derive(Clone, Copy, Debug)]
pub struct Push<'a> {
    /// The feature touched, as believed.
    pub feature: &'a Feature,
    /// Tip \[m\], base frame, as late as the force.
    pub tip: Vector2<f64>,
    /// Force on the tip \[N\], base frame, by sensors as they are.
    pub force: Vector2<f64>,
    /// Its derivative with respect to ε: F(ε) = F + ε dF, which takes ε out again \[N\].
    pub by_ratio: Vector2<f64>,
    /// Direction of sliding along the tangent: ±1.
    pub direction: f64,
    /// Time that the sample stands for \[s\], and time within which samples are alike \[s\].
    pub dt: f64,
    /// See `dt`.
    pub alike: f64,
}

/// Sums over the samples of a straight line y = a + b x.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    weight: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Line {
    fn add(&mut self, keep: f64, x: f64, y: f64) {
        for (sum, new) in [
            (&mut self.weight, 1.0),
            (&mut self.x, x),
            (&mut self.y, y),
            (&mut self.xx, x * x),
            (&mut self.xy, x * y),
            (&mut self.yy, y * y),
        ] {
            *sum = keep * *sum + new;
        }
    }

    /// b, and its variance for samples of which `alike` in a row are one, their residual at least
    /// `least`; `None` where x hardly changes.
    fn slope(&self, alike: f64, least: f64) -> Option<(f64, f64)> {
        let independent = self.weight / alike;
        if independent < 4.0 {
            return None;
        }
        let n = self.weight;
        let (xx, xy, yy) = (
            self.xx - self.x * self.x / n,
            self.xy - self.x * self.y / n,
            self.yy - self.y * self.y / n,
        );
        if xx <= n * LEAST_WAY * LEAST_WAY {
            return None;
        }
        let slope = xy / xx;
        let residual = ((yy - slope * xy).max(0.0) / n).max(least * least);
        Some((slope, residual * alike / xx))
    }
}

/// What was seen of one edge.
#[derive(Clone, Copy, Debug)]
struct Edge {
    forces: SMatrix<f64, TERMS, TERMS>,
    weight: f64,
    alike: f64,
    /// Distance from the believed edge over the place along it, and F_N/k over the place.
    way: Line,
    bend: Line,
    turn: Calibrated,
    turn_in_use: f64,
    friction: f64,
}

impl Edge {
    fn new(uncertainty: &Uncertainty) -> Self {
        Self {
            forces: SMatrix::zeros(),
            weight: 0.0,
            alike: 1.0,
            way: Line::default(),
            bend: Line::default(),
            turn: Calibrated {
                value: 0.0,
                error: uncertainty.contour_turn,
            },
            turn_in_use: 0.0,
            friction: 0.0,
        }
    }

    /// What the tip's way says of the turn: value and variance.
    fn turn_by_way(&self) -> Option<(f64, f64)> {
        let (turn, variance) = self.way.slope(self.alike, LEAST_PLACE)?;
        let (bend, _) = self.bend.slope(self.alike, LEAST_PLACE)?;
        let model = LEAST_TURN.powi(2) + (EDGE_STIFFNESS * bend).powi(2);
        Some((turn, variance + model))
    }
}

/// Finds gains and turns. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct SelfCalibration {
    uncertainty: Uncertainty,
    /// One for each feature of the contour.
    edges: Vec<Edge>,
    /// Force of the springs over the way that they give \[N\] over \[m\], in shares of their
    /// stiffness, and N/F_n times that.
    spring: Line,
    spring_by_ratio: Line,
    spring_alike: f64,
    found: Calibration,
    /// ε and c in use [-].
    in_use: [f64; 2],
    due: f64,
}

impl SelfCalibration {
    /// Nothing is known but what is stated; of a contour with so many `features`.
    pub fn new(uncertainty: Uncertainty, features: usize) -> Self {
        let gain = uncertainty.torque_gain;
        Self {
            edges: vec![Edge::new(&uncertainty); features],
            spring: Line::default(),
            spring_by_ratio: Line::default(),
            spring_alike: 1.0,
            found: Calibration {
                ratio: Calibrated {
                    value: 0.0,
                    error: gain * std::f64::consts::SQRT_2,
                },
                common: Calibrated {
                    value: 0.0,
                    error: gain * std::f64::consts::FRAC_1_SQRT_2,
                },
            },
            in_use: [0.0; 2],
            due: 0.0,
            uncertainty,
        }
    }

    /// What is known now.
    pub fn calibration(&self) -> Calibration {
        self.found
    }

    /// Turn of feature number `feature` \[rad\]; `None` where there is no such.
    pub fn turn(&self, feature: usize) -> Option<Calibrated> {
        self.edges.get(feature).map(|edge| edge.turn)
    }

    /// Leads what is in use over to what was found, `dt` \[s\] after the last time.
    pub fn step(&mut self, dt: f64) {
        let share = low_pass_share(dt, LEAD);
        let found = [self.found.ratio.value, self.found.common.value];
        for (own, found) in self.in_use.iter_mut().zip(found) {
            *own += share * (found - *own);
        }
        for edge in &mut self.edges {
            edge.turn_in_use += share * (edge.turn.value - edge.turn_in_use);
        }
    }

    /// What is to be added to the contact's torque where the sensors feel `felt` \[Nm\].
    pub fn correction(&self, felt: &Vector2<f64>) -> Vector2<f64> {
        let [ratio, common] = self.in_use;
        let half = 0.5 * ratio;
        Vector2::new((common + half) * felt.x, (common - half) * felt.y)
    }

    /// Turn of feature number `feature` that is in use \[rad\].
    pub fn turn_in_use(&self, feature: usize) -> f64 {
        self.edges.get(feature).map_or(0.0, |edge| edge.turn_in_use)
    }

    /// Takes in a sample of sliding along the edge number `feature`; those of longer than
    /// `memory` \[s of sliding\] ago fade.
    pub fn slide(&mut self, feature: usize, memory: f64, push: &Push<'_>) {
        let Some(edge) = self.edges.get_mut(feature) else {
            return;
        };
        let (normal, tangent) = (push.feature.normal, push.feature.tangent());
        let keep = memory / (memory + push.dt);
        let terms = [
            push.force.dot(&tangent),
            push.by_ratio.dot(&tangent),
            push.force.dot(&normal),
            push.by_ratio.dot(&normal),
        ];
        let terms = Terms::from_fn(|i, _| terms[i % 4] * if i < 4 { 1.0 } else { push.direction });
        edge.forces = edge.forces * keep + terms * terms.transpose();
        edge.weight = edge.weight * keep + 1.0;
        edge.alike = (push.alike / push.dt).max(1.0);
        let bend = terms[2] / push.feature.contact.stiffness;
        let along = push.feature.along(&push.tip);
        let off = push.feature.distance(&push.tip) + bend;
        edge.way.add(keep, along, off);
        edge.bend.add(keep, along, bend);
        self.due -= push.dt;
        if self.due <= 0.0 {
            self.due = PERIOD;
            self.solve();
        }
    }

    /// Takes in a sample of pushing a spring, see [`slide`](Self::slide).
    pub fn press(&mut self, memory: f64, push: &Push<'_>) {
        let normal = push.feature.normal;
        let keep = memory / (memory + push.dt);
        let depth = -push.feature.distance(&push.tip);
        let stiffness = push.feature.contact.stiffness;
        let share = |force: &Vector2<f64>| force.dot(&normal) / stiffness;
        self.spring.add(keep, depth, share(&push.force));
        self.spring_by_ratio.add(keep, depth, share(&push.by_ratio));
        self.spring_alike = (push.alike / push.dt).max(1.0);
        self.solve_common();
    }

    fn solve_common(&mut self) {
        let known = self.uncertainty.spring_stiffness;
        let prior = 0.5 * self.uncertainty.torque_gain.powi(2);
        if known <= 0.0 || prior <= 0.0 {
            return;
        }
        let alike = self.spring_alike;
        let slope = self.spring.slope(alike, LEAST_PLACE);
        let by_ratio = self.spring_by_ratio.slope(alike, LEAST_PLACE);
        let Some(((slope, variance), (by_ratio, _))) = slope.zip(by_ratio) else {
            return;
        };
        let ratio = self.found.ratio;
        let seen = slope + ratio.value * by_ratio - 1.0;
        let variance = variance + known * known + (by_ratio * ratio.error).powi(2);
        let information = 1.0 / prior + 1.0 / variance;
        self.found.common = Calibrated {
            value: seen / variance / information,
            error: information.sqrt().recip(),
        };
    }

    fn solve(&mut self) {
        let prior_ratio = 2.0 * self.uncertainty.torque_gain.powi(2);
        let prior_turn = self.uncertainty.contour_turn.powi(2);
        if prior_ratio <= 0.0 || prior_turn <= 0.0 {
            return;
        }
        let mut ratio = self.found.ratio.value;
        let mut variance = prior_ratio;
        for _ in 0..ROUNDS {
            let mut information = 1.0 / prior_ratio;
            let mut gradient = ratio / prior_ratio;
            for edge in &self.edges {
                if let Some(own) = Normal::of(edge, ratio, prior_turn) {
                    information += own.ratio - own.coupling.dot(&(own.inverse * own.coupling));
                    gradient += own.gradient - own.coupling.dot(&(own.inverse * own.own_gradient));
                }
            }
            variance = 1.0 / information;
            let step = -gradient * variance;
            for edge in &mut self.edges {
                if let Some(own) = Normal::of(edge, ratio, prior_turn) {
                    let moved = own.inverse * (own.own_gradient + own.coupling * step);
                    edge.turn.value -= moved.x;
                    edge.friction -= moved.y;
                    let by_ratio = (own.inverse * own.coupling).x;
                    let square = own.inverse[(0, 0)] + by_ratio * by_ratio * variance;
                    edge.turn.error = square.max(0.0).sqrt();
                }
            }
            ratio += step;
        }
        self.found.ratio = Calibrated {
            value: ratio,
            error: variance.sqrt().hypot(LEAST_RATIO).min(prior_ratio.sqrt()),
        };
        self.solve_common();
    }
}

/// Normal equations of one edge in ε, and in its own δ and μ.
struct Normal {
    ratio: f64,
    coupling: Vector2<f64>,
    inverse: Matrix2<f64>,
    gradient: f64,
    own_gradient: Vector2<f64>,
}

impl Normal {
    /// `None` before the edge tells anything.
    fn of(edge: &Edge, ratio: f64, prior_turn: f64) -> Option<Normal> {
        if edge.weight < 4.0 * edge.alike {
            return None;
        }
        let (turn, friction) = (edge.turn.value, edge.friction);
        let (e, d, m) = (ratio, turn, friction);
        let residual = Terms::from([1.0, e, d, d * e, -m * d, -m * d * e, m, m * e]);
        let slopes = SMatrix::<f64, TERMS, 3>::from_columns(&[
            Terms::from([0.0, 1.0, 0.0, d, 0.0, -m * d, 0.0, m]),
            Terms::from([0.0, 0.0, 1.0, e, -m, -m * e, 0.0, 0.0]),
            Terms::from([0.0, 0.0, 0.0, 0.0, -d, -d * e, 1.0, e]),
        ]);
        let products = edge.forces * residual;
        let square = residual.dot(&products).max(0.0) / edge.weight;
        let scale = 1.0 / (square.max(LEAST_FORCE * LEAST_FORCE) * edge.alike);
        let mut normal = slopes.tr_mul(&(edge.forces * slopes)) * scale;
        let mut gradient = slopes.tr_mul(&products) * scale;
        normal[(1, 1)] += 1.0 / prior_turn;
        gradient[1] += turn / prior_turn;
        if let Some((way, variance)) = edge.turn_by_way() {
            normal[(1, 1)] += 1.0 / variance;
            gradient[1] += (turn - way) / variance;
        }
        let own: Matrix2<f64> = normal.fixed_view::<2, 2>(1, 1).into_owned();
        Some(Normal {
            ratio: normal[(0, 0)],
            coupling: Vector2::new(normal[(1, 0)], normal[(2, 0)]),
            inverse: own.try_inverse()?,
            gradient: gradient[0],
            own_gradient: Vector2::new(gradient[1], gradient[2]),
        })
    }
}

#[cfg(test)]
mod tests;

//! The tip on the edge, moved by what carries it.
//!
//! Quasi-static: a spring (what carries the tip) and dry friction in series. The
//! spring's other end is where the motors say that the tip is.

use super::effect::{Effect, State};
use super::parameters::EdgeParameters;

const MILLISECOND: f64 = 1e-3;

/// What is done to the tip at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// Where the motors say that the tip is \[m\].
    pub(super) place: f64,
    /// F_N \[N\].
    pub(super) normal_force: f64,
    /// Since the first session's start \[days\].
    pub(super) date: f64,
    /// \[degC\]
    pub(super) temperature: f64,
}

/// A tip on an edge.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    parameters: EdgeParameters,
    /// Where the tip is \[m\].
    tip: f64,
    /// How fast it slid at last \[m/s\].
    speed: f64,
}

impl Edge {
    /// The tip at `tip` \[m\].
    pub(super) fn new(parameters: EdgeParameters, tip: f64) -> Self {
        Edge {
            parameters,
            tip,
            speed: 0.0,
        }
    }

    /// F_T \[N\] after a millisecond; `factor` is on all friction. Positive
    /// where it opposes a motion towards larger places.
    pub(super) fn millisecond(
        &mut self,
        at: &Moment,
        effects: &[Box<dyn Effect>],
        factor: f64,
    ) -> f64 {
        let stretch = at.place - self.tip;
        let state = State {
            place: self.tip,
            direction: stretch.signum(),
            speed: self.speed,
            normal_force: at.normal_force,
            date: at.date,
            temperature: at.temperature,
        };
        let own = &self.parameters;
        let coulomb = own.b0t * own.coulomb_force(at.normal_force);
        let sum = |part: fn(&dyn Effect, &State) -> f64| -> f64 {
            effects
                .iter()
                .map(|effect| part(effect.as_ref(), &state))
                .sum()
        };
        let holds = (factor * (coulomb + sum(|e, s| e.holds(s)))).max(0.0);
        let damping = factor * (own.film + sum(|e, s| e.damping(s)));
        let pull = own.stiffness * stretch.abs();
        // Sliding at v: k (stretch − v dt) = holds + damping v.
        self.speed = (pull - holds).max(0.0) / (own.stiffness * MILLISECOND + damping.max(0.0));
        self.tip += state.direction * self.speed * MILLISECOND;
        own.stiffness * (at.place - self.tip) + sum(|e, s| e.along(s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slid(edge: &mut Edge, from: f64, to: f64, seconds: f64) -> Vec<f64> {
        let count = (seconds * 1e3) as usize;
        (1..=count)
            .map(|step| {
                let at = Moment {
                    place: from + (to - from) * step as f64 / count as f64,
                    normal_force: 20.0,
                    date: 0.0,
                    temperature: 10.0,
                };
                edge.millisecond(&at, &[], 1.0)
            })
            .collect()
    }

    #[test]
    fn a_sliding_tip_feels_coulomb_and_viscous_friction() {
        let parameters = EdgeParameters::example();
        let force = slid(&mut Edge::new(parameters, 0.0), 0.0, 0.02, 1.0);
        let wanted = parameters.b0t * 20.0 + parameters.film * 0.02;
        assert!(
            (force[999] - wanted).abs() < 1e-3 * wanted,
            "{}",
            force[999]
        );
    }

    /// The paper's Fig. 16: the motors move back, the tip still rests.
    #[test]
    fn after_a_turn_the_force_keeps_its_sign_until_the_spring_has_let_go() {
        let parameters = EdgeParameters {
            stiffness: 1e4,
            ..EdgeParameters::example()
        };
        let mut edge = Edge::new(parameters, 0.0);
        let before = slid(&mut edge, 0.0, 0.02, 1.0)[999];
        let back = slid(&mut edge, 0.02, 0.01, 1.0);
        // Half of the way that winds it up the other way.
        let half = before / parameters.stiffness / 0.01 * 1e3;
        assert!(back[(0.8 * half) as usize] > 0.0 && back[(1.2 * half) as usize] < 0.0);
        assert!(back[(3.0 * half) as usize] < -0.9 * before);
    }
}

//! A joint that starts cold and whose temperature nobody measures: the work of friction warms the
//! lubricant, which gets thinner, −(1 − e^−θ) (c_v q̇ + c_0 sign(q̇)), with θ how warm it is,
//! t_w θ̇ = P/P_0 − θ, P the power of friction. Sizes are those of 5 to 20 K by the laws of this bench.
//!
//! It is not among what can be hidden, since recordings of the bench have a temperature: those that
//! are like real ones bring it along.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State};

#[derive(Clone)]
struct ColdStart {
    /// c_v \[Nm·s/rad\].
    viscous: f64,
    /// c_0 \[Nm\].
    coulomb: f64,
    /// t_w \[s\].
    time_constant: f64,
    /// P_0 \[W\].
    power: f64,
    /// θ \[-\].
    warmth: f64,
}

/// Viscous friction changes, or Coulomb friction with it.
pub(in crate::joint_bench) fn draw(random: &mut Random) -> Box<dyn Effect> {
    let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
    let warming = within(5.0, 20.0);
    Box::new(ColdStart {
        viscous: 0.55 * warming,
        coulomb: 0.16 * warming * within(-0.5, 0.5).max(0.0),
        time_constant: within(40.0, 150.0),
        power: within(1.5, 4.0),
        warmth: 0.0,
    })
}

impl Effect for ColdStart {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("viscous", self.viscous, "Nm·s/rad"),
            ("coulomb", self.coulomb, "Nm"),
            ("time_constant", self.time_constant, "s"),
            ("power", self.power, "W"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        let thinned = 1.0 - (-self.warmth).exp();
        friction.level -= thinned * self.coulomb;
        friction.torque -= thinned * self.viscous * state.velocity;
    }

    fn reset(&mut self) {
        self.warmth = 0.0;
    }

    fn tick(&mut self, work: f64) {
        let heat = work / self.power - 0.001 * self.warmth;
        self.warmth += heat / self.time_constant;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At P_0 it comes to θ = 1 as 1 − e^(−t/t_w), and friction falls by 1 − 1/e of what it can.
    #[test]
    fn it_warms_up_and_gets_thinner() {
        let mut own = ColdStart {
            viscous: 8.0,
            coulomb: 1.5,
            time_constant: 50.0,
            power: 2.0,
            warmth: 0.0,
        };
        let state = State {
            velocity: 0.1,
            ..State::default()
        };
        let less = |own: &ColdStart| {
            let mut friction = Friction::default();
            own.friction(&state, &mut friction);
            [friction.level, friction.torque]
        };
        assert_eq!(less(&own), [0.0; 2]);
        (0..50_000).for_each(|_| own.tick(0.002));
        let one_constant = 1.0 - (-1.0_f64).exp();
        assert!((own.warmth - one_constant).abs() < 1e-4, "{}", own.warmth);
        (0..1_000_000).for_each(|_| own.tick(0.002));
        let [level, torque] = less(&own);
        assert!((level + one_constant * 1.5).abs() < 1e-6, "{level}");
        assert!((torque + one_constant * 0.8).abs() < 1e-6, "{torque}");
        own.reset();
        assert_eq!(less(&own), [0.0; 2]);
    }
}

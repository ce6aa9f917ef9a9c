//! Parameters of the edge on the bench.

use ferntast_emulation::random::Random;

/// Normal force at which hidden effects are given \[N\].
pub(super) const TYPICAL_FORCE: f64 = 15.0;

/// The edge without its hidden effects. Symbols are the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EdgeParameters {
    /// b_0T \[-\].
    pub(super) b0t: f64,
    /// How Coulomb friction grows with F_N: F_N^exponent \[-\].
    pub(super) exponent: f64,
    /// Viscous friction of the film \[N·s/m\].
    pub(super) film: f64,
    /// What carries the tip, along the edge \[N/m\].
    pub(super) stiffness: f64,
}

impl EdgeParameters {
    /// The lubricated or the bare edge, within ±5 %. The paper publishes no
    /// scale for b_0T: it and the film are assumed. A stylus and a contact of
    /// aluminium give way by microns: they can be neglected, as the paper says.
    pub(super) fn draw(random: &mut Random) -> Self {
        let is_lubricated = random.chance(0.5);
        let mut within = |middle: f64| middle * (0.95 + 0.1 * random.uniform());
        EdgeParameters {
            b0t: within(if is_lubricated { 0.16 } else { 0.45 }),
            exponent: 1.0,
            film: within(20.0),
            stiffness: within(5e6),
        }
    }

    /// F_N to its exponent, with \[N\] restored: equal to F_N at
    /// [`TYPICAL_FORCE`].
    pub(super) fn coulomb_force(&self, normal_force: f64) -> f64 {
        let share = normal_force.max(0.0) / TYPICAL_FORCE;
        // A power takes much of a step's time, and most edges need none.
        let raised = match self.exponent {
            1.0 => share,
            exponent => share.powf(exponent),
        };
        TYPICAL_FORCE * raised
    }

    /// Name, value, unit.
    pub(super) fn named(&self) -> [(&'static str, f64, &'static str); 4] {
        [
            ("b0T", self.b0t, "-"),
            ("exponent", self.exponent, "-"),
            ("film", self.film, "N·s/m"),
            ("stiffness", self.stiffness, "N/m"),
        ]
    }

    #[cfg(test)]
    pub(super) fn example() -> Self {
        EdgeParameters {
            b0t: 0.4,
            exponent: 1.0,
            film: 10.0,
            stiffness: 5e6,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_edges_come_up_within_five_percent() {
        let drawn: Vec<f64> = (0..200)
            .map(|seed| EdgeParameters::draw(&mut Random::new(seed)).b0t)
            .collect();
        let near = |middle: f64| {
            let near = drawn.iter().filter(|b| (*b / middle - 1.0).abs() < 0.0501);
            near.count()
        };
        assert!(near(0.16) > 60 && near(0.45) > 60);
        assert_eq!(near(0.16) + near(0.45), 200);
    }
}

//! The impedance of a human hand about where it wants to be:
//!
//! M ẍ = K (x_t − x) + B (ẋ_t − ẋ) + F
//!
//! with target x_t and the force F on the hand. A linear mass, damper and
//! spring describe small motions of arm and hand well (Hogan 1989,
//! "Controlling impedance at the man/machine interface"). Measured at the hand
//! of relaxed to tense people: M 0.5–2 kg, B 5–50 N·s/m, K 50–1000 N/m (Tsuji,
//! Morasso, Goto, Ito 1995, "Human hand impedance characteristics during
//! maintained posture"; Speich, Shao, Goldfarb 2005, "Modeling the human hand as it
//! interacts with a telemanipulation system").

use ferntast_model::parameters;

parameters! {
    /// Impedance of hand and handle, the same along all axes; by default a firm
    /// grip, as it is often taken in stability analyses of teleoperators
    /// (Hashtrudi-Zaad and Salcudean 2001).
    #[derive(Copy)]
    pub struct ImpedanceParameters {
        /// M \[kg\].
        pub mass: f64 [0.01..=20.0, "kg"] = 0.5,
        /// B \[N·s/m\].
        pub damping: f64 [0.0..=1000.0, "N·s/m"] = 50.0,
        /// K \[N/m\].
        pub stiffness: f64 [1.0..=10_000.0, "N/m"] = 1000.0,
    }
}

/// The hand as a mass on damper and spring, in the plane or in space.
#[derive(Clone, Copy, Debug)]
pub struct HandImpedance<const AXES: usize = 2> {
    parameters: ImpedanceParameters,
    position: [f64; AXES],
    velocity: [f64; AXES],
}

impl<const AXES: usize> HandImpedance<AXES> {
    /// At rest at `position` \[m\].
    pub fn new(parameters: ImpedanceParameters, position: [f64; AXES]) -> Self {
        HandImpedance {
            parameters,
            position,
            velocity: [0.0; AXES],
        }
    }

    /// From now on it holds like this.
    pub fn hold(&mut self, parameters: ImpedanceParameters) {
        self.parameters = parameters;
    }

    /// Position \[m\].
    pub fn position(&self) -> [f64; AXES] {
        self.position
    }

    /// Velocity \[m/s\].
    pub fn velocity(&self) -> [f64; AXES] {
        self.velocity
    }

    /// Moves on by `dt` \[s\] towards `target` \[m\], which moves at
    /// `target_velocity` \[m/s\], under `force` \[N\]. Implicit Euler: stable
    /// for every `dt`. A force that is not finite counts as none.
    pub fn step(
        &mut self,
        dt: f64,
        target: [f64; AXES],
        target_velocity: [f64; AXES],
        force: [f64; AXES],
    ) {
        let ImpedanceParameters {
            mass,
            damping,
            stiffness,
        } = self.parameters;
        for axis in 0..AXES {
            let force = if force[axis].is_finite() {
                force[axis]
            } else {
                0.0
            };
            let pull = stiffness * (target[axis] - self.position[axis])
                + damping * target_velocity[axis]
                + force;
            self.velocity[axis] = (mass * self.velocity[axis] + dt * pull)
                / (mass + dt * damping + dt * dt * stiffness);
            self.position[axis] += self.velocity[axis] * dt;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARAMETERS: ImpedanceParameters = ImpedanceParameters {
        mass: 1.0,
        damping: 10.0,
        stiffness: 400.0,
    };

    #[test]
    fn under_a_force_it_gives_way_by_force_over_stiffness() {
        let mut hand = HandImpedance::new(PARAMETERS, [0.0; 2]);
        for _ in 0..5000 {
            hand.step(1e-3, [0.01, 0.0], [0.0; 2], [-8.0, 2.0]);
        }
        assert!((hand.position()[0] - (0.01 - 0.02)).abs() < 1e-9);
        assert!((hand.position()[1] - 0.005).abs() < 1e-9);
    }

    #[test]
    fn let_go_it_swings_at_its_own_frequency() {
        // ω_d = √(K/M − B²/4M²) = √(400 − 25) = 19.365 rad/s: 0.1622 s to the
        // first minimum; it overshoots by exp(−δπ/ω_d), δ = 5.
        let mut hand = HandImpedance::new(PARAMETERS, [0.02, 0.0]);
        let (mut lowest, mut when) = (0.0, 0.0);
        for k in 1..=4000 {
            hand.step(1e-4, [0.0; 2], [0.0; 2], [0.0; 2]);
            if hand.position()[0] < lowest {
                (lowest, when) = (hand.position()[0], f64::from(k) * 1e-4);
            }
        }
        let frequency = 375f64.sqrt();
        assert!(
            (when - std::f64::consts::PI / frequency).abs() < 1e-3,
            "{when} s"
        );
        let overshoot = 0.02 * (-5.0 * std::f64::consts::PI / frequency).exp();
        assert!((lowest / -overshoot - 1.0).abs() < 0.02, "{lowest} m");
    }
}

//! A cable along the joint, on the motor side of the torque sensor: k_c (q − q_0).
//! A straight line over q, whatever the direction.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct CableSpring {
    /// k_c \[Nm/rad\].
    kc: f64,
    /// q_0 \[rad\].
    q0: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(CableSpring {
        kc: strength * about(9.0, random),
        q0: 0.4 * random.uniform(),
    })
}

impl Effect for CableSpring {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("kc", self.kc, "Nm/rad"), ("q0", self.q0, "rad")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.kc * (state.position - self.q0);
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

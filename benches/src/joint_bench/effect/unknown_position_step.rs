//! Outside the catalogue: a step of torque at one position, whatever the
//! direction, a tanh((q − q_c)/w), as of a stop that leans on.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, either_sign};

#[derive(Clone)]
struct UnknownPositionStep {
    /// a \[Nm\].
    torque: f64,
    /// q_c \[rad\].
    centre: f64,
    /// w \[rad\].
    width: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownPositionStep {
        torque: strength * either_sign(1.5, random),
        centre: 0.08 + 0.18 * random.uniform(),
        width: 0.004,
    })
}

impl Effect for UnknownPositionStep {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("torque", self.torque, "Nm"),
            ("centre", self.centre, "rad"),
            ("width", self.width, "rad"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.torque * ((state.position - self.centre) / self.width).tanh();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

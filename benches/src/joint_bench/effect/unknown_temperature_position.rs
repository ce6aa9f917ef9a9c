//! Outside the catalogue: a pull that turns with temperature and position,
//! c (T − T₀)(q − q_c), as of a cable that stiffens in the cold.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, either_sign};

#[derive(Clone)]
struct UnknownTemperaturePosition {
    /// c \[Nm/(K rad)\].
    coupling: f64,
    /// T₀ \[degC\].
    t0: f64,
    /// q_c \[rad\].
    centre: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownTemperaturePosition {
        coupling: strength * either_sign(1.0, random),
        t0: 10.0,
        centre: 0.1 + 0.2 * random.uniform(),
    })
}

impl Effect for UnknownTemperaturePosition {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("coupling", self.coupling, "Nm/(K rad)"),
            ("t0", self.t0, "degC"),
            ("centre", self.centre, "rad"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque +=
            self.coupling * (state.temperature - self.t0) * (state.position - self.centre);
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

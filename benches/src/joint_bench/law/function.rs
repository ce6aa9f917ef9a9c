//! Functions that laws are drawn from: as people write down what machines do, not as
//! a program searches.

use ferntast_emulation::random::Random;

/// A function of a quantity over its usual size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    /// u / (1 + |u|/a), which levels off.
    Levelling(f64),
    /// 2/π · atan(u / a).
    Arc(f64),
    /// u / √(a² + u²).
    Rounded(f64),
    /// 1 / (1 + e^(−(u − b)/a)).
    Logistic(f64, f64),
    /// 1 / (1 + ((u − b)/a)²), a resonance.
    Resonance(f64, f64),
    /// 1 / cosh((u − b)/a).
    Hump(f64, f64),
    /// max(0, u − b).
    Engaging(f64),
    /// a ln(1 + e^((u − b)/a)), which engages softly.
    Soft(f64, f64),
    /// |u|^p.
    Power(f64),
    /// |u|^p with the sign of u.
    OddPower(f64),
    /// 1 / (a + |u|).
    Falling(f64),
    /// 1 + a u.
    Slope(f64),
}

use Function::{
    Arc, Engaging, Falling, Hump, Levelling, Logistic, OddPower, Power, Resonance, Rounded, Slope,
    Soft,
};

impl Function {
    /// One that a quantity may enter by: with a sign (`odd`), without, or about places
    /// other than zero (`placed`).
    pub(super) fn draw(odd: bool, placed: bool, random: &mut Random) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let (width, place, power) = (between(0.15, 0.5), between(0.25, 0.75), between(0.5, 2.6));
        let pick = (between(0.0, 1.0) * 6.0) as usize;
        match (placed, odd) {
            (true, _) => match pick {
                0 => Logistic(0.3 * width, place),
                1 => Resonance(0.5 * width, place),
                2 => Hump(0.5 * width, place),
                3 => Engaging(place),
                4 => Soft(0.2 * width, place),
                _ => Slope(-place.recip()),
            },
            (false, true) => match pick {
                0 | 1 => Levelling(width),
                2 => Arc(width),
                3 => Rounded(width),
                _ => OddPower(power),
            },
            (false, false) => match pick {
                0 => Resonance(width, 0.0),
                1 => Falling(0.5 * width),
                2 => Hump(width, 0.0),
                _ => Power(power),
            },
        }
    }

    /// The function in words, of what is called so.
    pub(super) fn of(self, quantity: &str) -> String {
        let (name, numbers) = match self {
            Levelling(a) => ("levelling", vec![a]),
            Arc(a) => ("arc", vec![a]),
            Rounded(a) => ("rounded", vec![a]),
            Logistic(a, b) => ("logistic", vec![a, b]),
            Resonance(a, b) => ("resonance", vec![a, b]),
            Hump(a, b) => ("hump", vec![a, b]),
            Engaging(b) => ("engaging", vec![b]),
            Soft(a, b) => ("soft", vec![a, b]),
            Power(p) => ("power", vec![p]),
            OddPower(p) => ("odd power", vec![p]),
            Falling(a) => ("falling", vec![a]),
            Slope(a) => ("slope", vec![a]),
        };
        let numbers: Vec<String> = numbers.iter().map(|own| format!("{own:.3}")).collect();
        format!("{name}({}) of {quantity}", numbers.join(", "))
    }

    pub(super) fn value(self, u: f64) -> f64 {
        match self {
            Levelling(a) => u / (1.0 + u.abs() / a),
            Arc(a) => std::f64::consts::FRAC_2_PI * (u / a).atan(),
            Rounded(a) => u / a.hypot(u),
            Logistic(a, b) => 1.0 / (1.0 + (-(u - b) / a).exp()),
            Resonance(a, b) => 1.0 / (1.0 + ((u - b) / a).powi(2)),
            Hump(a, b) => 1.0 / ((u - b) / a).cosh(),
            Engaging(b) => (u - b).max(0.0),
            Soft(a, b) => a * (1.0 + ((u - b) / a).exp()).ln(),
            Power(p) => u.abs().powf(p),
            OddPower(p) => u.abs().powf(p).copysign(u),
            Falling(a) => 1.0 / (a + u.abs()),
            Slope(a) => 1.0 + a * u,
        }
    }
}

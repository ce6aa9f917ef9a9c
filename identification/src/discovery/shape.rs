//! Functions of one signal that formulas are made of.

use super::dimension::Dimension;

/// A function of one signal x. Those with constants hold them as (place, scale),
/// of which each uses what it needs; arguments of what is no power are x over a
/// scale, which has the unit of x.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Shape {
    /// x
    Linear,
    /// |x|
    Size,
    /// x²
    Square,
    /// x |x|
    SignedSquare,
    /// x³
    Cube,
    /// √|x|
    Root,
    /// √|x| with the sign of x
    SignedRoot,
    /// x − place
    Shifted,
    /// |x − place|
    Bend,
    /// |x − place| + x − place: twice what is beyond the place, nothing before it
    Above,
    /// |x − place| − (x − place): twice what is short of the place, nothing beyond it
    Below,
    /// (x − place)²
    Bowl,
    /// tanh(x / scale)
    Tanh,
    /// tanh(|x| / scale)
    SizeTanh,
    /// tanh((x − place) / scale)
    Step,
    /// exp(−|x| / scale)
    Decay,
    /// The same with the sign of x
    SignedDecay,
    /// exp(−(x / scale)²)
    Bell,
    /// The same with the sign of x
    SignedBell,
    /// exp(−((x − place) / scale)²)
    Spot,
    /// exp(x / scale)
    Growth,
    /// ln(1 + |x| / scale)
    Logarithm,
    /// The same with the sign of x
    SignedLogarithm,
    /// sin(x / scale)
    Sine,
    /// cos(x / scale)
    Cosine,
}

/// Which constants a shape has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Constants {
    pub(super) place: bool,
    pub(super) scale: bool,
}

use Shape::{
    Above, Bell, Below, Bend, Bowl, Cosine, Cube, Decay, Growth, Linear, Logarithm, Root, Shifted,
    SignedBell, SignedDecay, SignedLogarithm, SignedRoot, SignedSquare, Sine, Size, SizeTanh, Spot,
    Square, Step, Tanh,
};

impl Shape {
    /// All of them.
    #[cfg(test)]
    pub(super) const ALL: [Self; 25] = [
        Linear,
        Size,
        Square,
        SignedSquare,
        Cube,
        Root,
        SignedRoot,
        Shifted,
        Bend,
        Above,
        Below,
        Bowl,
        Tanh,
        SizeTanh,
        Step,
        Decay,
        SignedDecay,
        Bell,
        SignedBell,
        Spot,
        Growth,
        Logarithm,
        SignedLogarithm,
        Sine,
        Cosine,
    ];

    /// Its value at `x`.
    pub(super) fn value(self, x: f64, [place, scale]: [f64; 2]) -> f64 {
        let sign = crate::effects::sign(x);
        let shifted = x - place;
        match self {
            Linear => x,
            Size => x.abs(),
            Square => x * x,
            SignedSquare => x * x.abs(),
            Cube => x * x * x,
            Root => x.abs().sqrt(),
            SignedRoot => x.abs().sqrt() * sign,
            Shifted => shifted,
            Bend => shifted.abs(),
            Above => shifted.abs() + shifted,
            Below => shifted.abs() - shifted,
            Bowl => shifted * shifted,
            Tanh => (x / scale).tanh(),
            SizeTanh => (x.abs() / scale).tanh(),
            Step => (shifted / scale).tanh(),
            Decay => (-x.abs() / scale).exp(),
            SignedDecay => (-x.abs() / scale).exp() * sign,
            Bell => (-(x / scale).powi(2)).exp(),
            SignedBell => (-(x / scale).powi(2)).exp() * sign,
            Spot => (-(shifted / scale).powi(2)).exp(),
            Growth => (x / scale).exp(),
            Logarithm => (1.0 + x.abs() / scale).ln(),
            SignedLogarithm => (1.0 + x.abs() / scale).ln() * sign,
            Sine => (x / scale).sin(),
            Cosine => (x / scale).cos(),
        }
    }

    /// The same as text that the lab reads, with its constants as texts.
    pub(super) fn text(self, x: &str, [place, scale]: [&Constant; 2]) -> String {
        let scale = &scale.text;
        let shifted = place.taken_from(x);
        match self {
            Linear => x.to_owned(),
            Size => format!("abs({x})"),
            Square => format!("{x}^2"),
            SignedSquare => format!("{x}*abs({x})"),
            Cube => format!("{x}^3"),
            Root => format!("sqrt(abs({x}))"),
            SignedRoot => format!("sqrt(abs({x}))*sign({x})"),
            Shifted => format!("({shifted})"),
            Bend => format!("abs({shifted})"),
            Above => format!("(abs({shifted}) + {shifted})"),
            Below => format!("(abs({shifted}) - ({shifted}))"),
            Bowl => format!("({shifted})^2"),
            Tanh => format!("tanh({x}/{scale})"),
            SizeTanh => format!("tanh(abs({x})/{scale})"),
            Step => format!("tanh(({shifted})/{scale})"),
            Decay => format!("exp(-abs({x})/{scale})"),
            SignedDecay => format!("exp(-abs({x})/{scale})*sign({x})"),
            Bell => format!("exp(-({x}/{scale})^2)"),
            SignedBell => format!("exp(-({x}/{scale})^2)*sign({x})"),
            Spot => format!("exp(-(({shifted})/{scale})^2)"),
            Growth => format!("exp({x}/{})", place_in_parentheses(scale)),
            Logarithm => format!("ln(1 + abs({x})/{scale})"),
            SignedLogarithm => format!("ln(1 + abs({x})/{scale})*sign({x})"),
            Sine => format!("sin({x}/{scale})"),
            Cosine => format!("cos({x}/{scale})"),
        }
    }

    /// Which constants it has.
    pub(super) const fn constants(self) -> Constants {
        let (place, scale) = match self {
            Linear | Size | Square | SignedSquare | Cube | Root | SignedRoot => (false, false),
            Shifted | Bend | Above | Below | Bowl => (true, false),
            Step | Spot => (true, true),
            Tanh | SizeTanh | Decay | SignedDecay | Bell | SignedBell | Growth | Logarithm
            | SignedLogarithm | Sine | Cosine => (false, true),
        };
        Constants { place, scale }
    }

    /// The power of the signal's unit that its value has.
    pub(super) const fn power(self) -> f64 {
        match self {
            Linear | Size | Shifted | Bend | Above | Below => 1.0,
            Square | SignedSquare | Bowl => 2.0,
            Cube => 3.0,
            Root | SignedRoot => 0.5,
            _ => 0.0,
        }
    }

    /// Signals, functions and constants that a reader has to take in.
    pub(super) const fn complexity(self) -> usize {
        match self {
            Linear => 1,
            Size | Square | Cube => 2,
            SignedSquare | Root | Shifted => 3,
            SignedRoot | Bend | Bowl | Tanh | Growth | Sine | Cosine => 4,
            SizeTanh | Decay | Bell => 5,
            Step | SignedDecay | SignedBell | Logarithm | Above | Below => 6,
            Spot | SignedLogarithm => 7,
        }
    }
}

/// A constant as a text: a number, or its name.
#[derive(Clone, Debug, Default)]
pub(super) struct Constant {
    pub(super) text: String,
}

impl Constant {
    /// `x - 0.2`; with a negative number `x + 0.2`.
    fn taken_from(&self, x: &str) -> String {
        match self.text.strip_prefix('-') {
            Some(size) => format!("{x} + {size}"),
            None => format!("{x} - {}", self.text),
        }
    }
}

/// A number that may be negative, as an operand.
fn place_in_parentheses(text: &str) -> String {
    match text.starts_with('-') {
        true => format!("({text})"),
        false => text.to_owned(),
    }
}

/// A signal's unit, to the power that a shape's value has.
pub(super) fn unit_of(shape: Shape, signal: &Dimension) -> Dimension {
    Dimension::default().times(signal, shape.power())
}

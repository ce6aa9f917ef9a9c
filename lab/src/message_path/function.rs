//! Functions at the end of a path, `.@name` or `.@name(number)`.

use std::fmt;

/// A function of one number. Those of Foxglove that turn units and signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Function {
    /// `.@abs`: |x|.
    Absolute,
    /// `.@negative`: −x.
    Negative,
    /// `.@deg2rad`: degrees to radians.
    DegreesToRadians,
    /// `.@rad2deg`: radians to degrees.
    RadiansToDegrees,
    /// `.@add(a)`: x + a.
    Add(f64),
    /// `.@sub(a)`: x − a.
    Subtract(f64),
    /// `.@mul(a)`: x a.
    Multiply(f64),
    /// `.@div(a)`: x / a; a is not 0.
    Divide(f64),
}

/// The functions by the names that stand in a path, for messages.
pub const FUNCTIONS: &str =
    "abs, negative, deg2rad, rad2deg, add(number), sub(number), mul(number), div(number)";

impl Function {
    /// The function called `name`, with the number in its parentheses if it
    /// has one; `None` when there is no such function.
    pub fn from_name(name: &str, argument: Option<f64>) -> Option<Function> {
        match (name, argument) {
            ("abs", None) => Some(Function::Absolute),
            ("negative", None) => Some(Function::Negative),
            ("deg2rad", None) => Some(Function::DegreesToRadians),
            ("rad2deg", None) => Some(Function::RadiansToDegrees),
            ("add", Some(number)) => Some(Function::Add(number)),
            ("sub", Some(number)) => Some(Function::Subtract(number)),
            ("mul", Some(number)) => Some(Function::Multiply(number)),
            ("div", Some(number)) if number != 0.0 => Some(Function::Divide(number)),
            _ => None,
        }
    }

    /// Its value at `x`.
    pub fn apply(self, x: f64) -> f64 {
        match self {
            Function::Absolute => x.abs(),
            Function::Negative => -x,
            Function::DegreesToRadians => x.to_radians(),
            Function::RadiansToDegrees => x.to_degrees(),
            Function::Add(number) => x + number,
            Function::Subtract(number) => x - number,
            Function::Multiply(number) => x * number,
            Function::Divide(number) => x / number,
        }
    }
}

impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Function::Absolute => f.write_str(".@abs"),
            Function::Negative => f.write_str(".@negative"),
            Function::DegreesToRadians => f.write_str(".@deg2rad"),
            Function::RadiansToDegrees => f.write_str(".@rad2deg"),
            Function::Add(number) => write!(f, ".@add({number})"),
            Function::Subtract(number) => write!(f, ".@sub({number})"),
            Function::Multiply(number) => write!(f, ".@mul({number})"),
            Function::Divide(number) => write!(f, ".@div({number})"),
        }
    }
}

//! Units of signals, and those that the constants of a formula follow from.

use crate::data::JointType;

/// Powers of the base units: force or torque, angle or way, second, kelvin; and
/// of the signals whose unit is not known, by their place among them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Dimension {
    base: [f64; 4],
    own: Vec<(String, f64)>,
}

const FORCE: usize = 0;
const ANGLE: usize = 1;
const SECOND: usize = 2;
const KELVIN: usize = 3;

impl Dimension {
    const fn of(base: [f64; 4]) -> Self {
        Self {
            base,
            own: Vec::new(),
        }
    }

    /// Of the torque that a formula gives, and of loads.
    pub(super) const fn force() -> Self {
        Self::of([1.0, 0.0, 0.0, 0.0])
    }

    /// Of a position differentiated `order` times.
    pub(super) fn motion(order: u8) -> Self {
        Self::of([0.0, 1.0, -f64::from(order), 0.0])
    }

    /// Of time.
    pub(super) const fn second() -> Self {
        Self::of([0.0, 0.0, 1.0, 0.0])
    }

    /// Of differences of temperature.
    pub(super) const fn kelvin() -> Self {
        Self::of([0.0, 0.0, 0.0, 1.0])
    }

    /// Of a signal of which nothing is known but its name.
    pub(super) fn own(name: &str) -> Self {
        Self {
            own: vec![(format!("[{name}]"), 1.0)],
            ..Self::default()
        }
    }

    /// Times `other` to a power.
    pub(super) fn times(mut self, other: &Self, power: f64) -> Self {
        for (own, other) in self.base.iter_mut().zip(other.base) {
            *own += power * other;
        }
        for (name, exponent) in &other.own {
            match self.own.iter_mut().find(|(own, _)| own == name) {
                Some((_, own)) => *own += power * exponent,
                None => self.own.push((name.clone(), power * exponent)),
            }
        }
        self
    }

    /// As text, of this kind of joint: `Nm s/rad`.
    pub(super) fn text(&self, joint: JointType) -> String {
        let angle = match joint {
            JointType::Revolute => "rad",
            JointType::Prismatic | JointType::Contact => "m",
        };
        let mut powers = vec![
            (joint.force_unit().to_owned(), self.base[FORCE]),
            (angle.to_owned(), self.base[ANGLE]),
            ("s".to_owned(), self.base[SECOND]),
            ("K".to_owned(), self.base[KELVIN]),
        ];
        powers.extend(self.own.iter().cloned());
        let side = |sign: f64| -> Vec<String> {
            let on_side = powers.iter().filter(|(_, power)| sign * power > 1e-9);
            on_side
                .map(|(unit, power)| format!("{unit}{}", superscript(power.abs())))
                .collect()
        };
        // Seconds before angles above the line, as in Nm s/rad.
        let (above, below) = (side(1.0), side(-1.0));
        let top = match above.is_empty() {
            true => "1".to_owned(),
            false => above.join(" "),
        };
        match below.as_slice() {
            [] => top,
            [one] => format!("{top}/{one}"),
            all => format!("{top}/({})", all.join(" ")),
        }
    }
}

/// A power as it stands behind its unit.
fn superscript(power: f64) -> String {
    let text = match power {
        p if (p - 1.0).abs() < 1e-9 => return String::new(),
        p if (p - p.round()).abs() < 1e-9 => format!("{}", p.round()),
        p => return format!("^{p}"),
    };
    let digit = |c: char| match c {
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        other => other,
    };
    text.chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_read_as_those_of_the_catalogue() {
        let force = Dimension::force;
        let viscous = force().times(&Dimension::motion(1), -1.0);
        assert_eq!(viscous.text(JointType::Revolute), "Nm s/rad");
        assert_eq!(viscous.text(JointType::Prismatic), "N s/m");
        let quadratic = force().times(&Dimension::motion(1), -2.0);
        assert_eq!(quadratic.text(JointType::Revolute), "Nm s²/rad²");
        let by_load = force().times(&force(), -1.0);
        assert_eq!(by_load.text(JointType::Revolute), "1");
        let warm = (force().times(&Dimension::kelvin(), -1.0)).times(&Dimension::motion(0), -1.0);
        assert_eq!(warm.text(JointType::Revolute), "Nm/(rad K)");
        let root = force().times(&force(), -0.5);
        assert_eq!(root.text(JointType::Revolute), "Nm^0.5");
        let own = force().times(&Dimension::own("supply"), -1.0);
        assert_eq!(own.text(JointType::Revolute), "Nm/[supply]");
        assert_eq!(Dimension::motion(1).text(JointType::Revolute), "rad/s");
    }
}

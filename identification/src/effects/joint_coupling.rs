//! Friction and torque that reach a joint from another one of its arm: a gear that is
//! driven through another joint, belts side by side, a wrist with a differential.

use ferntast_model::friction::{Contrast, EffectParameter, ONE, Proposal, Row, TORQUE, Unit};

use super::{Effect, EffectDescription, Memory, Point, free, sign};

/// Its id.
pub const COUPLING: &str = "joint_coupling";
/// What the extra signal with another joint's position \[rad\] is called, before its name.
pub const POSITION_OF: &str = "position_";
/// The same of its velocity \[rad/s\].
pub const VELOCITY_OF: &str = "velocity_";
/// The same of the torque \[Nm\] that moves its links.
pub const LOAD_OF: &str = "load_";

/// Friction by the other joint's motion, as a value of the second shape parameter.
const BY_MOTION: f64 = 0.0;
/// Its torque.
const BY_TORQUE: f64 = 1.0;

static ROW: Row = Row {
    id: COUPLING,
    equation: "τ_F = cv · q̇_k + cc · sign(q̇_k), or ct · τ_k, of another joint k",
    source: "Staubli TX40: axis 6 is driven through axis 5",
    coefficients: &[
        free("cv", Unit::new("Nm s/rad", "N s/m")),
        free("cc", TORQUE),
        free("ct", ONE),
    ],
    shape: &[free("from", ONE), free("by", ONE)],
    shows_as: "over another joint's velocity or torque",
    excited_by: "motion of the other joint while this one goes at constant speed",
    shown_by: Proposal::WideSpeedRange,
    contrasts: &[Contrast::WideSpeedRange],
    confusable_with: &["viscous", "coulomb"],
    ..Row::NONE
};

/// Torque on a joint by the motion of another one. Its shape is the number of the
/// other joint, and whether its motion or its torque counts.
pub struct JointCoupling {
    description: EffectDescription,
    /// The other joints' velocities, then their torques.
    signals: Vec<String>,
    others: usize,
}

impl JointCoupling {
    /// Of the joints whose motion is among these extra signals; `None` where there
    /// is none.
    pub fn among<'a>(extras: impl Iterator<Item = &'a String>) -> Option<Self> {
        let names: Vec<&str> = extras
            .filter_map(|name| name.strip_prefix(VELOCITY_OF))
            .collect();
        let with = |prefix: &'static str| names.iter().map(move |name| format!("{prefix}{name}"));
        (!names.is_empty()).then(|| Self {
            description: EffectDescription::from_row(&ROW),
            signals: with(VELOCITY_OF).chain(with(LOAD_OF)).collect(),
            others: names.len(),
        })
    }

    /// The other joint that a shape names, and which of the coefficients it has.
    #[must_use]
    pub fn partner(&self, shape: &[f64]) -> Option<(&str, &'static [EffectParameter])> {
        let [from, by, ..] = shape else {
            return None;
        };
        let name = self
            .signals
            .get(*from as usize)?
            .strip_prefix(VELOCITY_OF)?;
        let (motion, torque) = ROW.coefficients.split_at(2);
        Some((name, if *by == BY_TORQUE { torque } else { motion }))
    }
}

impl Effect for JointCoupling {
    fn description(&self) -> &EffectDescription {
        &self.description
    }

    fn row(&self) -> &'static Row {
        &ROW
    }

    fn shapes(&self, _facts: &super::Facts) -> Vec<Vec<f64>> {
        let each = (0..self.others).map(|from| from as f64);
        each.flat_map(|from| [BY_MOTION, BY_TORQUE].map(|by| vec![from, by]))
            .collect()
    }

    fn freedom(&self) -> usize {
        2
    }

    fn evaluate(&self, _shape: &[f64], _point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        columns.fill(0.0);
    }

    fn extra(&self) -> &[String] {
        &self.signals
    }

    fn evaluate_with(
        &self,
        shape: &[f64],
        _point: &Point,
        extra: &[f64],
        _memory: &mut Memory,
        columns: &mut [f64],
    ) {
        columns.fill(0.0);
        let (&[from, by, ..], [viscous, coulomb, torque]) = (shape, columns) else {
            return;
        };
        let of = |at: usize| extra.get(at).copied().unwrap_or(0.0);
        if by == BY_TORQUE {
            *torque = of(from as usize + self.others);
        } else {
            let velocity = of(from as usize);
            (*viscous, *coulomb) = (velocity, sign(velocity));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_other_joint_is_offered_by_motion_and_by_torque() {
        let extras = ["load_a", "load_b", "supply", "velocity_a", "velocity_b"];
        let extras = extras.map(String::from);
        let coupling = JointCoupling::among(extras.iter()).unwrap();
        assert_eq!(
            coupling.extra(),
            ["velocity_a", "velocity_b", "load_a", "load_b"]
        );
        let at = |shape: &[f64]| {
            let mut columns = [9.0; 3];
            let values = [0.5, -0.25, 3.0, 4.0];
            let point = Point::default();
            coupling.evaluate_with(shape, &point, &values, &mut [0.0; 4], &mut columns);
            columns
        };
        assert_eq!(at(&[1.0, BY_MOTION]), [-0.25, -1.0, 0.0]);
        assert_eq!(at(&[0.0, BY_TORQUE]), [0.0, 0.0, 3.0]);
        let (name, own) = coupling.partner(&[1.0, BY_TORQUE]).unwrap();
        assert_eq!((name, own[0].name, own.len()), ("b", "ct", 1));
        assert!(JointCoupling::among(extras[2..3].iter()).is_none());
    }
}

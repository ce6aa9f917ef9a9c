//! The ways in which a joint may be read.

use ferntast_model::friction::JointType;

/// How one joint is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Whose position it has, …
    pub position_of: usize,
    /// … and whose torque.
    pub torque_of: usize,
    /// ±1.
    pub direction: f64,
    /// ±1.
    pub torque: f64,
    /// Quarters of a turn.
    pub quarters: u8,
}

impl Reading {
    /// As the model has it.
    pub const fn plain(joint: usize) -> Self {
        Self {
            position_of: joint,
            torque_of: joint,
            direction: 1.0,
            torque: 1.0,
            quarters: 0,
        }
    }

    /// In how many ways it is other than the model has joint number `at`.
    pub fn parts(&self, at: usize) -> usize {
        let other = [
            self.position_of != at,
            self.torque_of != at,
            self.direction < 0.0,
            self.direction * self.torque < 0.0,
            self.quarters != 0,
        ];
        other.into_iter().filter(|own| *own).count()
    }

    /// The other ways to read the same channels.
    pub fn others(self, kind: JointType) -> Vec<Self> {
        let quarters = match kind {
            JointType::Revolute => 4,
            _ => 1,
        };
        let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let all = signs.into_iter().flat_map(|[direction, torque]| {
            (0..quarters).map(move |quarters| Self {
                direction,
                torque,
                quarters,
                ..self
            })
        });
        all.filter(|own| *own != self).collect()
    }
}

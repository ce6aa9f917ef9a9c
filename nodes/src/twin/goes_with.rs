//! Which signal the residual goes with, from the latest rows alone.

use ferntast_identification::twin::TwinOutput;

/// Rows that are remembered.
const ROWS: f64 = 200.0;
/// Share of the residual's mean square that a signal has to explain \[1\].
const LEAST_SHARE: f64 = 0.3;
/// What the residual is held against. Friction turns with the motion: so do all
/// but load and position as they are.
const SHAPES: [&str; 8] = [
    "velocity",
    "velocity",
    "velocity",
    "load",
    "load",
    "position",
    "position",
    "temperature",
];

/// Means over the latest rows, each row weighing less than the one after it.
#[derive(Clone, Debug, Default)]
pub(super) struct GoesWith {
    rows: f64,
    residual: f64,
    squared: f64,
    position: f64,
    temperature: f64,
    shapes: [Means; SHAPES.len()],
}

#[derive(Clone, Copy, Debug, Default)]
struct Means {
    mean: f64,
    squared: f64,
    product: f64,
}

impl GoesWith {
    /// Takes a row in which the joint slides.
    pub(super) fn note(&mut self, row: &TwinOutput) {
        self.rows += 1.0;
        let share = 1.0 / self.rows.min(ROWS);
        let residual = row.measured - row.predicted;
        let direction = row.velocity.signum();
        // From their means, or direction alone would be in them.
        self.position += share * (row.position - self.position);
        self.temperature += share * (row.temperature - self.temperature);
        let position = row.position - self.position;
        let temperature = row.temperature - self.temperature;
        let values = [
            direction,
            row.velocity,
            row.velocity * row.velocity.abs(),
            row.joint_torque,
            row.joint_torque.abs() * direction,
            position,
            position * direction,
            temperature * direction,
        ];
        self.residual += share * (residual - self.residual);
        self.squared += share * (residual * residual - self.squared);
        for (means, value) in self.shapes.iter_mut().zip(values) {
            means.mean += share * (value - means.mean);
            means.squared += share * (value * value - means.squared);
            means.product += share * (value * residual - means.product);
        }
    }

    /// The signal that explains most of the residual, if one explains enough.
    pub(super) fn name(&self) -> Option<&'static str> {
        let variance = self.squared - self.residual * self.residual;
        let shares = self.shapes.iter().map(|means| {
            let own = means.squared - means.mean * means.mean;
            let common = means.product - means.mean * self.residual;
            match own > 1e-9 * means.squared && variance > 0.0 {
                true => common * common / (own * variance),
                false => 0.0,
            }
        });
        // Of equals the first: direction alone before what only turns with it.
        let mut best = (LEAST_SHARE, None);
        for (share, name) in shares.zip(SHAPES) {
            if share > best.0 + 1e-3 {
                best = (share, Some(name));
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(residual: impl Fn(f64, f64, f64) -> f64) -> Option<&'static str> {
        let mut own = GoesWith::default();
        for i in 0..400 {
            let t = f64::from(i) * 0.05;
            let (velocity, load, turn) = ((0.7 * t).cos(), (1.9 * t).sin(), (0.7 * t).sin());
            own.note(&TwinOutput {
                time: t,
                // Around a place that is not zero.
                position: 3.0 + turn,
                velocity,
                joint_torque: load,
                temperature: 20.0,
                measured: 5.0 + residual(velocity, load, turn),
                predicted: 5.0,
                followed: 5.0,
                slides: true,
            });
        }
        own.name()
    }

    #[test]
    fn the_signal_is_named_that_made_the_residual() {
        assert_eq!(told(|velocity, _, _| 3.0 * velocity), Some("velocity"));
        assert_eq!(
            told(|velocity, _, _| 2.0 * velocity.signum()),
            Some("velocity")
        );
        assert_eq!(
            told(|velocity, load, _| load.abs() * velocity.signum()),
            Some("load")
        );
        assert_eq!(told(|_, _, position| position), Some("position"));
        let mut k = 0.0_f64;
        let noise = std::cell::RefCell::new(|| {
            k += 1.0;
            (k * k * 12.9898).sin()
        });
        assert_eq!(told(|_, _, _| (noise.borrow_mut())()), None);
    }
}

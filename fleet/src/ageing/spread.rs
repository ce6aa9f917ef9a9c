//! How far robots differ from one another and from day to day.

/// Variances, as shares of the siblings' size: between robots and from day to day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Of the noise, over the square of the standard error that the twin tells.
    pub noise: f64,
    /// Of what fades within days.
    pub wander: f64,
    /// Of the random walk \[1/d\].
    pub walk: f64,
    /// Between the robots' drifts \[1/d²\].
    pub drift: f64,
    /// Between the robots' slopes with temperature \[1/(10 K)²\].
    pub slope: f64,
    /// Between their curvatures \[1/(10 K)⁴\].
    pub curvature: f64,
    /// Mean slope \[1/(10 K)\] and mean curvature \[1/(10 K)²\].
    pub mean_slope: f64,
    /// See [`Spread::mean_slope`].
    pub mean_curvature: f64,
    /// The usual standard error.
    pub usual_error: f64,
    /// What is known of a robot's noise from its siblings', in degrees of freedom.
    pub alike: f64,
}

/// A variance that is fitted: where it is held while little is known (standard deviation),
/// by how much its logarithm may be off that (standard deviation), and its largest value.
struct Held {
    value: f64,
    by: f64,
    most: f64,
}

/// In the order of [`Spread::variance`]. Where they are held is what is published of gears:
/// slopes of some percent a kelvin that differ by a part of themselves, ageing of 10 % a year.
const HELD: [Held; 6] = [
    Held {
        value: 0.0,
        by: f64::INFINITY,
        most: f64::INFINITY,
    },
    Held {
        value: 0.003,
        by: 2.0,
        most: 0.1,
    },
    Held {
        value: 0.001,
        by: 1.5,
        most: 0.006,
    },
    Held {
        value: 3e-4,
        by: 1.0,
        most: 1e-3,
    },
    Held {
        value: 0.05,
        by: 2.0,
        most: 0.5,
    },
    Held {
        value: 0.01,
        by: 2.0,
        most: 0.2,
    },
];

impl Spread {
    /// How many variances are fitted.
    pub(super) const VARIANCES: usize = HELD.len();

    /// What is believed before anything is seen, where the twins tell that standard error.
    pub(super) fn before(usual_error: f64) -> Spread {
        let square = |i: usize| HELD[i].value * HELD[i].value;
        Spread {
            noise: 1.0,
            wander: square(1),
            walk: square(2),
            drift: square(3),
            slope: square(4),
            curvature: square(5),
            mean_slope: 0.0,
            mean_curvature: 0.0,
            usual_error: usual_error.max(1e-6),
            alike: 10.0,
        }
    }

    /// Variance of the noise of a value with that standard error. One that is told far
    /// too small is not believed.
    pub(super) fn noise_of(&self, std_error: f64) -> f64 {
        self.noise * std_error.max(0.5 * self.usual_error).powi(2)
    }

    fn variance(&mut self, i: usize) -> &mut f64 {
        match i {
            0 => &mut self.noise,
            1 => &mut self.wander,
            2 => &mut self.walk,
            3 => &mut self.drift,
            4 => &mut self.slope,
            _ => &mut self.curvature,
        }
    }

    /// Makes a variance larger or smaller, within what is possible.
    pub(super) fn multiply(&mut self, i: usize, factor: f64) {
        let most = HELD[i].most * HELD[i].most;
        let variance = self.variance(i);
        *variance = (*variance * factor).min(most).max(1e-14);
        // Few days cannot tell noise from what fades within days.
        let least = 0.25 * self.wander / (self.usual_error * self.usual_error);
        self.noise = self.noise.max(least);
    }

    /// How little it is believed, as a negative log-likelihood.
    pub(super) fn doubt(mut self) -> f64 {
        let own = HELD
            .iter()
            .enumerate()
            .filter(|(_, held)| held.by.is_finite());
        own.map(|(i, held)| {
            let off = (*self.variance(i) / (held.value * held.value)).ln() / held.by;
            0.5 * off * off
        })
        .sum()
    }
}

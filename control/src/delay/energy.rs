//! Energy at a port of the two-port between hand and tip, whatever the law.
//!
//! E ← E + F · Δx with the force F that acted over the displacement Δx since
//! the last step: exact for a force that is held between steps (Ryu, Kim,
//! Hannaford 2004, "Stable teleoperation with time-domain passivity control").
//! What goes in and what comes out are counted apart, so that either can be
//! compared with what the other end reports, however late.

/// Energy at a port since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Went into the two-port \[J\], never falls.
    pub entered: f64,
    /// Came out of the two-port \[J\], never falls.
    pub left: f64,
}

impl Energy {
    /// What went in and has not come out \[J\].
    pub fn balance(&self) -> f64 {
        self.entered - self.left
    }

    /// As in a packet \[J\].
    pub(super) fn packet(&self) -> [f32; 2] {
        let limit = f64::from(super::ENERGY_LIMIT);
        [self.entered, self.left].map(|energy| energy.clamp(0.0, limit) as f32)
    }
}

/// Counts the energy at a port.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnergyMeter {
    energy: Energy,
    position: Option<[f64; 3]>,
}

impl EnergyMeter {
    /// `force` \[N\], positive where it drives the two-port along `position`
    /// \[m\], acted since the last step. Nothing is counted over a stretch
    /// whose position is not known or not finite.
    pub fn step(&mut self, force: [f64; 3], position: Option<[f64; 3]>) {
        let position = position.filter(|own| own.iter().all(|value| value.is_finite()));
        if let (Some(now), Some(before)) = (position, self.position) {
            let work: f64 = (0..3)
                .map(|axis| force[axis] * (now[axis] - before[axis]))
                .sum();
            if work > 0.0 {
                self.energy.entered += work;
            } else if work < 0.0 {
                self.energy.left -= work;
            }
        }
        self.position = position;
    }

    /// Since the start.
    pub fn energy(&self) -> Energy {
        self.energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spring_gives_back_what_it_took() {
        // The two-port as a spring: pressed in by 10 cm, let out again.
        // ½ k x² = 0.5 · 400 · 0.01 = 2 J.
        let mut meter = EnergyMeter::default();
        let path = |k: i32| 0.1 * (std::f64::consts::PI * f64::from(k) / 10_000.0).sin();
        for k in 0..=10_000 {
            let middle = 0.5 * (path(k) + path(k - 1));
            meter.step([400.0 * middle, 0.0, 0.0], Some([path(k), 0.0, 0.0]));
        }
        let energy = meter.energy();
        assert!((energy.entered - 2.0).abs() < 1e-9, "{energy:?}");
        assert!(energy.balance().abs() < 1e-9, "{energy:?}");
    }

    #[test]
    fn nothing_is_counted_across_a_gap_or_nan() {
        let mut meter = EnergyMeter::default();
        meter.step([1.0; 3], Some([0.0; 3]));
        meter.step([1.0; 3], None);
        meter.step([1.0; 3], Some([5.0; 3]));
        meter.step([1.0; 3], Some([f64::NAN; 3]));
        meter.step([f64::NAN; 3], Some([5.0; 3]));
        meter.step([f64::NAN; 3], Some([6.0; 3]));
        assert_eq!(meter.energy(), Energy::default());
    }
}

//! Friction that falls while a joint warms up and nobody measures its temperature.
//!
//! A joint is one heat capacity that is heated and cools towards its surroundings, and its lubricant gets
//! thinner: tw dθ/dt = P/P0 − θ, with θ how warm it is, 1 of a joint that has been heated with P0 for
//! long. P is the power of friction, (τ_m − τ) q̇ (what inertia, weight and springs take they give back
//! in much less than tw), or the joint is heated evenly, as by its drive, P/P0 = 1. Every recording
//! begins cold. Simoni, Beschi, Legnani and Visioli 2015, "Friction modeling with temperature effects for
//! industrial robot manipulators", IROS (abstract), for the power of friction.

use ferntast_model::friction::{
    EffectParameter, Proposal, Row, TORQUE, Unit, Unmeasured, logarithmic, sign,
};

use super::{Effect, EffectDescription, Facts, Memory, Point, combinations, free};

/// tw, and P0 or [`EVENLY`].
const SHAPE: &[EffectParameter] = &[
    free("tw", Unit::new("s", "s")),
    free("P0", Unit::new("W", "W")),
];

/// What both are.
const BOTH: Row = Row {
    source: "Simoni et al. 2015, or heated evenly",
    shape: SHAPE,
    shown_by: Proposal::TemperatureSweep,
    // The scale of the power is not chosen.
    freedom: Some(2),
    of_unmeasured: Some(Unmeasured::Temperature),
    ..Row::NONE
};

static COULOMB: Row = Row {
    id: "warm_up_coulomb",
    equation: "τ_F = −bw · θ · sign(q̇), tw dθ/dt = P/P0 − θ, P = (τ_m − τ) · q̇; P0 = 0: heated evenly, P/P0 = 1",
    coefficients: &[free("bw", TORQUE)],
    shows_as: "step that shrinks with time, no temperature recorded",
    excited_by: "slow motion from a cold start, for as long as friction changes",
    confusable_with: &["warm_up_viscous", "temperature_coulomb", "wear_drift"],
    ..BOTH
};

static VISCOUS: Row = Row {
    id: "warm_up_viscous",
    equation: "τ_F = −bwv · θ · q̇, tw dθ/dt = P/P0 − θ, P = (τ_m − τ) · q̇; P0 = 0: heated evenly, P/P0 = 1",
    coefficients: &[free("bwv", Unit::new("Nm s/rad", "N s/m"))],
    shows_as: "slope that shrinks with time, no temperature recorded",
    excited_by: "slow and fast motion from a cold start, for as long as friction changes",
    confusable_with: &["warm_up_coulomb", "temperature_viscous", "clock_drift"],
    ..BOTH
};

/// Friction that falls by what it is of the velocity, times how warm the joint is.
pub struct WarmUp {
    row: &'static Row,
    description: EffectDescription,
    of_velocity: fn(f64) -> f64,
}

/// In place of P0.
const EVENLY: f64 = 0.0;
/// Fastest that a joint warms up, the film of its lubricant \[s\].
const FASTEST: f64 = 15.0;
/// Time constants that are told by a recording, in its lengths: beyond, it shows a straight line.
const SLOWEST_OF_LENGTH: f64 = 2.0;

impl WarmUp {
    /// Coulomb friction.
    pub fn coulomb() -> Self {
        Self::new(&COULOMB, sign)
    }

    /// Viscous friction.
    pub fn viscous() -> Self {
        Self::new(&VISCOUS, |velocity| velocity)
    }

    fn new(row: &'static Row, of_velocity: fn(f64) -> f64) -> Self {
        Self {
            row,
            description: EffectDescription::from_row(row),
            of_velocity,
        }
    }

    /// Its column at a sample; `warmth` is θ before it.
    fn column(&self, shape: &[f64], point: &Point, warmth: &mut f64) -> f64 {
        if let [time_constant, power] = *shape {
            *warmth += (heating(power, point) - *warmth) * point.period / time_constant;
        }
        -*warmth * (self.of_velocity)(point.velocity)
    }
}

/// P/P0.
fn heating(power: f64, point: &Point) -> f64 {
    match power == EVENLY {
        true => 1.0,
        false => point.friction_power() / power,
    }
}

impl Effect for WarmUp {
    fn description(&self) -> &EffectDescription {
        &self.description
    }

    fn row(&self) -> &'static Row {
        self.row
    }

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let [warmth, ..] = memory;
        columns.fill(self.column(shape, point, warmth));
    }

    // A piece that begins within its recording is as warm as a joint that did the same before.
    fn whole(&self, shape: &[f64], points: &[Point]) -> Option<Vec<Vec<f64>>> {
        let ([time_constant, power], [first, ..]) = (shape, points) else {
            return None;
        };
        if first.time <= first.period {
            return None;
        }
        let heating = points.iter().map(|point| heating(*power, point));
        let mean = heating.sum::<f64>() / points.len() as f64;
        let mut warmth = mean * (1.0 - (-first.time / time_constant).exp());
        let each = points.iter();
        let each = each.map(|point| self.column(shape, point, &mut warmth));
        Some(vec![each.collect()])
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        let measured = Unmeasured::Temperature.measured(facts);
        measured.or(facts.no_warm_up())
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        let powers = [EVENLY, facts.friction_power].into_iter();
        let powers = powers.filter(|own| *own >= EVENLY).collect();
        combinations(&[logarithmic(low, high, 8), powers])
    }

    // P0 is not refined: it is a scale.
    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let slowest = SLOWEST_OF_LENGTH * facts.recording_length;
        vec![[FASTEST, slowest.max(FASTEST)], [0.0, 0.0]]
    }

    // Friction falls as a joint warms up.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|own| *own > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{column_of, find};

    const PERIOD: f64 = 0.1;

    /// 100 s at 0.5 rad/s against 8 Nm, from `start` \[s\] on.
    fn points(start: f64) -> Vec<Point> {
        (0..1000)
            .map(|at| Point {
                period: PERIOD,
                time: start + f64::from(at) * PERIOD,
                velocity: 0.5,
                motor_torque: 11.0,
                load: 3.0,
                ..Point::default()
            })
            .collect()
    }

    /// θ = 1 − e^(−t/tw) of even heat, and P/P0 times that of a power that stays: 4 W of 2 W.
    #[test]
    fn it_warms_up_as_one_heat_capacity_does() {
        let coulomb = find("warm_up_coulomb").unwrap();
        for (power, most) in [(EVENLY, 1.0), (2.0, 2.0)] {
            let column = column_of(coulomb.as_ref(), &[40.0, power], &points(0.0));
            let expected = most * (1.0 - (-100.0_f64 / 40.0).exp());
            assert!((column[999] + expected).abs() < 2e-3, "{}", column[999]);
            assert!(coulomb.whole(&[40.0, power], &points(0.0)).is_none());
            // A piece that begins 100 s later goes on from there.
            let later = coulomb.whole(&[40.0, power], &points(100.0)).unwrap();
            assert!((later[0][0] / column[999] - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn viscous_friction_falls_with_speed() {
        let shape = [40.0, EVENLY];
        let [coulomb, viscous] = ["warm_up_coulomb", "warm_up_viscous"]
            .map(|id| column_of(find(id).unwrap().as_ref(), &shape, &points(0.0)));
        assert!((viscous[500] / coulomb[500] - 0.5).abs() < 1e-12);
    }
}

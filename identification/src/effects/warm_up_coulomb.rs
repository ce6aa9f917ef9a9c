//! Coulomb friction that falls while the joint warms up.

use ferntast_model::friction::{Proposal, TORQUE, Unmeasured};

use super::{Effect, Facts, Memory, Point, free, row, warm_up};

row!(
    WarmUpCoulomb,
    id: "warm_up_coulomb",
    equation: "τ_F = −bw · θ · sign(q̇), tw dθ/dt = P/P0 − θ, P = (τ_m − τ) · q̇; P0 = 0: heated evenly, P/P0 = 1",
    source: "Simoni et al. 2015, or heated evenly",
    coefficients: &[free("bw", TORQUE)],
    shape: warm_up::SHAPE,
    shows_as: "step that shrinks with time, no temperature recorded",
    excited_by: "slow motion from a cold start, for as long as friction changes",
    shown_by: Proposal::TemperatureSweep,
    confusable_with: &["warm_up_viscous", "temperature_coulomb", "wear_drift"],
    // The scale of the power is not chosen.
    freedom: Some(2),
    of_unmeasured: Some(Unmeasured::Temperature),
);

impl Effect for WarmUpCoulomb {
    row!(methods);

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        columns.fill(-warm_up::warmth(shape, point, memory) * point.sign());
    }

    fn whole(&self, shape: &[f64], points: &[Point]) -> Option<Vec<Vec<f64>>> {
        warm_up::within_a_recording(self, shape, points)
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        warm_up::unavailable(facts)
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        warm_up::shapes(facts)
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        warm_up::bounds(facts)
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        warm_up::plausible(coefficients)
    }
}

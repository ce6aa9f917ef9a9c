//! One trial's conditions and outcome, as in JSON.

use ferntast_sim::teleoperation::Outcome;
use serde::Serialize;

use super::Condition;

/// A trial. Positions and forces are at the hand's scale; what is not finite,
/// as after an instability, is `null` in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The law.
    pub law: &'static str,
    /// Whether it claims passivity.
    pub claims_passivity: bool,
    /// Round trip \[ms\].
    pub rtt_ms: f64,
    /// Standard deviation of the delay each way \[ms\].
    pub jitter_ms: f64,
    /// Share of frames lost each way \[-\].
    pub loss: f64,
    /// What the tip meets.
    pub environment: &'static str,
    /// Of all chance.
    pub seed: u64,
    /// Hand and tip come to rest.
    pub stable: bool,
    /// By how much hand or tip moved while they should rest \[m\].
    pub swing_m: f64,
    /// Tip less hand as it was one delay ago, while the tip is free \[m\].
    pub position_rmse_m: f64,
    /// Force on the hand less the contact's as it was one delay ago \[N\].
    #[serde(rename = "force_rmse_N")]
    pub force_rmse: f64,
    /// Hand less tip at the end \[m\].
    pub drift_m: f64,
    /// Largest force of the contact on the tip \[N\].
    #[serde(rename = "peak_force_N")]
    pub peak_force: f64,
    /// Largest force on the hand \[N\].
    #[serde(rename = "peak_felt_N")]
    pub peak_felt: f64,
    /// Least of energy entered less energy left, over both ports; never above zero \[J\].
    #[serde(rename = "energy_margin_J")]
    pub energy_margin: f64,
    /// Stiffness felt by stiffness touched \[-\]; `null` where nothing is pressed.
    pub transparency: Option<f64>,
    /// Damping felt on the free way to the surface \[N·s/m\].
    #[serde(rename = "felt_damping_Ns_m")]
    pub felt_damping: f64,
    /// When the tip is back where it began \[s\]; `null` when it is not in time.
    pub task_time_s: Option<f64>,
}

impl Row {
    /// Of a trial.
    pub fn new(condition: &Condition, outcome: &Outcome) -> Row {
        Row {
            law: condition.law.name(),
            claims_passivity: condition.law.claims_passivity(),
            rtt_ms: condition.rtt_ms,
            jitter_ms: condition.jitter_ms,
            loss: condition.loss,
            environment: condition.environment.name(),
            seed: condition.seed,
            stable: outcome.stable,
            swing_m: outcome.swing,
            position_rmse_m: outcome.position_rmse,
            force_rmse: outcome.force_rmse,
            drift_m: outcome.drift,
            peak_force: outcome.peak_force,
            peak_felt: outcome.peak_felt,
            energy_margin: outcome.energy_margin,
            transparency: outcome.transparency,
            felt_damping: outcome.felt_damping,
            task_time_s: outcome.task_time,
        }
    }

    /// Whether nothing was left to chance: neither jitter nor loss.
    pub fn is_ideal(&self) -> bool {
        self.jitter_ms == 0.0 && self.loss == 0.0
    }
}

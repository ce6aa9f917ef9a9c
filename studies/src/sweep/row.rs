//! One trial's conditions and outcome, as in JSON.

use std::borrow::Cow;

use ferntast_sim::teleoperation::Outcome;
use serde::{Deserialize, Serialize};

use super::Condition;

/// A trial. Positions and forces are at the hand's scale; what is not finite,
/// as after an instability, is `null` in JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The law.
    pub law: Cow<'static, str>,
    /// Whether it claims passivity.
    pub claims_passivity: bool,
    /// Round trip \[ms\].
    pub rtt_ms: f64,
    /// Standard deviation of the delay each way \[ms\].
    pub jitter_ms: f64,
    /// Jitter buffer of both ends, which the round trip has twice beside \[ms\].
    pub buffer_ms: f64,
    /// Share of frames lost each way \[-\].
    pub loss: f64,
    /// What the tip meets.
    pub environment: Cow<'static, str>,
    /// What the operator does.
    pub task: Cow<'static, str>,
    /// Of all chance.
    pub seed: u64,
    /// Hand and tip come to rest, and the task was done: a law that does nothing is not stable.
    pub stable: bool,
    /// By how much hand or tip moved while they should rest \[m\].
    pub swing_m: f64,
    /// Tip less hand as it was one delay ago, while the tip is free \[m\].
    pub position_rmse_m: f64,
    /// Force on the hand less the contact's as it was one delay ago \[N\].
    #[serde(rename = "force_rmse_N")]
    pub force_rmse: f64,
    /// The task was done in time.
    pub done: bool,
    /// Stiffness felt in the hand \[N/m\]; `null` where the hand is nowhere behind the surface.
    #[serde(rename = "felt_stiffness_N_per_m")]
    pub felt_stiffness: Option<f64>,
    /// Stiffness of what is touched, at the hand's scale \[N/m\].
    #[serde(rename = "true_stiffness_N_per_m")]
    pub true_stiffness: f64,
    /// Largest change of the force on the hand in a millisecond \[N/ms\].
    #[serde(rename = "force_step_N_per_ms")]
    pub force_step: f64,
    /// For how long the arm did not obey \[s\].
    pub held_s: f64,
    /// Hand, as it was one delay ago, less tip at the end \[mm\].
    pub drift_mm: f64,
    /// Largest force of the contact on the tip \[N\].
    #[serde(rename = "peak_force_N")]
    pub peak_force: f64,
    /// Largest force on the hand \[N\].
    #[serde(rename = "peak_felt_N")]
    pub peak_felt: f64,
    /// Least of energy entered less energy left at hand and tip, of the simulated bodies; never
    /// above zero \[J\].
    #[serde(rename = "true_energy_J")]
    pub true_energy: f64,
    /// Stiffness felt by stiffness touched \[-\]; `null` where nothing is pressed.
    pub transparency: Option<f64>,
    /// Damping felt on the free way to the surface, or in the second half of roaming \[N·s/m\].
    #[serde(rename = "drag_N_s_per_m")]
    pub drag: f64,
    /// When the tip is back where it began, or the hand let go \[s\]; `null` when it is not in
    /// time, or nothing was touched.
    pub task_time_s: Option<f64>,
    /// Share of the link's frames that were sent, both ways \[-\].
    pub frame_share: f64,
    /// Share of them that were sent with content \[-\].
    pub content_share: f64,
    /// Share of the bytes \[-\].
    pub byte_share: f64,
}

impl Row {
    /// Of a trial.
    pub fn new(condition: &Condition, outcome: &Outcome) -> Row {
        Row {
            law: condition.law.name().into(),
            claims_passivity: condition.law.claims_passivity(),
            rtt_ms: condition.rtt_ms,
            jitter_ms: condition.jitter_ms,
            buffer_ms: condition.buffer_ms,
            loss: condition.loss,
            environment: condition.environment.name().into(),
            task: condition.task.name().into(),
            seed: condition.seed,
            stable: outcome.stable && outcome.task_time.is_some(),
            swing_m: outcome.swing,
            position_rmse_m: outcome.position_rmse,
            force_rmse: outcome.force_rmse,
            done: outcome.task_time.is_some(),
            felt_stiffness: outcome.felt_stiffness,
            true_stiffness: condition.true_stiffness(),
            force_step: outcome.force_step,
            held_s: outcome.held,
            drift_mm: 1e3 * outcome.drift,
            peak_force: outcome.peak_force,
            peak_felt: outcome.peak_felt,
            true_energy: outcome.energy_margin,
            transparency: outcome.transparency,
            drag: outcome.felt_damping,
            task_time_s: outcome.task_time,
            frame_share: outcome.traffic.frame_share(),
            content_share: outcome.traffic.content_share(),
            byte_share: outcome.traffic.byte_share(),
        }
    }

    /// Whether nothing was left to chance: neither jitter nor loss.
    pub fn is_ideal(&self) -> bool {
        self.jitter_ms == 0.0 && self.loss == 0.0
    }
}

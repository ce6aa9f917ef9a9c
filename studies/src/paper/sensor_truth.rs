//! Torque sensors and a contour that are not as believed: what zeroing and self-calibration on
//! line make of the contact's forces, and whether the stated error of b_0T covers what is left.
//! Not an item of the paper, whose sensors are as they are.

use std::path::Path;

use ferntast_model::{Vector2, contour::Surface};
use ferntast_sim::arm::{ArmConfig, TorqueSensorErrors};

use super::{
    PaperError,
    item::{Item, Section},
};
use crate::experiment::{Conditions, IdentifyError, Plan, identify::Contact, run};

/// Zero \[Nm\] (0.75 % of the range), gain \[-\] and turn \[rad\] (2 degrees) that are put in, the
/// second joint's with the other sign.
const ZERO: f64 = 0.3;
const GAIN: f64 = 0.03;
const TURN: f64 = 0.0349;
/// Memory of what is found on line \[s\].
const ZEROING: f64 = 2.0;
const CALIBRATION: f64 = 60.0;
/// Normal force \[N\].
const FORCE: f64 = 20.0;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    Zero,
    Gain,
    Turn,
}

/// One run along the lubricated edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensorTruthJob {
    wrong: Wrong,
    /// Whether zeros, gains and turn are looked for.
    mended: bool,
}

/// What it said.
#[derive(Clone, Copy, Debug)]
pub struct SensorTruthRun {
    /// RMS of F_T/F_N off the true coefficient, over that, in the second half \[-\].
    force: f64,
    /// b_0T off line less the true one, in stated errors.
    off: f64,
    /// The same in errors by noise alone.
    off_by_noise: f64,
}

/// Before and after, one thing after the other.
pub(super) fn jobs() -> impl Iterator<Item = SensorTruthJob> {
    let all = [Wrong::Zero, Wrong::Gain, Wrong::Turn].into_iter();
    all.flat_map(|wrong| [false, true].map(|mended| SensorTruthJob { wrong, mended }))
}

impl SensorTruthJob {
    fn name(&self) -> &'static str {
        match self.wrong {
            Wrong::Zero => "zero",
            Wrong::Gain => "gain",
            Wrong::Turn => "turn",
        }
    }

    /// The experiment.
    pub(super) fn plan(&self) -> Plan {
        Plan::Contact {
            surface: Surface::Lubricated,
            forces: vec![FORCE],
            frequencies: vec![0.4],
            time_per_press: 20.0,
        }
    }

    fn arm(&self, arm: &ArmConfig) -> ArmConfig {
        let mut arm = arm.clone();
        let uncertainty = &mut arm.estimator.uncertainty;
        uncertainty.torque_zero = ZERO;
        uncertainty.torque_gain = GAIN;
        uncertainty.contour_turn = TURN;
        arm.estimator.zeroing_time = if self.mended || self.wrong != Wrong::Zero {
            ZEROING
        } else {
            0.0
        };
        arm.estimator.calibration_time = if self.mended { CALIBRATION } else { 0.0 };
        for (joint, sign) in arm.truth.joint.iter_mut().zip([1.0, -1.0]) {
            let of = |wrong, size: f64| {
                if self.wrong == wrong {
                    sign * size
                } else {
                    0.0
                }
            };
            joint.sensor.torque_errors = Some(TorqueSensorErrors {
                zero: of(Wrong::Zero, ZERO),
                gain: 1.0 + of(Wrong::Gain, GAIN),
                ..TorqueSensorErrors::default()
            });
        }
        if self.wrong == Wrong::Turn {
            let mut contour = arm.contour.clone();
            let middle = Vector2::from(contour.nominal_tip);
            let (sine, cosine) = TURN.sin_cos();
            for edge in &mut contour.edge {
                for place in [&mut edge.from, &mut edge.to] {
                    let from = Vector2::from(*place) - middle;
                    let turned = Vector2::new(
                        cosine * from.x - sine * from.y,
                        sine * from.x + cosine * from.y,
                    );
                    *place = (middle + turned).into();
                }
            }
            arm.truth.contour = Some(contour);
        }
        arm
    }

    /// Runs it into a folder below `folder`, and reads what was recorded.
    pub(super) fn run(
        &self,
        arm: &ArmConfig,
        conditions: &Conditions,
        seed: u64,
        folder: &Path,
        progress: &dyn Fn(f64),
    ) -> Result<SensorTruthRun, PaperError> {
        let which = if self.mended { "after" } else { "before" };
        let path = folder.join(format!("sensor_{}_{which}", self.name()));
        let arm = self.arm(arm);
        run(&self.plan(), &arm, conditions, seed, &path, progress)?;
        let contact = Contact::read(&path, Surface::Lubricated)?;
        let empty = || IdentifyError::Empty {
            path: path.clone(),
            what: "the tip hardly slid",
        };
        let found = contact.friction().ok_or_else(empty)?;
        let surface = &arm.truth.surface.lubricated;
        let day = conditions.day.unwrap_or(arm.truth.environment.day);
        let truth = surface.wear.map_or(surface.friction, |wear| {
            wear.worn_friction + (surface.friction - wear.worn_friction) * (-day / wear.days).exp()
        });
        let half = contact.usable.len() / 2;
        let ratios: Vec<f64> = (half..contact.usable.len())
            .filter(|&at| contact.usable[at] && contact.normal[at] > 0.25 * FORCE)
            .map(|at| contact.opposing[at] / contact.normal[at] / truth - 1.0)
            .collect();
        if ratios.is_empty() {
            return Err(empty().into());
        }
        let square: f64 = ratios.iter().map(|off| off * off).sum();
        Ok(SensorTruthRun {
            force: (square / ratios.len() as f64).sqrt(),
            off: (found.coefficient - truth) / found.std_error,
            off_by_noise: (found.coefficient - truth) / found.random_error,
        })
    }
}

/// The section: `runs` in the order of [`jobs`].
pub(super) fn section(runs: &[SensorTruthRun]) -> Section {
    let mut items = Vec::new();
    for (pair, job) in runs.chunks_exact(2).zip(jobs().step_by(2)) {
        let (before, after) = (pair[0], pair[1]);
        let name = |what: &str| format!("sensor_truth/{}/{what}", job.name());
        items.push(Item::inside(
            &name("tangential_force_off_before"),
            "",
            Some(before.force),
            None,
            [0.1, f64::INFINITY],
            "wrong as it is, RMS over the true force",
        ));
        items.push(Item::inside(
            &name("tangential_force_off_after"),
            "",
            Some(after.force),
            None,
            [0.0, 0.05_f64.min(0.5 * before.force)],
            "found on line and taken out",
        ));
        items.push(Item::inside(
            &name("b_0T_off_in_stated_errors"),
            "",
            Some(after.off),
            None,
            [-3.0, 3.0],
            "the stated error covers what is left",
        ));
        items.push(Item::inside(
            &name("b_0T_off_before_in_stated_errors"),
            "",
            Some(before.off),
            None,
            [-3.0, 3.0],
            &format!(
                "as it covers what is not mended ({:.0} errors by noise alone)",
                before.off_by_noise.abs()
            ),
        ));
    }
    Section {
        name: "Sensor truth".to_owned(),
        title: "Torque sensors and contour that are off".to_owned(),
        text: "Not in the paper. Along the lubricated edge, with a zero of 0.3 Nm, a gain of 3 % more and 3 % less, a contour \
               turned by 2 degrees: the tangential force before and after zeroing and self-calibration on line, and b_0T off \
               line with its stated error. A gain that both sensors have in common scales all forces alike; sliding does not \
               tell it, nor does it change b_0T."
            .to_owned(),
        charts: Vec::new(),
        items,
    }
}

//! The second paper's flexible joint: parameters on line beside those off line.

use std::path::Path;

use ferntast_benches::flexible_joint_bench::{FlexibleJointParameters, FlexibleJointRun};
use ferntast_identification::experiments::flexible_joint::{
    Estimate, OnLine, PARAMETERS, Row, Track, off_line, on_line,
};
use ferntast_model::recursive_least_squares::Forgetting;

use super::{
    PaperError,
    item::{Chart, Curve, Item, OnLineItem, Section, Settling},
};
use crate::experiment::flexible_joint;

/// Rows that both rules of forgetting remember; a hundred a second.
const MEMORY: f64 = 3000.0;
/// A smaller factor is never used by the variable rule \[1\].
const LEAST_FACTOR: f64 = 0.98;
/// Standard deviations of k_1, k_2; b_in, b_inD; b_out, b_outC before the first
/// sample, in their units: nothing is known.
const PRIORS: [[f64; 2]; 3] = [[1e5, 1e9], [1e3, 1e2], [1e3, 1e2]];
/// Residual that each regression is expected to leave \[Nm\].
const NOISE: [f64; 3] = [1.0, 0.3, 1.0];
/// The steady state begins here \[s\].
const STEADY_FROM: f64 = 80.0;
/// The run with a rest \[s\]: from when to when.
const REST: [f64; 2] = [60.0, 660.0];
/// After the rest, estimates may burst out for so long \[s\].
const BURST: f64 = 10.0;
/// Deviation from the value off line that is allowed \[1\]: the paper's figures
/// show fluctuation of this kind, and no number.
const DEVIATION: f64 = 0.05;
/// The same for the fluctuation \[1\].
const FLUCTUATION: f64 = 0.10;
/// Points of a curve.
const POINTS: usize = 400;

/// Rows of the three regressions, out of two recordings.
#[derive(Clone, Debug)]
pub struct FlexibleJointEvidence {
    /// Motion without a rest.
    pub motion: [Vec<Row>; 3],
    /// Motion with ten minutes of rest in it.
    pub rest: [Vec<Row>; 3],
}

/// One run of the bench.
pub(super) struct FlexibleJointJob {
    name: &'static str,
    duration: f64,
    rest: Option<[f64; 2]>,
}

/// Both runs: motion first.
pub(super) fn jobs() -> impl Iterator<Item = FlexibleJointJob> {
    [
        FlexibleJointJob {
            name: "flexible_joint_motion",
            duration: 240.0,
            rest: None,
        },
        FlexibleJointJob {
            name: "flexible_joint_rest",
            duration: REST[1] + 60.0,
            rest: Some(REST),
        },
    ]
    .into_iter()
}

impl FlexibleJointJob {
    /// Virtual time \[s\].
    pub(super) fn duration(&self) -> f64 {
        self.duration
    }

    /// Runs it into a folder below `folder`, and reads what was recorded.
    pub(super) fn run(&self, folder: &Path, seed: u64) -> Result<[Vec<Row>; 3], PaperError> {
        let path = folder.join(self.name);
        let run = FlexibleJointRun {
            seed,
            duration: self.duration,
            rest: self.rest,
            change: None,
        };
        flexible_joint::record(&path, &FlexibleJointParameters::default(), &run)?;
        Ok(flexible_joint::read(&path)?)
    }
}

const VARIABLE: Forgetting = Forgetting::Variable {
    memory: MEMORY,
    least: LEAST_FACTOR,
};
const FIXED: Forgetting = Forgetting::Exponential {
    factor: 1.0 - 1.0 / MEMORY,
};

/// One regression under one rule of forgetting, in both runs.
struct Runs {
    motion: OnLine,
    rest: OnLine,
}

impl Runs {
    fn of(evidence: &FlexibleJointEvidence, regression: usize, rule: Forgetting) -> Option<Runs> {
        let (priors, noise) = (PRIORS[regression], NOISE[regression]);
        let run = |rows: &[Row]| on_line(rows, priors, noise, rule).ok();
        Some(Runs {
            motion: run(evidence.motion.get(regression)?)?,
            rest: run(evidence.rest.get(regression)?)?,
        })
    }

    fn settling(&self, index: usize, off_line: Estimate) -> Settling {
        let steady = self.motion.steady(index, STEADY_FROM);
        let after = REST[1]..REST[1] + BURST;
        let away = self
            .rest
            .track
            .iter()
            .filter(|one| after.contains(&one.time));
        let away = away.map(|one| (one.values[index] / off_line.value - 1.0).abs());
        Settling {
            convergence_time_s: self.motion.convergence_time(index, off_line),
            steady_state_deviation: steady.map(|(mean, _)| mean / off_line.value - 1.0),
            fluctuation: steady.map(|(_, spread)| (spread / off_line.value).abs()),
            wind_up_at_rest: self.rest.wind_up(index, REST[0]),
            burst_after_rest: away.reduce(f64::max),
        }
    }
}

/// Every so many points of a track, each as `value` says.
fn thinned(name: &str, track: &[Track], value: impl Fn(&Track) -> f64) -> Curve {
    let step = track.len().div_ceil(POINTS).max(1);
    let points = track.iter().step_by(step);
    Curve::line(name, points.map(|one| (one.time, value(one))))
}

fn item(index: usize, off_line: Estimate, variable: &Runs, fixed: &Runs) -> Item {
    let (symbol, unit) = PARAMETERS[index];
    let of = index % 2;
    let on_line = OnLineItem {
        off_line: off_line.value,
        off_line_std_error: off_line.std_error,
        variable: variable.settling(of, off_line),
        fixed: fixed.settling(of, off_line),
    };
    let settled = &on_line.variable;
    let allowed = DEVIATION.max(3.0 * off_line.std_error / off_line.value.abs());
    let holds = settled.convergence_time_s.is_some()
        && settled
            .steady_state_deviation
            .is_some_and(|own| own.abs() <= allowed)
        && settled.fluctuation.is_some_and(|own| own <= FLUCTUATION);
    Item {
        item: format!("seed2/{symbol}"),
        paper: None,
        here: settled
            .steady_state_deviation
            .map(|deviation| off_line.value * (1.0 + deviation)),
        std_error: variable.motion.track.last().map(|last| last.std_errors[of]),
        unit,
        holds,
        criterion: format!(
            "the paper gives no number: on line it settles at the value off line ({:.4} ± {:.2}), its mean within {} % or \
             3 standard errors, its fluctuation below {} %. Variable forgetting: {}. Fixed: {}.",
            off_line.value,
            off_line.std_error,
            100.0 * DEVIATION,
            100.0 * FLUCTUATION,
            on_line.variable,
            on_line.fixed,
        ),
        on_line: Some(on_line),
    }
}

fn charts(index: usize, off_line: Estimate, variable: &Runs, fixed: &Runs) -> Chart {
    let (symbol, unit) = PARAMETERS[index];
    let of = index % 2;
    let end = variable.motion.track.last().map_or(0.0, |last| last.time);
    Chart {
        title: symbol.to_owned(),
        x: "time [s]".to_owned(),
        y: format!("{symbol} [{unit}]"),
        curves: vec![
            thinned("variable forgetting", &variable.motion.track, |one| {
                one.values[of]
            }),
            thinned("fixed forgetting", &fixed.motion.track, |one| {
                one.values[of]
            }),
            Curve::line("off line", [(0.0, off_line.value), (end, off_line.value)]),
        ],
    }
}

/// The section.
pub(super) fn section(evidence: &super::Evidence) -> Section {
    let evidence = &evidence.flexible_joint;
    let (mut items, mut all) = (Vec::new(), Vec::new());
    let mut wind_up = [f64::NAN; 2];
    for regression in 0..evidence.motion.len() {
        let found = off_line(&evidence.motion[regression]);
        let variable = Runs::of(evidence, regression, VARIABLE);
        let fixed = Runs::of(evidence, regression, FIXED);
        let (Some(found), Some(variable), Some(fixed)) = (found, variable, fixed) else {
            items.extend([0, 1].map(|of| {
                let (symbol, unit) = PARAMETERS[2 * regression + of];
                let nothing = [f64::INFINITY; 2];
                let statement = "the recording has to determine it";
                Item::inside(
                    &format!("seed2/{symbol}"),
                    unit,
                    None,
                    None,
                    nothing,
                    statement,
                )
            }));
            continue;
        };
        for of in [0, 1] {
            let index = 2 * regression + of;
            items.push(item(index, found[of], &variable, &fixed));
            all.push(charts(index, found[of], &variable, &fixed));
        }
        if regression == 0 {
            wind_up = [&fixed, &variable].map(|runs| {
                runs.rest
                    .wind_up(0, REST[0])
                    .max(runs.rest.wind_up(1, REST[0]))
            });
            let digits = |one: &Track| one.uncertainty[1].max(1e-12).log10();
            all.push(Chart {
                title: "k2, ten minutes of rest from 60 s".to_owned(),
                x: "time [s]".to_owned(),
                y: "log10 of the uncertainty over that at the start [-]".to_owned(),
                curves: vec![
                    thinned("variable forgetting", &variable.rest.track, digits),
                    thinned("fixed forgetting", &fixed.rest.track, digits),
                ],
            });
        }
    }
    items.push(Item::inside(
        "seed2/stiffness/uncertainty_at_rest_fixed_forgetting",
        "",
        Some(wind_up[0]),
        None,
        [1.0, f64::INFINITY],
        "plain exponential forgetting winds up at rest: over that at the start",
    ));
    items.push(Item::inside(
        "seed2/stiffness/uncertainty_at_rest_variable_forgetting",
        "",
        Some(wind_up[1]),
        None,
        [0.0, 1.0 + 1e-9],
        "the variable factor does not: over that at the start",
    ));
    Section {
        name: "Second paper".to_owned(),
        title: "A flexible joint identified on line".to_owned(),
        text: "Recursive least squares with a variable forgetting factor on the simulated bench, its gear weak in places and its \
               brake fluctuating. Only the paper's last page is at hand: six parameters settle on line at their values off \
               line, with some fluctuation; it gives no number and no equation. Read here: τ = k1 Δ + k2 Δ³ of the gear; \
               b_in and b_inD viscous and dry friction of the motor's side, b_out and b_outC viscous and Coulomb friction of \
               the load's. Fixed forgetting remembers as many samples as the variable one."
            .to_owned(),
        charts: all,
        items,
    }
}

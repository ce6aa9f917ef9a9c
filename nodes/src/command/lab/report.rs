//! `ferntast lab report`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_identification::{
    Comparison, Diagnosis, Verdict,
    compare::{self, Series},
};
use ferntast_lab::{
    experiment,
    report::{self as page, Report},
};
use serde_json::json;

use super::{
    super::{Failure, output::print_json},
    diagnose::with_bar,
    open::{self, Opened},
    table::significant,
};

/// Write one self-contained page: measured against model, where it fails, what is missing, the falling error.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file, or the recording of a session (then its first joint).
    experiment: PathBuf,

    /// The page.
    #[arg(short, long, default_value = "report.html", value_name = "FILE")]
    output: PathBuf,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let opened = open::open(&arguments.experiment)?;
    let Some(opened) = opened.first() else {
        return Err(Failure::refused(format!(
            "{}: no joint in it",
            arguments.experiment.display()
        )));
    };
    let comparison = compare::compare(&opened.dataset, &opened.experiment.model)
        .map_err(|error| open::refuse(opened, error))?;
    let diagnosis = with_bar(opened)?;
    let report = assemble(opened, &comparison, &diagnosis)?;
    let html = page::render(&report).map_err(Failure::failed)?;
    std::fs::write(&arguments.output, html)
        .map_err(|error| Failure::refused(format!("{}: {error}", arguments.output.display())))?;
    if json {
        print_json(&json!({"report": arguments.output, "verdict": diagnosis.verdict}))?;
    } else {
        println!("written to {}", arguments.output.display());
    }
    Ok(ExitCode::SUCCESS)
}

fn assemble(
    opened: &Opened,
    comparison: &Comparison,
    diagnosis: &Diagnosis,
) -> Result<Report, Failure> {
    let unit = opened.torque_unit().to_owned();
    let history = match &opened.experiment.path {
        Some(path) => {
            experiment::history(path, &experiment::data_folder()).map_err(Failure::refused)?
        }
        None => Vec::new(),
    };
    let (kind, text) = match diagnosis.verdict {
        Verdict::Missing => (
            "missing",
            format!(
                "{} explains what the model leaves.",
                diagnosis
                    .candidates
                    .first()
                    .map_or("An effect", |best| best.effect.as_str())
            ),
        ),
        Verdict::Complete => ("complete", "What is left is noise.".to_owned()),
        Verdict::Unexplained => (
            "unexplained",
            "Something is missing that the catalogue does not have.".to_owned(),
        ),
    };
    let mut notes = opened.notes.clone();
    notes.extend(comparison.extrapolated.iter().map(|beyond| {
        format!(
            "{}: {} goes beyond what was fitted in {:.0} % of it",
            beyond.session,
            beyond.signal,
            beyond.share * 100.0
        )
    }));
    Ok(Report {
        title: opened.experiment.title.clone(),
        subtitle: format!(
            "{} samples in {} sessions, {} used",
            comparison.samples,
            opened.dataset.sessions.len(),
            comparison.used
        ),
        verdict: Some(page::Verdict {
            kind: kind.to_owned(),
            text,
        }),
        figures: figures(comparison, &unit),
        traces: comparison
            .series
            .iter()
            .map(|series| trace(series, &unit))
            .collect(),
        maps: comparison
            .residual_maps
            .iter()
            .map(|map| page::ResidualMap {
                signal: map.signal.clone(),
                signal_unit: map.unit.clone(),
                unit: unit.clone(),
                bins: map
                    .bins
                    .iter()
                    .map(|bin| page::Bin {
                        center: bin.at,
                        mean: bin.mean,
                        spread: bin.spread,
                        count: bin.count as u64,
                    })
                    .collect(),
            })
            .collect(),
        candidates: diagnosis
            .candidates
            .iter()
            .map(|own| page::Candidate {
                effect: own.effect.clone(),
                held_out_before: own.held_out_before,
                held_out_after: own.held_out_after,
                unit: unit.clone(),
                p_value: own.p_value,
                indistinguishable_from: own.indistinguishable_from.clone(),
                separate_by: own.separate_by.clone(),
            })
            .collect(),
        dependences: diagnosis
            .residual_depends_on
            .iter()
            .map(|own| page::Dependence {
                signals: own.signals.clone(),
                strength: own.strength,
            })
            .collect(),
        history: history
            .into_iter()
            .filter_map(|step| {
                Some(page::HistoryPoint {
                    label: step.added.unwrap_or_else(|| step.effects.join(", ")),
                    held_out: step.held_out?,
                    unit: unit.clone(),
                })
            })
            .collect(),
        parameters: comparison
            .parameters
            .iter()
            .map(|(name, own)| page::Parameter {
                name: name.clone(),
                value: own.value,
                std_error: own.std_error,
                unit: own.unit.clone(),
                excited: !comparison.not_excited.contains(name),
            })
            .collect(),
        worst: comparison
            .worst
            .iter()
            .map(|own| page::Window {
                session: own.session.clone(),
                start: own.from,
                end: own.to,
                rms: own.rms,
                unit: unit.clone(),
            })
            .collect(),
        notes,
    })
}

fn figures(comparison: &Comparison, unit: &str) -> Vec<page::Figure> {
    let figure = |label: &str, value: String, note: &str| page::Figure {
        label: label.to_owned(),
        value,
        note: note.to_owned(),
    };
    let mut figures = vec![
        figure(
            "error on data held out",
            format!("{} {unit}", significant(comparison.rms.held_out)),
            &format!(
                "{:.2} % of the torque",
                comparison.relative_error_held_out * 100.0
            ),
        ),
        figure(
            "error on data fitted",
            format!("{} {unit}", significant(comparison.rms.train)),
            &format!("{:.2} % of the torque", comparison.relative_error * 100.0),
        ),
    ];
    if let Some(noise) = comparison.noise.repeats {
        figures.push(figure(
            "noise between repeats",
            format!("{} {unit}", significant(noise)),
            "no model gets below it",
        ));
    }
    figures
}

fn trace(series: &Series, unit: &str) -> page::Trace {
    let start = series.time.first().copied().unwrap_or(0.0);
    let period = match series.time.as_slice() {
        [first, .., last] => (last - first) / (series.time.len() - 1) as f64,
        _ => 1.0,
    };
    let curve = |name: &str, values: Vec<f64>| page::Curve {
        name: name.to_owned(),
        values,
    };
    let residual = series
        .measured
        .iter()
        .zip(&series.modelled)
        .map(|(measured, modelled)| measured - modelled)
        .collect();
    page::Trace {
        title: series.session.clone(),
        unit: unit.to_owned(),
        start,
        period,
        curves: vec![
            curve("measured", series.measured.clone()),
            curve("model", series.modelled.clone()),
            curve("residual", residual),
        ],
    }
}

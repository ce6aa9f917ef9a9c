//! From results to a report.

use ferntast_identification::{
    Comparison, Diagnosis, Usage,
    comparison::{Reason, Series, VariesTogether},
    diagnosis::NamedCandidate,
    fit::{Implausible, Pair},
};

use super::{
    About, Bin, Candidate, Curve, Dependence, Figure, HistoryPoint, Parameter, Report, ResidualMap,
    Rival, Share, Trace, Verdict, Window, shades,
};
use crate::{
    experiment::{self, ExperimentError},
    work::Opened,
};

/// The report on an experiment.
///
/// # Errors
///
/// A file of the experiment's chain cannot be used.
pub fn assemble(
    opened: &Opened,
    comparison: &Comparison,
    diagnosis: &Diagnosis,
) -> Result<Report, ExperimentError> {
    let unit = opened.torque_unit().to_owned();
    let history = match &opened.experiment.path {
        Some(path) => experiment::history(path, &experiment::data_folder())?,
        None => Vec::new(),
    };
    let kind = diagnosis.verdict.name();
    let mut text = diagnosis.claim();
    text.push('.');
    let mut notes = opened.notes.clone();
    notes.extend(comparison.extrapolated.iter().map(|beyond| {
        format!(
            "{}: {} goes beyond what was fitted in {:.0} % of it",
            beyond.session,
            beyond.signal,
            beyond.share * 100.0
        )
    }));
    let cannot_show = diagnosis.not_tested.why_not_tested.iter();
    notes.extend(cannot_show.map(|line| format!("these recordings cannot show {line}")));
    Ok(Report {
        title: opened.experiment.title.clone(),
        subtitle: format!(
            "{} samples in {} sessions, {:.1} % of them used",
            comparison.used.samples,
            opened.dataset.sessions.len(),
            comparison.used.share * 100.0,
        ),
        verdict: Some(Verdict {
            kind: kind.to_owned(),
            text,
        }),
        figures: figures(comparison, &unit),
        used: used(&comparison.used),
        warnings: warnings(comparison, diagnosis),
        about: about(opened, comparison)?,
        traces: comparison
            .series
            .iter()
            .map(|series| trace(series, &unit))
            .collect(),
        maps: comparison
            .residual_maps
            .iter()
            .map(|map| ResidualMap {
                signal: map.signal.clone(),
                signal_unit: map.unit.clone(),
                unit: unit.clone(),
                bins: map
                    .bins
                    .iter()
                    .map(|bin| Bin {
                        center: bin.at,
                        mean: bin.mean,
                        spread: bin.spread,
                        count: bin.count as u64,
                    })
                    .collect(),
            })
            .collect(),
        candidates: candidates(&diagnosis.candidates, &unit),
        helps_in_part: candidates(&diagnosis.helps_in_part, &unit),
        rivals: diagnosis
            .runners_up
            .iter()
            .map(|own| Rival {
                effect: own.effect.clone(),
                share: own.share,
                p_value: own.p_value,
                why: own.why_not.text().to_owned(),
            })
            .collect(),
        dependences: diagnosis
            .residual_depends_on
            .iter()
            .map(|own| Dependence {
                signals: own.signals.clone(),
                period_s: own.period_s,
                strength: own.strength,
            })
            .collect(),
        history: history
            .into_iter()
            .filter_map(|step| {
                Some(HistoryPoint {
                    label: step.added.unwrap_or_else(|| step.effects.join(", ")),
                    held_out: step.held_out?,
                    unit: unit.clone(),
                })
            })
            .collect(),
        parameters: comparison
            .parameters
            .iter()
            .map(|(name, own)| Parameter {
                name: name.clone(),
                value: own.value,
                std_error: own.std_error,
                interval_95: own.interval_95,
                effect: own.effect.clone(),
                unit: own.unit.clone(),
                excited: !comparison.not_excited.contains(name),
            })
            .collect(),
        worst: comparison
            .worst
            .iter()
            .map(|own| Window {
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

fn candidates(named: &[NamedCandidate], unit: &str) -> Vec<Candidate> {
    let each = named.iter().map(|own| Candidate {
        effect: own.effect.clone(),
        held_out_before: own.held_out_before,
        held_out_after: own.held_out_after,
        unit: unit.to_owned(),
        p_value: own.p_value,
        indistinguishable_from: own.indistinguishable_from.clone(),
        separate_by: own.separate_by.clone(),
    });
    each.collect()
}

/// What becomes of the samples, the used ones first.
fn used(usage: &Usage) -> Vec<Share> {
    let row = |(reason, samples): (Reason, usize)| Share {
        what: reason.text().to_owned(),
        samples,
        share: samples as f64 / usage.samples.max(1) as f64,
        used: reason.is_used(),
    };
    let all = usage.by_reason.iter().map(|(own, count)| (*own, *count));
    let used = all.filter(|(reason, _)| reason.is_used());
    used.chain(usage.left_out()).map(row).collect()
}

/// What has to be known before the verdict or a parameter is believed.
fn warnings(comparison: &Comparison, diagnosis: &Diagnosis) -> Vec<String> {
    let soundness = &comparison.soundness;
    let implausible = soundness.implausible.iter().map(Implausible::text);
    let pairs = soundness.inseparable.iter().map(Pair::text);
    let cutoff = diagnosis.cutoff_warning();
    let together = comparison.varies_together.iter().map(VariesTogether::text);
    let of_parameters = implausible.chain(pairs);
    (cutoff.into_iter().chain(together).chain(of_parameters)).collect()
}

/// The model's equation, the program's version, the data.
fn about(opened: &Opened, comparison: &Comparison) -> Result<Vec<About>, ExperimentError> {
    let row = |name: &str, value: String| About {
        name: name.to_owned(),
        value,
    };
    let equation = opened.equation().into_iter();
    let mut about: Vec<About> = equation.map(|own| row(&own.effect, own.formula)).collect();
    let usage = &comparison.used;
    about.push(row(
        "filter",
        format!(
            "{} Hz, {}",
            significant(usage.cutoff_hz),
            usage.cutoff_reason
        ),
    ));
    let condition = significant(comparison.soundness.condition);
    about.push(row("condition of the normal equations", condition));
    let files = opened.experiment.files();
    let hash = experiment::data_hash(&files)
        .map_err(|(path, source)| ExperimentError::Read { path, source })?;
    let names: Vec<String> = files.iter().map(|own| own.display().to_string()).collect();
    about.push(row("recordings", names.join(", ")));
    about.push(row("SHA-256 of their content", hash));
    about.push(row("ferntast", env!("CARGO_PKG_VERSION").to_owned()));
    Ok(about)
}

fn figures(comparison: &Comparison, unit: &str) -> Vec<Figure> {
    let figure = |label: &str, value: String, note: &str| Figure {
        label: label.to_owned(),
        value,
        note: note.to_owned(),
    };
    let mut figures = vec![
        figure(
            "error on data held out",
            format!("{} {unit}", significant(comparison.rms.held_out)),
            &format!(
                "{:.2} % of what is measured",
                comparison.relative_error_held_out * 100.0
            ),
        ),
        figure(
            "error on data fitted",
            format!("{} {unit}", significant(comparison.rms.train)),
            &format!(
                "{:.2} % of what is measured",
                comparison.relative_error * 100.0
            ),
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

fn trace(series: &Series, unit: &str) -> Trace {
    let start = series.time.first().copied().unwrap_or(0.0);
    let period = match series.time.as_slice() {
        [first, .., last] => (last - first) / (series.time.len() - 1) as f64,
        _ => 1.0,
    };
    let curve = |name: &str, values: Vec<f64>| Curve {
        name: name.to_owned(),
        values,
    };
    let residual = series
        .measured
        .iter()
        .zip(&series.modelled)
        .map(|(measured, modelled)| measured - modelled)
        .collect();
    Trace {
        title: series.session.clone(),
        unit: unit.to_owned(),
        start,
        period,
        curves: vec![
            curve("measured", series.measured.clone()),
            curve("model", series.modelled.clone()),
            curve("residual", residual),
        ],
        shades: shades::of(series),
    }
}

/// Four significant digits.
pub fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..6).contains(&magnitude) {
        let digits = usize::try_from(3 - magnitude).unwrap_or(0);
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn four_digits() {
        assert_eq!(significant(203.1349), "203.1");
        assert_eq!(significant(-0.012345), "-0.01235");
        assert_eq!(significant(12345.6), "12346");
        assert_eq!(significant(1.5e-7), "1.500e-7");
        assert_eq!(significant(0.0), "0");
    }
}

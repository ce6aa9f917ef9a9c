//! Results for people at a terminal.

use std::collections::BTreeMap;

use ferntast_identification::{
    Comparison, Diagnosis, Verdict, comparison::residual_map::ResidualMap,
    diagnosis::NamedCandidate, fit::Parameter,
};

pub use ferntast_lab::report::significant;

/// The parameters with their standard errors.
pub fn parameters(parameters: &BTreeMap<String, Parameter>, not_excited: &[String]) {
    println!(
        "{:<26} {:>14} {:>14}  unit",
        "parameter", "value", "std error"
    );
    for (name, parameter) in parameters {
        let error = parameter
            .std_error
            .map_or_else(|| "searched".to_owned(), significant);
        let excited = match not_excited.contains(name) {
            true => "  (not excited by these data)",
            false => "",
        };
        println!(
            "{name:<26} {:>14} {error:>14}  {}{excited}",
            significant(parameter.value),
            parameter.unit
        );
    }
}

/// How far off the model is, and where.
pub fn comparison(comparison: &Comparison, unit: &str) {
    println!(
        "{} samples, {} used; error {} {unit} fitted, {} {unit} held out ({:.1} % of what is measured); noise between repeats {}",
        comparison.samples,
        comparison.used,
        significant(comparison.rms.train),
        significant(comparison.rms.held_out),
        comparison.relative_error_held_out * 100.0,
        comparison.noise.repeats.map_or_else(
            || "-".to_owned(),
            |noise| format!("{} {unit}", significant(noise))
        )
    );
    println!();
    parameters(&comparison.parameters, &comparison.not_excited);
    for map in &comparison.residual_maps {
        println!();
        residual_map(map, unit);
    }
    println!();
    println!("worst stretches");
    for window in comparison.worst.iter().take(5) {
        println!(
            "  {} {:.1} … {:.1} s: {} {unit}",
            window.session,
            window.from,
            window.to,
            significant(window.rms)
        );
    }
    for beyond in &comparison.extrapolated {
        println!(
            "  {}: {} goes beyond what was fitted ({} … {}): {} … {} in {:.0} % of it",
            beyond.session,
            beyond.signal,
            significant(beyond.fitted[0]),
            significant(beyond.fitted[1]),
            significant(beyond.reached[0]),
            significant(beyond.reached[1]),
            beyond.share * 100.0
        );
    }
    if let Some(simulation) = &comparison.simulation {
        println!();
        println!(
            "simulated forward over {} windows of {} s: position off by {} of {} moved (RMS)",
            simulation.windows,
            simulation.window_s,
            significant(simulation.position_rms_rad),
            significant(simulation.motion_rms_rad)
        );
    }
}

/// The mean residual over one signal as bars.
fn residual_map(map: &ResidualMap, unit: &str) {
    const HALF: usize = 20;
    let largest = map
        .bins
        .iter()
        .map(|bin| bin.mean.abs())
        .fold(f64::MIN_POSITIVE, f64::max);
    println!(
        "mean residual over {} [{}], full bar {} {unit}",
        map.signal,
        map.unit,
        significant(largest)
    );
    let step = map.bins.len().div_ceil(16).max(1);
    for bin in map.bins.iter().step_by(step) {
        let length = (bin.mean.abs() / largest * HALF as f64).round() as usize;
        let (left, right) = match bin.mean < 0.0 {
            true => ("#".repeat(length), String::new()),
            false => (String::new(), "#".repeat(length)),
        };
        println!("  {:>11} {left:>HALF$}|{right}", significant(bin.at));
    }
}

/// A verdict in words.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Missing => "missing: an effect of the catalogue explains what the model leaves",
        Verdict::Complete => "complete: what is left is noise",
        Verdict::Unexplained => {
            "unexplained: something is missing that the catalogue does not have"
        }
    }
}

/// What a verdict does not rest on.
pub fn not_tested(effects: &[String]) {
    if !effects.is_empty() {
        println!();
        println!(
            "not tested, since the motions of other joints are not among the signals: {}",
            effects.join(", ")
        );
    }
}

/// One line of the ranking, `name` so wide, and what these data cannot tell it from.
pub fn candidate(name: &str, candidate: &NamedCandidate, width: usize) {
    println!(
        "{name:<width$} {:>12} {:>12} {:>7.1}% {:>9.1e}",
        significant(candidate.held_out_before),
        significant(candidate.held_out_after),
        (candidate.held_out_after / candidate.held_out_before - 1.0) * 100.0,
        candidate.p_value
    );
    if !candidate.indistinguishable_from.is_empty() {
        println!(
            "    these data cannot tell it from {}",
            candidate.indistinguishable_from.join(", ")
        );
    }
    if !candidate.separate_by.is_empty() {
        println!("    {}", candidate.separate_by);
    }
}

/// The verdict, the ranking, and what to do next.
pub fn diagnosis(diagnosis: &Diagnosis, unit: &str) {
    println!("{}", verdict(diagnosis.verdict));
    println!(
        "error {} {unit} on data held out; {} variants tried",
        significant(diagnosis.rms.held_out),
        diagnosis.tried
    );
    if !diagnosis.candidates.is_empty() {
        println!();
        println!(
            "{:<24} {:>12} {:>12} {:>8} {:>9}",
            "effect", "before", "after", "", "p"
        );
    }
    for own in &diagnosis.candidates {
        candidate(&own.effect, own, 24);
    }
    for suspect in &diagnosis.suspected {
        println!(
            "suspected, not proven: {} (p {:.2}); to be sure record {}: {}",
            suspect.effect,
            suspect.p_value,
            suspect.next_experiment.id(),
            suspect.next_experiment.instruction()
        );
    }
    if !diagnosis.residual_depends_on.is_empty() {
        println!();
        println!("the residual depends on");
    }
    for dependence in &diagnosis.residual_depends_on {
        println!(
            "  {:<28} {:.1} % of its mean square",
            dependence.signals.join(" and "),
            dependence.strength * 100.0
        );
    }
    not_tested(&diagnosis.not_tested);
}

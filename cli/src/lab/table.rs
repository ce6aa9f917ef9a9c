//! Results for people at a terminal.

use std::{collections::BTreeMap, path::Path};

use ferntast_identification::{
    Comparison, Diagnosis, Discovery, Formula, NotTested, Usage, Verdict,
    comparison::{VariesTogether, residual_map::ResidualMap},
    diagnosis::NamedCandidate,
    fit::{Parameter, Soundness},
};

pub use ferntast_lab::report::significant;

/// A probability, in words that a person writes: 1, 0.034, 2.0e-5.
pub fn chance(p: f64) -> String {
    match p {
        p if p > 0.995 => "1".to_owned(),
        p if p >= 0.1 => format!("{p:.2}"),
        p if p >= 1e-3 => format!("{p:.3}"),
        p if p <= 0.0 => "0".to_owned(),
        p => format!("{p:.1e}"),
    }
}

/// The parameters with their standard errors.
pub fn parameters(parameters: &BTreeMap<String, Parameter>, not_excited: &[String]) {
    println!(
        "{:<26} {:>14} {:>14}  {:<24} unit",
        "parameter", "value", "std error", "95 %"
    );
    for (name, parameter) in parameters {
        let error = parameter
            .std_error
            .map_or_else(|| "-".to_owned(), significant);
        let interval = parameter
            .interval_95
            .map_or_else(String::new, |[low, high]| {
                format!("{} … {}", significant(low), significant(high))
            });
        let excited = match not_excited.contains(name) {
            true => "  (not excited by these data)",
            false => "",
        };
        println!(
            "{name:<26} {:>14} {error:>14}  {interval:<24} {}{excited}",
            significant(parameter.value),
            parameter.unit
        );
    }
}

/// Pairs of parameters that cannot be told apart, and values that are not possible.
pub fn soundness(soundness: &Soundness) {
    println!(
        "condition of the normal equations {}",
        significant(soundness.condition)
    );
    for own in &soundness.implausible {
        println!("warning: {}", own.text());
    }
    for pair in &soundness.inseparable {
        println!("warning: {}", pair.text());
    }
}

/// Signals and conditions that vary together.
pub fn varies_together(pairs: &[VariesTogether]) {
    for pair in pairs {
        println!("warning: {}", pair.text());
    }
}

/// What of the samples is used, and what is left out.
fn usage(used: &Usage) {
    println!(
        "{} of {} used, as {} rows; errors are measured on {}",
        used.claim(),
        used.samples,
        used.rows,
        used.held_out_by.text()
    );
    for (reason, samples) in used.left_out() {
        println!(
            "  left out {:>5.1} %  {}",
            samples as f64 / used.samples.max(1) as f64 * 100.0,
            reason.text()
        );
    }
    if let Some([low, high]) = used.speed_range {
        println!(
            "  speeds that remain {} … {} {}",
            significant(low),
            significant(high),
            used.speed_unit
        );
    }
    println!(
        "  filter: cut-off {} Hz, {}",
        significant(used.cutoff_hz),
        used.cutoff_reason
    );
}

/// How far off the model is, and where.
pub fn comparison(comparison: &Comparison, unit: &str) {
    println!(
        "error {} {unit} fitted, {} {unit} held out ({:.1} % of what is measured); noise between repeats {}",
        significant(comparison.rms.train),
        significant(comparison.rms.held_out),
        comparison.relative_error_held_out * 100.0,
        comparison.noise.repeats.map_or_else(
            || "-".to_owned(),
            |noise| format!("{} {unit}", significant(noise))
        )
    );
    usage(&comparison.used);
    println!();
    parameters(&comparison.parameters, &comparison.not_excited);
    soundness(&comparison.soundness);
    varies_together(&comparison.varies_together);
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

/// The formulas that are proposed, and how to accept one.
pub fn discovery(discovery: &Discovery, experiment: Option<&Path>, unit: &str) {
    println!("{}", discovery.verdict.name());
    if discovery.tried == 0 {
        println!("no formula is searched");
        return;
    }
    if let Some(named) = discovery.named.first() {
        println!(
            "add {} first; a formula is proposed only where it is certainly better",
            named.effect
        );
    }
    if discovery.formulas.is_empty() {
        println!(
            "no formula explains what is left better than chance does ({} terms tried)",
            discovery.tried
        );
    }
    for (own, number) in discovery.formulas.iter().zip(1..) {
        formula(own, number, unit);
    }
    if let (Some(formula), Some(path)) = (discovery.formulas.first(), experiment) {
        to_accept(path, &formula.name, &formula.expression);
    }
}

/// The line that adds a formula.
pub fn to_accept(experiment: &Path, name: &str, expression: &str) {
    println!();
    println!(
        "to accept the first:  ferntast lab add {} '{name}={expression}'",
        experiment.display(),
    );
}

/// A formula with its constants, and what it cannot be told from.
pub fn formula(formula: &Formula, number: usize, unit: &str) {
    println!();
    println!("{number}. {}", formula.expression);
    println!(
        "   error {} {unit} before, {} {unit} after on data held out ({:+.1} %); p {}, complexity {}",
        significant(formula.held_out_before),
        significant(formula.held_out_after),
        (formula.held_out_after / formula.held_out_before - 1.0) * 100.0,
        chance(formula.p_value),
        formula.complexity
    );
    println!("   {}", formula.form);
    for (name, own) in &formula.parameters {
        let error = own
            .std_error
            .map_or_else(String::new, |error| format!(" ± {}", significant(error)));
        println!(
            "     {name} = {}{error} {}",
            significant(own.value),
            own.unit
        );
    }
    if !formula.cannot_be_told_from.is_empty() {
        println!("   these data cannot tell it from");
    }
    for rival in &formula.cannot_be_told_from {
        println!("     {rival}");
    }
    println!("   {}", formula.separate_by);
}

/// What a verdict does not rest on.
pub fn not_tested(own: &NotTested) {
    if !own.why_not_tested.is_empty() {
        println!();
        println!("not tested, since these recordings cannot show it");
    }
    for line in &own.why_not_tested {
        println!("  {line}");
    }
}

/// One line of the ranking, `name` so wide, and what these data cannot tell it from.
pub fn candidate(name: &str, candidate: &NamedCandidate, width: usize) {
    println!(
        "{name:<width$} {:>12} {:>12} {:>7.1}% {:>9}",
        significant(candidate.held_out_before),
        significant(candidate.held_out_after),
        (candidate.held_out_after / candidate.held_out_before - 1.0) * 100.0,
        chance(candidate.p_value)
    );
    if !candidate.indistinguishable_from.is_empty() {
        println!(
            "    these data cannot tell it from {}",
            candidate.indistinguishable_from.join(", ")
        );
    }
    if !candidate.separate_by.is_empty() {
        println!("    next experiment: {}", candidate.separate_by);
    }
}

/// The verdict, the ranking, and what to do next.
pub fn diagnosis(diagnosis: &Diagnosis, unit: &str) {
    println!("{}: {}", diagnosis.verdict.name(), diagnosis.claim());
    println!(
        "error {} {unit} on data held out; {} variants tried",
        significant(diagnosis.rms.held_out),
        diagnosis.tried
    );
    usage(&diagnosis.used);
    if let Some(warning) = diagnosis.cutoff_warning() {
        println!("warning: {warning}");
    } else if !diagnosis.verdict_at_other_cutoffs.is_empty() {
        let others = diagnosis.verdict_at_other_cutoffs.iter();
        let others: Vec<String> = others.map(|own| significant(own.cutoff_hz)).collect();
        println!(
            "the same verdict at cut-offs of {} Hz",
            others.join(" and ")
        );
    }
    soundness(&diagnosis.soundness);
    varies_together(&diagnosis.varies_together);
    if !diagnosis.candidates.is_empty() {
        println!();
    }
    candidates(&diagnosis.candidates);
    if !diagnosis.helps_in_part.is_empty() {
        println!();
        println!("these lower the error in part, and are not the explanation");
    }
    candidates(&diagnosis.helps_in_part);
    for suspect in &diagnosis.suspected {
        println!(
            "suspected, not proven: {} (p {:.2})\n    next experiment: {}: {}",
            suspect.effect,
            suspect.p_value,
            suspect.next_experiment.id(),
            suspect.next_experiment.instruction()
        );
    }
    if !diagnosis.residual_depends_on.is_empty() {
        println!();
        println!("the residual depends on (parts overlap: signals go together)");
    }
    for dependence in &diagnosis.residual_depends_on {
        println!(
            "  {:<28} {:.1} % of its mean square",
            dependence.on(),
            dependence.strength * 100.0
        );
    }
    if diagnosis.verdict != Verdict::Missing && !diagnosis.runners_up.is_empty() {
        println!();
        println!("tried and not named, the strongest first");
        for own in &diagnosis.runners_up {
            println!(
                "  {:<28} {:>6.2} % of the mean square, p {}: {}",
                own.effect,
                own.share * 100.0,
                chance(own.p_value),
                own.why_not.text()
            );
        }
    }
    not_tested(&diagnosis.not_tested);
}

/// Effects with what they do to the error, and what would prove them.
fn candidates(candidates: &[NamedCandidate]) {
    if !candidates.is_empty() {
        println!(
            "{:<24} {:>12} {:>12} {:>8} {:>9}",
            "effect", "before", "after", "", "p"
        );
    }
    for own in candidates {
        candidate(&own.effect, own, 24);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_are_written_as_people_do() {
        let told = [1.0, 0.534, 0.0456, 2e-5, 0.0].map(chance);
        assert_eq!(told, ["1", "0.53", "0.046", "2.0e-5", "0"]);
    }
}

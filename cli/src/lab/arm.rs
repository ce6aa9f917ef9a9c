//! The commands of the lab on an experiment about a whole arm.

use std::{path::Path, process::ExitCode};

use ferntast_identification::{
    Term,
    arm::{ArmComparison, ArmDiagnosis, ArmTerm},
};
use ferntast_lab::work::{
    self, AddedToArm, ArmAutoEvent, AutoOptions, InUnit, OpenedArm, tell_misread,
};
use indicatif::ProgressBar;

use super::{
    super::{Failure, output::print_json},
    open,
    table::{self, significant},
};

/// Signals that a joint's residual depends on of which the terminal tells.
const DEPENDENCES: usize = 3;

/// Opens an experiment file that is about an arm; `None` where it is about something else.
pub fn open(path: &Path) -> Result<Option<OpenedArm>, Failure> {
    let opened = work::open_arm(path).map_err(Failure::refused)?;
    opened.iter().for_each(tell_notes);
    Ok(opened)
}

fn tell_notes(opened: &OpenedArm) {
    for note in &opened.notes {
        eprintln!("note: {note}");
    }
}

/// `ferntast lab compare`.
pub fn compare(opened: &OpenedArm, json: bool) -> Result<ExitCode, Failure> {
    let result = opened.compare().map_err(Failure::refused)?;
    let unit = opened.torque_unit();
    if json {
        print_json(&InUnit { unit, result })?;
    } else {
        print_comparison(opened, &result);
    }
    Ok(ExitCode::SUCCESS)
}

/// `ferntast lab diagnose`.
pub fn diagnose(opened: &OpenedArm, json: bool) -> Result<ExitCode, Failure> {
    let result = with_bar(opened)?;
    let unit = opened.torque_unit();
    if json {
        print_json(&InUnit { unit, result })?;
    } else {
        println!("{}", opened.experiment.title);
        let misread = opened.tell_misread(&result.misread);
        print_diagnosis(&result, &misread, &|joint| opened.unit_of(joint));
    }
    Ok(ExitCode::SUCCESS)
}

/// `ferntast lab discover`.
pub fn discover(opened: &OpenedArm, seed: u64, json: bool) -> Result<ExitCode, Failure> {
    let bar = open::bar("discover");
    let result = opened.discover(seed, &mut |share| bar.set_position((share * 1000.0) as u64));
    bar.finish_and_clear();
    let result = result.map_err(Failure::refused)?;
    let unit = opened.torque_unit();
    if json {
        print_json(&InUnit { unit, result })?;
        return Ok(ExitCode::SUCCESS);
    }
    println!("{}", opened.experiment.title);
    println!("{}", result.verdict.name());
    for own in &result.candidates {
        println!("add {} first", own.term());
    }
    if result.formulas.is_empty() {
        println!("no formula is proposed ({} terms tried)", result.tried);
    }
    for (own, number) in result.formulas.iter().zip(1..) {
        println!();
        println!("{}", own.joint);
        table::formula(&own.formula, number, opened.unit_of(Some(&own.joint)));
    }
    if let (Some(own), Some(path)) = (result.formulas.first(), &opened.experiment.path) {
        let name = format!("{}@{}", own.formula.name, own.joint);
        table::to_accept(path, &name, &own.formula.expression);
    }
    Ok(ExitCode::SUCCESS)
}

fn with_bar(opened: &OpenedArm) -> Result<ArmDiagnosis, Failure> {
    let bar = open::bar("diagnose");
    let result = opened.diagnose(&mut |share| bar.set_position((share * 1000.0) as u64));
    bar.finish_and_clear();
    result.map_err(Failure::refused)
}

/// `ferntast lab add`.
pub fn add(
    opened: &OpenedArm,
    effect: &Term,
    output: &Path,
    json: bool,
) -> Result<ExitCode, Failure> {
    let added = opened
        .add(&ArmTerm::of(effect), output)
        .map_err(Failure::refused)?;
    if json {
        print_json(&added)?;
        return Ok(ExitCode::SUCCESS);
    }
    print_added(&added, opened.unit_of(added.joint.as_deref()));
    table::parameters(&added.parameters, &added.not_excited);
    tell_held(&added.held_possible);
    Ok(ExitCode::SUCCESS)
}

/// `ferntast lab auto`; `None` where the file is about something else.
pub fn auto(path: &Path, options: &AutoOptions, json: bool) -> Result<Option<ExitCode>, Failure> {
    let mut bar = ProgressBar::hidden();
    let mut table = None;
    let mut tell = |event: ArmAutoEvent<'_>| match event {
        ArmAutoEvent::Opened(opened) => {
            tell_notes(opened);
            table.clone_from(&opened.experiment.arm);
            bar = open::bar("diagnose");
        }
        ArmAutoEvent::Share(share) => bar.set_position((share * 1000.0) as u64),
        ArmAutoEvent::Diagnosed => bar.finish_and_clear(),
        ArmAutoEvent::Added(opened, added) if !json => {
            print_added(added, opened.unit_of(added.joint.as_deref()));
        }
        ArmAutoEvent::Added(..) => {}
    };
    let found = work::auto_arm(path, options, &mut tell).map_err(Failure::refused)?;
    let Some(found) = found else {
        return Ok(None);
    };
    match json {
        true => print_json(&found)?,
        false => {
            let misread = &found.last.misread;
            let told = table.as_ref().map(|arm| tell_misread(arm, misread));
            let unit = |joint: Option<&str>| {
                let arm = table.as_ref();
                arm.map_or("Nm", |arm| arm.torque_unit(joint))
            };
            print_diagnosis(&found.last, &told.unwrap_or_default(), &unit);
        }
    }
    Ok(Some(ExitCode::SUCCESS))
}

fn print_added(added: &AddedToArm, unit: &str) {
    let place = added.joint.as_ref().map(|joint| format!("@{joint}"));
    println!(
        "{:<32} {:>12} -> {} {unit} on data held out ({:+.1} %); {}",
        format!("{}{}", added.effect, place.unwrap_or_default()),
        significant(added.held_out_before),
        significant(added.held_out_after),
        (added.held_out_after / added.held_out_before - 1.0) * 100.0,
        added.experiment.display()
    );
}

fn print_comparison(opened: &OpenedArm, comparison: &ArmComparison) {
    println!("{}", opened.experiment.title);
    println!(
        "{} samples of {} joints, {} rows used",
        comparison.samples,
        comparison.joints.len(),
        comparison.used
    );
    println!();
    println!(
        "{:<26} {:>12} {:>12} {:>10}",
        "joint", "fitted", "held out", "of torque"
    );
    for name in &opened.dataset.joints {
        let Some(own) = comparison.joints.get(name) else {
            continue;
        };
        let unit = opened.unit_of(Some(name));
        println!(
            "{name:<26} {:>9} {unit:<2} {:>9} {unit:<2} {:>8.1} %",
            significant(own.rms.train),
            significant(own.rms.held_out),
            own.relative_error_held_out * 100.0
        );
    }
    for (effect, parameters) in &comparison.arm {
        println!();
        println!("{effect}");
        table::parameters(parameters, &[]);
    }
    tell_held(&comparison.held_possible);
    tell_misread_joints(&opened.tell_misread(&comparison.misread));
    table::varies_together(&comparison.varies_together);
    for name in &opened.dataset.joints {
        if let Some(own) = comparison.joints.get(name) {
            println!();
            println!("{name}");
            table::parameters(&own.parameters, &own.not_excited);
        }
    }
}

/// Joints that are read otherwise than the model has them.
fn tell_misread_joints(told: &[String]) {
    if !told.is_empty() {
        println!();
        println!("warning: joints are read otherwise than the model has them; mend that first:");
    }
    for line in told {
        println!("  {line}");
    }
}

/// Effects whose free fit is no body.
fn tell_held(names: &[String]) {
    for name in names {
        println!("warning: {}", work::held_possible(name));
    }
}

/// `misread`: what is said of joints that are read otherwise than the model has them.
/// `unit`: of a joint's torque.
fn print_diagnosis(
    diagnosis: &ArmDiagnosis,
    misread: &[String],
    unit: &dyn Fn(Option<&str>) -> &'static str,
) {
    println!("{}", diagnosis.verdict.name());
    tell_misread_joints(misread);
    println!("{} variants tried", diagnosis.tried);
    table::varies_together(&diagnosis.varies_together);
    println!();
    println!(
        "{:<26} {:<12} {:>12} {:>8} {:>12}",
        "joint", "", "held out", "used", "cut-off"
    );
    for (name, own) in &diagnosis.joints {
        println!(
            "{name:<26} {:<12} {:>9} {:<2} {:>6.1} % {:>9} Hz",
            own.verdict.name(),
            significant(own.rms.held_out),
            unit(Some(name)),
            own.used.share * 100.0,
            significant(own.used.cutoff_hz)
        );
    }
    if !diagnosis.candidates.is_empty() {
        println!();
        println!(
            "{:<40} {:>12} {:>12} {:>8} {:>9}",
            "effect", "before", "after", "", "p"
        );
    }
    for candidate in &diagnosis.candidates {
        let mut name = candidate.term().to_string();
        if let Some(partner) = &candidate.partner {
            name.push_str(&format!(" from {partner}"));
        }
        table::candidate(&name, &candidate.named, 40);
    }
    print_dependences(diagnosis);
    table::not_tested(&diagnosis.not_tested);
}

/// Of each joint the strongest.
fn print_dependences(diagnosis: &ArmDiagnosis) {
    if !diagnosis.residual_depends_on.is_empty() {
        println!();
        println!("residuals depend on (parts overlap: signals go together)");
    }
    for joint in diagnosis.joints.keys() {
        let all = diagnosis.residual_depends_on.iter();
        let all: Vec<_> = all.filter(|own| own.joint == *joint).collect();
        for own in all.iter().take(DEPENDENCES) {
            println!(
                "  {joint:<22} {:<44} {:.1} % of its mean square",
                own.dependence.on(),
                own.dependence.strength * 100.0
            );
        }
        if let Some(more) = all.len().checked_sub(DEPENDENCES).filter(|own| *own > 0) {
            println!("  {joint:<22} and {more} more, weaker ones (--json)");
        }
    }
}

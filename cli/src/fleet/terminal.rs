//! What is told of a fleet, for people.

use ferntast_fleet::{
    Named, Told,
    ageing::{Kind, Standing},
};

/// Parameters that are told though nothing is named.
pub const STANDING: usize = 10;

/// Tells how the fleet is.
pub fn tell(told: &Told) {
    let (Some(from), Some(to)) = (&told.from, &told.to) else {
        println!("no days");
        return;
    };
    println!(
        "{} days, {from} to {to}; {} robots, {} joints; named from {:.1} standard deviations on",
        told.days, told.robots, told.joints, told.threshold
    );
    told.named.iter().for_each(tell_named);
    match told.named.is_empty() {
        true => println!("no joint ages differently from its siblings"),
        false => println!(),
    }
    if told.standing.is_empty() {
        println!(
            "nobody can be told from its siblings yet: that takes six days, and three robots on each of them"
        );
        return;
    }
    println!("what stands out most today:");
    told.standing.iter().for_each(tell_standing);
}

/// Tells of a joint that was named.
pub fn tell_named(own: &Named) {
    let course = match own.kind {
        Kind::Ramp => "ages differently",
        Kind::Step => "made a step",
    };
    println!(
        "{}: {} {} {course} since {} ({:.1} standard deviations, {:.1} are enough)",
        own.day,
        own.robot,
        own.joint,
        own.since,
        own.evidence.abs(),
        own.threshold
    );
    own.parameters.iter().for_each(tell_standing);
}

fn tell_standing(own: &Standing) {
    let course = match own.kind {
        Kind::Ramp => "ramp",
        Kind::Step => "step",
    };
    println!(
        "  {:<16} {:<10} {:<8} {course} of {:+.3} ({:+.1} % beside its siblings), {:+.1} standard deviations",
        own.robot,
        own.joint,
        own.parameter,
        own.change,
        100.0 * own.share,
        own.evidence
    );
}

//! `ferntast twin friction`, `take-over`, `give-back`.

use std::{process::ExitCode, thread, time::Duration};

use ferntast_bus::{Bus, Depth};
use ferntast_msgs::{
    Time,
    sample::{FrictionCommand, FrictionCommandSample, FrictionStatusSample, JointNames},
    topics,
};
use ferntast_nodes::{process::Clock, servo::FrictionSummary, session::Visit};

use super::super::{Failure, output::print_json};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Name of the session.
    #[arg(long, default_value = "default", value_name = "NAME")]
    session: String,
}

/// How long an answer is waited for \[s\]: the servo tells every second.
const PATIENCE: f64 = 2.5;

/// What the servo says of its joints.
type Told = Vec<FrictionStatusSample>;

/// Gives the command, if there is one, and tells what is fed forward.
pub fn run(
    arguments: &Arguments,
    command: Option<FrictionCommand>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let visit = Visit::open(&arguments.session).map_err(Failure::refused)?;
    let told = match visit.as_ref().and_then(Visit::bus) {
        Some(bus) => ask(bus, command)?,
        None => None,
    };
    drop(visit);
    let Some(told) = told else {
        return Err(Failure::failed(format!(
            "the servo of session {:?} does not answer: is it running on this host? (ferntast session, or --session NAME)",
            arguments.session
        )));
    };
    if let (Some(_), Some(one)) = (command, told.iter().find(|one| !one.refused.is_empty())) {
        let (joint, why) = (&one.joint, &one.refused);
        return Err(Failure::refused(format!("{joint}: refused: {why}")));
    }
    let summaries: Vec<FrictionSummary> = told.iter().map(FrictionSummary::of).collect();
    if json {
        print_json(&summaries)?;
    } else {
        summaries.iter().for_each(|own| println!("{own}"));
    }
    Ok(ExitCode::SUCCESS)
}

/// The first word of all joints, or the first after the command was dealt with.
fn ask(bus: &Bus, command: Option<FrictionCommand>) -> Result<Option<Told>, Failure> {
    let clock = Clock::start();
    let mut publisher = bus
        .publisher(topics::FOLLOWER_FRICTION_COMMAND)
        .map_err(Failure::failed)?;
    let Some(names) = joints(bus, clock)? else {
        return Ok(None);
    };
    let friction = topics::FOLLOWER_JOINT_FRICTION.of_joints(&names);
    let mut joints = Vec::new();
    for topic in friction.map_err(Failure::failed)? {
        let joint = bus.subscriber(topic, Depth::Newest);
        joints.push(joint.map_err(Failure::failed)?);
    }
    let mut listen = |enough: &dyn Fn(&FrictionStatusSample) -> bool| {
        let mut told: Vec<Option<FrictionStatusSample>> = vec![None; joints.len()];
        wait(clock, |now| {
            for (place, joint) in told.iter_mut().zip(&mut joints) {
                let heard = joint.newest(now).map(|received| received.message);
                *place = heard.filter(|own| enough(own)).or(*place);
            }
            told.iter().copied().collect::<Option<Told>>()
        })
    };
    let Some(before) = listen(&|_| true) else {
        return Ok(None);
    };
    let Some(command) = command else {
        return Ok(Some(before));
    };
    let now = clock.now();
    publisher
        .publish(now, &FrictionCommandSample::new(now, command))
        .map_err(Failure::failed)?;
    let dealt_with = before.iter().map(|own| own.commands).max();
    Ok(listen(&|own| {
        dealt_with.is_none_or(|before| own.commands > before)
    }))
}

/// The joints of the servo: it names them in every message.
fn joints(bus: &Bus, clock: Clock) -> Result<Option<JointNames>, Failure> {
    let mut servo = bus
        .subscriber(topics::FOLLOWER_SETPOINT_JS, Depth::Newest)
        .map_err(Failure::failed)?;
    Ok(wait(clock, |now| {
        servo.newest(now).map(|received| received.message.joints)
    }))
}

/// What `look` finds, asked for as long as an answer is waited for.
fn wait<T>(clock: Clock, mut look: impl FnMut(Time) -> Option<T>) -> Option<T> {
    let begun = clock.now();
    while clock.now().seconds_since(begun) < PATIENCE {
        if let Some(found) = look(clock.now()) {
            return Some(found);
        }
        thread::sleep(Duration::from_millis(5));
    }
    None
}

//! `ferntast twin friction`, `take-over`, `give-back`.

use std::{process::ExitCode, thread, time::Duration};

use ferntast_bus::{Bus, Depth, SharedMemoryBus, SharedMemoryConfig};
use ferntast_msgs::{
    sample::{FrictionCommand, FrictionCommandSample, FrictionStatusSample},
    topics,
};
use ferntast_nodes::{process::Clock, servo::FrictionSummary};

use super::super::{Failure, output::print_json};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Name of the session.
    #[arg(long, default_value = "default", value_name = "NAME")]
    session: String,
}

/// How long an answer is waited for \[s\]: the servo tells every second.
const PATIENCE: f64 = 2.5;

/// What the servo says of both joints.
type Told = [FrictionStatusSample; 2];

/// Gives the command, if there is one, and tells what is fed forward.
pub fn run(
    arguments: &Arguments,
    command: Option<FrictionCommand>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let bus = Bus::SharedMemory(
        SharedMemoryBus::open(&SharedMemoryConfig {
            session: arguments.session.clone(),
        })
        .map_err(Failure::refused)?,
    );
    let told = ask(&bus, command);
    drop(bus);
    // Where no session runs, this process is the only one that was in its
    // shared memory; where one runs, this is refused.
    let _ = SharedMemoryBus::clean_up(&arguments.session);
    let Some(told) = told? else {
        return Err(Failure::failed(format!(
            "the servo of session {:?} does not answer: is it running on this host? (ferntast session, or --session NAME)",
            arguments.session
        )));
    };
    if let (Some(_), Some(one)) = (command, told.iter().find(|one| !one.refused.is_empty())) {
        return Err(Failure::refused(format!("refused: {}", one.refused)));
    }
    let summaries = told.each_ref().map(FrictionSummary::of);
    if json {
        print_json(&summaries)?;
    } else {
        summaries.iter().for_each(|own| println!("{own}"));
    }
    Ok(ExitCode::SUCCESS)
}

/// The first word of both joints, or the first after the command was dealt with.
fn ask(bus: &Bus, command: Option<FrictionCommand>) -> Result<Option<Told>, Failure> {
    let clock = Clock::start();
    let mut publisher = bus
        .publisher(topics::FOLLOWER_FRICTION_COMMAND)
        .map_err(Failure::failed)?;
    let open = |topic| {
        bus.subscriber(topic, Depth::Newest)
            .map_err(Failure::failed)
    };
    let mut joints = [
        open(topics::FOLLOWER_JOINT_1_FRICTION)?,
        open(topics::FOLLOWER_JOINT_2_FRICTION)?,
    ];
    let mut listen = |enough: &dyn Fn(&FrictionStatusSample) -> bool| {
        let begun = clock.now();
        let mut told: [Option<FrictionStatusSample>; 2] = [None; 2];
        while clock.now().seconds_since(begun) < PATIENCE {
            for (place, joint) in told.iter_mut().zip(&mut joints) {
                let heard = joint.newest(clock.now()).map(|received| received.message);
                *place = heard.filter(|own| enough(own)).or(*place);
            }
            if let [Some(first), Some(second)] = told {
                return Some([first, second]);
            }
            thread::sleep(Duration::from_millis(5));
        }
        None
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
    let dealt_with = before[0].commands;
    Ok(listen(&|own| own.commands > dealt_with))
}

//! The console: serves the page, and carries what pages want to the topics.
//!
//! No 1 kHz loop shares its process: whatever a browser asks of it, the arm's
//! loops go on.

mod about;
mod spatial;

use std::{path::PathBuf, sync::Arc};

use ferntast_config::Believed;
use ferntast_console::{
    Listen, Server,
    server::Content,
    session::{ArmTopics, GripModel, HandMapping, PageHand, SessionPorts, SharedSession},
};
use ferntast_emulation::hand::{HandImpedance, ImpedanceParameters};
use ferntast_msgs::{
    sample::{Fault, Faults, Level},
    topics,
};

use crate::{
    events::TELLER,
    node::{InputWatch, NodeHealth},
    process::{End, NodeError, Priority, ProcessContext},
};

/// How far the hand goes from the middle \[m\].
const REACH: f64 = 0.06;
/// How far the pointer draws the hand's spring out \[m\]: it pulls with 4 N at
/// most, which with the usual scale is 80 N at the tip.
const LEASH: f64 = 0.004;
/// A firm grip, with more damping than a person's: a mouse gives none.
const IMPEDANCE: ImpedanceParameters = ImpedanceParameters {
    mass: 0.5,
    damping: 80.0,
    stiffness: 1000.0,
};

/// A hand with the impedance of a person's.
struct Grip(HandImpedance<3>);

impl GripModel for Grip {
    fn rest_at(&mut self, position: [f64; 3]) {
        self.0 = HandImpedance::new(IMPEDANCE, position);
    }

    fn step(&mut self, dt: f64, target: [f64; 3], force: [f64; 3]) -> [f64; 3] {
        self.0.step(dt, target, [0.0; 3], force);
        self.0.position()
    }
}

/// What tells of the arm on a host that runs `here`.
fn arm_topics(here: Option<End>) -> ArmTopics {
    let state = End::arm_state(here);
    match End::Arm.is_at(here) {
        true => ArmTopics {
            joints: topics::FOLLOWER_MEASURED_JS,
            tip: topics::FOLLOWER_MEASURED_CP,
            force: topics::FOLLOWER_MEASURED_CF,
            contact: topics::FOLLOWER_CONTACT_STATE,
            state,
        },
        false => ArmTopics {
            joints: topics::LINK_ARM_MEASURED_JS,
            tip: topics::LINK_ARM_MEASURED_CP,
            force: topics::LINK_ARM_MEASURED_CF,
            contact: topics::LINK_ARM_CONTACT_STATE,
            state,
        },
    }
}

/// Runs the console until it is told to stop.
///
/// # Errors
///
/// A topic that cannot be opened; an address that cannot be listened at.
pub fn run(process: &ProcessContext) -> Result<(), NodeError> {
    let options = process.session.console.clone().unwrap_or_default();
    let clock = process.clock;
    let loaded = &process.session.loaded;
    // In the direction in which a planar arm cannot go, its hand does not.
    let reach = match loaded.arm.model {
        Believed::Planar(_) => [REACH, REACH, 0.0],
        Believed::Serial(_) => [REACH; 3],
    };
    let about = about::about(process.session, reach);
    let shared = Arc::new(SharedSession::new(about, Box::new(move || clock.now())));
    let grip = Grip(HandImpedance::new(IMPEDANCE, [0.0; 3]));
    let hand = PageHand::new(Box::new(grip), reach, LEASH);
    let mapping = loaded.scenario.law.mapping();
    let mapping = HandMapping {
        offset: mapping.workspace_offset,
        scale: mapping.position_scale,
    };
    let mut ports = SessionPorts::connect(
        &process.bus,
        &process.session.joints(),
        arm_topics(process.session.end),
        shared.clone(),
        hand,
        mapping,
        TELLER,
    )?;
    let mut diagnostics = process.bus.publisher(topics::DIAGNOSTICS)?;
    let listen = Listen {
        address: options.listen,
        token: options.token,
    };
    let server = Server::start(
        &listen,
        Content {
            shared: Some(shared),
            folder: PathBuf::from("."),
        },
    )
    .map_err(NodeError::own)?;
    eprintln!("console: {}", server.url);
    // After the server's threads, which must not have it: the hand on the
    // master shall not be lost to a computer that is busy drawing.
    let mut standing = Faults::default();
    if Priority::Hand.take().is_err() {
        standing.set(Fault::NoRealtime);
    }
    let mut meter = process.meter(standing);
    let mut watch = InputWatch::default();
    process.run(|wake| {
        let mut health = NodeHealth {
            lost: ports.round(wake.now),
            ..NodeHealth::default()
        };
        if meter.is_due(wake.now) {
            watch.note(|each| ports.inputs(each), &mut health);
        }
        if health.lost > 0 {
            health.level = health.level.max(Level::WARN);
        }
        let sample = meter.step(wake.now, wake.late_nanos, wake.missed, &health);
        if let Some(sample) = sample {
            // What cannot be said now is said a tenth of a second later.
            let _ = diagnostics.publish(wake.now, &sample);
        }
    });
    drop(server);
    Ok(())
}

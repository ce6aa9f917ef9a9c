//! The console: serves the page, and carries what pages want to the topics.
//!
//! No 1 kHz loop shares its process: whatever a browser asks of it, the arm's
//! loops go on.

use std::{path::PathBuf, sync::Arc};

use ferntast_console::{
    Listen, Server,
    server::Content,
    session::{GripModel, HandMapping, PageHand, SessionPorts, SharedSession},
};
use ferntast_control::{delay::Law, frame::WIRE_LENGTH};
use ferntast_emulation::{
    channel::LinkConfig,
    hand::{HandImpedance, ImpedanceParameters},
};
use ferntast_msgs::{
    sample::{Fault, Faults, Level},
    topics,
};
use serde_json::{Value, json};

use crate::{
    config::{Believed, HandSource, Loaded, known_links},
    events::TELLER,
    node::{InputWatch, NodeHealth},
    process::{NodeError, Priority, ProcessContext},
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
struct Grip(HandImpedance);

impl GripModel for Grip {
    fn rest_at(&mut self, position: [f64; 2]) {
        self.0 = HandImpedance::new(IMPEDANCE, position);
    }

    fn step(&mut self, dt: f64, target: [f64; 2], force: [f64; 2]) -> [f64; 2] {
        self.0.step(dt, target, [0.0; 2], force);
        self.0.position()
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
    let about = about(&process.session.session, &process.session.loaded);
    let shared = Arc::new(SharedSession::new(about, Box::new(move || clock.now())));
    let grip = Grip(HandImpedance::new(IMPEDANCE, [0.0; 2]));
    let hand = PageHand::new(Box::new(grip), REACH, LEASH);
    let mapping = process.session.loaded.scenario.law.mapping();
    let [x, y, _] = mapping.workspace_offset;
    let mapping = HandMapping {
        offset: [x, y],
        scale: mapping.position_scale,
    };
    let mut ports = SessionPorts::connect(
        &process.bus,
        &process.session.joints(),
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
        watch.note(|each| ports.inputs(each), &mut health);
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

/// What the page has to know of the session before anything moves. Lengths
/// \[m\], times \[s\], forces \[N\].
fn about(session: &str, loaded: &Loaded) -> Value {
    let scenario = &loaded.scenario;
    let json = |value: Result<Value, serde_json::Error>| value.unwrap_or_default();
    let mapping = scenario.law.mapping();
    // What the page draws beside the tip: of an arm in space nothing, which it sees from above.
    let (lengths, nominal_tip, edges, springs) = match &loaded.arm.model {
        Believed::Planar(_) => {
            let arm = json(serde_json::to_value(&loaded.arm));
            let length = |link: usize| arm["arm"]["link"][link]["length"].clone();
            let contour = &arm["contour"];
            (
                json!([length(0), length(1)]),
                contour["nominal_tip"].clone(),
                contour["edge"].clone(),
                contour["spring"].clone(),
            )
        }
        Believed::Serial(serial) => {
            let tip = serial.arm.home_tip().translation;
            (json!([]), json!([tip.x, tip.y]), json!([]), json!([]))
        }
    };
    let presets = known_links();
    let presets: Vec<Value> = presets
        .iter()
        .map(|(name, link)| preset(name, link))
        .collect();
    json!({
        "session": session,
        "scenario": scenario.name,
        "hand": match scenario.hand.source {
            HandSource::Scripted => "the script",
            HandSource::Recorded => "the recorded motion",
            HandSource::Crtk => "this host",
            HandSource::Haply => "the Haply",
        },
        "lengths": lengths,
        "nominal_tip": nominal_tip,
        "edges": edges,
        "springs": springs,
        "workspace_offset": mapping.workspace_offset,
        "position_scale": mapping.position_scale,
        "law": scenario.law.name(),
        "laws": Law::NAMES,
        "presets": presets,
        "rearm_after_gap": scenario.link.rearm_after_gap,
        "force_limit": scenario.master.force_limit,
        // The hand's force is drawn as long as the contact's that it stands for.
        "hand_arrow": 1.0 / Some(mapping.force_scale).filter(|scale| *scale > 0.0).unwrap_or(1.0),
    })
}

/// A channel to choose: what the sliders are set to. Times \[s\].
fn preset(name: &str, link: &LinkConfig) -> Value {
    let (up, down) = (&link.up, &link.down);
    json!({
        "name": name,
        "description": link.description,
        "round_trip": link.nominal_round_trip(WIRE_LENGTH),
        "jitter": up.largest_deviation().max(down.largest_deviation()),
        "loss": up.mean_loss().max(down.mean_loss()),
    })
}

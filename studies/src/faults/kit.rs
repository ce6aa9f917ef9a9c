//! What schedules are made from: the scenario, read once.

use ferntast_config::{ConfigError, HandSource, Loaded, UnknownLaw};
use ferntast_control::planted::Planted;
use ferntast_drivers::simulated::{self, serial::truth};
use ferntast_emulation::{channel::LinkConfig, hand::Motion};
use ferntast_model::ParameterError;
use ferntast_nodes::{
    graph::{Graph, NodeRow, UnknownNode},
    process::SessionContext,
};
use ferntast_sim::arm::ArmConfig;

use super::{arm::TrueArm, facts::Facts, fault::Node};

/// How many times as fast as in its scenario a scripted hand works, so that a
/// schedule of 2.5 s has reaching, pressing and sliding in it.
const PACE: f64 = 4.0;

/// Steps of the mechanics, longer than usual \[s\]: the first one with which the
/// arm's configuration says that its fastest vibration is resolved is taken.
const SUBSTEPS: [f64; 4] = [1.0 / 2000.0, 1.0 / 3000.0, 1.0 / 4000.0, 1.0 / 6000.0];

/// Why a scenario cannot be run under faults.
#[derive(Debug, thiserror::Error)]
pub enum KitError {
    /// A file cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// There is no such law.
    #[error(transparent)]
    Law(#[from] UnknownLaw),
    /// The graph lacks a node.
    #[error(transparent)]
    Node(#[from] UnknownNode),
    /// The hand is somebody's on ROS 2.
    #[error(
        "{path}: its hand is not scripted, and nobody else is there in virtual time; \
         choose a scenario with [hand] source = \"scripted\""
    )]
    Hand {
        /// The scenario's file.
        path: String,
    },
    /// An arm or a tuning that no servo takes.
    #[error("{path}: {source}")]
    Arm {
        /// The scenario's file.
        path: String,
        /// What is wrong.
        source: ParameterError,
    },
}

/// A scenario under one of its laws.
pub struct Kit {
    /// As nodes have it; channels are the wire's.
    pub context: SessionContext,
    /// Channels of the scenario.
    pub link: LinkConfig,
    /// The arm.
    pub arm: TrueArm,
    /// Limits.
    pub facts: Facts,
    /// Nodes of the control path.
    pub rows: [NodeRow; 6],
}

impl Kit {
    /// What `loaded` comes to under `law`.
    ///
    /// # Errors
    ///
    /// What keeps it from being run under faults.
    pub fn new(graph: &Graph, loaded: &Loaded, law: &str) -> Result<Kit, KitError> {
        let mut loaded = loaded.clone();
        loaded.complete()?;
        loaded.scenario.set_law(law)?;
        let path = loaded.path.clone();
        if loaded.scenario.hand.source != HandSource::Scripted {
            return Err(KitError::Hand { path });
        }
        if let Some(hand) = &mut loaded.scenario.hand.scripted {
            for phase in &mut hand.script.phase {
                phase.duration = (phase.duration / PACE).max(0.01);
            }
        }
        let link = std::mem::take(&mut loaded.link);
        let arm = match loaded.arm.model.serial() {
            None => TrueArm::Planar(Box::new(quicker(loaded.arm.whole()?))),
            Some(_) => TrueArm::Serial(Box::new(truth(&loaded.arm)?)),
        };
        let stiffest = match &arm {
            TrueArm::Planar(_) => 0.0,
            TrueArm::Serial(truth) => {
                let each = truth.object.iter().map(|own| own.surface.stiffness);
                each.fold(0.0, f64::max)
            }
        };
        let facts =
            Facts::new(&loaded, stiffest).map_err(|source| KitError::Arm { path, source })?;
        let mut rows = Vec::with_capacity(Node::ALL.len());
        for node in Node::ALL {
            rows.push(*graph.row(node.name())?);
        }
        Ok(Kit {
            context: SessionContext::in_virtual_time(loaded),
            link,
            arm,
            facts,
            rows: [rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]],
        })
    }

    /// The same session with the seed of a schedule.
    pub fn session(&self, seed: u64, planted: Planted) -> SessionContext {
        let mut context = self.context.clone();
        context.planted = planted;
        context.loaded.scenario.seed = seed;
        context
    }

    /// Another operator's host of the same session: its hand does something else.
    pub fn other_operator(&self, seed: u64) -> SessionContext {
        let mut context = self.session(seed ^ 1, Planted::NONE);
        if let Some(hand) = &mut context.loaded.scenario.hand.scripted {
            for phase in &mut hand.script.phase {
                phase.motion = Motion::Sine {
                    amplitude: [0.025, -0.02].into(),
                    frequency: 3.0,
                };
                phase.duration = 5.0;
            }
        }
        context
    }
}

/// The arm of two joints with steps of its mechanics that are as long as they may be.
fn quicker(mut arm: ArmConfig) -> ArmConfig {
    let usual = arm.truth.substep;
    for substep in SUBSTEPS {
        arm.truth.substep = usual.max(substep);
        if arm.validate().is_ok() {
            break;
        }
        arm.truth.substep = usual;
    }
    arm
}

/// Loads a scenario for the simulated arm.
///
/// # Errors
///
/// What is wrong with it, where, and how to correct it.
pub fn load(scenario: &str) -> Result<Loaded, ConfigError> {
    let mut loaded = ferntast_config::load_scenario(scenario, simulated::load_arm)?;
    loaded.complete()?;
    Ok(loaded)
}

//! Playback: player, gateway and, if asked, a live estimator and a twin.

use std::{
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
};

use ferntast_bag::{BagInfo, BagReader, Break};
use ferntast_bus::{Bus, CreateError, SharedMemoryBus, SharedMemoryConfig};
use ferntast_msgs::sample::JointNames;
use serde::Serialize;

use super::{
    Monitor, SessionError, Supervisor, host_resources::HostResources, node_view::NodeView,
};
use crate::{
    bridge::{
        others::{self, LeftOut, Sorted},
        player,
    },
    graph::{Graph, NodeRow},
    process::SessionContext,
    twin::{self, TwinSummary},
};

/// How long a twin may take to fit its model \[s\].
const TWIN_PATIENCE: f64 = 60.0;

/// What was played.
#[derive(Debug, Serialize)]
pub struct Played {
    /// The recording.
    pub recording: String,
    /// How long it was played \[s\].
    pub played_s: f64,
    /// Whether a live estimator took part.
    pub estimated: bool,
    /// Topics that are not ours, which went to ROS 2 as they are.
    pub as_recorded: Vec<String>,
    /// Topics that were not played, and why.
    pub left_out: Vec<LeftOut>,
    /// Messages that were lost on the way onto the topics.
    pub lost: u64,
    /// Where the recording is damaged: what stood there was not played.
    pub breaks: Vec<Break>,
    /// The last word of each live twin.
    pub twins: Vec<TwinSummary>,
}

impl Played {
    /// Why not all of the recording was played; `None` where it was.
    pub fn fault(&self) -> Option<String> {
        if let Some(first) = self.breaks.first() {
            return Some(format!(
                "{} is damaged in {} places, the first at byte {} ({}): what stands there was not played; `ferntast bag repair` mends it",
                self.recording,
                self.breaks.len(),
                first.offset,
                first.reason
            ));
        }
        (self.lost > 0).then(|| {
            format!(
                "{} messages of {} were not played: the computer is too slow for --rate",
                self.lost, self.recording
            )
        })
    }
}

/// The joints of the recording at `path`, where it says which.
pub fn recorded_joints(path: &Path) -> Option<JointNames> {
    ferntast_lab::joints::recorded_joints(&BagReader::open(path).ok()?)
}

/// Plays the context's recording, to the nodes of `graph` that listen to it,
/// until its end or until `stop` is set; `info` says what it holds. What a live
/// node publishes is not played.
///
/// # Errors
///
/// What keeps it from starting.
pub fn play(
    graph: &Graph,
    mut context: SessionContext,
    info: &BagInfo,
    stop: &AtomicBool,
) -> Result<Played, SessionError> {
    let follows = !context.twins.is_empty();
    // First those that listen, then the player.
    let rows: Vec<&NodeRow> = graph
        .rows()
        .filter(|row| (row.in_playback)(&context))
        .collect();
    let nodes: Vec<&str> = rows.iter().map(|row| row.name).collect();
    let joints = context.joints();
    for row in &rows {
        let live = row.outputs(&joints).map_err(CreateError::from)?;
        context
            .play
            .except
            .extend(live.into_iter().map(String::from));
    }
    let sorted = sort(&context, &joints)?;
    let resources = HostResources::acquire(&context)?;
    let session_file = resources.session_file.clone();
    let executable = std::env::current_exe().map_err(SessionError::Executable)?;
    let mut listeners = Supervisor::new(executable.clone(), session_file.clone(), &nodes);
    listeners.start()?;
    let clock = context.clock();
    let bus = Bus::SharedMemory(SharedMemoryBus::open(&SharedMemoryConfig {
        session: context.session.clone(),
    })?);
    let mut monitor = Monitor::new(&bus, &joints, None)?;
    let ready = clock.now().plus_seconds(1.0);
    let patience = clock.now().plus_seconds(TWIN_PATIENCE);
    loop {
        let now = clock.now();
        monitor.update(now);
        // A twin is ready once its model is fitted.
        let fitted = !follows || monitor.is_alive(twin::NAME, now) || now > patience;
        if (now >= ready && fitted) || stop.load(Ordering::Relaxed) {
            break;
        }
        listeners.watch()?;
        clock.sleep_until(now.plus_nanos(20_000_000));
    }
    let mut player = Supervisor::new(executable, session_file, &[player::NAME]);
    player.start()?;
    let begun = clock.now();
    let bar = indicatif::ProgressBar::new((info.duration_s / context.play.rate).ceil() as u64);
    while !stop.load(Ordering::Relaxed) {
        listeners.watch()?;
        if player.ended()? {
            break;
        }
        bar.set_position(clock.now().seconds_since(begun) as u64);
        monitor.update(clock.now());
        clock.sleep_until(clock.now().plus_nanos(20_000_000));
    }
    bar.finish_and_clear();
    let played = clock.now().seconds_since(begun);
    monitor.update(clock.now());
    let twins = match follows {
        true => monitor.twins(),
        false => Vec::new(),
    };
    let lost = monitor.nodes.get(player::NAME).map_or(0, NodeView::lost);
    drop((monitor, bus));
    player.stop();
    listeners.stop();
    resources.release()?;
    Ok(Played {
        recording: context
            .bag
            .map(|bag| bag.display().to_string())
            .unwrap_or_default(),
        played_s: played,
        estimated: context.play.estimate,
        as_recorded: sorted.raw.into_iter().map(|own| own.name).collect(),
        left_out: sorted.left_out,
        lost,
        breaks: info.breaks.clone(),
        twins,
    })
}

/// What becomes of the recording's topics.
fn sort(context: &SessionContext, joints: &JointNames) -> Result<Sorted, CreateError> {
    // What cannot be opened the player refuses in words.
    let bag = context
        .bag
        .as_deref()
        .and_then(|path| BagReader::open(path).ok());
    let Some(bag) = bag else {
        return Ok(Sorted::default());
    };
    let middleware = context.loaded.scenario.gateway.middleware;
    Ok(others::sort(
        &bag,
        joints,
        &context.play.except,
        middleware,
    )?)
}

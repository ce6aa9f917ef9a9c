//! Playback: player, gateway and, if asked, a live estimator.

use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;

use super::{SessionContext, Supervisor, place::Place, run::SessionError};
use crate::node_name::NodeName;

/// Topics that a live estimator publishes in place of the recording.
const OF_THE_ESTIMATOR: [&str; 4] = [
    "/follower/measured_cp",
    "/follower/measured_cf",
    "/follower/contact_cf",
    "/follower/contact_state",
];

/// What was played.
#[derive(Debug, Serialize)]
pub struct Played {
    /// The recording.
    pub recording: String,
    /// How long it was played \[s\].
    pub played_s: f64,
    /// Whether a live estimator took part.
    pub estimated: bool,
}

/// Plays the context's recording until its end or until `stop` is set.
///
/// # Errors
///
/// What keeps it from starting.
pub fn play(
    mut context: SessionContext,
    estimate: bool,
    duration: f64,
    stop: &AtomicBool,
) -> Result<Played, SessionError> {
    // First those that listen, then the player.
    let mut nodes = vec![NodeName::Gateway];
    if estimate {
        nodes.push(NodeName::Estimator);
        context.play.except = OF_THE_ESTIMATOR.map(str::to_owned).to_vec();
    }
    let place = Place::take(&context)?;
    let session_file = place.session_file.clone();
    let executable = std::env::current_exe().map_err(SessionError::Executable)?;
    let mut listeners = Supervisor::new(executable.clone(), session_file.clone(), &nodes);
    listeners.start()?;
    let clock = context.clock();
    let ready = clock.now().plus_seconds(1.0);
    while clock.now() < ready && !stop.load(Ordering::Relaxed) {
        listeners.watch()?;
        clock.sleep_until(clock.now().plus_nanos(20_000_000));
    }
    let mut player = Supervisor::new(executable, session_file, &[NodeName::Player]);
    player.start()?;
    let begun = clock.now();
    let bar = indicatif::ProgressBar::new((duration / context.play.rate).ceil() as u64);
    while !stop.load(Ordering::Relaxed) {
        listeners.watch()?;
        if player.ended()? {
            break;
        }
        bar.set_position(clock.now().seconds_since(begun) as u64);
        clock.sleep_until(clock.now().plus_nanos(20_000_000));
    }
    bar.finish_and_clear();
    let played = clock.now().seconds_since(begun);
    player.stop();
    listeners.stop();
    place.leave()?;
    Ok(Played {
        recording: context
            .bag
            .map(|bag| bag.display().to_string())
            .unwrap_or_default(),
        played_s: played,
        estimated: estimate,
    })
}

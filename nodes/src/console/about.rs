//! What the page has to know of a session before anything moves.

use ferntast_config::{HandSource, known_links};
use ferntast_control::{delay::Law, frame::WIRE_LENGTH};
use ferntast_emulation::channel::LinkConfig;
use serde_json::{Value, json};

use super::spatial::spatial;
use crate::process::SessionContext;

/// Of `session`; its hand goes as far as `reach` from the middle. Lengths \[m\], times \[s\],
/// forces \[N\].
pub fn about(session: &SessionContext, reach: [f64; 3]) -> Value {
    let loaded = &session.loaded;
    let scenario = &loaded.scenario;
    let json = |value: Result<Value, serde_json::Error>| value.unwrap_or_default();
    let mapping = scenario.law.mapping();
    // The flat picture is of a planar arm; its contour goes with it.
    let planar = loaded.arm.model.planar().map(|_| {
        let arm = json(serde_json::to_value(&loaded.arm));
        let length = |link: usize| arm["arm"]["link"][link]["length"].clone();
        let contour = &arm["contour"];
        json!({
            "lengths": [length(0), length(1)],
            "nominal_tip": contour["nominal_tip"],
            "edges": contour["edge"],
            "springs": contour["spring"],
        })
    });
    let presets = known_links();
    let presets: Vec<Value> = presets
        .iter()
        .map(|(name, link)| preset(name, link))
        .collect();
    json!({
        "session": session.session,
        // The end of the link on this host, where that is only one.
        "end": session.end,
        "scenario": scenario.name,
        "hand": match scenario.hand.source {
            HandSource::Scripted => "the script",
            HandSource::Recorded => "the recorded motion",
            HandSource::Crtk => "this host",
            HandSource::Haply => "the Haply",
            HandSource::Leader => "the leader arm",
        },
        "planar": planar,
        "spatial": spatial(&loaded.arm),
        "reach": reach,
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

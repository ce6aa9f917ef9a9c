//! What Haply's Inverse Service says and takes, as JSON over its WebSocket.
//!
//! It sends frames {"inverse3": [{"device_id", "state": {"cursor_position": {"x", "y", "z"},
//! "cursor_velocity": {…}}}], "wireless_verse_grip": [{"device_id", "state": {"orientation": {"w", "x",
//! "y", "z"}}}]} in m and m/s, and takes {"inverse3": [{"device_id", "commands":
//! {"set_cursor_force": {"values": {"x", "y", "z"}}}}]} in N, each frame being answered. By
//! Haply's documentation of its Inverse Service 3; whatever else a frame holds is not looked at.

use serde::Deserialize;
use serde_json::{Value, json};

/// What a frame says of the hand, in the device's frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Heard {
    /// Which device, as it is to be called.
    pub(super) device: Value,
    /// Of the cursor \[m\].
    pub(super) position: [f64; 3],
    /// Of a grip: quaternion x, y, z, w; `None` without one.
    pub(super) orientation: Option<[f64; 4]>,
}

/// Why a frame tells nothing of a hand.
#[derive(Debug, thiserror::Error)]
pub(super) enum FrameError {
    /// No JSON, or of another form.
    #[error("a frame that is none of Haply's Inverse Service 3: {0}")]
    Form(#[from] serde_json::Error),
    /// The service runs, the device is not there.
    #[error("no Inverse3 in the service's frames: is it plugged in and calibrated?")]
    NoDevice,
}

#[derive(Deserialize)]
struct Frame {
    #[serde(default)]
    inverse3: Vec<Device>,
    #[serde(default)]
    wireless_verse_grip: Vec<Grip>,
    #[serde(default)]
    verse_grip: Vec<Grip>,
}

#[derive(Deserialize)]
struct Device {
    device_id: Value,
    state: DeviceState,
}

#[derive(Deserialize)]
struct DeviceState {
    cursor_position: Vector,
}

#[derive(Deserialize)]
struct Vector {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Deserialize)]
struct Grip {
    state: GripState,
}

#[derive(Deserialize)]
struct GripState {
    orientation: Option<Quaternion>,
}

#[derive(Deserialize)]
struct Quaternion {
    w: f64,
    x: f64,
    y: f64,
    z: f64,
}

/// Reads a frame: the first device, and the first grip.
pub(super) fn read(text: &str) -> Result<Heard, FrameError> {
    let frame: Frame = serde_json::from_str(text)?;
    let device = frame
        .inverse3
        .into_iter()
        .next()
        .ok_or(FrameError::NoDevice)?;
    let mut grips = frame
        .wireless_verse_grip
        .into_iter()
        .chain(frame.verse_grip);
    let Vector { x, y, z } = device.state.cursor_position;
    Ok(Heard {
        device: device.device_id,
        position: [x, y, z],
        orientation: grips
            .find_map(|own| own.state.orientation)
            .map(|own| [own.x, own.y, own.z, own.w]),
    })
}

/// The answer that puts `force` \[N\], of the device's frame, on the hand.
pub(super) fn force(device: &Value, [x, y, z]: [f64; 3]) -> String {
    let values = json!({"x": x, "y": y, "z": z});
    let commands = json!({"set_cursor_force": {"values": values}});
    json!({"inverse3": [{"device_id": device, "commands": commands}]}).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_tells_cursor_and_grip() {
        let text = r#"{"inverse3": [{"device_id": "04C3", "config": {"handedness": "right"}, "state":
            {"cursor_position": {"x": 0.01, "y": -0.12, "z": 0.2}, "cursor_velocity": {"x": 0, "y": 0,
            "z": 0}}, "status": {"calibrated": true}}], "wireless_verse_grip": [{"device_id": "61576",
            "state": {"orientation": {"w": 0.6, "x": 0.0, "y": 0.8, "z": 0.0}, "buttons": {}}}]}"#;
        let heard = read(text).unwrap();
        assert_eq!(heard.position, [0.01, -0.12, 0.2]);
        assert_eq!(heard.orientation, Some([0.0, 0.8, 0.0, 0.6]));
        assert_eq!(
            force(&heard.device, [1.0, 0.0, -2.5]),
            r#"{"inverse3":[{"commands":{"set_cursor_force":{"values":{"x":1.0,"y":0.0,"z":-2.5}}},"device_id":"04C3"}]}"#
        );
    }

    #[test]
    fn what_is_no_frame_is_refused_in_words() {
        let words = |text| read(text).unwrap_err().to_string();
        assert!(words("{\"inverse3\": []}").contains("plugged in"));
        assert!(words("{}").contains("plugged in"));
        assert!(words("hello").contains("none of Haply's"));
        assert!(
            words("{\"inverse3\": [{\"device_id\": 1, \"state\": {}}]}")
                .contains("cursor_position")
        );
    }
}

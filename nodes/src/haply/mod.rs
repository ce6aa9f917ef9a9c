//! A Haply Inverse3 as the hand: what its service says becomes `/leader/measured_cp`, the master's
//! force goes back.
//!
//! The service is on the operator's host ([`message`]); it is asked for every second until it is there.
//! A frame of it is a measurement of the hand, and is answered with the force of `/leader/servo_cf`,
//! which the master has limited. Silence is not filled in: without frames there is no hand, the master
//! lets go and the arm pauses, as with any client; the device, which keeps what it was told, is told
//! no force. The force fades in whenever the service is met.
//! Where the cursor is first heard is the middle of the hand's workspace. The orientation is that of
//! the first grip, where there is one.

mod device;
mod message;

use ferntast_bus::Depth;
use ferntast_control::haptics::FORCE_LIFE;
use ferntast_msgs::{
    Text, Time,
    sample::{Fault, Faults, Frame, Level, PoseSample, WrenchSample},
    topics,
};

use self::device::{Device, DeviceError};
use crate::{
    node::NodeHealth,
    process::{NodeError, ProcessContext},
};

/// How this hand is told from others.
const SOURCE: u64 = 0x6861_706c_7900_0000;
/// A service that is not there is asked for again after this \[ns\].
const AGAIN_NANOS: i64 = 1_000_000_000;
/// In this time the force fades in [s].
const FORCE_RAMP: f64 = 0.5;
/// A service that says nothing for so long is asked for anew [s].
const SILENCE: f64 = 0.5;

/// A device that was met.
struct Met {
    device: Device,
    name: serde_json::Value,
    since: Time,
    heard: Time,
    /// A force was put on the hand.
    pushes: bool,
}

impl Met {
    fn new(device: Device, now: Time) -> Met {
        Met {
            device,
            name: serde_json::Value::Null,
            since: now,
            heard: now,
            pushes: false,
        }
    }

    /// Puts `force` \[N\], of the device's frame, on the hand.
    fn push(&mut self, force: [f64; 3]) -> Result<(), DeviceError> {
        self.pushes = force != [0.0; 3];
        self.device.push(&self.name, force)
    }

    /// Takes the force off the hand: the device keeps what it was told last.
    fn let_go(&mut self) {
        if std::mem::take(&mut self.pushes) {
            // A device that cannot be told any more is gone, which is found out as it is heard.
            let _ = self.push([0.0; 3]);
        }
    }
}

/// Carries the hand in and the force out until it is told to stop; lets go in the end.
///
/// # Errors
///
/// Axes that are none; a topic that cannot be opened.
pub fn run(process: &ProcessContext) -> Result<(), NodeError> {
    let config = process
        .session
        .loaded
        .scenario
        .hand
        .haply
        .clone()
        .unwrap_or_default();
    let axes = config
        .turned()
        .ok_or_else(|| NodeError::Broken("[hand.haply] axes are none".to_owned()))?;
    let mut poses = process.bus.publisher(topics::LEADER_MEASURED_CP)?;
    let mut forces = process
        .bus
        .subscriber(topics::LEADER_SERVO_CF, Depth::Queue(1))?;
    let mut diagnostics = process.bus.publisher(topics::DIAGNOSTICS)?;
    let mut meter = process.meter(Faults::default());
    let (mut met, mut again): (Option<Met>, Time) = (None, Time::INVALID);
    let mut middle: Option<[f64; 3]> = None;
    let mut wrench: Option<WrenchSample> = None;
    let mut trouble = Text::<96>::EMPTY;
    process.run(|wake| {
        let now = wake.now;
        if let Some(received) = forces.newest(now) {
            wrench = Some(received.message);
        }
        if met.is_none() && now >= again {
            again = now.plus_nanos(AGAIN_NANOS);
            match Device::connect(&config.url) {
                Ok(device) => met = Some(Met::new(device, now)),
                Err(error) => trouble = Text::display(error),
            }
        }
        if let Some(own) = &mut met {
            let outcome = own.device.receive().and_then(|heard| {
                let Some(heard) = heard else {
                    return Ok(());
                };
                own.heard = now;
                trouble = Text::EMPTY;
                let cursor = axes.to_leader(heard.position);
                let middle = *middle.get_or_insert(cursor);
                let mut pose = PoseSample {
                    source: SOURCE,
                    ..PoseSample::at(
                        now,
                        Frame::LEADER_BASE,
                        std::array::from_fn(|axis| cursor[axis] - middle[axis]),
                    )
                };
                if let Some([x, y, z, w]) = heard.orientation {
                    let [x, y, z] = axes.to_leader([x, y, z]);
                    pose.orientation = [x, y, z, w];
                }
                // What is no number is refused there, and told by the master's silence.
                let _ = poses.publish(now, &pose);
                let fresh = wrench.filter(|own| now.seconds_since(own.stamp) <= FORCE_LIFE);
                let share = (now.seconds_since(own.since) / FORCE_RAMP).clamp(0.0, 1.0);
                let force = fresh.map_or([0.0; 3], |own| own.force.map(|value| share * value));
                own.name = heard.device;
                own.push(axes.to_device(force))
            });
            let silence = now.seconds_since(own.heard);
            if outcome.is_err() || silence > FORCE_LIFE {
                own.let_go();
            }
            if let Err(error) = outcome {
                trouble = Text::display(error);
                met = None;
            } else if silence > SILENCE {
                trouble = Text::new(
                    "Haply's service says nothing: is the device plugged in and calibrated?",
                );
                met = None;
            }
        }
        let mut health = NodeHealth::default();
        if !trouble.is_empty() {
            health.raise(Fault::CommandSilent, Level::WARN);
            health.message = trouble;
        }
        if let Some(sample) = meter.step(now, wake.late_nanos, wake.missed, &health) {
            // What cannot be said now is said a tenth of a second later.
            let _ = diagnostics.publish(now, &sample);
        }
    });
    if let Some(mut own) = met {
        own.let_go();
    }
    Ok(())
}

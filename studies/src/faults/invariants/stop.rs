//! A stop is obeyed.

use super::{
    super::{
        facts::Facts,
        fault::{Device, Word},
        log::Log,
        seen::{DeviceState, Seen},
    },
    Invariant,
};

/// From the word to the device's obedience \[steps\]; time in which it does not
/// run is not counted.
const IN_TIME: i64 = 3;

/// A device that was told to pause or to disable does not follow commands 3 ms
/// later, unless it was told otherwise since.
#[derive(Default)]
pub struct StopObeyed {
    since: [i64; 2],
}

impl Invariant for StopObeyed {
    fn name(&self) -> &'static str {
        "stop_obeyed"
    }

    fn step(&mut self, seen: &Seen, log: &Log, _: &Facts) -> Option<String> {
        let devices: [(Device, &DeviceState, i64); 2] = [
            (Device::Leader, &seen.leader, log.operator_side_stalled),
            (Device::Follower, &seen.follower, seen.arm_side_stalled),
        ];
        for (place, (device, own, stalled)) in devices.into_iter().enumerate() {
            let last = log
                .words
                .iter()
                .rfind(|said| said.is_for(device) || (device == Device::Follower && said.arms()));
            let stop = last.filter(|said| matches!(said.word, Word::Pause | Word::Disable));
            let Some(stop) = stop.filter(|_| own.enabled() && seen.tick - stalled > IN_TIME) else {
                self.since[place] = 0;
                continue;
            };
            if seen.tick - stop.tick > IN_TIME {
                self.since[place] += 1;
            }
            // A word to arm that was under way may still be heard for a step.
            if self.since[place] > 1 {
                return Some(format!(
                    "{device:?}: ENABLED {} ms after it was told to {:?}",
                    seen.tick - stop.tick,
                    stop.word
                ));
            }
        }
        None
    }
}

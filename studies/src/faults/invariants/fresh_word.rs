//! No device follows commands again without a fresh word of the operator.

use ferntast_msgs::sample::OperatingState;

use super::{
    super::{
        facts::Facts,
        fault::Device,
        log::{Log, Said},
        seen::{DeviceState, Seen},
    },
    Invariant,
};

/// A word is fresh for so long \[steps\].
const FRESH: i64 = 1000;

/// The frame that carries a word to the master goes out this much later at most, and may
/// know of a stop of the arm that the word itself did not \[steps\].
const UNDER_WAY: i64 = 4;

/// A device that begins to follow commands does so by a word that was given to
/// it after it last ceased to, at most a second ago, and that nothing was made
/// of before. The arm also takes the words that the master was told: they come
/// over the link. A device in FAULT was disabled before.
#[derive(Default)]
pub struct FreshWord {
    devices: [Watched; 2],
}

struct Watched {
    left: i64,
    used: i64,
}

impl Default for Watched {
    fn default() -> Self {
        Watched { left: -1, used: -1 }
    }
}

impl Watched {
    fn step(&mut self, own: &DeviceState, device: Device, tick: i64, log: &Log) -> Option<String> {
        if own.just_left() {
            self.left = tick;
        }
        if !own.just_enabled() {
            return None;
        }
        let name = match device {
            Device::Leader => "leader",
            _ => "follower",
        };
        if own.before == OperatingState::FAULT {
            return Some(format!("{name}: ENABLED out of FAULT without disable"));
        }
        let first = (self.used + 1).max(tick - FRESH);
        let counts = |said: &&Said| {
            let since = match device {
                // The arm hears what the master was told.
                Device::Follower if said.is_for(Device::Leader) => self.left - UNDER_WAY,
                _ if said.is_for(device) => self.left,
                _ => return false,
            };
            said.arms() && (since.max(first)..=tick).contains(&said.tick)
        };
        match log.words.iter().find(counts) {
            Some(said) => {
                self.used = said.tick;
                None
            }
            None => Some(match log.words.iter().rfind(|said| said.arms()) {
                Some(last) => format!(
                    "{name}: ENABLED without a fresh word: it had left ENABLED at {} ms, and the \
                     last word to arm was given at {} ms",
                    self.left, last.tick
                ),
                None => format!("{name}: ENABLED though nobody ever said so"),
            }),
        }
    }
}

impl Invariant for FreshWord {
    fn name(&self) -> &'static str {
        "fresh_word"
    }

    fn step(&mut self, seen: &Seen, log: &Log, _: &Facts) -> Option<String> {
        let [leader, follower] = &mut self.devices;
        let first = leader.step(&seen.leader, Device::Leader, seen.tick, log);
        let second = follower.step(&seen.follower, Device::Follower, seen.tick, log);
        first.or(second)
    }
}

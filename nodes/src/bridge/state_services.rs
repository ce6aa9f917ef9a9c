//! Operating states as services of type `std_srvs/srv/Trigger`, beside CRTK's `state_command`:
//! `/follower/enable`, `disable`, `pause`, `resume`, the same of `/leader`, and `/stop`, which
//! disables both. `ros2 service call /stop std_srvs/srv/Trigger`.
//!
//! A call is answered once the device says, after it, that it is in the state that was asked for, or
//! does not in time; a caller who may not is told so at once.

use ferntast_bus::{
    Bus, Call, CreateError, Depth, OpenError, Publisher, Subscriber, TriggerService,
};
use ferntast_msgs::{
    Time,
    sample::{OperatingState, OperatingStateSample, StateCommand, StateCommandSample},
    topics::{self, Topic},
};

use crate::process::NodeError;

/// How long a device has to follow \[s\].
const PATIENCE: f64 = 1.5;

/// Words, and the states that they lead to.
const WORDS: [(StateCommand, OperatingState); 4] = [
    (StateCommand::ENABLE, OperatingState::ENABLED),
    (StateCommand::DISABLE, OperatingState::DISABLED),
    (StateCommand::PAUSE, OperatingState::PAUSED),
    (StateCommand::RESUME, OperatingState::ENABLED),
];

/// Disables both devices.
const STOP: &str = "/stop";
/// Those that take words.
const DEVICES: [&str; 2] = ["follower", "leader"];

fn name_of(device: &str, word: StateCommand) -> String {
    format!("/{device}/{}", word.name().unwrap_or_default())
}

/// Names of the services, and whether everybody may call them.
pub fn offered() -> Vec<(String, bool)> {
    let of_devices = DEVICES.into_iter().flat_map(|device| {
        let words = WORDS.map(|(word, _)| (name_of(device, word), word.is_stop()));
        let (open, others): (Vec<_>, Vec<_>) = words.into_iter().partition(|(_, open)| *open);
        open.into_iter().chain(others)
    });
    let stop = (STOP.to_owned(), true);
    std::iter::once(stop).chain(of_devices).collect()
}

/// A device that takes words.
struct Device {
    name: &'static str,
    command: Publisher<StateCommandSample>,
    states: Subscriber<OperatingStateSample>,
    last: Option<OperatingStateSample>,
}

impl Device {
    fn open(
        bus: &Bus,
        name: &'static str,
        command: Topic<StateCommandSample>,
        state: Topic<OperatingStateSample>,
    ) -> Result<Device, CreateError> {
        Ok(Device {
            name,
            command: bus.publisher(command)?,
            states: bus.subscriber(state, Depth::Newest)?,
            last: None,
        })
    }

    fn say(&mut self, now: Time, word: StateCommand) {
        // One that does not get through is not followed, which the caller is told.
        let _ = self
            .command
            .publish(now, &StateCommandSample::new(now, word));
    }

    /// What it said after `since`.
    fn said(&self, since: Time) -> Option<&OperatingStateSample> {
        self.last.as_ref().filter(|own| own.stamp > since)
    }

    fn is(&self, wanted: OperatingState, since: Time) -> bool {
        self.said(since).is_some_and(|own| own.state == wanted)
    }

    /// State and reason, in words.
    fn told(&self, since: Time) -> String {
        match self.said(since) {
            Some(own) => {
                let state = own.state.name().unwrap_or("UNKNOWN");
                format!("{} {state}: {}", self.name, own.reason)
            }
            None => format!("{}: nothing is heard of it", self.name),
        }
    }
}

/// A service: a word to one device or to all.
struct Offer {
    service: TriggerService,
    word: StateCommand,
    leads_to: OperatingState,
    /// Which devices, by their places.
    devices: std::ops::Range<usize>,
    /// Who waits, since when.
    waiting: Vec<(Call, Time)>,
}

/// All of them.
pub struct StateServices {
    devices: [Device; 2],
    offers: Vec<Offer>,
    /// Peers may do more than stop.
    commands: bool,
}

impl StateServices {
    /// Offers them on `ros`, for the devices on `bus`; without `commands` peers may pause, disable
    /// and stop only. None where `ros` is not ROS 2.
    ///
    /// # Errors
    ///
    /// A topic or a service that cannot be opened.
    pub fn open(bus: &Bus, ros: &Bus, commands: bool) -> Result<StateServices, NodeError> {
        let devices = [
            Device::open(
                bus,
                DEVICES[0],
                topics::FOLLOWER_STATE_COMMAND,
                topics::FOLLOWER_OPERATING_STATE,
            )?,
            Device::open(
                bus,
                DEVICES[1],
                topics::LEADER_STATE_COMMAND,
                topics::LEADER_OPERATING_STATE,
            )?,
        ];
        let mut offers = Vec::new();
        let mut offer = |name: &str, (word, leads_to), devices| -> Result<(), OpenError> {
            let service = TriggerService::open(ros, name)?;
            offers.extend(service.map(|service| Offer {
                service,
                word,
                leads_to,
                devices,
                waiting: Vec::new(),
            }));
            Ok(())
        };
        for (place, device) in devices.iter().enumerate() {
            for (word, leads_to) in WORDS {
                let name = name_of(device.name, word);
                offer(&name, (word, leads_to), place..place + 1)?;
            }
        }
        let stop = (StateCommand::DISABLE, OperatingState::DISABLED);
        offer(STOP, stop, 0..devices.len())?;
        Ok(StateServices {
            devices,
            offers,
            commands,
        })
    }

    /// One round: passes on what was called for, answers who can be answered.
    pub fn round(&mut self, now: Time) {
        for device in &mut self.devices {
            if let Some(received) = device.states.newest(now) {
                device.last = Some(received.message);
            }
        }
        for offer in &mut self.offers {
            offer.round(now, &mut self.devices, self.commands);
        }
    }
}

impl Offer {
    fn round(&mut self, now: Time, devices: &mut [Device], commands: bool) {
        let devices = devices.get_mut(self.devices.clone()).unwrap_or_default();
        while let Some(call) = self.service.call() {
            if !commands && !self.word.is_stop() {
                let why = "peers on ROS 2 may pause, disable and stop only; begin the session with --ros-commands, \
                     or say it on the page or by ferntast state";
                self.service.answer(call, false, why);
                continue;
            }
            for device in devices.iter_mut() {
                device.say(now, self.word);
            }
            self.waiting.push((call, now));
        }
        let mut waiting = std::mem::take(&mut self.waiting);
        for (call, since) in waiting.drain(..) {
            let there = devices.iter().all(|device| device.is(self.leads_to, since));
            let late = now.seconds_since(since) > PATIENCE;
            if there || late {
                let told: Vec<String> = devices.iter().map(|device| device.told(since)).collect();
                self.service.answer(call, there, &told.join("; "));
            } else {
                self.waiting.push((call, since));
            }
        }
    }
}

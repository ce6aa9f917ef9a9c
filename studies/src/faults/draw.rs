//! Schedules from seeds.

use ferntast_emulation::random::{Random, mixed};

use super::{
    fault::{Device, Fault, Garbage, Node, SensorFault, Side, Way, Word},
    schedule::{Event, LENGTH_MS, Schedule},
};

/// Faults of a schedule at most, words of the operator not counted.
const MOST_FAULTS: usize = 8;

/// The first fault comes when the devices have been enabled \[ms\].
const FIRST_MS: i64 = 60;

/// Draws numbers that read as what they are for.
struct Draw(Random);

impl Draw {
    fn below(&mut self, count: usize) -> usize {
        ((self.0.uniform() * count as f64) as usize).min(count.saturating_sub(1))
    }

    fn of<T: Copy>(&mut self, choice: &[T]) -> T {
        choice[self.below(choice.len())]
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// Short and long ones alike: uniform in the logarithm.
    fn ms(&mut self, least: i64, most: i64) -> i64 {
        let (low, high) = ((least as f64).ln(), (most as f64).ln());
        self.between(low, high).exp().round() as i64
    }
}

/// The schedule of `seed`; `laws` are those that the session can run, the
/// scenario's own first.
pub fn draw(seed: u64, scenario: &str, laws: &[&str]) -> Schedule {
    let mut draw = Draw(Random::new(mixed(seed ^ 0x6661_756c_7473)));
    let law = match draw.0.chance(0.3) {
        true => laws[0],
        false => draw.of(laws),
    };
    // Few faults are as frequent as many: what needs one is found as soon as what needs five.
    let count = 1 + draw.below(MOST_FAULTS);
    let mut event = Vec::with_capacity(2 * count);
    for _ in 0..count {
        let at_ms = draw.between(FIRST_MS as f64, LENGTH_MS as f64 - 150.0) as i64;
        let fault = fault(&mut draw, laws);
        let at_ms = match fault {
            // A clock is elsewhere from the start.
            Fault::Clock { .. } => 0,
            _ => at_ms,
        };
        event.push(Event { at_ms, fault });
        // An operator who sees the arm hold re-arms it, soon or late.
        if draw.0.chance(0.5) {
            let device = draw.of(&[Device::Both, Device::Leader, Device::Follower]);
            let word = draw.of(&[Word::Resume, Word::Resume, Word::Enable]);
            let at_ms = (at_ms + draw.ms(10, 700)).min(LENGTH_MS - 100);
            let fault = Fault::Word { device, word };
            event.push(Event { at_ms, fault });
        }
    }
    event.sort_by_key(|event| event.at_ms);
    Schedule {
        scenario: scenario.to_owned(),
        seed,
        law: law.to_owned(),
        length_ms: LENGTH_MS,
        planted: None,
        event,
    }
}

fn fault(draw: &mut Draw, laws: &[&str]) -> Fault {
    let way = draw.of(&[Way::Forth, Way::Back]);
    let side = draw.of(&[Side::Operator, Side::Arm]);
    let node = draw.of(&Node::ALL);
    let device = draw.of(&[Device::Leader, Device::Follower, Device::Both]);
    let share = draw.between(0.05, 1.0);
    let ms = draw.ms(5, 800);
    match draw.below(28) {
        0..=2 => Fault::Crash { node },
        3 | 4 => Fault::Stall {
            node,
            ms: draw.ms(2, 400),
        },
        5 => Fault::HostStall {
            side,
            ms: draw.ms(2, 200),
        },
        6 => Fault::Clock {
            side,
            offset_ms: draw.of(&[-10_000, -1_000, -200, -40, -3, 3, 40, 200, 1_000, 10_000]),
            drift_ppm: draw.between(-100.0, 100.0),
        },
        7 => Fault::ClockJump {
            side,
            ms: draw.of(&[-5_000, -150, -10, 4, 15, 60, 400, 5_000]),
        },
        8 => Fault::Loss { way, share, ms },
        9 => Fault::Duplicate { way, share, ms },
        10 => Fault::Reorder {
            way,
            share,
            held_ms: draw.ms(2, 60),
            ms,
        },
        11 => Fault::Jitter {
            way,
            most_ms: draw.ms(2, 80),
            ms,
        },
        12 | 13 => Fault::Blackout { way, ms },
        14 => Fault::BitFlip { way, share, ms },
        15 => Fault::Forge {
            way,
            count: draw.ms(1, 300) as u32,
        },
        16 => Fault::Replay {
            way,
            ago_ms: draw.ms(2, 600),
            count: draw.ms(1, 200) as u32,
        },
        17 => Fault::SecondMaster { ms },
        18 => Fault::SecondHand { ms },
        19 => Fault::Garbage {
            side,
            garbage: draw.of(&[
                Garbage::NotANumber,
                Garbage::Infinite,
                Garbage::OutOfRange,
                Garbage::ZeroStamp,
            ]),
            count: draw.ms(1, 20) as u32,
        },
        20 => Fault::Stranger { side, ms },
        21 => Fault::LawSwitch {
            law: draw.of(laws).to_owned(),
        },
        22 | 23 => {
            let error = draw.between(-0.05, 0.05);
            let torque = draw.between(-150.0, 150.0);
            let sensor = [
                SensorFault::Stuck,
                SensorFault::ZeroError(error),
                SensorFault::TorqueError(torque),
                SensorFault::DropOut,
                SensorFault::NotANumber,
            ];
            Fault::Sensor {
                sensor: draw.of(&sensor),
                ms,
            }
        }
        24 | 25 => Fault::Word {
            device,
            word: draw.of(&[
                Word::Pause,
                Word::Pause,
                Word::Disable,
                Word::Enable,
                Word::Resume,
            ]),
        },
        26 => Fault::Channel {
            round_trip_ms: draw.between(0.0, 120.0),
            jitter_ms: draw.between(0.0, 8.0),
            loss: draw.between(0.0, 0.2),
        },
        _ => Fault::DiskFull { ms },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_is_drawn_and_a_seed_gives_one_schedule() {
        let laws = ["position_force", "wave"];
        let mut seen = std::collections::BTreeMap::new();
        for seed in 0..400 {
            let schedule = draw(seed, "rokviss", &laws);
            assert_eq!(schedule, draw(seed, "rokviss", &laws));
            assert!((1..=2 * MOST_FAULTS).contains(&schedule.event.len()));
            for Event { at_ms, fault } in &schedule.event {
                assert!((0..LENGTH_MS).contains(at_ms), "{schedule}");
                *seen.entry(fault.name()).or_insert(0) += 1;
            }
        }
        for name in Fault::NAMES {
            assert!(
                seen.get(name).is_some_and(|count| *count > 10),
                "{name}: {seen:?}"
            );
        }
    }
}

//! What comes in over the link is judged before anything is done with it.

use super::*;
use crate::delay::{Law, Packet, Wave};
use crate::frame::{self, FRAME_LENGTH, FrameBytes, KEEP_ALIVE_LENGTH, LinkFrame};
use crate::meter::RefusedCounts;
use crate::operating::OperatingState;
use crate::switching::{Laws, code};
use proptest::prelude::*;

const START_NS: i64 = 1_700_000_000_000_000_000;
const TICK_NS: i64 = 1_000_000;

/// The arm's end, fed with bytes.
struct Rig {
    link: FollowerLink,
    now_ns: i64,
    sequence: u32,
}

impl Rig {
    fn new() -> Rig {
        Rig::with_buffer(0.0)
    }

    fn with_buffer(buffer: f64) -> Rig {
        Rig {
            link: FollowerLink::new(Laws::new(Law::default()), buffer),
            now_ns: START_NS,
            sequence: 0,
        }
    }

    /// The next good frame, sent now.
    fn good(&mut self) -> LinkFrame {
        self.sequence += 1;
        LinkFrame {
            sequence: self.sequence,
            stamp_ns: self.now_ns,
            sent_ns: self.now_ns,
            echo: None,
            hold: false,
            state: OperatingState::Enabled,
            arming: 0,
            law: 0,
            pace: 0,
            since_content: 0,
            packet: Packet {
                valid: true,
                position: [0.01, 0.02, 0.0],
                ..Packet::default()
            },
            orientation: None,
        }
    }

    /// One step with `frames`; whether the arm was commanded.
    fn step(&mut self, frames: &[&[u8]]) -> bool {
        for bytes in frames {
            self.link.arrived(bytes, self.now_ns);
        }
        let readings = FollowerReadings {
            tip: None,
            contact_force: None,
            state: OperatingState::Enabled,
            told_to_stop: false,
        };
        let command = self.link.step(self.now_ns, &readings).command;
        self.now_ns += TICK_NS;
        assert!(command.is_none_or(|own| own.position.iter().all(|x| x.is_finite())));
        command.is_some()
    }

    fn counts(&mut self) -> RefusedCounts {
        self.link.state(self.now_ns).measured.refused
    }

    fn received(&mut self) -> u64 {
        self.link.state(self.now_ns).measured.received
    }
}

fn bytes(frame: &LinkFrame) -> FrameBytes {
    frame::encode(frame)
}

#[test]
fn good_frames_are_acted_on() {
    let mut rig = Rig::new();
    let frame = rig.good();
    assert!(rig.step(&[&bytes(&frame)]));
    assert!(!rig.step(&[]), "nothing is repeated");
    assert_eq!(rig.counts(), RefusedCounts::default());
}

#[test]
fn each_kind_of_bad_frame_is_counted_and_never_acted_on() {
    type Spoil = fn(&mut Rig) -> Vec<u8>;
    type Count = fn(&RefusedCounts) -> u64;
    let kinds: [(&str, Spoil, Count); 6] = [
        (
            "short",
            |rig| bytes(&rig.good())[..49].to_vec(),
            |own| own.length,
        ),
        (
            "long",
            |rig| [&bytes(&rig.good())[..], &[0]].concat(),
            |own| own.length,
        ),
        (
            "future",
            |rig| {
                let good = rig.good();
                let stamp_ns = good.stamp_ns + 60_000_000;
                bytes(&LinkFrame { stamp_ns, ..good }).to_vec()
            },
            |own| own.time,
        ),
        (
            "past",
            |rig| {
                let good = rig.good();
                let stamp_ns = good.stamp_ns - 11_000_000_000;
                bytes(&LinkFrame { stamp_ns, ..good }).to_vec()
            },
            |own| own.time,
        ),
        (
            "not a number",
            |rig| {
                let mut good = rig.good();
                good.packet.position[1] = f32::NAN;
                bytes(&good).to_vec()
            },
            |own| own.value,
        ),
        (
            "out of range",
            |rig| {
                let mut good = rig.good();
                good.packet.energy[0] = 1e10;
                bytes(&good).to_vec()
            },
            |own| own.value,
        ),
    ];
    for (what, spoil, count) in kinds {
        let mut rig = Rig::new();
        let first = rig.good();
        assert!(rig.step(&[&bytes(&first)]), "{what}");
        let bad = spoil(&mut rig);
        assert!(!rig.step(&[&bad]), "{what} was acted on");
        let counts = rig.counts();
        assert_eq!(count(&counts), 1, "{what}: {counts:?}");
        let frame = rig.good();
        assert!(rig.step(&[&bytes(&frame)]), "{what}: good frames go on");
        assert_eq!(rig.counts(), counts, "{what}");
    }
}

#[test]
fn what_was_there_before_or_was_overtaken_is_not_acted_on() {
    let mut rig = Rig::new();
    let [one, two, three] = [rig.good(), rig.good(), rig.good()].map(|own| bytes(&own));
    assert!(rig.step(&[&one, &three]));
    assert!(!rig.step(&[&two]), "overtaken");
    assert!(!rig.step(&[&three]), "again");
    assert!(!rig.step(&[&one, &two, &three]), "a recording of all of it");
    let counts = rig.counts();
    assert_eq!((counts.late, counts.replayed), (1, 4), "{counts:?}");
}

#[test]
fn a_buffer_lets_overtaken_frames_fall_into_place() {
    let mut rig = Rig::with_buffer(0.005);
    let mut commanded = 0;
    // Frames two by two, each pair in the wrong order.
    for _ in 0..20 {
        let one = bytes(&rig.good());
        rig.now_ns += TICK_NS;
        let two = bytes(&rig.good());
        rig.now_ns += 2 * TICK_NS;
        commanded += usize::from(rig.step(&[&two]));
        commanded += usize::from(rig.step(&[&one]));
    }
    for _ in 0..10 {
        commanded += usize::from(rig.step(&[]));
    }
    // All but those whose time fell between two steps with another's.
    assert!((20..=40).contains(&commanded), "{commanded}");
}

/// Frames are held up on the way for 130 ms, which is what a buffer of 150 ms is for: the arm
/// is commanded throughout, and nobody asks to hold; when what waited is played out, for as
/// long as without a buffer.
#[test]
fn frames_that_wait_bridge_a_gap_in_what_arrives() {
    let mut rig = Rig::with_buffer(0.15);
    rig.link = FollowerLink::new(Laws::new(Law::Wave(Wave::default())), 0.15);
    let mut last = None;
    let mut held_up = Vec::new();
    for tick in 0..500_i64 {
        if tick % 2 == 0 && tick < 290 {
            let law = code("wave").unwrap();
            held_up.push(bytes(&LinkFrame { law, ..rig.good() }));
        }
        if !(100..230).contains(&tick) {
            for frame in held_up.drain(..) {
                rig.link.arrived(&frame, rig.now_ns);
            }
        }
        let readings = FollowerReadings {
            tip: Some(StampedPosition {
                stamp_ns: rig.now_ns,
                position: [0.35, 0.0, 0.0],
                silence: 0.0,
            }),
            contact_force: Some([0.0; 3]),
            state: OperatingState::Enabled,
            told_to_stop: false,
        };
        let step = rig.link.step(rig.now_ns, &readings);
        if (151..430).contains(&tick) {
            assert!(step.command.is_some(), "at {tick} ms");
            let frame = step
                .frame
                .map(|own| frame::decode(&own, rig.now_ns, 0).expect("a frame"));
            assert!(frame.is_none_or(|own| !own.hold), "at {tick} ms");
        }
        if step.command.is_some() {
            last = Some(tick);
        }
        rig.now_ns += TICK_NS;
    }
    // The last frame came at 288 ms and was due 150 ms later.
    assert!(
        last.is_some_and(|tick| (430..=464).contains(&tick)),
        "{last:?}"
    );
}

#[test]
fn a_law_that_is_not_known_commands_nothing() {
    let mut rig = Rig::new();
    let frame = LinkFrame {
        law: 15,
        ..rig.good()
    };
    assert!(!rig.step(&[&bytes(&frame)]));
    let frame = rig.good();
    assert!(rig.step(&[&bytes(&frame)]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn whatever_comes_in_is_counted_once(
        spoils in proptest::collection::vec(
            (0..4u8, proptest::collection::vec(any::<u8>(), 0..FRAME_LENGTH), 0..FRAME_LENGTH),
            1..60,
        ),
    ) {
        let mut rig = Rig::new();
        let mut sent = 0;
        let mut last = bytes(&rig.good());
        for (kind, garbage, place) in spoils {
            let good = bytes(&rig.good());
            let (frame, harmless): (Vec<u8>, bool) = match kind {
                // As long as a keep-alive it may be one: the seal tells.
                0 if garbage.len() != KEEP_ALIVE_LENGTH => (garbage, false),
                0 | 1 => (good[..place].to_vec(), false),
                2 => (last.to_vec(), true),
                _ => (good.to_vec(), true),
            };
            last = good;
            sent += 1;
            let acted = rig.step(&[&frame]);
            prop_assert!(harmless || !acted, "{frame:?} was acted on");
        }
        prop_assert_eq!(rig.counts().total() + rig.received(), sent);
    }
}

/// Both ends for `steps` ticks; how often the arm's end was told to arm again.
fn words(leader: &mut LeaderLink, rig: &mut Rig, steps: usize) -> usize {
    let mut words = 0;
    for _ in 0..steps {
        let hand = LeaderReadings {
            hand: None,
            orientation: None,
            state: OperatingState::Enabled,
        };
        if let Some(frame) = leader.step(rig.now_ns, &hand).frame {
            rig.link.arrived(&frame, rig.now_ns);
        }
        let arm = FollowerReadings {
            tip: None,
            contact_force: None,
            state: OperatingState::Paused,
            told_to_stop: false,
        };
        words += usize::from(rig.link.step(rig.now_ns, &arm).word == Some(Word::Rearm));
        rig.now_ns += TICK_NS;
    }
    words
}

/// A crash of the operator's end must not arm a paused arm again.
#[test]
fn an_operators_end_that_is_started_again_does_not_arm() {
    let begin = || LeaderLink::new(Laws::new(Law::default()), 0.0);
    let (mut leader, mut rig) = (begin(), Rig::new());
    assert_eq!(words(&mut leader, &mut rig, 100), 0);
    for _ in 0..3 {
        leader.rearm();
        assert_eq!(words(&mut leader, &mut rig, 100), 1);
    }
    leader = begin();
    assert_eq!(words(&mut leader, &mut rig, 3000), 0, "after a restart");
    leader.rearm();
    assert_eq!(words(&mut leader, &mut rig, 100), 1, "the operator's word");
}

/// A word whose frames were lost, and that the arm's next stop has overtaken, is no answer
/// to that stop.
#[test]
fn a_word_that_a_stop_overtakes_is_forgotten() {
    let mut leader = LeaderLink::new(Laws::new(Law::default()), 0.0);
    let mut rig = Rig::new();
    let mut run = |leader: &mut LeaderLink, state, forth: bool| -> Vec<Word> {
        let step = |_| {
            let hand = LeaderReadings {
                hand: None,
                orientation: None,
                state: OperatingState::Enabled,
            };
            let frame = leader.step(rig.now_ns, &hand).frame;
            if let Some(frame) = frame.filter(|_| forth) {
                rig.link.arrived(&frame, rig.now_ns);
            }
            let arm = FollowerReadings {
                tip: None,
                contact_force: None,
                state,
                told_to_stop: false,
            };
            let step = rig.link.step(rig.now_ns, &arm);
            if let Some(frame) = step.frame {
                leader.arrived(&frame, rig.now_ns);
            }
            rig.now_ns += TICK_NS;
            step.word
        };
        (0..20).filter_map(step).collect()
    };
    assert_eq!(run(&mut leader, OperatingState::Enabled, true), []);
    leader.rearm();
    assert_eq!(run(&mut leader, OperatingState::Enabled, false), []);
    assert_eq!(run(&mut leader, OperatingState::Paused, false), []);
    assert_eq!(run(&mut leader, OperatingState::Paused, true), []);
    leader.rearm();
    let heard = run(&mut leader, OperatingState::Paused, true);
    assert_eq!(heard, [Word::Rearm]);
}

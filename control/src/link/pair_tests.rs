//! Both ends with a wire between them, and a clock each.

use super::*;
use crate::delay::Law;
use crate::frame::FrameBytes;
use crate::operating::OperatingState;
use crate::switching::Laws;

const START_NS: i64 = 1_700_000_000_000_000_000;
const MS: i64 = 1_000_000;
/// Where the tip is while the hand is in the middle of its workspace [m].
const MIDDLE: [f64; 3] = [0.35355, 0.0, 0.0];

/// Two ends, joined by a wire that takes `delay_ms` each way.
struct Pair {
    leader: LeaderLink,
    follower: FollowerLink,
    ms: i64,
    delay_ms: i64,
    /// What the operator's clock is ahead of the arm's: \[ns\], and that a nanosecond.
    offset_ns: i64,
    drift: f64,
    /// Which ways carry: forward, back.
    carries: [bool; 2],
    /// The hand is measured every so many milliseconds.
    hand_ms: i64,
    hand_stamp_ms: i64,
    forward: Vec<(i64, FrameBytes)>,
    back: Vec<(i64, FrameBytes)>,
    tip: [f64; 3],
    /// Contact with a spring of 2 kN/m behind this x [m].
    wall: f64,
}

/// What a millisecond looked like.
struct Seen {
    commanded: bool,
    /// How long ago the command counts as made [ms].
    stale: f64,
    force: [f64; 3],
    hold: bool,
}

impl Pair {
    fn new(law: Law) -> Pair {
        let laws = || Laws::new(law.clone());
        Pair {
            leader: LeaderLink::new(laws(), 0.0),
            follower: FollowerLink::new(laws(), 0.0),
            ms: 0,
            delay_ms: 5,
            offset_ns: 0,
            drift: 0.0,
            carries: [true, true],
            hand_ms: 1,
            hand_stamp_ms: 0,
            forward: Vec::new(),
            back: Vec::new(),
            tip: MIDDLE,
            wall: f64::INFINITY,
        }
    }

    fn operator_ns(&self, ms: i64) -> i64 {
        START_NS + ms * MS + self.offset_ns + (self.drift * (ms * MS) as f64) as i64
    }

    /// As a handshake does, which knows the offset to the length of the way.
    fn shake_hands(&mut self) {
        let (here, there) = (self.operator_ns(self.ms), START_NS + self.ms * MS);
        self.leader.peer_changed(here, there - here + 2 * MS);
        self.follower.peer_changed(there, here - there - 5 * MS);
    }

    fn step(&mut self) -> Seen {
        let (here, there) = (self.operator_ns(self.ms), START_NS + self.ms * MS);
        let arrived = self.ms - self.delay_ms;
        self.back.retain(|(sent, bytes)| {
            if *sent == arrived && self.carries[1] {
                self.leader.arrived(bytes, here);
            }
            *sent > arrived
        });
        self.forward.retain(|(sent, bytes)| {
            if *sent == arrived && self.carries[0] {
                self.follower.arrived(bytes, there);
            }
            *sent > arrived
        });
        if self.ms % self.hand_ms == 0 {
            self.hand_stamp_ms = self.ms;
        }
        // To and fro by 20 mm in 2 s.
        let at = self.hand_stamp_ms as f64 * 1e-3;
        let hand = StampedPosition {
            stamp_ns: self.operator_ns(self.hand_stamp_ms),
            position: [0.010 * (std::f64::consts::PI * at).sin(), 0.0, 0.0],
            silence: (self.ms - self.hand_stamp_ms) as f64 * 1e-3,
        };
        let led = self.leader.step(
            here,
            &LeaderReadings {
                hand: Some(hand),
                orientation: None,
                state: OperatingState::Enabled,
            },
        );
        let depth = (self.tip[0] - self.wall).max(0.0);
        let followed = self.follower.step(
            there,
            &FollowerReadings {
                tip: Some(StampedPosition {
                    stamp_ns: there,
                    position: self.tip,
                    silence: 0.0,
                }),
                contact_force: Some([-2000.0 * depth, 0.0, 0.0]),
                state: OperatingState::Enabled,
                told_to_stop: false,
            },
        );
        if let Some(command) = followed.command {
            self.tip = command.position;
        }
        self.forward.extend(led.frame.map(|own| (self.ms, own)));
        self.back.extend(followed.frame.map(|own| (self.ms, own)));
        self.ms += 1;
        let hold = led.frame.is_some_and(|own| own[5] & 2 != 0);
        Seen {
            commanded: followed.command.is_some(),
            stale: (there - followed.command_ns) as f64 * 1e-6,
            force: led.force,
            hold,
        }
    }

    fn run(&mut self, milliseconds: usize) -> Vec<Seen> {
        (0..milliseconds).map(|_| self.step()).collect()
    }
}

fn commands(seen: &[Seen]) -> usize {
    seen.iter().filter(|own| own.commanded).count()
}

/// Finding: five of six laws went on commanding for 25 ms, and the servo waited 25 ms more.
#[test]
fn the_servo_hears_from_its_commands_how_long_the_link_is_silent() {
    for law in Law::all() {
        let mut pair = Pair::new(law.clone());
        pair.shake_hands();
        let seen = pair.run(1000);
        let seen = &seen[500..];
        assert!(commands(seen) >= 240, "{}", law.name());
        // Frames come every 2 ms.
        assert!(seen.iter().all(|own| own.stale <= 1.0), "{}", law.name());
        pair.carries[0] = false;
        for (ms, own) in pair.run(100).iter().enumerate() {
            // The last frame came one or two milliseconds before.
            let made = ms as f64 - own.stale;
            let most = FRESH * 1e3;
            assert!(
                !own.commanded || made <= most,
                "{} {ms} ms: {made} ms",
                law.name()
            );
        }
        // And goes on by itself: that the arm waits is the servo's.
        pair.carries[0] = true;
        assert!(commands(&pair.run(500)) >= 200, "{}", law.name());
    }
}

/// Finding: nobody felt anything and the arm pressed on.
#[test]
fn a_silent_return_link_holds_the_arm() {
    for law in Law::all() {
        let mut pair = Pair::new(law.clone());
        pair.shake_hands();
        pair.run(1000);
        pair.carries[1] = false;
        let seen = pair.run(300);
        let asked = seen.iter().position(|own| own.hold).unwrap();
        // Silence, and the frames in it are 2 ms apart.
        assert!((24..=30).contains(&asked), "{}: {asked} ms", law.name());
        let last = seen.iter().rposition(|own| own.commanded).unwrap();
        let way = pair.delay_ms as usize;
        assert!(last <= asked + way + 2, "{}: {last} ms", law.name());
        pair.carries[1] = true;
        assert!(commands(&pair.run(500)) >= 200, "{}", law.name());
    }
}

/// Finding: 10 s ahead no frame was accepted, 0.2 s behind the hand felt nothing.
#[test]
fn clocks_need_not_agree() {
    for law in Law::all() {
        let mut alike = None;
        for (offset_s, drift) in [
            (0.0, 0.0),
            (10.0, 0.0),
            (-10.0, 0.0),
            (-0.2, 0.0),
            (0.0, 100e-6),
        ] {
            let mut pair = Pair::new(law.clone());
            pair.wall = MIDDLE[0] + 0.002;
            (pair.offset_ns, pair.drift) = ((offset_s * 1e9) as i64, drift);
            pair.shake_hands();
            let seen = pair.run(20_000);
            let tail = &seen[18_000..];
            let peak = tail
                .iter()
                .map(|own| own.force[0].abs())
                .fold(0.0, f64::max);
            let state = pair.leader.state(pair.operator_ns(pair.ms)).measured;
            let what = format!("{} {offset_s} s {drift}: {peak} N", law.name());
            assert!(
                (state.delay - 0.005).abs() < 0.0015,
                "{what} {} s",
                state.delay
            );
            let expected = -offset_s - drift * 20.0;
            assert!((state.clock.offset - expected).abs() < 0.0015, "{what}");
            assert_eq!(state.refused.total(), 0, "{what}");
            let (commands, force) = *alike.get_or_insert((commands(tail), peak));
            assert_eq!(self::commands(tail), commands, "{what}");
            assert!(
                (peak - force).abs() <= 0.05 * force + 1e-3,
                "{what}, not {force} N"
            );
        }
    }
}

#[test]
fn a_clock_that_jumps_holds_for_a_moment_and_is_told() {
    for jump in [10.0, -10.0, -0.2] {
        let mut pair = Pair::new(Law::default());
        pair.shake_hands();
        pair.run(3000);
        pair.offset_ns = (jump * 1e9) as i64;
        pair.run(200);
        let seen = pair.run(500);
        assert!(commands(&seen) >= 240, "{jump} s: {}", commands(&seen));
        let state = pair.follower.state(START_NS + pair.ms * MS).measured;
        assert_eq!(state.clock.jumps, 1, "{jump} s");
        assert!((state.clock.offset - jump).abs() < 1e-3, "{jump} s");
    }
}

/// Finding: a hand at 100 Hz was absent half of the time.
#[test]
fn a_hand_of_100_hz_is_there_all_the_time() {
    for law in Law::all() {
        let peak = |hand_ms: i64| {
            let mut pair = Pair::new(law.clone());
            (pair.hand_ms, pair.wall) = (hand_ms, MIDDLE[0] + 0.002);
            pair.shake_hands();
            let seen = pair.run(3000);
            let tail = &seen[2000..];
            assert!(
                commands(tail) >= 490,
                "{} {hand_ms} ms: {}",
                law.name(),
                commands(tail)
            );
            tail.iter()
                .map(|own| own.force[0].abs())
                .fold(0.0, f64::max)
        };
        let (quick, slow) = (peak(1), peak(10));
        assert!(
            (slow - quick).abs() < 0.15 * quick + 0.01,
            "{}: {slow} N, not {quick} N",
            law.name()
        );
    }
}

/// A word that was said to a link that was away is not fresh when it comes back.
#[test]
fn a_word_said_during_an_outage_does_not_arm_after_it() {
    for (gap, words) in [(300, 1), (2000, 0)] {
        let mut pair = Pair::new(Law::default());
        pair.shake_hands();
        pair.run(500);
        pair.carries = [false, false];
        pair.run(gap / 2);
        pair.leader.rearm();
        pair.run(gap / 2);
        pair.carries = [true, true];
        let heard = (0..500).filter(|_| rearmed(&mut pair)).count();
        assert_eq!(heard, words, "{gap} ms");
    }
}

/// One step of the arm's end alone, after one of the pair.
fn rearmed(pair: &mut Pair) -> bool {
    let before = pair.follower.clone();
    let ms = pair.ms;
    let arrived = ms - pair.delay_ms;
    let mut probe = before;
    for (sent, bytes) in &pair.forward {
        if *sent == arrived {
            probe.arrived(bytes, START_NS + ms * MS);
        }
    }
    let readings = FollowerReadings {
        tip: None,
        contact_force: None,
        state: OperatingState::Enabled,
        told_to_stop: false,
    };
    let word = probe.step(START_NS + ms * MS, &readings).word;
    pair.step();
    word == Some(Word::Rearm)
}

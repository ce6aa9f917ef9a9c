use super::*;
use crate::frame::PLAIN_LENGTH;
use crate::wire::first_byte;
use proptest::prelude::*;

const START: i64 = 1_700_000_000_000_000_000;
const SESSION: &str = "session";

fn key(number: u8) -> PrivateKey {
    PrivateKey::from_random([number; 32])
}

/// The key of operator and arm.
const OPERATOR: u8 = 1;
const ARM: u8 = 2;

fn operator(seed: u8) -> SecureEnd {
    let role = Role::Operator {
        peer: key(ARM).public(),
    };
    SecureEnd::new(key(OPERATOR), role, SESSION, [seed; 32])
}

fn arm(seed: u8) -> SecureEnd {
    let known = vec![key(9).public(), key(OPERATOR).public()];
    SecureEnd::new(key(ARM), Role::Arm { known }, SESSION, [seed; 32])
}

/// Two ends, and a wire that keeps what it carried.
struct Rig {
    operator: SecureEnd,
    arm: SecureEnd,
    now_ns: i64,
    number: u32,
    forward: Vec<Vec<u8>>,
    back: Vec<Vec<u8>>,
    opened: [u32; 2],
}

impl Rig {
    fn new() -> Rig {
        Rig {
            operator: operator(11),
            arm: arm(12),
            now_ns: START,
            number: 0,
            forward: Vec::new(),
            back: Vec::new(),
            opened: [0; 2],
        }
    }

    fn plain(&mut self) -> [u8; PLAIN_LENGTH] {
        let mut plain = [0x5a; PLAIN_LENGTH];
        plain[..4].copy_from_slice(&self.number.to_le_bytes());
        self.number += 1;
        plain
    }

    /// A millisecond in which both ends send and, where the wire carries, receive.
    fn step(&mut self, carries: [bool; 2]) {
        let plain = self.plain();
        let sent: Vec<Vec<u8>> = sends(&mut self.operator, &plain, self.now_ns);
        let answered: Vec<Vec<u8>> = sends(&mut self.arm, &plain, self.now_ns);
        self.now_ns += MILLISECOND;
        for bytes in sent.iter().filter(|_| carries[0]) {
            let received = self.arm.received(bytes, self.now_ns);
            self.opened[0] += u32::from(matches!(received, Received::Sealed(..)));
        }
        for bytes in answered.iter().filter(|_| carries[1]) {
            let received = self.operator.received(bytes, self.now_ns);
            self.opened[1] += u32::from(matches!(received, Received::Sealed(..)));
        }
        self.forward.extend(sent);
        self.back.extend(answered);
    }

    fn run(&mut self, milliseconds: usize) -> [u32; 2] {
        self.opened = [0; 2];
        (0..milliseconds).for_each(|_| self.step([true, true]));
        self.opened
    }

    fn incarnations(&self) -> [u64; 2] {
        [&self.operator, &self.arm].map(|end| end.established().map_or(0, |own| own.incarnation))
    }
}

fn sends(end: &mut SecureEnd, plain: &[u8], now_ns: i64) -> Vec<Vec<u8>> {
    let message = end.message(now_ns).map(|own| own.bytes().to_vec());
    let frame = end.seal(Kind::Frame, plain).map(|own| own.to_vec());
    message.into_iter().chain(frame).collect()
}

#[test]
fn a_handshake_takes_two_round_trips_and_frames_go_both_ways() {
    let mut rig = Rig::new();
    assert!(rig.operator.seal(Kind::Frame, &[0; PLAIN_LENGTH]).is_none());
    let opened = rig.run(100);
    assert!(
        opened.iter().all(|own| (90..=97).contains(own)),
        "{opened:?}"
    );
    assert_eq!(rig.incarnations(), [1, 1]);
    assert_eq!(rig.arm.established().unwrap().peer, key(OPERATOR).public());
    assert_eq!(rig.operator.refused().total(), 0);
    assert_eq!(rig.arm.refused().total(), 0);
    // Nothing is shaken again while all goes well.
    let opened = rig.run(5_000);
    assert_eq!(opened, [5_000, 5_000]);
    assert_eq!(rig.incarnations(), [1, 1]);
}

#[test]
fn a_view_goes_from_the_arm_s_end_to_the_operator_s_alone() {
    let mut rig = Rig::new();
    rig.run(100);
    let view = [7; 43];
    let (kind, now_ns) = (Kind::View, rig.now_ns);
    let sealed = rig.arm.seal(kind, &view).unwrap();
    let Received::Sealed(Kind::View, opened) = rig.operator.received(&sealed, now_ns) else {
        panic!("{:?}", rig.operator.last_refusal());
    };
    assert_eq!(opened[..], view);
    let again = Received::Refused(Refusal::Replayed);
    assert_eq!(rig.operator.received(&sealed, now_ns), again);
    let reflected = Received::Refused(Refusal::WrongSide);
    assert_eq!(rig.arm.received(&sealed, now_ns), reflected);
    let sealed = rig.operator.seal(kind, &view).unwrap();
    assert_eq!(rig.arm.received(&sealed, now_ns), reflected);
    // Frames go on as they were counted.
    assert_eq!(rig.run(50), [50, 50]);
}

#[test]
fn a_gap_changes_no_key() {
    let mut rig = Rig::new();
    rig.run(100);
    for carries in [[false, false], [true, false], [false, true]] {
        (0..5_000).for_each(|_| rig.step(carries));
        rig.run(100);
        assert_eq!(rig.incarnations()[1], 1, "{carries:?}");
    }
}

#[test]
fn an_end_that_is_started_anew_gets_new_keys() {
    let mut rig = Rig::new();
    rig.run(100);
    rig.operator = operator(21);
    let opened = rig.run(300);
    assert!(opened.iter().all(|own| *own > 150), "{opened:?}");
    assert_eq!(rig.incarnations(), [1, 2]);
    // The arm's end is away for as long as a process takes to start.
    (0..200).for_each(|_| rig.step([false, false]));
    rig.arm = arm(22);
    let opened = rig.run(100);
    assert!(opened.iter().all(|own| *own > 80), "{opened:?}");
    assert_eq!(rig.incarnations(), [2, 1]);
}

#[test]
fn what_was_recorded_is_worth_nothing() {
    let mut rig = Rig::new();
    rig.run(300);
    let (forward, back) = (rig.forward.clone(), rig.back.clone());
    // To the same ends, to ends started anew, to the other end.
    for restart in [false, true] {
        if restart {
            (rig.operator, rig.arm) = (operator(31), arm(32));
            rig.run(100);
        }
        let before = rig.incarnations();
        for (at, (one, other)) in forward.iter().zip(&back).enumerate() {
            let now_ns = rig.now_ns + at as i64;
            for end in [&mut rig.arm, &mut rig.operator] {
                for bytes in [one, other] {
                    let received = end.received(bytes, now_ns);
                    assert!(!matches!(received, Received::Sealed(..)), "{at} {restart}");
                }
            }
        }
        assert_eq!(rig.incarnations(), before);
        let opened = rig.run(100);
        assert_eq!(opened, [100, 100], "{restart}");
    }
}

#[test]
fn strangers_are_refused_by_name() {
    let mut rig = Rig::new();
    let role = Role::Operator {
        peer: key(ARM).public(),
    };
    rig.operator = SecureEnd::new(key(77), role, SESSION, [5; 32]);
    rig.run(500);
    assert_eq!(rig.incarnations(), [0, 0]);
    let refusal = rig.arm.last_refusal().unwrap();
    assert_eq!(refusal, Refusal::UnknownPeer(key(77).public().exchange()));
    assert!(refusal.to_string().contains("ferntast link keys add"));
    assert!((1..10).contains(&rig.arm.refused().handshake));
}

#[test]
fn another_session_and_another_arm_cannot_be_read() {
    let peer = key(ARM).public();
    let wrong = key(3).public();
    for (session, peer) in [("other", peer), (SESSION, wrong)] {
        let mut rig = Rig::new();
        rig.operator = SecureEnd::new(key(OPERATOR), Role::Operator { peer }, session, [5; 32]);
        rig.run(500);
        assert_eq!(rig.incarnations(), [0, 0]);
        assert_eq!(rig.arm.last_refusal(), Some(Refusal::Handshake));
    }
}

#[test]
fn one_key_may_serve_both_ends_of_one_host() {
    let own = key(4);
    let known = vec![own.public()];
    let peer = own.public();
    let mut rig = Rig::new();
    rig.operator = SecureEnd::new(own.clone(), Role::Operator { peer }, SESSION, [5; 32]);
    rig.arm = SecureEnd::new(own, Role::Arm { known }, SESSION, [6; 32]);
    assert!(rig.run(100)[0] > 90);
}

#[test]
fn the_handshake_tells_the_clocks_offset() {
    let mut rig = Rig::new();
    rig.run(100);
    // One millisecond each way, one clock.
    let [here, there] =
        [&rig.operator, &rig.arm].map(|end| end.established().unwrap().clock_offset_ns);
    assert!(here.abs() <= MILLISECOND, "{here}");
    assert!((-2 * MILLISECOND..=0).contains(&there), "{there}");
}

#[test]
fn same_seeds_same_bytes() {
    let bytes = || {
        let mut rig = Rig::new();
        rig.run(50);
        (rig.forward, rig.back)
    };
    assert_eq!(bytes(), bytes());
}

/// Another host that the arm knows does not get it while the first is heard.
#[test]
fn whoever_is_heard_keeps_the_arm() {
    let mut rig = Rig::new();
    rig.run(100);
    let role = Role::Operator {
        peer: key(ARM).public(),
    };
    let mut second = SecureEnd::new(key(9), role, SESSION, [7; 32]);
    let mut told = 0;
    for _ in 0..1000 {
        if let Some(message) = second.message(rig.now_ns) {
            let received = rig.arm.received(message.bytes(), rig.now_ns);
            told += usize::from(received == Received::Refused(Refusal::Taken));
        }
        if let Some(message) = rig.arm.message(rig.now_ns) {
            second.received(message.bytes(), rig.now_ns);
        }
        rig.step([true, true]);
    }
    assert!(told > 0);
    assert!(second.established().is_none());
    assert_eq!(rig.incarnations(), [1, 1]);
    // Once the first is gone it does.
    (0..200).for_each(|_| rig.step([false, false]));
    rig.operator = second;
    assert!(rig.run(3000)[0] > 500);
    assert_eq!(rig.arm.established().unwrap().peer, key(9).public());
}

/// An operator that sends all, an arm that leaves out what says nothing new: the operator's key is
/// worn long before the arm's, of whose frames a tenth was lost on the way, too.
#[test]
fn keys_are_renewed_where_one_end_sends_more() {
    const HALF: u32 = 1 << 30;
    for (forth, back) in [(HALF, HALF / 4), (HALF / 4, HALF)] {
        let mut rig = Rig::new();
        rig.run(300);
        let arrived = |sent: u32| sent / 10 * 9;
        let wear = |end: &mut SecureEnd, sealed, opened| {
            end.keys.as_mut().expect("keys").wear(sealed, opened);
        };
        wear(&mut rig.operator, forth, back);
        wear(&mut rig.arm, back, arrived(forth));
        // Another one who may have the arm does not get it meanwhile.
        let role = Role::Operator {
            peer: key(ARM).public(),
        };
        let mut other = SecureEnd::new(key(9), role, SESSION, [13; 32]);
        let mut told = 0;
        for _ in 0..200 {
            if let Some(message) = other.message(rig.now_ns) {
                let received = rig.arm.received(message.bytes(), rig.now_ns);
                told += usize::from(received == Received::Refused(Refusal::Taken));
            }
            if let Some(message) = rig.arm.message(rig.now_ns) {
                other.received(message.bytes(), rig.now_ns);
            }
            rig.step([true, true]);
        }
        assert!(told > 0 && other.established().is_none());
        rig.run(3000);
        assert_eq!(rig.incarnations(), [2, 2], "{forth} forth, {back} back");
        assert_eq!(rig.run(100), [100, 100]);
    }
}

#[test]
fn a_flood_of_hellos_does_not_keep_the_answer_back() {
    let mut rig = Rig::new();
    for _ in 0..50 {
        for _ in 0..100 {
            rig.arm.received(&[first_byte(HELLO)], rig.now_ns);
        }
        rig.step([true, true]);
    }
    assert_eq!(rig.incarnations(), [1, 1]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is put between, damaged, doubled or lost: no frame is opened twice, none
    /// that was not sent, and the link recovers.
    #[test]
    fn a_bad_wire_opens_nothing_that_was_not_sent(
        faults in proptest::collection::vec((0..6u8, any::<u16>(), any::<u8>()), 200),
    ) {
        let mut rig = Rig::new();
        let mut seen = std::collections::BTreeSet::new();
        for (fault, place, value) in faults {
            let plain = rig.plain();
            let mut sent = sends(&mut rig.operator, &plain, rig.now_ns);
            let answered = sends(&mut rig.arm, &plain, rig.now_ns);
            rig.now_ns += MILLISECOND;
            match fault {
                0 => sent.clear(),
                1 => sent.extend(sent.clone()),
                2 => sent.push(vec![value; place as usize % 130]),
                3 => {
                    for bytes in &mut sent {
                        let at = place as usize % bytes.len();
                        bytes[at] ^= value;
                    }
                }
                4 if !rig.forward.is_empty() => {
                    sent.push(rig.forward[place as usize % rig.forward.len()].clone());
                }
                _ => {}
            }
            for bytes in &sent {
                if let Received::Sealed(_, opened) = rig.arm.received(bytes, rig.now_ns) {
                    let number = u32::from_le_bytes([opened[0], opened[1], opened[2], opened[3]]);
                    prop_assert!(number < rig.number);
                    prop_assert!(seen.insert(number), "{number} twice");
                    prop_assert!(opened[4..].iter().all(|byte| *byte == 0x5a));
                }
            }
            for bytes in &answered {
                rig.operator.received(bytes, rig.now_ns);
            }
            rig.forward.extend(sent);
        }
        rig.run(3_000);
        prop_assert_eq!(rig.run(50), [50, 50]);
    }
}

//! Encoder and decoder with a wire between them that may lose frames.

use super::*;
use crate::delay::{Packet, Sample, Samples};
use crate::frame::{self, LinkFrame, SEND_PERIOD_NS};
use crate::operating::OperatingState;
use crate::orientation::{Orientation, PackedOrientation};
use proptest::prelude::*;

const START_NS: i64 = 1_700_000_000_000_000_000;
const MS: i64 = 1_000_000;

fn motion() -> Samples {
    Samples {
        position: Sample::Position,
        vector: Sample::Velocity,
        energy: false,
    }
}

fn force() -> Samples {
    Samples {
        vector: Sample::Force { at_hand: 0.05 },
        energy: true,
        ..Samples::default()
    }
}

fn packet(position: f64, vector: f64, energy: f64) -> Packet {
    Packet {
        valid: true,
        position: [position as f32, 0.0, 0.0],
        vector: [vector as f32, 0.0, 0.0],
        energy: [energy as f32, 0.0],
    }
}

/// A wire without delay.
struct Wire {
    encoder: Encoder,
    decoder: Decoder,
    samples: Samples,
    sequence: u32,
    ms: i64,
    hold: bool,
    orientation: Option<PackedOrientation>,
}

impl Wire {
    fn new(deadband: Deadband, samples: Samples) -> Wire {
        Wire {
            encoder: Encoder::new(Some(deadband)),
            decoder: Decoder::default(),
            samples,
            sequence: 0,
            ms: 0,
            hold: false,
            orientation: None,
        }
    }

    /// Two milliseconds; the frame that was sent, if one was.
    fn step(&mut self, packet: Packet, carries: bool) -> Option<LinkFrame> {
        let now_ns = START_NS + self.ms * MS;
        self.ms += 2;
        let whole = LinkFrame {
            sequence: self.sequence,
            stamp_ns: now_ns,
            sent_ns: now_ns,
            echo: None,
            hold: self.hold,
            state: OperatingState::Enabled,
            arming: 0,
            law: 0,
            pace: 0,
            since_content: 0,
            packet,
            orientation: self.orientation,
        };
        let sent = self.encoder.pass(whole, &self.samples);
        if let Some(sent) = &sent {
            self.encoder.sent(sent, &frame::encode(sent));
            self.sequence += 1;
            if carries {
                let content = (sent.since_content == 0).then_some(sent);
                self.decoder.heard(sent, content, now_ns, |_| self.samples);
            }
        }
        self.decoder.step(now_ns);
        sent
    }

    fn told(&self) -> Packet {
        self.decoder.decoded().expect("something came").packet
    }
}

#[test]
fn who_rests_sends_keep_alives_and_now_and_then_all() {
    let mut wire = Wire::new(Deadband::default(), motion());
    for _ in 0..500 {
        wire.step(packet(0.1, 0.0, 0.0), true);
    }
    let traffic = wire.encoder.traffic();
    // Every 8 ms one, every 100 ms with content in between; at first six in a row.
    assert_eq!(traffic.due, 500);
    assert!((128..=136).contains(&traffic.frames), "{traffic:?}");
    assert!((10..=11).contains(&traffic.contents), "{traffic:?}");
    assert!((0.12..0.15).contains(&traffic.byte_share()), "{traffic:?}");
}

#[test]
fn what_is_said_of_a_stop_goes_out_at_once() {
    let mut wire = Wire::new(Deadband::default(), motion());
    let rest = packet(0.1, 0.0, 0.0);
    while wire.step(rest, true).is_some() {}
    wire.hold = true;
    // One that is lost is not missed.
    for _ in 0..6 {
        let told = wire.step(rest, true).expect("at once");
        assert!(told.hold && told.since_content > 0);
    }
}

/// A hand that turns is news every half milliradian; one that rests is sent how it is turned anew
/// with everything else only.
#[test]
fn how_a_hand_turns_is_sent_as_it_changes() {
    let mut wire = Wire::new(Deadband::default(), motion());
    let rest = packet(0.1, 0.0, 0.0);
    let about_z = |angle: f64| {
        let [sine, cosine] = [(0.5 * angle).sin(), (0.5 * angle).cos()];
        Orientation::given([0.0, 0.0, sine, cosine]).unwrap()
    };
    let mut heard = about_z(0.5);
    let mut step = |wire: &mut Wire, angle: f64| {
        wire.orientation = Some(about_z(angle).into());
        if let Some(frame) = wire.step(rest, true) {
            assert_eq!(frame.orientation.is_some(), frame.since_content == 0);
            heard = frame.orientation.map_or(heard, Orientation::from);
        }
        heard.angle_to(&about_z(angle))
    };
    for k in 0..500 {
        // 0.1 rad/s.
        let off = step(&mut wire, 0.5 + 2e-4 * f64::from(k));
        assert!(off < 5.1e-4, "{off} rad");
    }
    let turning = wire.encoder.traffic().contents;
    assert!((150..190).contains(&turning), "{turning}");
    for _ in 0..500 {
        step(&mut wire, 0.6);
    }
    let resting = wire.encoder.traffic().contents - turning;
    assert!((9..=12).contains(&resting), "{resting}");
}

/// The frame with which a hand goes is lost: the next one says so, too.
#[test]
fn a_hand_that_is_gone_is_no_hand_though_the_news_is_lost() {
    let mut wire = Wire::new(Deadband::default(), motion());
    for _ in 0..50 {
        wire.step(packet(0.1, 0.0, 0.0), true);
    }
    let gone = Packet {
        valid: false,
        ..packet(0.1, 0.0, 0.0)
    };
    assert!(wire.step(gone, false).is_some());
    assert!(wire.told().valid);
    wire.step(gone, true);
    assert!(!wire.told().valid);
}

/// 20 mm to and fro in a second: the position within its deadband, and a share of what there
/// was to send.
#[test]
fn a_motion_goes_on_in_between() {
    let mut wire = Wire::new(Deadband::default(), motion());
    let mut worst = 0.0_f64;
    for k in 0..2000 {
        let angle = std::f64::consts::TAU * 2e-3 * f64::from(k);
        let (x, v) = (
            0.01 * angle.sin(),
            0.01 * std::f64::consts::TAU * angle.cos(),
        );
        wire.step(packet(x, v, 0.0), true);
        worst = worst.max((f64::from(wire.told().position[0]) - x).abs());
    }
    let traffic = wire.encoder.traffic();
    assert!(worst <= 11e-6, "{worst}");
    assert!(
        (0.02..0.3).contains(&traffic.content_share()),
        "{traffic:?}"
    );
}

#[test]
fn energy_is_held_and_never_led_on() {
    let mut wire = Wire::new(Deadband::default(), force());
    for k in 0..2000 {
        let energy = 1e-3 * (f64::from(k) / 40.0);
        wire.step(packet(0.0, 10.0, energy), true);
        let told = f64::from(wire.told().energy[0]);
        assert!(
            told <= energy + 1e-7 && told > energy - 5.1e-3,
            "{told} {energy}"
        );
    }
}

#[test]
fn every_wave_is_sent_and_none_made_up() {
    let samples = Samples {
        vector: Sample::Integral,
        ..motion()
    };
    let mut wire = Wire::new(Deadband::default(), samples);
    for k in 0..100 {
        assert!(wire.step(packet(0.0, f64::from(k), 0.0), true).is_some());
        assert_eq!(f64::from(wire.told().vector[0]), f64::from(k));
    }
    let last = wire.told();
    for _ in 0..20 {
        wire.step(packet(0.0, 99.0, 0.0), true);
        let decoded = wire.decoder.decoded().expect("something came");
        assert!(!decoded.fresh || decoded.packet == last, "{decoded:?}");
    }
}

/// The content of a hand that stops is lost: it is not led on for longer than a keep-alive
/// takes.
#[test]
fn who_missed_something_stays_where_it_is() {
    let mut wire = Wire::new(Deadband::default(), motion());
    let speed = 0.1;
    let mut x = 0.0;
    for _ in 0..200 {
        x += 2e-3 * speed;
        wire.step(packet(x, speed, 0.0), true);
    }
    let lost = wire.step(packet(x, 0.0, 0.0), false).expect("news");
    assert_eq!(lost.since_content, 0);
    let mut furthest = 0.0_f64;
    for _ in 0..60 {
        wire.step(packet(x, 0.0, 0.0), true);
        furthest = furthest.max(f64::from(wire.told().position[0]) - x);
    }
    assert!((0.2e-3..1.3e-3).contains(&furthest), "{furthest}");
    // Sent anew in the meantime.
    assert!((f64::from(wire.told().position[0]) - x).abs() < 1e-6);
}

#[test]
fn nothing_is_led_on_beyond_what_was_announced() {
    let mut wire = Wire::new(Deadband::default(), motion());
    for _ in 0..10 {
        wire.step(packet(0.1, 0.0, 0.0), true);
    }
    let from_ns = START_NS + wire.ms * MS;
    let mut given = Vec::new();
    for ms in 0..60 {
        wire.decoder.step(from_ns + ms * MS);
        if wire.decoder.decoded().is_some_and(|own| own.fresh) {
            given.push(ms);
        }
        // What the laws are told of the silence is all of it afterwards.
        let silence = wire.decoder.silence(from_ns + ms * MS, 1e-3 * ms as f64);
        match ms {
            0..=10 => assert!(silence < 2.5e-3, "{ms}: {silence}"),
            20.. => assert_eq!(silence, 1e-3 * ms as f64),
            _ => {}
        }
    }
    let last = *given.last().expect("some");
    assert!((10..=18).contains(&last), "{given:?}");
}

proptest! {
    /// Without loss what is told is within the deadband of what is, whatever that does.
    #[test]
    fn what_is_told_is_within_the_deadband(
        forces in proptest::collection::vec(-60.0..60.0f64, 1..200),
        force_share in 0.0..0.3f64,
        force_floor in 0.0..0.5f64,
        keep_alive in 0.002..0.010f64,
        refresh in 0.002..1.0f64,
    ) {
        let deadband = Deadband { force_share, force_floor, keep_alive, refresh, ..Deadband::default() };
        let mut wire = Wire::new(deadband, force());
        let mut silent = 0;
        for (k, own) in forces.iter().enumerate() {
            let sent = wire.step(packet(0.0, *own, 0.0), true);
            silent = if sent.is_some() { 0 } else { silent + 1 };
            // As was announced.
            prop_assert!(k == 0 || f64::from(silent) * SEND_PERIOD_NS as f64 * 1e-9 < keep_alive + 1e-3);
            let told = f64::from(wire.told().vector[0]);
            let most = (force_share * told.abs()).max(force_floor / 0.05);
            prop_assert!((told - own).abs() <= most + 1e-3, "{told} for {own}");
        }
    }

    #[test]
    fn nothing_that_comes_panics(
        frames in proptest::collection::vec((any::<u32>(), any::<i64>(), 0..16u8, any::<u8>(), -10.0..10.0f64, any::<i64>()), 0..60),
    ) {
        let mut decoder = Decoder::default();
        for (sequence, stamp_ns, pace, since_content, value, now_ns) in frames {
            let frame = LinkFrame {
                sequence,
                stamp_ns,
                sent_ns: stamp_ns,
                echo: None,
                hold: false,
                state: OperatingState::Enabled,
                arming: 0,
                law: 0,
                pace,
                since_content,
                packet: packet(value, value, 0.0),
                orientation: None,
            };
            let content = (since_content == 0).then_some(&frame);
            decoder.heard(&frame, content, now_ns, |_| motion());
            decoder.step(now_ns);
            if let Some(decoded) = decoder.decoded() {
                prop_assert!(decoded.packet.position.iter().all(|own| own.abs() <= 10.0));
            }
        }
    }
}
